"""Floors, ceilings and walls of a plan as flat surfaces in space.

Model frame: metres, y up, x of the plan to the right, -z along the plan's second axis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
import shapely
import shapely.affinity

from panoplan.exporters.bodies import interval_on, wall_bodies
from panoplan.exporters.heights import ceilings, door_head, elevations
from panoplan.exporters.storeys import Storey, aperture_area, metric_storeys, room_area
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.plan import Aperture, FloorPlan, Room, Wall

Kind = Literal["floor", "ceiling", "wall", "reveal", "top"]

_WIDE_M = 1.0
_UP = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True, eq=False)
class Surface:
    """A flat region, seen from the side that its room is on.

    A point (s, t) of the region lies at origin + s across + t along; across x along looks into
    the room.

    Attributes:
        id: unique in the model.
        kind: what it is.
        room: id of the room that sees it, empty for tops of walls.
        region: shapely area of (s, t), metres.
        origin: (3,) model frame.
        across: (3,) unit vector, to the right as seen.
        along: (3,) unit vector, up as seen on walls.
    """

    id: str
    kind: Kind
    room: str
    region: Any
    origin: FloatArray
    across: FloatArray
    along: FloatArray

    @cached_property
    def normal(self) -> FloatArray:
        """(3,) unit vector into the room."""
        return np.asarray(np.cross(self.across, self.along))

    def in_space(self, points: FloatArray) -> FloatArray:
        """(N, 2) points of the region as (N, 3) points of the model."""
        return np.asarray(self.origin + points @ np.stack([self.across, self.along]))

    def triangles(self) -> tuple[FloatArray, IntArray]:
        """(V, 2) corners of the region and (T, 3) indices of triangles, counter-clockwise."""
        parts = shapely.get_parts(shapely.constrained_delaunay_triangles(self.region))
        rings = [shapely.get_coordinates(part)[:3] for part in parts if not part.is_empty]
        corners = np.array(rings).reshape(-1, 3, 2)
        (ax, ay), (bx, by), (cx, cy) = (corners[:, k].T for k in range(3))
        clockwise = (bx - ax) * (cy - ay) < (cx - ax) * (by - ay)
        corners[clockwise] = corners[clockwise][:, ::-1]
        points, index = np.unique(corners.reshape(-1, 2), axis=0, return_inverse=True)
        return points, index.reshape(-1, 3)


def in_model(points: FloatArray, height: float) -> FloatArray:
    """(N, 2) points of the plan at a height as (N, 3) points of the model."""
    x, y = np.asarray(points).T
    return np.stack([x, np.full(len(x), height), -y], axis=1)


def plan_surfaces(plan: FloorPlan) -> tuple[Surface, ...]:
    """The surfaces of all rooms of a metric plan, with holes where doors and openings lead on.

    Doors and windows in outer walls are no holes: what lies behind them is not known. Heights
    that the plan does not tell are those of `exporters.heights`.

    Raises:
        InputError: not metric or without rooms.
    """
    floors = metric_storeys(plan)
    heights, rises = ceilings(floors), elevations(floors)
    made: list[Surface] = []
    for floor in floors:
        rise = rises[floor.level]
        passages = _passages(floor, heights)
        for room in floor.rooms:
            made += _room_surfaces(room, rise, heights[room.id], passages)
        for passage in passages:
            made += _reveal(passage, floor.walls, rise)
        made += _tops(floor, rise, heights)
    return tuple(made)


@dataclass(frozen=True, eq=False)
class _Passage:
    """A door or opening between two rooms, as a hole in both faces of their wall.

    Attributes:
        item: the aperture.
        head: upper edge above the floor, metres.
    """

    item: Aperture
    head: float


def _passages(floor: Storey, heights: Mapping[str, float]) -> list[_Passage]:
    walls = floor.walls
    found = []
    for items, is_door in ((floor.doors, True), (floor.openings, False)):
        for item in items:
            if len(item.walls) == 2 and all(name in walls for name in item.walls):
                ceiling = min(heights[name] for name in item.rooms if name in heights)
                found.append(_Passage(item, door_head(ceiling) if is_door else ceiling))
    return found


def _room_surfaces(
    room: Room, rise: float, height: float, passages: Sequence[_Passage]
) -> list[Surface]:
    area = room_area(room)
    x, y = np.eye(3)[0], -np.eye(3)[2]
    base = np.array([0.0, rise, 0.0])
    mirrored = shapely.affinity.scale(area, -1.0, 1.0, origin=(0.0, 0.0))
    made = [
        Surface(f"{room.id}_floor", "floor", room.id, area, base, x, y),
        Surface(f"{room.id}_ceiling", "ceiling", room.id, mirrored, base + height * _UP, -x, y),
    ]
    for wall in room.walls:
        surface = _wall_surface(wall, room.id, rise, height, passages)
        if surface is not None:
            made.append(surface)
    return made


def _wall_surface(
    wall: Wall, room: str, rise: float, height: float, passages: Sequence[_Passage]
) -> Surface | None:
    length = float(np.hypot(*(wall.b - wall.a)))
    holes = [
        # A little below the floor, so that no sliver stays.
        shapely.box(length - high, -1.0, length - low, passage.head)
        for passage in passages
        if wall.id in passage.item.walls
        for low, high in [interval_on(wall, passage.item.segment)]
    ]
    region = shapely.box(0.0, 0.0, length, height).difference(shapely.union_all(holes))
    if region.area < 1e-6:
        return None
    origin, end = in_model(np.array([wall.b, wall.a]), rise)
    across = (end - origin) / length
    return Surface(wall.id, "wall", room, region, origin, across, _UP)


def _reveal(passage: _Passage, walls: Mapping[str, Wall], rise: float) -> list[Surface]:
    """Floor, sides and head of a passage through a wall, as seen from inside it."""
    one, other = (_hole_ends(walls[name], passage.item) for name in passage.item.walls)
    if np.hypot(*(one[0] - other[0])) > np.hypot(*(one[0] - other[1])):
        other = other[::-1]
    # Counter-clockwise seen from above, so that the sides look inwards.
    ring = np.array([one[0], one[1], other[1], other[0]])
    area = shapely.Polygon(ring)
    if not area.is_valid or area.area < 1e-4:
        return []
    if not area.exterior.is_ccw:
        ring = ring[::-1]
    name, head = passage.item.id, passage.head
    x, y = np.eye(3)[0], -np.eye(3)[2]
    base = np.array([0.0, rise, 0.0])
    mirrored = shapely.affinity.scale(area, -1.0, 1.0, origin=(0.0, 0.0))
    made = [
        Surface(f"{name}_floor", "reveal", "", area, base, x, y),
        Surface(f"{name}_head", "reveal", "", mirrored, base + head * _UP, -x, y),
    ]
    for number, (a, b) in enumerate(zip(ring, np.roll(ring, -1, axis=0), strict=True)):
        # Every second edge lies in a face of the wall: that is the way through.
        if {tuple(a), tuple(b)} in (
            {tuple(one[0]), tuple(one[1])},
            {tuple(other[0]), tuple(other[1])},
        ):
            continue
        length = float(np.hypot(*(b - a)))
        if length > 1e-6:
            origin, end = in_model(np.array([b, a]), rise)
            region = shapely.box(0.0, 0.0, length, head)
            side = f"{name}_side_{number}"
            made.append(Surface(side, "reveal", "", region, origin, (end - origin) / length, _UP))
    return made


def _hole_ends(wall: Wall, item: Aperture) -> FloatArray:
    direction = (wall.b - wall.a) / float(np.hypot(*(wall.b - wall.a)))
    return np.asarray(wall.a + np.outer(interval_on(wall, item.segment), direction))


def _tops(floor: Storey, rise: float, heights: Mapping[str, float]) -> list[Surface]:
    """Walls between rooms seen from above, each as high as the higher of its rooms."""
    x, y = np.eye(3)[0], -np.eye(3)[2]
    gaps = shapely.union_all([aperture_area(item, _WIDE_M) for item in floor.openings])
    of_wall = {wall.id: heights[room.id] for room in floor.rooms for wall in room.walls}
    made = []
    for body in wall_bodies(floor):
        region = body.footprint.difference(gaps)
        if not body.outer and region.area > 1e-6:
            base = np.array([0.0, rise + max(of_wall[face] for face in body.faces), 0.0])
            made.append(Surface(f"{body.id}_top", "top", "", region, base, x, y))
    return made
