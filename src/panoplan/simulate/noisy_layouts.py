"""What a layout network tells of a view, with the errors of a noise model."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.special import ndtri

from panoplan.simulate.columns import column_field, column_fields
from panoplan.simulate.measured import GROSS_M, GROSS_SHARE, REFERENCE_WIDTH
from panoplan.simulate.noise import NoiseModel, StatedSigma
from panoplan.simulate.spans import noisy_spans
from panoplan.simulate.views import View
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.layout import Layout

_STEEPEST_RAD, _SHALLOWEST_RAD = np.deg2rad(-89.99), np.deg2rad(-1.5)
_CEILING_CORRELATION = 0.6
_LARGEST_ERROR_RAD = np.deg2rad(60.0)


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
    field, calm = column_fields(width, model.correlation, rng)
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


def scale_factor(model: NoiseModel, rng: np.random.Generator) -> float:
    """A panorama's common factor on its ranges, around 1."""
    share, core = model.scale_outlier_share, model.scale_core_std
    outlier, z = rng.random() < share, float(rng.standard_normal())
    if share == 0:
        return float(np.exp(model.scale_std * z))
    wide = np.sqrt((model.scale_std**2 - (1 - share) * core**2) / share)
    return float(np.exp((wide if outlier else core) * z))


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
    smoothing = stated.columns * width / REFERENCE_WIDTH

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
        off = np.interp(rng.random(len(kept)), shares, limits) * width / REFERENCE_WIDTH
        kept = kept + off * rng.choice([-1.0, 1.0], len(kept))
    hits = model.corner_recall * len(corners)
    made_up = rng.uniform(0, width, (rng.poisson(hits * (1 / model.corner_precision - 1)), 20))
    gap = np.abs((made_up[..., None] - corners + width / 2) % width - width / 2)
    away = gap.min(axis=2, initial=width) > 20 * width / REFERENCE_WIDTH
    made_up = made_up[np.arange(len(made_up)), np.argmax(away, axis=1)]
    return np.sort(np.concatenate([kept, made_up]) % width)


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
    mean = model.gross_columns * width / REFERENCE_WIDTH
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
