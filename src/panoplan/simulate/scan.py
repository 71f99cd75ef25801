"""A scan of a simulated building: the cloud that a depth camera would have made of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
import shapely
from scipy.spatial import cKDTree

from panoplan.simulate.buildings import Building, Stairs
from panoplan.simulate.render.cast import ray_caster
from panoplan.simulate.render.furnish import draw_uses, furnish
from panoplan.simulate.render.looks import draw_look
from panoplan.simulate.render.materials import Float32Array
from panoplan.simulate.render.mesh import MeshBuilder
from panoplan.types.arrays import BoolArray, FloatArray

_WALL_POINTS_M2, _FLOOR_POINTS_M2 = 400.0, 250.0
_SIGMA_M = 0.015
_LINTEL_M = {"door": 2.0, "opening": 2.3}
_SILL_M, _WINDOW_TOP_M = 0.9, 2.1
_SAME_WALL_M = 0.02
_LOOKS = 4
"""A point is seen if one of so many cameras of its room that are nearest to it sees it."""
_SAME_SURFACE_M = 0.03

_Gap = tuple[FloatArray, float, float]
"""Segment of a wall's face, and from where to where above the floor there is nothing."""
_Part = tuple[int, FloatArray]
"""Room, and (N, 3) x, z and height above its floor of points in it."""
_FLIGHT_POINTS_M2 = 400.0


def scanned(
    building: Building, camera_height_m: float, seed: int, *, walked: FloatArray | None = None
) -> FloatArray:
    """Points on walls, floors and ceilings, and on furniture, with noise.

    Nothing drifts: it is better than the scan of a real building. Doors stand open under a lintel,
    windows have no points.

    Args:
        building: in the plan frame.
        camera_height_m: height of the world's origin above the floor.
        seed: of the points and the furniture.
        walked: (N, 3) where the cameras were, world. The rooms are furnished where they did not
            go, and what furniture hides from them is not scanned. None: rooms are empty.

    Returns:
        (N, 3) metres, x right, y down, z forward.
    """
    rng = np.random.default_rng(seed)
    parts = [*_walls(building, rng)]
    for k, room in enumerate(building.rooms):
        for end, up in enumerate((0.0, room.ceiling_height_m)):
            parts.append((k, _level(_around_stairs(building, k, end), up, rng)))
    # What lies between the jambs is in nobody's way.
    sills = [(p.rooms[0], _level(shapely.Polygon(p.area), 0.0, rng)) for p in building.passages]
    if walked is not None:
        cameras = np.stack([walked[:, 0], walked[:, 2], camera_height_m - walked[:, 1]], axis=1)
        parts = _furnished(building, parts, cameras, seed, rng)
    plan_and_up = np.concatenate(
        [points + [0.0, 0.0, building.floor_m(k)] for k, points in parts + sills]
        + [_flight(building, stairs, rng) for stairs in building.stairs]
    )
    points = np.stack(
        [plan_and_up[:, 0], camera_height_m - plan_and_up[:, 2], plan_and_up[:, 1]], axis=1
    )
    return np.asarray(points + rng.normal(0.0, _SIGMA_M, points.shape))


def _walls(building: Building, rng: np.random.Generator) -> Iterator[_Part]:
    """Points on each wall's face."""
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
                yield index, np.column_stack([at, up])[_solid(at, up, gaps)]


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


def _around_stairs(building: Building, room: int, end: int) -> shapely.Polygon:
    """A room's floor (end 0) or ceiling (1) without the holes that stairs go through."""
    area = building.rooms[room].floor
    for stairs in building.stairs:
        if stairs.rooms[1 - end] == room:
            area = area.difference(shapely.Polygon(stairs.area))
    return area


