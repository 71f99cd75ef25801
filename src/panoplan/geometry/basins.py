"""Basins of a height map, joined where the pass between them is high."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def basins(height: FloatArray, neck: float) -> IntArray:
    """Splits what is above zero into the surroundings of its peaks.

    Cells are taken from the highest down. One without a neighbour that was taken begins a basin,
    another joins that of its highest neighbour. Where two basins meet at a height of at least
    `neck` times the lower one's peak, they become one.

    Args:
        height: (n, m), 0 where there is nothing.
        neck: in [0, 1]; 0 joins all that touch, above 1 none.

    Returns:
        (n, m) labels from 1 up, 0 where there is nothing.
    """
    order = np.argsort(-height, axis=None, kind="stable")
    order = order[: int(np.count_nonzero(height > 0))]
    labels, parents = _flood(np.pad(height, 1), order, neck)
    roots = _roots(parents)
    _, numbered = np.unique(roots[1:], return_inverse=True)
    return np.asarray(np.concatenate([[0], numbered + 1])[labels[1:-1, 1:-1]])


@njit(cache=True)
def _root(parents, k):
    while parents[k] != k:
        parents[k] = parents[parents[k]]
        k = parents[k]
    return k


@njit(cache=True)
def _roots(parents):
    return np.array([_root(parents, k) for k in range(parents.size)])


@njit(cache=True)
def _flood(height, order, neck):
    rows, cols = height.shape
    labels = np.zeros((rows, cols), dtype=np.int64)
    parents = np.zeros(order.size + 1, dtype=np.int64)
    peaks = np.zeros(order.size + 1)
    count = 0
    for place in order:
        i, j = place // (cols - 2) + 1, place % (cols - 2) + 1
        here = height[i, j]
        best, highest = 0, 0.0
        for di in range(-1, 2):
            for dj in range(-1, 2):
                other = labels[i + di, j + dj]
                if other and height[i + di, j + dj] > highest:
                    best, highest = other, height[i + di, j + dj]
        if best == 0:
            count += 1
            parents[count] = count
            peaks[count] = here
            labels[i, j] = count
            continue
        labels[i, j] = best
        for di in range(-1, 2):
            for dj in range(-1, 2):
                other = labels[i + di, j + dj]
                if other == 0:
                    continue
                a, b = _root(parents, best), _root(parents, other)
                if a != b and here >= neck * min(peaks[a], peaks[b]):
                    if peaks[a] < peaks[b]:
                        a, b = b, a
                    parents[b] = a
    return labels, parents[: count + 1]
