"""The bodies of walls: between two rooms as thick as measured, else assumed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from panoplan.exporters.storeys import Storey, room_area
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Aperture, Wall

OUTER_THICKNESS_M = 0.2
"""Thickness of walls that have a room on one side only: plans do not tell it."""

_SHORTEST_M = 0.02

Interval = tuple[float, float]


@dataclass(frozen=True, eq=False)
class WallBody:
    """A straight piece of wall.

    Attributes:
        id: unique in the plan.
        faces: ids of the room walls that it stands behind, one or two.
        axis: (2, 2) from end to end along its first face.
        footprint: shapely polygon seen from above.
        thickness: metres.
        outer: whether it has a room on one side only; its thickness is then assumed.
    """

    id: str
    faces: tuple[str, ...]
    axis: FloatArray
    footprint: Any
    thickness: float
    outer: bool

    @property
    def length(self) -> float:
        """Metres from end to end."""
        return float(np.hypot(*(self.axis[1] - self.axis[0])))


def wall_bodies(floor: Storey) -> tuple[WallBody, ...]:
    """Bodies of all walls of a storey; none where rooms only end, as at an opening.

    Bodies keep out of rooms; they may meet one another at corners.
    """
    rooms = shapely.union_all([room_area(room) for room in floor.rooms])
    walls = floor.walls
    covered: dict[str, list[Interval]] = {name: [] for name in walls}
    bodies: list[WallBody] = []
    for shared in floor.shared_walls:
        one, other = (walls[name] for name in shared.walls)
        for face, opposite in ((one, other), (other, one)):
            covered[face.id].append(_facing(face, opposite))
        if shared.solid:
            footprint = _between(one, other)
            axis = _along(one, _facing(one, other))
            made = _clear(footprint, rooms)
            if made is not None:
                bodies.append(
                    WallBody(shared.id, shared.walls, axis, made, shared.thickness, False)
                )
    for wall in walls.values():
        pieces = _left(float(np.hypot(*(wall.b - wall.a))), covered[wall.id])
        for number, piece in enumerate(pieces, 1):
            made = _clear(_behind(wall, piece), rooms)
            if made is not None:
                name = wall.id if len(pieces) == 1 else f"{wall.id}_{number}"
                axis = _along(wall, piece)
                bodies.append(WallBody(name, (wall.id,), axis, made, OUTER_THICKNESS_M, True))
    return tuple(bodies)


def body_of(item: Aperture, bodies: Iterable[WallBody]) -> WallBody | None:
    """The body that an aperture is in: of its walls the one that it lies nearest to, or None."""
    own = [body for body in bodies if set(body.faces) & set(item.walls)]
    if not own:
        return None
    middle = shapely.Point(item.segment.mean(axis=0))
    return min(own, key=lambda body: float(body.footprint.distance(middle)))


def interval_on(wall: Wall, points: FloatArray) -> Interval:
    """Where (N, 2) points lie along a wall, in metres from its start, within the wall."""
    along = wall.b - wall.a
    length = float(np.hypot(*along))
    at = np.clip((points - wall.a) @ along / max(length, 1e-12), 0.0, length)
    return float(at.min()), float(at.max())


def _facing(face: Wall, opposite: Wall) -> Interval:
    return interval_on(face, np.array([opposite.a, opposite.b]))


def _along(wall: Wall, piece: Interval) -> FloatArray:
    direction = (wall.b - wall.a) / float(np.hypot(*(wall.b - wall.a)))
    return np.asarray(wall.a + np.outer(piece, direction))


def _between(one: Wall, other: Wall) -> Any:
    ends = np.concatenate([_along(one, _facing(one, other)), _along(other, _facing(other, one))])
    return shapely.MultiPoint(ends).convex_hull


def _behind(wall: Wall, piece: Interval) -> Any:
    """The rectangle behind a piece of wall; it reaches around the corner at the wall's end."""
    length = float(np.hypot(*(wall.b - wall.a)))
    direction = (wall.b - wall.a) / length
    outward = np.array([direction[1], -direction[0]]) * OUTER_THICKNESS_M
    end = piece[1] + (OUTER_THICKNESS_M if piece[1] > length - _SHORTEST_M else 0.0)
    a, b = wall.a + piece[0] * direction, wall.a + end * direction
    return shapely.Polygon([a, b, b + outward, a + outward])


def _clear(footprint: Any, rooms: Any) -> Any:
    """The largest part of a footprint that is outside all rooms, or None."""
    parts = [
        part
        for part in shapely.get_parts(footprint.difference(rooms))
        if isinstance(part, shapely.Polygon) and part.area > _SHORTEST_M**2
    ]
    return max(parts, key=lambda part: float(part.area)) if parts else None


def _left(length: float, covered: Iterable[Interval]) -> list[Interval]:
    """The pieces of a wall that intervals leave."""
    pieces, start = [], 0.0
    for low, high in [*sorted(covered), (length, length)]:
        if low - start > _SHORTEST_M:
            pieces.append((start, low))
        start = max(start, high)
    return pieces
