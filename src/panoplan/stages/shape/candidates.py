"""Corner candidates: the nodes of iSPA's graph."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from panoplan.geometry.angles import wrapped
from panoplan.geometry.contour import trace_outline
from panoplan.types.arrays import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class Candidates:
    """Corner candidates in the order of one lap around the room.

    Attributes:
        nodes: (N, 2) in cells, sorted by `order`.
        order: (N,) place on the lap, in [0, lap).
        lap: length of the lap.
        turn: (N,) unwrapped angle around the core in rad.
    """

    nodes: FloatArray
    order: FloatArray
    lap: float
    turn: FloatArray


def core_of(mask: BoolArray) -> FloatArray:
    """(2,) the point of a mask deepest inside it, in cells: what the shape must contain."""
    depth = ndimage.distance_transform_edt(mask)
    at = np.unravel_index(int(np.argmax(depth)), mask.shape)
    return np.array(at, dtype=float) + 0.5


def band_candidates(mask: BoolArray, core: FloatArray, inner: float, outer: float) -> Candidates:
    """Cells around the outline of the mask, ordered along it.

    Args:
        mask: one part without holes, rim empty.
        core: (2,) point inside.
        inner: how far inside the mask candidates may lie, in cells.
        outer: how far outside.

    Returns:
        The candidates; their order is the place of the nearest point of the outline.
    """
    outside = ndimage.distance_transform_edt(~mask)
    inside = ndimage.distance_transform_edt(mask)
    chosen = np.where(mask, inside <= inner, outside <= outer)
    nodes: FloatArray = np.argwhere(chosen).astype(np.float64) + 0.5
    return _ordered(nodes, trace_outline(mask), core)


def refined_candidates(polygon: FloatArray, core: FloatArray, reach: float) -> Candidates:
    """Cells around earlier corners, ordered corner by corner.

    Args:
        polygon: (K, 2) earlier corners in cells of the new grid, counter-clockwise.
        core: (2,) point inside.
        reach: how far from a corner candidates lie, in cells.

    Returns:
        The candidates; all those of one corner share one place on the lap, so that no edge joins
        two of them.
    """
    steps = np.arange(-np.ceil(reach), np.ceil(reach) + 1)
    box = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    near = np.floor(polygon)[:, None, :] + box[None] + 0.5
    nodes = near.reshape(-1, 2)
    distance, corner = (np.asarray(found) for found in cKDTree(polygon).query(nodes))
    nodes, kept = np.unique(nodes[distance <= reach], axis=0, return_index=True)
    corner = corner[distance <= reach][kept]
    return _sorted(nodes, corner.astype(float), float(len(polygon)), polygon, corner, core)


def _ordered(nodes: FloatArray, outline: FloatArray, core: FloatArray) -> Candidates:
    nearest = np.asarray(cKDTree(outline).query(nodes)[1])
    return _sorted(nodes, nearest.astype(float), float(len(outline)), outline, nearest, core)


def _sorted(
    nodes: FloatArray,
    order: FloatArray,
    lap: float,
    guide: FloatArray,
    nearest: np.ndarray,
    core: FloatArray,
) -> Candidates:
    bearing = np.arctan2(guide[:, 1] - core[1], guide[:, 0] - core[0])
    unwrapped = np.unwrap(bearing)
    own = np.arctan2(nodes[:, 1] - core[1], nodes[:, 0] - core[0])
    turn = unwrapped[nearest] + wrapped(own - unwrapped[nearest])
    keep = np.argsort(order, kind="stable")
    return Candidates(nodes[keep], order[keep], lap, turn[keep])
