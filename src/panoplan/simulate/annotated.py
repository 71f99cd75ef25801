"""Buildings of real geometry, from annotated plans."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.geometry.polygons import counter_clockwise
from panoplan.simulate.adjacency import shared_walls
from panoplan.simulate.buildings import (
    BlindDoor,
    Building,
    InteriorRoom,
    Passage,
    PassageKind,
    Window,
)
from panoplan.types.arrays import FloatArray
from panoplan.types.truth import TruePlan, TrueRoom

_ON_WALL_M = 0.06
_THICKEST_M = 0.4
_THINNEST_M = 0.01
_PARALLEL = np.cos(np.deg2rad(15.0))
_LEAST_OVERLAP_M = 0.3
_DOOR_M = 0.8
_JAMB_MARGIN_M = 0.05


def annotated_building(
    name: str,
    plan: TruePlan,
    *,
    ways: FloatArray | None = None,
    ceiling_height_m: float = 2.5,
) -> Building:
    """A building of annotated rooms.

    Doors and openings annotated on the walls of two rooms, opposite one another, become passages;
    those on one room's wall only become blind ones. Where the plan has none, a door is placed
    wherever the way from one camera to the next passes between rooms that stand wall to wall.

    Args:
        name: what it is called.
        plan: metres; its rooms split at openings where it has such.
        ways: (N, 2) cameras in the order of their walk, for plans without doors.
        ceiling_height_m: of all rooms.

    Returns:
        The building; not every room need be reachable.

    Raises:
        InputError: the plan has no room.
    """
    rooms = _apart(plan.rooms_partial or plan.rooms)
    if not rooms:
        raise InputError(name, "no room", "at least one")
    interiors = tuple(InteriorRoom(r.label, r.polygon, ceiling_height_m, r.holes) for r in rooms)
    marks = [("door", s) for s in plan.doors] + [("opening", s) for s in plan.openings]
    passages, blind = _paired([_on_wall(s, kind, rooms) for kind, s in marks])
    if not marks and ways is not None:
        passages = _along(ways, rooms)
    windows = (_on_wall(s, "window", rooms) for s in plan.windows)
    return Building(
        name,
        interiors,
        tuple(passages),
        tuple(Window(w[1], w[2]) for w in windows if w is not None),
        tuple(blind),
    )


def largest_part(building: Building) -> Building:
    """The rooms of a building that most others can be reached from, and what joins them."""
    parts: list[set[int]] = []
    for k in range(len(building.rooms)):
        if not any(k in part for part in parts):
            parts.append(building.reachable(k))
    largest = max(parts, key=lambda part: (len(part), -min(part)))
    kept = sorted(largest)
    now = {old: new for new, old in enumerate(kept)}
    return replace(
        building,
        rooms=tuple(building.rooms[k] for k in kept),
        passages=tuple(
            replace(p, rooms=(now[p.rooms[0]], now[p.rooms[1]]))
            for p in building.passages
            if p.rooms[0] in now
        ),
        windows=tuple(replace(w, room=now[w.room]) for w in building.windows if w.room in now),
        blind_doors=tuple(
            replace(d, room=now[d.room]) for d in building.blind_doors if d.room in now
        ),
    )


def _apart(rooms: Sequence[TrueRoom]) -> list[TrueRoom]:
    """The rooms, a centimetre narrower where annotations touch or overlap."""
    areas = [shapely.Polygon(r.polygon, r.holes) for r in rooms]
    found = []
    for k, room in enumerate(rooms):
        touching = [a for n, a in enumerate(areas) if n != k and a.distance(areas[k]) < _THINNEST_M]
        area = areas[k]
        for other in touching:
            area = area.difference(other.buffer(2 * _THINNEST_M, join_style="mitre"))
        parts = [p for p in shapely.get_parts(area) if isinstance(p, shapely.Polygon)]
        if not parts:
            continue
        largest = max(parts, key=lambda part: part.area).simplify(1e-3)
        if largest.area < 0.1:
            continue
        ring = counter_clockwise(np.asarray(largest.exterior.coords)[:-1])
        found.append(replace(room, polygon=ring if touching else room.polygon))
    return found


_Mark = tuple[str, int, FloatArray]


def _on_wall(segment: FloatArray, kind: str, rooms: Sequence[TrueRoom]) -> _Mark | None:
    """A segment laid onto the nearest wall: kind, room and ends, the room on the left."""
    best: tuple[float, _Mark] | None = None
    for k, room in enumerate(rooms):
        for a, b in zip(room.polygon, np.roll(room.polygon, -1, axis=0), strict=True):
            length = float(np.hypot(*(b - a)))
            if length < 1e-6:
                continue
            along = (b - a) / length
            off = float(np.abs((segment - a) @ np.array([along[1], -along[0]])).max())
            at = np.clip(np.sort((segment - a) @ along), 0.0, length)
            if off > _ON_WALL_M or at[1] - at[0] < _LEAST_OVERLAP_M:
                continue
            if best is None or off < best[0]:
                best = off, (kind, k, a + at[:, None] * along)
    return None if best is None else best[1]


def _paired(marks: Sequence[_Mark | None]) -> tuple[list[Passage], list[BlindDoor]]:
    """Marks on opposite walls as passages, the others as blind doors."""
    known = [mark for mark in marks if mark is not None]
    pairs = []
    for i, first in enumerate(known):
        for j in range(i + 1, len(known)):
            faces = _opposite(first, known[j])
            if faces is not None:
                gap = float(np.hypot(*(faces[0].mean(axis=0) - faces[1].mean(axis=0))))
                pairs.append((gap, i, j, faces))
    used: set[int] = set()
    passages = []
    for _, i, j, faces in sorted(pairs, key=lambda pair: pair[:3]):
        if i not in used and j not in used:
            used |= {i, j}
            passages.append(Passage(_kind(known[i]), (known[i][1], known[j][1]), faces))
    blind = [
        BlindDoor(_kind(mark), mark[1], mark[2]) for k, mark in enumerate(known) if k not in used
    ]
    return passages, blind


def _kind(mark: _Mark) -> PassageKind:
    return "door" if mark[0] == "door" else "opening"


def _opposite(first: _Mark, second: _Mark) -> FloatArray | None:
    """Both faces of the passage through two marks, or None where they are no pair."""
    (kind, room, a), (other_kind, other, b) = first, second
    along, back = (e[1] - e[0] for e in (a, b))
    length, other_length = np.hypot(*along), np.hypot(*back)
    along, back = along / length, back / other_length
    if kind != other_kind or room == other or along @ back > -_PARALLEL:
        return None
    outwards = np.array([along[1], -along[0]])
    gaps = (b - a[0]) @ outwards
    if gaps.min() <= 0 or gaps.max() >= _THICKEST_M:
        return None
    at = np.sort((b - a[0]) @ along)
    low, high = max(0.0, float(at[0])), min(float(length), float(at[1]))
    if high - low < _LEAST_OVERLAP_M:
        return None
    near = a[0] + np.array([[low], [high]]) * along
    far = b[0] + (((near - b[0]) @ along) / (back @ along))[:, None] * back
    return np.stack([near, far])


def _along(ways: FloatArray, rooms: Sequence[TrueRoom]) -> list[Passage]:
    """A door wherever a way passes from one room to one that stands wall to wall with it."""
    areas = [shapely.Polygon(r.polygon, r.holes) for r in rooms]
    walls = shared_walls([r.polygon for r in rooms], _THICKEST_M, _DOOR_M, np.deg2rad(15.0))
    doors: dict[tuple[int, int], Passage] = {}
    for start, end in pairwise(ways):
        way = shapely.LineString([start, end])
        for wall in walls:
            room = wall.length - 2 * _JAMB_MARGIN_M
            middle = wall.faces(0, wall.length)
            strip = shapely.Polygon([*middle[0], *middle[1][::-1]])
            joins = way.intersects(areas[wall.rooms[0]]) and way.intersects(areas[wall.rooms[1]])
            if wall.rooms in doors or room < 0.6 or not joins or not way.intersects(strip):
                continue
            width = min(_DOOR_M, room)
            crossing = np.asarray(way.intersection(strip).centroid.coords[0])
            at = float((crossing - wall.origin) @ wall.direction) - width / 2
            low = float(np.clip(at, _JAMB_MARGIN_M, _JAMB_MARGIN_M + room - width))
            doors[wall.rooms] = Passage("door", wall.rooms, wall.faces(low, low + width))
    return list(doors.values())
