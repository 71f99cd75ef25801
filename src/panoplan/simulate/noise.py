"""How a layout network errs: noise calibrated on real panoramas.

All figures of `MEASURED` come from 69 real panoramas of two homes with a real layout network's
predictions, compared with human annotation.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.special import ndtri

from panoplan.simulate.odometry import (
    MEASURED_ODOMETRY,
    MEASURED_TOUR,
    OdometryErrors,
    TourErrors,
)
from panoplan.simulate.spans import EXACT_SPANS, MEASURED_SPANS, SpanErrors, noisy_spans
from panoplan.simulate.views import View
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.layout import Layout

GROSS_M = 0.3
"""A range is grossly wrong where it errs by more than this and `GROSS_SHARE` of the range."""
GROSS_SHARE = 0.15

_REFERENCE_WIDTH = 1024
_STEEPEST_RAD, _SHALLOWEST_RAD = np.deg2rad(-89.99), np.deg2rad(-1.5)
_CEILING_CORRELATION = 0.6
_LARGEST_ERROR_RAD = np.deg2rad(60.0)
_TAIL_SMOOTHING_COLUMNS = 6.0
"""What swells an error changes slowly, so that a gross error is a stretch and no spike."""
_PERCENTILE_90_Z = 1.2815515655446004


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


@dataclass(frozen=True)
class Leak:
    """A boundary that goes through a door or an opening.

    Attributes:
        depth_m: how far, square to the wall.
        partly: whether it does so in a part of the columns only.
    """

    depth_m: float
    partly: bool = False


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


def draw_leaks(
    doors: Iterable[int],
    openings: Iterable[int],
    model: NoiseModel,
    rng: np.random.Generator,
    near: Container[int] = (),
) -> dict[int, Leak]:
    """Which passages of a room a view goes through, and how deep.

    Args:
        doors: indices of the room's doors.
        openings: indices of its openings.
        model: the grade.
        rng: of the draw.
        near: those that the camera stands in or right before.

    Returns:
        The leaks, by index of the passage.
    """
    spread = np.log(model.leak_percentile_90_m / model.leak_median_m) / _PERCENTILE_90_Z
    leaks = {}
    for indices, share, part in (
        (doors, model.door_leak, model.door_part),
        (openings, model.opening_leak, model.opening_part),
    ):
        for k in indices:
            chance, depth = rng.random(), rng.standard_normal()
            whole = max(share, model.doorway_leak) if k in near else share
            if chance < whole + part:
                depth_m = float(model.leak_median_m * np.exp(spread * depth))
                leaks[k] = Leak(depth_m, chance >= whole)
    return leaks


def partly_closed(view: View, leaks: Mapping[int, Leak], rng: np.random.Generator) -> View:
    """The view with leaks that are partial closed in the rest of their columns.

    Args:
        view: with all leaks.
        leaks: by index of the passage.
        rng: of the part.

    Returns:
        The view; a part of one fifth to four fifths at one end stays open.
    """
    closed = np.zeros(len(view.range_m), dtype=np.bool_)
    for k in (k for k, leak in leaks.items() if leak.partly):
        columns = np.flatnonzero(view.leaked & (view.passage == k))
        # Columns in the order of the image, over its edge where need be.
        gap = (
            int(np.argmax(np.diff(columns, append=columns[:1] + len(closed))))
            if len(columns)
            else 0
        )
        columns = np.roll(columns, -gap - 1)
        stays, at_start = int(rng.uniform(0.2, 0.8) * len(columns)), rng.random() < 0.5
        closed[columns[stays:] if at_start else columns[: len(columns) - stays]] = True
    if not closed.any():
        return view
    return replace(
        view,
        range_m=np.where(closed, view.closed_range_m, view.range_m),
        surface=np.where(closed, view.closed_surface, view.surface),
        leaked=view.leaked & ~closed,
    )


def scale_factor(model: NoiseModel, rng: np.random.Generator) -> float:
    """A panorama's common factor on its ranges, around 1."""
    share, core = model.scale_outlier_share, model.scale_core_std
    outlier, z = rng.random() < share, float(rng.standard_normal())
    if share == 0:
        return float(np.exp(model.scale_std * z))
    wide = np.sqrt((model.scale_std**2 - (1 - share) * core**2) / share)
    return float(np.exp((wide if outlier else core) * z))


