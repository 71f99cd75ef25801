"""Rings of points cut into straight pieces."""

from __future__ import annotations

import itertools

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def resampled(ring: FloatArray, step: float) -> FloatArray:
    """A ring with evenly spaced points.

    Args:
        ring: (N, 2) open.
        step: distance of the points along the ring, rounded so that they come out even.

    Returns:
        (M, 2) open, at least 8 points, the first one kept.
    """
    closed = np.vstack([ring, ring[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    at = np.linspace(0.0, along[-1], max(8, round(along[-1] / step)), endpoint=False)
    return np.stack([np.interp(at, along, closed[:, k]) for k in (0, 1)], axis=-1)


def straight_pieces(ring: FloatArray, sigma: float, corner_cost: float) -> list[FloatArray]:
    """Cuts a ring into the pieces that straight lines explain best.

    The cut with the least sum of squared distances of the points to the line through their piece,
    over `sigma`², plus `corner_cost` a piece, by dynamic programming: exact for a ring that is
    opened at one of its corners. Such a corner is found by a first cut.

    Args:
        ring: (N, 2) open, N ≥ 4.
        sigma: standard deviation of the points about a line.
        corner_cost: what a further piece must save.

    Returns:
        The pieces in order, each (K, 2) with K ≥ 2.
    """
    centred = ring - ring.mean(axis=0)
    turn = int(np.argmax((centred**2).sum(axis=1)))
    for last in (False, True):
        turned = np.roll(centred, -turn, axis=0)
        cuts = _cuts(turned, sigma * sigma, corner_cost)
        if last or len(cuts) <= 3:
            break
        # The farthest point need not be a corner; one in the middle of the first cut is.
        turn += cuts[len(cuts) // 2]
    opened = np.roll(ring, -turn, axis=0)
    return [opened[i:j] for i, j in itertools.pairwise(cuts)]


def _cuts(points: FloatArray, variance: float, corner_cost: float) -> list[int]:
    """First indices of the pieces that cost least, and the number of points."""
    n = len(points)
    x, y = points.T
    sums = np.zeros((n + 1, 5))
    np.cumsum(np.stack([x, y, x * x, y * y, x * y], axis=1), axis=0, out=sums[1:])
    best = np.full(n + 1, np.inf)
    best[0] = 0.0
    before = np.zeros(n + 1, dtype=np.int64)
    _cheapest(sums, variance, corner_cost, best, before)
    cuts = [n]
    while cuts[-1] > 0:
        cuts.append(int(before[cuts[-1]]))
    return cuts[::-1]


@njit(cache=True)
def _cheapest(sums, variance, corner_cost, best, before):
    for j in range(2, best.size):
        for i in range(j - 1):
            if best[i] + corner_cost >= best[j]:
                continue
            k = j - i
            sx, sy = sums[j, 0] - sums[i, 0], sums[j, 1] - sums[i, 1]
            xx = sums[j, 2] - sums[i, 2] - sx * sx / k
            yy = sums[j, 3] - sums[i, 3] - sy * sy / k
            xy = sums[j, 4] - sums[i, 4] - sx * sy / k
            # Smaller eigenvalue of the scatter: the squared distances to the best line.
            off = 0.5 * (xx + yy) - np.sqrt(0.25 * (xx - yy) ** 2 + xy * xy)
            cost = best[i] + max(off, 0.0) / variance + corner_cost
            if cost < best[j]:
                best[j] = cost
                before[j] = i
