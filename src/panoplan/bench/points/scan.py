"""A scan of a simulated building: the cloud that a depth camera would have made of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
import shapely

from panoplan.simulate.buildings import Building
from panoplan.types.arrays import BoolArray, FloatArray

_WALL_POINTS_M2, _FLOOR_POINTS_M2 = 400.0, 250.0
_SIGMA_M = 0.015
_LINTEL_M = {"door": 2.0, "opening": 2.3}
_SILL_M, _WINDOW_TOP_M = 0.9, 2.1
_SAME_WALL_M = 0.02

_Gap = tuple[FloatArray, float, float]
"""Segment of a wall's face, and from where to where above the floor there is nothing."""


def scanned(building: Building, camera_height_m: float, seed: int) -> FloatArray:
    """Points on walls, floors and ceilings, with noise.

    Every surface is seen, nothing stands in the way, and the scan does not drift: it is better than
    one of a real building. Doors stand open under a lintel, windows have no points.

    Args:
        building: in the plan frame.
        camera_height_m: height of the world's origin above the floor.
        seed: of the points.

    Returns:
        (N, 3) metres, x right, y down, z forward.
    """
    rng = np.random.default_rng(seed)
    parts = list(_walls(building, rng))
    for room in building.rooms:
        parts += [_level(room.floor, up, rng) for up in (0.0, room.ceiling_height_m)]
    parts += [_level(shapely.Polygon(p.area), 0.0, rng) for p in building.passages]
    plan_and_up = np.concatenate(parts)
    points = np.stack(
        [plan_and_up[:, 0], camera_height_m - plan_and_up[:, 2], plan_and_up[:, 1]], axis=1
    )
    return np.asarray(points + rng.normal(0.0, _SIGMA_M, points.shape))


def _walls(building: Building, rng: np.random.Generator) -> Iterator[FloatArray]:
    """(N, 3) x, z and height of points on each wall's face."""
    for index, room in enumerate(building.rooms):
        gaps: list[_Gap] = [
            (p.faces[p.side(index)], 0.0, _LINTEL_M[p.kind])
            for p in building.passages
            if index in p.rooms
        ]
        gaps += [(w.segment, _SILL_M, _WINDOW_TOP_M) for w in building.windows if w.room == index]
        for ring in room.rings:
            for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                area = float(np.hypot(*(b - a))) * room.ceiling_height_m
                count = rng.poisson(_WALL_POINTS_M2 * area)
                at = a + rng.random((count, 1)) * (b - a)
                up = room.ceiling_height_m * rng.random(count)
                yield np.column_stack([at, up])[_solid(at, up, gaps)]


def _solid(at: FloatArray, up: FloatArray, gaps: Iterable[_Gap]) -> BoolArray:
    solid = np.ones(len(at), dtype=np.bool_)
    for segment, low, high in gaps:
        apart = shapely.distance(shapely.LineString(segment), shapely.points(at))
        solid &= ~((apart < _SAME_WALL_M) & (up >= low) & (up < high))
    return solid


def _level(area: shapely.Polygon, up: float, rng: np.random.Generator) -> FloatArray:
    """(N, 3) points on a level area."""
    low, high = np.array(area.bounds).reshape(2, 2)
    count = rng.poisson(_FLOOR_POINTS_M2 * float(np.prod(high - low)))
    at = rng.uniform(low, high, (count, 2))
    at = at[shapely.contains_xy(area, at)]
    return np.column_stack([at, np.full(len(at), up)])