def noisy_layout(view: View, model: NoiseModel, rng: np.random.Generator) -> Layout:
    """What a layout network tells of a view.

    Args:
        view: the truth, leaks included.
        model: the grade.
        rng: of all errors.

    Returns:
        Floor and ceiling boundary, corners and spans with the errors of the model. The ceiling's
        errors are not measured: they are the floor's core, partly independent.
    """
    width = len(view.range_m)
    ranges, corners = view.range_m, view.corners
    if rng.random() < model.occluder_share:
        ranges, edges = _occluded(ranges, rng)
        corners = np.append(corners, edges)
    factor = scale_factor(model, rng) * (1 + model.height_jitter * rng.standard_normal())
    field, calm = _column_fields(width, model.correlation, rng)
    bias, core, tail = _errors_at(model, view.range_m)
    own = core * field * np.exp(tail * calm**2 / 2)
    error = bias + _LARGEST_ERROR_RAD * np.tanh(own / _LARGEST_ERROR_RAD)
    elevation = -np.arctan2(view.camera_height_m, ranges * factor) + error
    elevation = np.clip(elevation, _STEEPEST_RAD, _SHALLOWEST_RAD)
    elevation = _with_gross(elevation, view, model, rng)
    apart = column_field(width, rng, model.correlation)
    shared = _CEILING_CORRELATION
    ceiling = view.ceiling_boundary - core * (shared * field + np.sqrt(1 - shared**2) * apart)
    found = noisy_corners(corners, width, model, rng)
    spans = noisy_spans(view, model.spans, rng)
    sigma = None if model.stated is None else stated_sigma(view, elevation, model.stated, rng)
    return Layout(elevation, ceiling, found, sigma, spans)


def stated_sigma(
    view: View, elevation: FloatArray, stated: StatedSigma, rng: np.random.Generator
) -> FloatArray:
    """What a network states as the standard deviation of a floor boundary.

    Args:
        view: the truth.
        elevation: (W,) rad, as told.
        stated: how it states.
        rng: of what it is aware of.

    Returns:
        (W,) rad.
    """
    width = len(elevation)
    smoothing = stated.columns * width / _REFERENCE_WIDTH

    def field() -> FloatArray:
        white = gaussian_filter1d(rng.standard_normal(width), smoothing, mode="wrap")
        return np.asarray(white * np.sqrt(2 * np.sqrt(np.pi) * smoothing))

    usual = np.interp(view.closed_range_m, stated.from_m, stated.usual_deg)
    usual = np.deg2rad(usual) * np.exp(stated.spread * (field() + rng.standard_normal()))
    error = np.abs(elevation + np.arctan2(view.camera_height_m, view.closed_range_m))
    error = gaussian_filter1d(error, smoothing / 4, mode="wrap")
    aware = field() < ndtri(stated.aware)
    share = gaussian_filter1d(aware.astype(np.float64), smoothing / 4, mode="wrap")
    return np.asarray(np.hypot(usual, share * error))


def column_field(
    width: int, rng: np.random.Generator, correlated: Correlation = COLUMN_CORRELATION
) -> FloatArray:
    """Gaussian noise around the panorama, correlated along the columns.

    Args:
        width: number of columns W, which go once around.
        rng: of the noise.
        correlated: how.

    Returns:
        (W,) of unit variance.
    """
    return _column_fields(width, correlated, rng)[0]