def _flight(building: Building, stairs: Stairs, rng: np.random.Generator) -> FloatArray:
    """(N, 3) points on the slope of stairs; height above the first storey's floor."""
    low, high = (building.floor_m(room) for room in stairs.rooms)
    run = stairs.line[1] - stairs.line[0]
    slope = float(np.sqrt(run @ run + (high - low) ** 2))
    share, off = rng.random((2, rng.poisson(_FLIGHT_POINTS_M2 * slope * stairs.width)))
    side = stairs.width * np.array([-stairs.along[1], stairs.along[0]])
    at = stairs.line[0] + share[:, None] * run + (off[:, None] - 0.5) * side
    return np.column_stack([at, low + share * (high - low)])


def _furnished(
    building: Building,
    parts: Iterable[_Part],
    cameras: FloatArray,
    seed: int,
    rng: np.random.Generator,
) -> list[_Part]:
    """The parts and those of furniture, less what it hides from the cameras of its storey."""
    on = building.levels_below(cameras[:, 2])
    # Nothing stands below stairs or over the hole that they go through.
    flights = [
        sample
        for stairs in building.stairs
        for sample in shapely.segmentize(shapely.LinearRing(stairs.area), 0.2).coords
    ]
    kept: list[_Part] = []
    for level, floor_m in enumerate(building.floors_m):
        first, storey = building.storey(level)
        there = cameras[on == level] - [0.0, 0.0, floor_m]
        clear = np.vstack([there[:, :2], *flights])
        things = _furniture(storey, clear, np.random.default_rng([seed, 1, level]))
        own = [(k - first, points) for k, points in parts if building.rooms[k].level == level]
        own += _on_furniture(storey, things, rng)
        kept += [(k + first, points) for k, points in _seen(storey, own, there, things)]
    return kept


def _furniture(building: Building, walked: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(T, 3, 3) corners of triangles, x, z and height above the floor."""
    mesh = MeshBuilder()
    furnish(
        building,
        draw_uses(building, rng),
        np.empty((0, 2, 2)),
        draw_look(rng),
        float(rng.uniform(0.2, 1.0)),
        walked,
        mesh,
        rng,
    )
    return np.asarray(mesh.build().triangles[:, :, [0, 2, 1]] * [1, 1, -1], dtype=np.float64)


def _on_furniture(
    building: Building, triangles: FloatArray, rng: np.random.Generator
) -> list[_Part]:
    """Points on the triangles that stand in each room."""
    first, one, other = triangles[:, 0], *(triangles[:, k] - triangles[:, 0] for k in (1, 2))
    areas = np.sqrt((np.cross(one, other) ** 2).sum(axis=1)) / 2
    which = np.repeat(np.arange(len(areas)), rng.poisson(_WALL_POINTS_M2 * areas))
    s, t = rng.random((2, len(which), 1))
    s, t = np.where(s + t > 1, 1 - s, s), np.where(s + t > 1, 1 - t, t)
    points = first[which] + s * one[which] + t * other[which]
    middles = triangles.mean(axis=1)[:, :2]
    return [
        (k, points[shapely.contains_xy(room.floor, middles)[which]])
        for k, room in enumerate(building.rooms)
    ]


def _seen(
    building: Building, parts: Iterable[_Part], cameras: FloatArray, things: FloatArray
) -> list[_Part]:
    """The points that no furniture hides from all cameras near them."""
    caster = ray_caster(_float32(things))
    kept = []
    for k, points in parts:
        own = cameras[shapely.contains_xy(building.rooms[k].floor, cameras[:, :2])]
        # Closets are looked into.
        there = own if len(own) else cameras
        looks = min(_LOOKS, len(there))
        _, near = cKDTree(there).query(points, k=looks)
        seen = np.zeros(len(points), dtype=np.bool_)
        for column in np.reshape(near, (len(points), looks)).T:
            todo = np.flatnonzero(~seen)
            towards = points[todo] - there[column[todo]]
            reach = 1 - _SAME_SURFACE_M / np.sqrt((towards**2).sum(axis=1))
            origins = _float32(there[column[todo]])
            seen[todo] = ~caster.blocked(origins, _float32(towards), _float32(reach))
        kept.append((k, points[seen]))
    return kept


def _float32(values: FloatArray) -> Float32Array:
    return np.ascontiguousarray(values, dtype=np.float32)
