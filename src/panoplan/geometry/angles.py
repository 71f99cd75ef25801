"""Angles of directions (period 2π) and of undirected lines (period π)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def line_angle(angle: FloatArray | float) -> FloatArray:
    """The angle of an undirected line, in [0, π)."""
    folded = np.mod(angle, np.pi)
    return np.asarray(np.where(folded >= np.pi, 0.0, folded))


def line_difference(a: FloatArray | float, b: FloatArray | float) -> FloatArray:
    """Signed difference a − b of two line angles, in [−π/2, π/2)."""
    return np.asarray(np.mod(np.subtract(a, b) + np.pi / 2, np.pi) - np.pi / 2)


def wrapped(angle: FloatArray | float) -> FloatArray:
    """An angle in [−π, π)."""
    return np.asarray(np.mod(np.asarray(angle) + np.pi, 2 * np.pi) - np.pi)