def _column_fields(
    width: int, correlated: Correlation, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """A field as `column_field` gives it and a smoothed one of unit variance that follows it."""
    white = np.fft.rfft(rng.standard_normal(width))
    rough, smooth = _amplitudes(width, correlated)
    return (
        np.asarray(np.fft.irfft(white * rough, n=width)),
        np.asarray(np.fft.irfft(white * smooth, n=width)),
    )


def correlation(lag: FloatArray, of: Correlation = COLUMN_CORRELATION) -> FloatArray:
    """Correlation of the column noise at lags in columns of 1024."""
    near = np.exp(-lag / of.near_columns)
    return np.asarray(of.near_share * near + (1 - of.near_share) * np.exp(-lag / of.far_columns))


@lru_cache(maxsize=8)
def _amplitudes(width: int, correlated: Correlation) -> tuple[FloatArray, FloatArray]:
    """Gains that give white noise the columns' correlation, and the same with smoothing."""
    column = np.arange(width)
    lag = np.minimum(column, width - column) * (_REFERENCE_WIDTH / width)
    spectrum = np.maximum(np.fft.rfft(correlation(lag, correlated)).real, 0.0)
    blur = np.exp(-(np.minimum(lag / _TAIL_SMOOTHING_COLUMNS, 30.0) ** 2) / 2)
    passed = np.fft.rfft(blur / blur.sum()).real
    smoothed = spectrum * passed**2
    variance = np.fft.irfft(smoothed, n=width)[0]
    return np.sqrt(spectrum), np.sqrt(smoothed / variance)


def _errors_at(model: NoiseModel, range_m: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Bias and core in rad, and tail, of each column."""
    if not model.bins:
        none = np.zeros(len(range_m))
        return none, none, none
    edges = np.array([b.from_m for b in model.bins])
    table = np.array([[b.bias_deg, b.core_deg, b.tail] for b in model.bins])
    bias, core, tail = table[np.searchsorted(edges, range_m, side="right") - 1].T
    return np.deg2rad(bias), np.deg2rad(core), tail


def _occluded(ranges: FloatArray, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Furniture on the boundary: it moves closer over one to three stretches.

    Returns:
        The ranges and the columns where the stretches begin and end.
    """
    width = len(ranges)
    out = ranges.copy()
    edges = []
    for _ in range(int(rng.integers(1, 4))):
        length = int(width * rng.uniform(8, 40) / 360)
        start = int(rng.integers(width))
        columns = (start + np.arange(length)) % width
        depth = rng.uniform(0.35, 0.9)
        closest = np.minimum(out[columns], np.maximum(0.4 * ranges[columns], 0.4))
        out[columns] = np.maximum(ranges[columns] - depth, closest)
        edges += [start, (start + length) % width]
    return out, np.array(edges, dtype=np.float64)


def _stretches(width: int, model: NoiseModel, rng: np.random.Generator) -> list[IntArray]:
    mean = model.gross_columns * width / _REFERENCE_WIDTH
    count = rng.poisson(model.gross_share * width / mean)
    found = []
    for _ in range(count):
        length = int(np.ceil(rng.exponential(mean)))
        found.append((int(rng.integers(width)) + np.arange(min(length, width))) % width)
    return found


def _with_gross(
    elevation: FloatArray, view: View, model: NoiseModel, rng: np.random.Generator
) -> FloatArray:
    """Makes stretches of the boundary grossly wrong: too near or too far."""
    out = elevation.copy()
    for columns in _stretches(len(elevation), model, rng):
        true = view.range_m[columns]
        told = view.camera_height_m / np.tan(-elevation[columns])
        size = 1.5 + rng.exponential(1.0)
        error = size * np.maximum(GROSS_M, GROSS_SHARE * true)
        nearer = rng.random() < 0.5 and bool(np.all(told - error > 0.4))
        wrong = np.maximum(told + (-error if nearer else error), 0.2)
        out[columns] = -np.arctan2(view.camera_height_m, wrong)
    return out


def noisy_corners(
    corners: FloatArray, width: int, model: NoiseModel, rng: np.random.Generator
) -> FloatArray:
    """Corners as a network finds them: some missed, some made up, the rest a little off.

    Args:
        corners: (K,) true columns.
        width: number of columns W.
        model: the grade.
        rng: of the draw.

    Returns:
        (M,) sorted columns in [0, W).
    """
    kept = corners[rng.random(len(corners)) < model.corner_recall]
    if model.corner_spread:
        limits = np.array([0, *(columns for columns, _ in model.corner_spread)], dtype=np.float64)
        shares = np.array([0.0, *(share for _, share in model.corner_spread)])
        off = np.interp(rng.random(len(kept)), shares, limits) * width / _REFERENCE_WIDTH
        kept = kept + off * rng.choice([-1.0, 1.0], len(kept))
    hits = model.corner_recall * len(corners)
    made_up = rng.uniform(0, width, (rng.poisson(hits * (1 / model.corner_precision - 1)), 20))
    gap = np.abs((made_up[..., None] - corners + width / 2) % width - width / 2)
    away = gap.min(axis=2, initial=width) > 20 * width / _REFERENCE_WIDTH
    made_up = made_up[np.arange(len(made_up)), np.argmax(away, axis=1)]
    return np.sort(np.concatenate([kept, made_up]) % width)


def gross(told_m: FloatArray, true_m: FloatArray) -> BoolArray:
    """Which told ranges are grossly wrong: by more than 0.3 m and more than 15 %."""
    return np.asarray(np.abs(told_m - true_m) > np.maximum(GROSS_M, GROSS_SHARE * true_m))
