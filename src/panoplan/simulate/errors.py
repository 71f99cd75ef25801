"""How layouts err: the same figures for a real network's layouts and for simulated ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from panoplan.simulate.measured import MEASURED, gross
from panoplan.simulate.spans import column_runs
from panoplan.simulate.views import Surface, View
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.layout import Layout

_LAST_BIN_M = 6.0
_REFERENCE_WIDTH = 1024
_FEWEST_COLUMNS = 12
_BAD_SHARE, _GOOD_SHARE = 0.25, 0.05
_MAD = 1.4826


@dataclass(frozen=True)
class ErrorTable:
    """Errors of the floor boundary over all columns of all views.

    Columns beyond 6 m count in the shares by surface only.

    Attributes:
        from_m: lower ends of the bins of true distance; the last one ends at 6 m.
        bias_deg: median error of the elevation in each.
        sigma_deg: its MAD-sigma.
        percentile_90_m: 90th percentile of the absolute error of the range.
        gross_share: share of the columns that are grossly wrong.
        gross_by_surface: the same over all distances, by what the closed boundary lies on.
        columns_by_surface: share of the columns.
        scale_std: standard deviation of the views' median ratio of told and true range.
        scale_mad_sigma: its MAD-sigma.
        lags: columns of 1024.
        autocorrelation: of the errors along the columns, less each view's median, without gross
            ones.
        through: of the doors and openings seen, the share that the boundary goes through: by more
            than is gross in at least half of the columns.
        stops: the share that it stops at: in at least nine tenths of the columns.
        leak_median_m: median depth of what goes through.
        leak_percentile_90_m: 90th percentile of that.
        bad_views: share of the views with more than a quarter of their columns grossly wrong.
        good_views: share of those with less than a twentieth.
        views: how many.
    """

    from_m: tuple[float, ...]
    bias_deg: tuple[float, ...]
    sigma_deg: tuple[float, ...]
    percentile_90_m: tuple[float, ...]
    gross_share: tuple[float, ...]
    gross_by_surface: dict[str, float]
    columns_by_surface: dict[str, float]
    scale_std: float
    scale_mad_sigma: float
    lags: tuple[int, ...]
    autocorrelation: tuple[float, ...]
    through: dict[str, float]
    stops: dict[str, float]
    leak_median_m: float
    leak_percentile_90_m: float
    bad_views: float
    good_views: float
    views: int


def error_table(views: Sequence[View], layouts: Sequence[Layout]) -> ErrorTable:
    """The errors of layouts against the exact views.

    Args:
        views: exact; only what is closed at doors and openings counts as true.
        layouts: one a view, of as many columns, of a level camera.

    Returns:
        The table; what nothing was seen of is NaN.
    """
    true = np.array([view.closed_range_m for view in views])
    height = np.array([view.camera_height_m for view in views])[:, None]
    told_rad = np.array([layout.floor_boundary for layout in layouts])
    told = height / np.tan(np.maximum(-told_rad, 1e-3))
    degrees = np.rad2deg(told_rad + np.arctan2(height, true))
    wrong = gross(told, true)
    surface = np.array([view.closed_surface for view in views])
    edges = np.array([*MEASURED.from_m, _LAST_BIN_M])
    inside = [(true >= low) & (true < high) for low, high in pairwise(edges)]
    kinds = (Surface.WALL, Surface.DOOR, Surface.OPENING, Surface.WINDOW)
    scale = np.median(told / true, axis=1)
    passages = {kind: _passages(views, told, wrong, kind) for kind in kinds[1:3]}
    depths = np.concatenate([found[2] for found in passages.values()])
    by_view = wrong.mean(axis=1)
    return ErrorTable(
        from_m=MEASURED.from_m,
        bias_deg=tuple(_median(degrees[k]) for k in inside),
        sigma_deg=tuple(_mad_sigma(degrees[k]) for k in inside),
        percentile_90_m=tuple(_quantile(np.abs(told - true)[k], 0.9) for k in inside),
        gross_share=tuple(_mean(wrong[k]) for k in inside),
        gross_by_surface={k.name.lower(): _mean(wrong[surface == k]) for k in kinds},
        columns_by_surface={k.name.lower(): float((surface == k).mean()) for k in kinds},
        scale_std=float(scale.std()),
        scale_mad_sigma=_mad_sigma(scale),
        lags=MEASURED.lags,
        autocorrelation=_autocorrelation(degrees, wrong),
        through={k.name.lower(): _mean(found[0]) for k, found in passages.items()},
        stops={k.name.lower(): _mean(found[1]) for k, found in passages.items()},
        leak_median_m=_median(depths),
        leak_percentile_90_m=_quantile(depths, 0.9),
        bad_views=float((by_view > _BAD_SHARE).mean()),
        good_views=float((by_view < _GOOD_SHARE).mean()),
        views=len(views),
    )


def _passages(
    views: Sequence[View], told: FloatArray, wrong: BoolArray, kind: Surface
) -> tuple[BoolArray, BoolArray, FloatArray]:
    """Of each door or opening seen: whether gone through, whether stopped at; depths of leaks."""
    through, stops, depths = [], [], []
    for view, told_here, wrong_here in zip(views, told, wrong, strict=True):
        width = len(told_here)
        for first, last in column_runs(view.closed_surface == kind, view.passage):
            columns = np.arange(first, last + 1) % width
            if len(columns) < _FEWEST_COLUMNS * width / _REFERENCE_WIDTH:
                continue
            excess = told_here[columns] - view.closed_range_m[columns]
            beyond = wrong_here[columns] & (excess > 0)
            through.append(beyond.mean() >= 0.5)
            stops.append(wrong_here[columns].mean() <= 0.1)
            if through[-1]:
                depths.append(float(np.median(excess[beyond])))
    return np.array(through), np.array(stops), np.array(depths, dtype=np.float64)


def _autocorrelation(degrees: FloatArray, wrong: BoolArray) -> tuple[float, ...]:
    right = np.where(wrong, np.nan, degrees)
    right = right - np.nanmedian(right, axis=1, keepdims=True)
    width = degrees.shape[1]
    found = []
    for lag in MEASURED.lags:
        other = np.roll(right, lag * width // _REFERENCE_WIDTH, axis=1)
        both = ~np.isnan(right) & ~np.isnan(other)
        a, b = right[both], other[both]
        spread = float(np.sqrt((a * a).mean() * (b * b).mean()))
        found.append(float((a * b).mean()) / spread if spread > 0 else float("nan"))
    return tuple(found)


def _median(values: FloatArray) -> float:
    return float(np.median(values)) if values.size else float("nan")


def _mad_sigma(values: FloatArray) -> float:
    return _MAD * _median(np.abs(values - np.median(values))) if values.size else float("nan")


def _quantile(values: FloatArray, share: float) -> float:
    return float(np.quantile(values, share)) if values.size else float("nan")


def _mean(values: FloatArray | BoolArray) -> float:
    return float(np.mean(values)) if values.size else float("nan")
