"""Where rays meet the edges of a ring."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Hits(NamedTuple):
    """What each of N rays meets first.

    Attributes:
        edge: (N,) index of the edge, by the point that it begins at.
        at: (N,) distance along the edge.
        range: (N,) distance along the ray; infinite where it meets none.
        sine: (N,) of the angle between ray and edge, 0-1.
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
    start = ring - origin
    with np.errstate(divide="ignore", invalid="ignore"):
        across = rays[:, :1] * along[:, 1] - rays[:, 1:] * along[:, 0]
        distance = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / across
        at = (start[:, 0] * rays[:, 1:] - start[:, 1] * rays[:, :1]) / across
    meets = (distance > 0) & (at >= -_SLACK) & (at <= length + _SLACK)
    distance = np.where(meets, distance, np.inf)
    edge = np.argmin(distance, axis=1)
    row = np.arange(len(rays))
    return Hits(edge, at[row, edge], distance[row, edge], np.abs(across[row, edge]))


_SLACK = 1e-9


def edge_directions(ring: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit direction (M, 2) and length (M,) of each edge of an open ring."""
    along = np.roll(ring, -1, axis=0) - ring
    length = np.maximum(np.hypot(*along.T), 1e-12)
    return along / length[:, None], length
