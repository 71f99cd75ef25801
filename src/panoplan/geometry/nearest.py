"""Nearest neighbours among unit vectors, both ways, with how much nearer than the second ones."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Float32Array = NDArray[np.float32]
FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ROWS = 512


def mutual_nearest(a: Float32Array, b: Float32Array) -> tuple[IntArray, FloatArray]:
    """Pairs that are each other's nearest neighbour.

    Args:
        a: (N, D) unit vectors.
        b: (M, D) unit vectors.

    Returns:
        (K, 2) indices into a and b, by rising index into a; (K,) the distance over that of the
        second neighbour, the larger one of both ways, 0-1 (1 where there is no second one).
    """
    if not len(a) or not len(b):
        return np.empty((0, 2), dtype=np.int64), np.empty(0)
    rows = _Nearest(len(a))
    columns = _Nearest(len(b))
    for start in range(0, len(a), _ROWS):
        cosines = a[start : start + _ROWS] @ b.T
        _scan(cosines, start, *rows.arrays, *columns.arrays)
    mutual = np.flatnonzero(columns.index[rows.index] == np.arange(len(a)))
    partner = rows.index[mutual]
    ratio = np.maximum(rows.ratios()[mutual], columns.ratios()[partner])
    return np.column_stack([mutual, partner]), ratio


class _Nearest:
    """The best and the second cosine of each vector, and the index of the best."""

    def __init__(self, count: int) -> None:
        self.index = np.zeros(count, dtype=np.int64)
        self.best = np.full(count, -np.inf, dtype=np.float32)
        self.second = np.full(count, -np.inf, dtype=np.float32)

    @property
    def arrays(self) -> tuple[IntArray, Float32Array, Float32Array]:
        return self.index, self.best, self.second

    def ratios(self) -> FloatArray:
        """Distance of the nearest over that of the second one."""
        near = np.sqrt(np.maximum(0.0, 2.0 - 2.0 * self.best.astype(np.float64)))
        far = np.sqrt(np.maximum(0.0, 2.0 - 2.0 * self.second.astype(np.float64)))
        known = np.isfinite(far) & (far > 0)
        return np.where(known, near / np.where(known, far, 1.0), 1.0)


@njit(cache=True)
def _scan(cosines, start, row_at, row_best, row_second, column_at, column_best, column_second):
    for i in range(cosines.shape[0]):
        at, best, second = 0, np.float32(-np.inf), np.float32(-np.inf)
        for j in range(cosines.shape[1]):
            value = cosines[i, j]
            if value > second:
                if value > best:
                    at, best, second = j, value, best
                else:
                    second = value
            if value > column_second[j]:
                if value > column_best[j]:
                    column_second[j] = column_best[j]
                    column_best[j] = value
                    column_at[j] = start + i
                else:
                    column_second[j] = value
        row_at[start + i], row_best[start + i], row_second[start + i] = at, best, second
