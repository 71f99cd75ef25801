"""Lines through noisy points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class LineFit:
    """A line n·x = d.

    Attributes:
        normal: (2,) unit normal n.
        offset: d.
        inliers: (N,) which points lie within the residual.
    """

    normal: FloatArray
    offset: float
    inliers: BoolArray


def ransac_line(points: FloatArray, pairs: IntArray, max_residual: float) -> LineFit | None:
    """The line with most inliers among those through given pairs, refitted to its inliers.

    Args:
        points: (N, 2), N ≥ 2.
        pairs: (I, 2) indices of the points each candidate goes through.
        max_residual: largest distance of an inlier.

    Returns:
        The total-least-squares line of the best candidate's inliers with its own inliers, or
        None where all pairs coincide.
    """
    best = _best_candidate(points, pairs, max_residual)
    if not best.any():
        return None
    kept = points[best]
    centre = kept.mean(axis=0)
    _, axes = np.linalg.eigh((kept - centre).T @ (kept - centre))
    normal = axes[:, 0]
    offset = float(normal @ centre)
    return LineFit(normal, offset, np.abs(points @ normal - offset) <= max_residual)


def farthest_from_chord(points: FloatArray) -> tuple[int, float]:
    """Index of the point farthest from the line through the first and last, and its distance."""
    along = points[-1] - points[0]
    length = float(np.hypot(along[0], along[1]))
    from_first = points - points[0]
    if length == 0.0:
        distance = np.hypot(from_first[:, 0], from_first[:, 1])
    else:
        distance = np.abs(along[0] * from_first[:, 1] - along[1] * from_first[:, 0]) / length
    at = int(np.argmax(distance))
    return at, float(distance[at])


@njit(cache=True)
def _best_candidate(points, pairs, max_residual):
    n = points.shape[0]
    best = np.zeros(n, dtype=np.bool_)
    best_count = 0
    for k in range(pairs.shape[0]):
        i, j = pairs[k, 0], pairs[k, 1]
        dx = points[j, 0] - points[i, 0]
        dy = points[j, 1] - points[i, 1]
        length = np.sqrt(dx * dx + dy * dy)
        if length == 0.0:
            continue
        limit = max_residual * length
        count = 0
        for p in range(n):
            cross = dx * (points[p, 1] - points[i, 1]) - dy * (points[p, 0] - points[i, 0])
            if abs(cross) <= limit:
                count += 1
        if count > best_count:
            best_count = count
            for p in range(n):
                cross = dx * (points[p, 1] - points[i, 1]) - dy * (points[p, 0] - points[i, 0])
                best[p] = abs(cross) <= limit
    return best
