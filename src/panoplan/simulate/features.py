"""What makes rooms more than boxes: closets, alcoves, bays, round walls, breasts and pillars.

Every function takes rooms as they are and returns them changed, or None where the draw does not
fit; whether a changed room can still be lived in is the caller's to check.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from panoplan.geometry.polygons import counter_clockwise
from panoplan.types.arrays import FloatArray

_SHORTEST_EDGE_M = 0.28
_WALKABLE_M = 0.45
_OUTSIDE_M = 0.45


@dataclass(frozen=True, eq=False)
class Draft:
    """A room that is still being shaped.

    Attributes:
        label: what it is called, "room" where that is open.
        polygon: (N, 2) interior faces of its walls, counter-clockwise, metres.
        holes: (M, 2) rings of what stands free in it, clockwise.
    """

    label: str
    polygon: FloatArray
    holes: tuple[FloatArray, ...] = ()

    @property
    def floor(self) -> shapely.Polygon:
        """What can be stood on."""
        return shapely.Polygon(self.polygon, self.holes)

    @property
    def lengths(self) -> FloatArray:
        """(N,) of its walls, metres."""
        return np.asarray(np.hypot(*(np.roll(self.polygon, -1, axis=0) - self.polygon).T))


def habitable(room: Draft, least_m2: float) -> bool:
    """Whether a room is large enough, has no slivers, and all of it can be walked to."""
    floor = room.floor
    if len(room.polygon) < 4 or not floor.is_valid or floor.area < least_m2:
        return False
    inner = floor.buffer(-_WALKABLE_M, join_style="mitre")
    return bool(
        room.lengths.min() > _SHORTEST_EDGE_M
        and isinstance(inner, shapely.Polygon)
        and inner.area > 0.02
    )


def corner_closet(
    room: Draft, corner: int, sizes: tuple[float, float], wall_m: float
) -> tuple[Draft, Draft]:
    """Walls a closet off a convex corner of a room.

    Args:
        room: as it is.
        corner: index of the vertex.
        sizes: how far the closet reaches along the edge after the vertex and along that before.
        wall_m: thickness of its walls; 0 cuts the corner out of the house.

    Returns:
        The closet, a parallelogram, and the room without it.
    """
    polygon = room.polygon
    vertex = polygon[corner]
    ahead, _ = _unit(polygon[(corner + 1) % len(polygon)] - vertex)
    back, _ = _unit(polygon[corner - 1] - vertex)
    sine = abs(float(back[0] * ahead[1] - back[1] * ahead[0]))
    a, b = sizes
    wide_a, wide_b = a + wall_m / sine, b + wall_m / sine
    closet = np.array(
        [vertex, vertex + a * ahead, vertex + a * ahead + b * back, vertex + b * back]
    )
    bend = np.array([vertex + wide_b * back, vertex + wide_a * ahead + wide_b * back])
    ring = np.vstack([polygon[:corner], bend, vertex + wide_a * ahead, polygon[corner + 1 :]])
    return Draft("closet", counter_clockwise(closet)), replace(room, polygon=ring)


def alcove_closet(
    room: Draft, edge: int, start: float, width: float, depth: float, wall_m: float
) -> tuple[Draft, Draft]:
    """Walls a closet off the middle of a wall, so that the room lies round it.

    Args:
        room: as it is.
        edge: index of the wall, from its vertex to the next.
        start: where the closet begins, metres along the wall.
        width: of the closet along the wall.
        depth: of the closet into the room.
        wall_m: thickness of its walls.

    Returns:
        The closet, a rectangle, and the room without it.
    """
    p = room.polygon[edge]
    along, _ = _unit(room.polygon[(edge + 1) % len(room.polygon)] - p)
    inwards = np.array([-along[1], along[0]])
    a, b = p + start * along, p + (start + width) * along
    closet = np.array([a, b, b + depth * inwards, a + depth * inwards])
    low, high, deep = a - wall_m * along, b + wall_m * along, (depth + wall_m) * inwards
    return (
        Draft("closet", closet),
        _bent(room, edge, np.array([low, low + deep, high + deep, high])),
    )


def bay(room: Draft, edge: int, start: float, width: float, depth: float, slant: float) -> Draft:
    """Pushes a part of a wall outwards.

    Args:
        room: as it is.
        edge: index of the wall.
        start: where the bay begins, metres along the wall.
        width: along the wall.
        depth: outwards; negative for a breast that stands into the room.
        slant: how much shorter its front is at each end, metres.

    Returns:
        The room with the bay.
    """
    p = room.polygon[edge]
    along, _ = _unit(room.polygon[(edge + 1) % len(room.polygon)] - p)
    out = depth * np.array([along[1], -along[0]])
    a, b = p + start * along, p + (start + width) * along
    return _bent(room, edge, np.array([a, a + slant * along + out, b - slant * along + out, b]))


def apse(room: Draft, edge: int, start: float, width: float, depth: float, parts: int) -> Draft:
    """Pushes a part of a wall outwards in an elliptic arc of straight pieces.

    Args:
        room: as it is.
        edge: index of the wall.
        start: where the arc begins, metres along the wall.
        width: of its chord.
        depth: of its crown beyond the wall.
        parts: number of pieces.

    Returns:
        The room with the round wall.
    """
    p = room.polygon[edge]
    along, _ = _unit(room.polygon[(edge + 1) % len(room.polygon)] - p)
    out = np.array([along[1], -along[0]])
    turn = np.linspace(0, np.pi, parts + 1)[:, None]
    share = (1 - np.cos(turn)) / 2
    return _bent(room, edge, p + (start + width * share) * along + depth * np.sin(turn) * out)


def cut_corner(room: Draft, corner: int, radius: float, parts: int) -> Draft:
    """Replaces a convex corner by an arc, or by one slanted wall.

    Args:
        room: as it is.
        corner: index of the vertex.
        radius: how far from the vertex the arc begins, metres.
        parts: number of straight pieces; 1 for a slanted wall.

    Returns:
        The room without the corner.
    """
    polygon = room.polygon
    vertex = polygon[corner]
    ahead, _ = _unit(polygon[(corner + 1) % len(polygon)] - vertex)
    back, _ = _unit(polygon[corner - 1] - vertex)
    turn = np.linspace(0, np.pi / 2, parts + 1)[:, None]
    arc = vertex + radius * ((1 - np.sin(turn)) * back + (1 - np.cos(turn)) * ahead)
    return replace(room, polygon=np.vstack([polygon[:corner], arc, polygon[corner + 1 :]]))


def pillar(room: Draft, centre: FloatArray, size: float, angle: float, corners: int) -> Draft:
    """Stands a pillar in a room.

    Args:
        room: as it is.
        centre: (2,) of the pillar.
        size: across, metres.
        angle: by which it is turned, rad.
        corners: 4 or more.

    Returns:
        The room with the pillar.
    """
    turn = angle - 2 * np.pi * (np.arange(corners) + 0.5) / corners
    ring = centre + size / 2 / np.cos(np.pi / corners) * np.stack([np.cos(turn), np.sin(turn)], 1)
    return replace(room, holes=(*room.holes, ring))


def convex_corners(polygon: FloatArray) -> list[int]:
    """Indices of the corners that turn left by 60° to 120°."""
    before = polygon - np.roll(polygon, 1, axis=0)
    after = np.roll(polygon, -1, axis=0) - polygon
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    dot = (before * after).sum(axis=1)
    turn = np.arctan2(cross, dot)
    return np.flatnonzero((turn > np.pi / 3) & (turn < 2 * np.pi / 3)).tolist()


def faces_outside(room: Draft, edge: int, depth: float, house: shapely.Geometry) -> bool:
    """Whether a wall may be moved outwards without coming near another room.

    Args:
        room: one of the house.
        edge: index of its wall.
        depth: by how much, metres.
        house: union of all rooms.
    """
    a, b = room.polygon[edge], room.polygon[(edge + 1) % len(room.polygon)]
    along, length = _unit(b - a)
    out = np.array([along[1], -along[0]])
    if length < 0.5:
        return False
    near, far = 0.05 * out, (depth + _OUTSIDE_M) * out
    inset = 0.02 * along
    strip = shapely.Polygon([a + inset + near, b - inset + near, b - inset + far, a + inset + far])
    return not strip.intersects(house)


def _bent(room: Draft, edge: int, points: FloatArray) -> Draft:
    """The room with points put in between a vertex and the next."""
    ring = np.vstack([room.polygon[: edge + 1], points, room.polygon[edge + 1 :]])
    return replace(room, polygon=ring)


def _unit(vector: FloatArray) -> tuple[FloatArray, float]:
    length = float(np.hypot(vector[0], vector[1]))
    return vector / length, length
