"""The errors of simulated layouts and poses, calibrated on real panoramas: what there is to set."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.simulate.measured import MEASURED
from panoplan.simulate.odometry import (
    MEASURED_ODOMETRY,
    MEASURED_TOUR,
    OdometryErrors,
    TourErrors,
)
from panoplan.simulate.spans import EXACT_SPANS, MEASURED_SPANS, SpanErrors


@dataclass(frozen=True)
class DistanceBin:
    """Errors of the floor boundary at one range of true distance.

    Attributes:
        from_m: the bin's lower end; it reaches to that of the next.
        bias_deg: median error of the elevation, predicted less true.
        core_deg: c of the columns' own error c·z·exp(h·y²/2), z standard Gaussian noise along
            the columns, y the same smoothed.
        tail: h ≥ 0 of the same (nearly Tukey's h distribution): how much heavier than a
            Gaussian's the tails are.
    """

    from_m: float
    bias_deg: float
    core_deg: float
    tail: float


_BEYOND_6_M_SIGMA = 1.25
_BEYOND_6_M_GROSS = 0.25
"""Assumed: angular error relative to that at 4-6 m, and gross share."""

TARGET_SIGMA_DEG = (*MEASURED.sigma_deg, MEASURED.sigma_deg[-1] * _BEYOND_6_M_SIGMA)
TARGET_GROSS_SHARE = (*MEASURED.gross_share, _BEYOND_6_M_GROSS)
"""What the errors of a panorama together come to in each bin, the last from 6 m on."""

# A common factor on a panorama's ranges errs the elevation by sin φ cos φ a unit, the more the
# nearer φ is to 45°. The cores are what is then missing to the target MAD-sigma, at a camera
# height of 1.54 m and distances spread evenly over each bin (0.4-1 m, 6-9 m at the ends). Hard's
# tails make up the target gross shares; the 90th percentiles of the range error follow of
# themselves. At 1.5-2 m hard's scale error alone has the target sigma: its core is kept at
# 0.05°, which leaves the total 7 % above.
_MILD_CORES_DEG = (0.835, 0.526, 0.224, 0.437, 0.626, 0.786, 1.013)
_HARD_CORES_DEG = (0.447, 0.275, 0.050, 0.171, 0.446, 0.472, 0.755)
_HARD_TAILS = (1.56, 0.86, 1.53, 1.25, 0.54, 1.37, 0.97)
# Where leaks through doors and openings are made apart, most gross errors are theirs and columns
# on walls have lighter tails. These are the cores and tails with which whole views of open homes
# have the measured MAD-sigma and 90th percentile in each bin, and at 4-6 m the gross share.
_MEASURED_CORES_DEG = (0.58, 0.415, 0.27, 0.355, 0.55, 0.53, 0.66)
_MEASURED_TAILS = (0.85, 0.55, 0.35, 0.40, 0.25, 0.90, 0.90)


def _mild_bins() -> tuple[DistanceBin, ...]:
    lows = (*MEASURED.from_m, 6.0)
    return tuple(
        DistanceBin(low, 0.0, core, 0.0) for low, core in zip(lows, _MILD_CORES_DEG, strict=True)
    )


def _measured_bins() -> tuple[DistanceBin, ...]:
    lows, biases = (*MEASURED.from_m, 6.0), (*MEASURED.bias_deg, MEASURED.bias_deg[-1])
    columns = zip(lows, biases, _MEASURED_CORES_DEG, _MEASURED_TAILS, strict=True)
    return tuple(DistanceBin(*column) for column in columns)


def _hard_bins() -> tuple[DistanceBin, ...]:
    lows, biases = (*MEASURED.from_m, 6.0), (*MEASURED.bias_deg, MEASURED.bias_deg[-1])
    columns = zip(lows, biases, _HARD_CORES_DEG, _HARD_TAILS, strict=True)
    return tuple(DistanceBin(*column) for column in columns)


@dataclass(frozen=True)
class Correlation:
    """How the error of one column goes with that of another: two exponentials of their distance.

    Attributes:
        near_columns: reach of the first, columns of 1024.
        far_columns: reach of the second.
        near_share: of the first in the variance.
    """

    near_columns: float
    far_columns: float
    near_share: float


COLUMN_CORRELATION = Correlation(44.0, 400.0, 0.683)
"""Of the errors' Gaussian core, as measured."""


@dataclass(frozen=True)
class StatedSigma:
    """How a network states the standard deviation of its own floor boundary.

    It knows of most of its large errors, not of all: the stated value is the usual one at a
    distance and, in the columns where the network is aware of it, the error that it makes there.

    Attributes:
        from_m: lower ends of the distance bins.
        usual_deg: what it states in each where it errs little.
        spread: standard deviation of the logarithm of that along the columns, and once more from
            view to view.
        aware: share of the columns where it is aware of its error.
        columns: over so many columns of 1024 what it states changes.
    """

    from_m: tuple[float, ...]
    usual_deg: tuple[float, ...]
    spread: float
    aware: float
    columns: float


MEASURED_SIGMA = StatedSigma(
    from_m=MEASURED.from_m,
    usual_deg=(0.93, 0.65, 0.48, 0.57, 0.85, 1.0),
    spread=0.12,
    aware=0.7,
    columns=50.0,
)
"""Of the network's own sigma on 23 real panoramas of one home, taken a quarter of a metre and more
from any wall."""


@dataclass(frozen=True)
class NoiseModel:
    """How layouts and poses differ from the truth.

    Attributes:
        name: of the grade.
        bins: errors of the boundary by distance, nearest first; empty: none.
        correlation: of the columns' own errors.
        scale_std: standard deviation of a panorama's common factor on its ranges.
        scale_outlier_share: share of panoramas whose factor is drawn from a wider Gaussian, so
            that it has heavy tails at the same standard deviation.
        scale_core_std: standard deviation of the factor in the other panoramas; of no effect
            where there are no outliers.
        gross_share: share of columns, in contiguous stretches, that are made grossly wrong on
            top of the bins' tails.
        gross_columns: mean length of a stretch, columns of 1024.
        height_jitter: standard deviation of a keyframe's true camera height relative to the
            nominal one, unknown to the odometry.
        occluder_share: share of the views where furniture hides part of the boundary.
        door_leak: probability that the boundary goes through a door.
        opening_leak: probability that it goes through an opening.
        door_part: probability that it goes through a part of a door.
        opening_part: probability that it goes through a part of an opening.
        doorway_leak: probability that it goes through what the camera stands in or right before.
        leak_median_m: median depth of the leaks, lognormal.
        leak_percentile_90_m: 90th percentile of that depth.
        stated: how the network states its own uncertainty; None where it states none.
        corner_recall: share of true corners found, none missed where 1.
        corner_precision: share of the corners told that are true.
        corner_spread: (largest error in columns of 1024, share of found corners within it).
        spans: how doors, openings and windows are told.
        drift_m: largest error of the odometry's position over the walk, metres.
        drift_deg: typical error of the odometry's heading at the end of the walk.
        odometry: how a SLAM errs on a walk, instead of that drift; None for the drift.
        tour: how an aligner of still photos errs, instead of that drift; None for the drift.
    """

    name: str
    bins: tuple[DistanceBin, ...] = ()
    correlation: Correlation = COLUMN_CORRELATION
    scale_std: float = 0.0
    scale_outlier_share: float = 0.0
    scale_core_std: float = 0.0
    gross_share: float = 0.0
    gross_columns: float = 30.0
    height_jitter: float = 0.0
    occluder_share: float = 0.0
    door_leak: float = 0.0
    opening_leak: float = 0.0
    door_part: float = 0.0
    opening_part: float = 0.0
    doorway_leak: float = 0.0
    leak_median_m: float = MEASURED.leak_median_m
    leak_percentile_90_m: float = MEASURED.leak_percentile_90_m
    stated: StatedSigma | None = None
    corner_recall: float = 1.0
    corner_precision: float = 1.0
    corner_spread: tuple[tuple[int, float], ...] = ()
    spans: SpanErrors = EXACT_SPANS
    drift_m: float = 0.0
    drift_deg: float = 0.0
    odometry: OdometryErrors | None = None
    tour: TourErrors | None = None


def _corner_spread() -> tuple[tuple[int, float], ...]:
    most = MEASURED.corner_recall[-1][1]
    return tuple((columns, share / most) for columns, share in MEASURED.corner_recall)


EXACT = NoiseModel("exact")
MILD = NoiseModel(
    "mild",
    bins=_mild_bins(),
    scale_std=0.015,
    gross_share=0.02,
    corner_recall=MEASURED.corner_recall[-1][1],
    corner_precision=MEASURED.corner_precision[-1][1],
    corner_spread=_corner_spread(),
    spans=MEASURED_SPANS,
    drift_m=0.05,
    drift_deg=0.1,
)
HARD = NoiseModel(
    "hard",
    bins=_hard_bins(),
    scale_std=MEASURED.scale_std,
    scale_outlier_share=0.15,
    scale_core_std=0.0129,
    height_jitter=0.03,
    occluder_share=0.3,
    door_leak=0.08,
    opening_leak=0.38,
    corner_recall=MEASURED.corner_recall[-1][1],
    corner_precision=MEASURED.corner_precision[-1][1],
    corner_spread=_corner_spread(),
    spans=MEASURED_SPANS,
    drift_m=0.4,
    drift_deg=1.0,
)
REAL = NoiseModel(
    "measured",
    bins=_measured_bins(),
    scale_std=MEASURED.scale_std,
    correlation=Correlation(110.0, 400.0, 0.6),
    scale_outlier_share=0.15,
    scale_core_std=0.006,
    door_leak=MEASURED.door_through,
    # A leak of less than 0.3 m counts as none where leaks are measured.
    opening_leak=0.28,
    door_part=1 - MEASURED.door_through - MEASURED.door_stops,
    opening_part=1 - MEASURED.opening_through - MEASURED.opening_stops,
    # Square to the wall; along the rays, as measured, they are longer.
    leak_median_m=0.5,
    leak_percentile_90_m=2.4,
    stated=MEASURED_SIGMA,
    doorway_leak=0.5,
    corner_recall=MEASURED.corner_recall[-1][1],
    corner_precision=MEASURED.corner_precision[-1][1],
    corner_spread=_corner_spread(),
    spans=MEASURED_SPANS,
    odometry=MEASURED_ODOMETRY,
    tour=MEASURED_TOUR,
)
GRADES = {model.name: model for model in (EXACT, MILD, HARD, REAL)}
