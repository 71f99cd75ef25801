"""Noise around a panorama, correlated along its columns."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from panoplan.simulate.measured import REFERENCE_WIDTH
from panoplan.simulate.noise import COLUMN_CORRELATION, Correlation
from panoplan.types.arrays import FloatArray

_TAIL_SMOOTHING_COLUMNS = 6.0
"""What swells an error changes slowly, so that a gross error is a stretch and no spike."""


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
    return column_fields(width, correlated, rng)[0]


def column_fields(
    width: int, correlated: Correlation, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Noise as of `column_field` with a smoothed one that follows it.

    Args:
        width: number of columns W.
        correlated: how.
        rng: of the noise.

    Returns:
        Two (W,) of unit variance.
    """
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
    lag = np.minimum(column, width - column) * (REFERENCE_WIDTH / width)
    spectrum = np.maximum(np.fft.rfft(correlation(lag, correlated)).real, 0.0)
    blur = np.exp(-(np.minimum(lag / _TAIL_SMOOTHING_COLUMNS, 30.0) ** 2) / 2)
    passed = np.fft.rfft(blur / blur.sum()).real
    smoothed = spectrum * passed**2
    variance = np.fft.irfft(smoothed, n=width)[0]
    return np.sqrt(spectrum), np.sqrt(smoothed / variance)
