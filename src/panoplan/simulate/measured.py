"""How a layout network errs: what was measured.

All figures of `MEASURED` come from 69 real panoramas of two homes with a real layout network's
predictions, compared with human annotation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.types.arrays import BoolArray, FloatArray

REFERENCE_WIDTH = 1024
"""Columns are told as of panoramas of this width."""

GROSS_M = 0.3
"""A range is grossly wrong where it errs by more than this and `GROSS_SHARE` of the range."""
GROSS_SHARE = 0.15


@dataclass(frozen=True)
class Measured:
    """What was measured on real panoramas.

    Attributes:
        from_m: lower ends of the distance bins; the last one ends at 6 m.
        bias_deg: median error of the elevation in each.
        sigma_deg: MAD-sigma of that error in each.
        percentile_90_m: 90th percentile of the absolute error of the range in each.
        gross_share: share of columns that are grossly wrong in each.
        lags: columns of 1024.
        autocorrelation: of the residuals along the columns at those lags.
        scale_std: standard deviation of a panorama's common error of scale.
        scale_mad_sigma: its MAD-sigma.
        corner_recall: (tolerance in columns of 1024, share of true corners found within it).
        corner_precision: (tolerance, share of the found corners that are true).
        door_through: share of the doors that the boundary goes through.
        door_stops: share that it stops at; it goes through a part of the others.
        opening_through: the same of openings.
        opening_stops: the same of openings.
        leak_median_m: median depth of a leak.
        leak_percentile_90_m: 90th percentile of that depth.
        gross_wall: share of the columns on walls that are grossly wrong.
        gross_door: the same on doors.
        gross_opening: the same on openings.
        gross_window: the same on windows.
        bad_views: share of panoramas with more than a quarter of their columns grossly wrong.
        good_views: share of those with less than a twentieth.
    """

    from_m: tuple[float, ...] = (0.0, 1.0, 1.5, 2.0, 3.0, 4.0)
    bias_deg: tuple[float, ...] = (-0.03, -0.22, -0.09, 0.07, 0.16, 0.08)
    sigma_deg: tuple[float, ...] = (0.89, 0.67, 0.48, 0.58, 0.70, 0.82)
    percentile_90_m: tuple[float, ...] = (0.17, 0.12, 0.10, 0.19, 0.29, 1.84)
    gross_share: tuple[float, ...] = (0.075, 0.020, 0.028, 0.053, 0.042, 0.171)
    lags: tuple[int, ...] = (1, 4, 8, 16, 32, 64)
    autocorrelation: tuple[float, ...] = (0.98, 0.94, 0.88, 0.78, 0.62, 0.43)
    scale_std: float = 0.028
    scale_mad_sigma: float = 0.015
    corner_recall: tuple[tuple[int, float], ...] = ((5, 0.58), (10, 0.66), (20, 0.71))
    corner_precision: tuple[tuple[int, float], ...] = ((5, 0.68), (10, 0.77), (20, 0.83))
    door_through: float = 0.035
    door_stops: float = 0.92
    opening_through: float = 0.24
    opening_stops: float = 0.62
    leak_median_m: float = 0.74
    leak_percentile_90_m: float = 3.3
    gross_wall: float = 0.013
    gross_door: float = 0.032
    gross_opening: float = 0.31
    gross_window: float = 0.025
    bad_views: float = 6 / 69
    good_views: float = 54 / 69


MEASURED = Measured()


def gross(told_m: FloatArray, true_m: FloatArray) -> BoolArray:
    """Which told ranges are grossly wrong: by more than 0.3 m and more than 15 %."""
    return np.asarray(np.abs(told_m - true_m) > np.maximum(GROSS_M, GROSS_SHARE * true_m))
