"""Segments drawn onto grids."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def splat_segments(
    target: FloatArray, ends: FloatArray, sigmas: FloatArray, weights: FloatArray
) -> None:
    """Adds segments with a normal profile across, in place.

    Args:
        target: (n, m) grid, sampled at cell centres.
        ends: (S, 2, 2) segments in cells.
        sigmas: (S,) width in cells.
        weights: (S,) height of the profile.
    """
    _splat(target, ends, sigmas, weights)


@njit(cache=True)
def _splat(target, ends, sigmas, weights):
    rows, cols = target.shape
    for k in range(ends.shape[0]):
        ax, ay, bx, by = ends[k, 0, 0], ends[k, 0, 1], ends[k, 1, 0], ends[k, 1, 1]
        reach = 3.0 * sigmas[k]
        i0, i1 = max(0, int(min(ax, bx) - reach)), min(rows, int(max(ax, bx) + reach) + 2)
        j0, j1 = max(0, int(min(ay, by) - reach)), min(cols, int(max(ay, by) + reach) + 2)
        dx, dy = bx - ax, by - ay
        squared = max(dx * dx + dy * dy, 1e-12)
        for i in range(i0, i1):
            for j in range(j0, j1):
                x, y = i + 0.5 - ax, j + 0.5 - ay
                t = min(max((x * dx + y * dy) / squared, 0.0), 1.0)
                ex, ey = x - t * dx, y - t * dy
                q = (ex * ex + ey * ey) / (sigmas[k] * sigmas[k])
                if q < 9.0:
                    target[i, j] += weights[k] * np.exp(-0.5 * q)
