"""Where rays meet the edges of a ring."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Hits(NamedTuple):
    """What each of N rays meets first.

    Attributes:
        edge: (N,) index of the edge, by the point that it begins at; 0 where the ray meets none.
        at: (N,) distance along the edge, NaN where the ray meets none.
        range: (N,) distance along the ray; infinite where it meets none.
        sine: (N,) of the angle between ray and edge, 0-1; NaN where it meets none.
    """

    edge: IntArray
    at: FloatArray
    range: FloatArray
    sine: FloatArray


def first_hits(origin: FloatArray, rays: FloatArray, ring: FloatArray) -> Hits:
    """The first edge that each ray meets.

    Args:
        origin: (2,) where the rays begin.
        rays: (N, 2) unit directions.
        ring: (M, 2) open ring, M ≥ 3.
    """
    along, length = edge_directions(ring)
    return Hits(*_first_hits(ring - origin, along, length, np.ascontiguousarray(rays)))


@njit(cache=True)
def _first_hits(start, along, length, rays):
    count = len(rays)
    edges, ats = np.zeros(count, np.int64), np.empty(count)
    ranges, sines = np.full(count, np.inf), np.empty(count)
    for n in range(count):
        x, y = rays[n]
        for k in range(len(start)):
            across = x * along[k, 1] - y * along[k, 0]
            if across == 0.0:
                continue
            at = (start[k, 0] * y - start[k, 1] * x) / across
            if at < -_SLACK or at > length[k] + _SLACK:
                continue
            distance = (start[k, 0] * along[k, 1] - start[k, 1] * along[k, 0]) / across
            if 0.0 < distance < ranges[n]:
                edges[n], ats[n], ranges[n], sines[n] = k, at, distance, abs(across)
        if ranges[n] == np.inf:
            ats[n] = sines[n] = np.nan
    return edges, ats, ranges, sines


_SLACK = 1e-9


def edge_directions(ring: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit direction (M, 2) and length (M,) of each edge of an open ring."""
    along = np.roll(ring, -1, axis=0) - ring
    length = np.maximum(np.hypot(*along.T), 1e-12)
    return along / length[:, None], length
