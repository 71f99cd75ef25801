"""Outline of a mask."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]


def trace_outline(mask: BoolArray) -> FloatArray:
    """Outer outline of the part of a mask that holds its first cell, along the cells' edges.

    Args:
        mask: (n, m) with at least one cell set and none on its rim.

    Returns:
        (N, 2) lattice corners, one a unit step, open, counter-clockwise, where cell (i, j) is
        the square [i, i + 1] × [j, j + 1].
    """
    return np.asarray(_trace(np.ascontiguousarray(mask)), dtype=np.float64)


@njit(cache=True)
def _trace(mask):
    n, m = mask.shape
    start_i, start_j = -1, -1
    for i in range(n):
        for j in range(m):
            if mask[i, j]:
                start_i, start_j = i, j
                break
        if start_i >= 0:
            break
    # Corner (i, j); direction 0: +i, 1: +j, 2: -i, 3: -j; the mask lies to the left.
    step_i = np.array([1, 0, -1, 0])
    step_j = np.array([0, 1, 0, -1])
    out = np.empty((4 * n * m + 4, 2), dtype=np.int64)
    count = 0
    i, j, direction = start_i, start_j, 0
    while True:
        out[count, 0], out[count, 1] = i, j
        count += 1
        i += step_i[direction]
        j += step_j[direction]
        if i == start_i and j == start_j:
            break
        # Cells ahead, to the left and to the right of the new corner.
        if direction == 0:
            left, right = mask[i, j], mask[i, j - 1]
        elif direction == 1:
            left, right = mask[i - 1, j], mask[i, j]
        elif direction == 2:
            left, right = mask[i - 1, j - 1], mask[i - 1, j]
        else:
            left, right = mask[i, j - 1], mask[i - 1, j - 1]
        if not left:
            direction = (direction + 1) % 4
        elif right:
            direction = (direction + 3) % 4
    return out[:count].copy()
