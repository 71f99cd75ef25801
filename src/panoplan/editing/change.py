"""Edits as people write them: ROOM=NAME, WALL=METRES."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from panoplan.editing.apply import in_units_of
from panoplan.editing.match import door_of, room_of, wall_of
from panoplan.errors import InputError
from panoplan.types.edits import (
    Edits,
    KnownDoorHeight,
    KnownLength,
    Nudge,
    RoomMark,
    RoomName,
    WallMark,
)
from panoplan.types.plan import FloorPlan

LONGEST_NAME = 200
"""Characters of a room's name."""

_ROW_SIGMA = 1.5
_SHORTEST_M, _LONGEST_M = 0.05, 1000.0

Item = TypeVar("Item")


def changed(
    edits: Edits,
    plan: FloorPlan,
    *,
    names: Sequence[str] = (),
    lengths: Sequence[str] = (),
    door_heights: Sequence[str] = (),
    nudges: Sequence[str] = (),
    drop: Sequence[str] = (),
) -> Edits:
    """Edits with more of them; a new one takes the place of an older one of the same thing.

    Args:
        edits: so far.
        plan: the estimate, whose ids are meant.
        names: ROOM=NAME each.
        lengths: WALL=METRES each.
        door_heights: DOOR=METRES@KEYFRAME,ROW/HEIGHT each.
        nudges: WALL=METRES each.
        drop: ids of rooms, walls or doors whose edits go.

    Raises:
        InputError: not so written, an id that the plan does not have, or a size out of range.
    """
    edits = in_units_of(edits, plan)
    rooms = {
        room.id: RoomMark(room.id, room.level, room.polygon)
        for room in plan.rooms
        if room.polygon is not None
    }
    walls = {
        wall.id: WallMark(wall.id, room.level, wall.a, wall.b)
        for room in plan.rooms
        for wall in room.walls
    }
    levels = {room.id: room.level for room in plan.rooms}
    doors = {
        door.id: WallMark(
            door.id, next((levels[r] for r in door.rooms if r in levels), 0), *door.segment
        )
        for door in plan.doors
    }

    def room_id(item: RoomName) -> str | None:
        found = room_of(item.room, plan)
        return None if found is None else found.id

    def wall_id(item: KnownLength | Nudge) -> str | None:
        found = wall_of(item.wall, plan)
        return None if found is None else found.id

    def door_id(item: KnownDoorHeight) -> str | None:
        found = door_of(item.door, plan)
        return None if found is None else found.id

    for word in drop:
        _known("--drop", word, {**rooms, **walls, **doors})
    gone = set(drop)
    told = {}
    for word in names:
        key, text = _split("--name", word, rooms)
        told[key] = RoomName(rooms[key], _name(text))
    measured = {}
    for word in lengths:
        key, text = _split("--length", word, walls)
        metres = _metres("--length", word, text, _SHORTEST_M, _LONGEST_M)
        measured[key] = KnownLength(walls[key], metres)
    moved = {}
    for word in nudges:
        key, text = _split("--nudge", word, walls)
        moved[key] = Nudge(walls[key], _metres("--nudge", word, text, -_LONGEST_M, _LONGEST_M))
    seen = {}
    for word in door_heights:
        key, text = _split("--door-height", word, doors)
        seen[key] = _door_height(word, text, doors[key], plan)
    return replace(
        edits,
        names=_merged(edits.names, told, gone, room_id),
        lengths=_merged(edits.lengths, measured, gone, wall_id),
        nudges=_merged(edits.nudges, moved, gone, wall_id),
        door_heights=_merged(edits.door_heights, seen, gone, door_id),
    )


def _merged(
    old: Iterable[Item],
    new: Mapping[str, Item],
    gone: set[str],
    id_of: Callable[[Item], str | None],
) -> tuple[Item, ...]:
    kept = [item for item in old if id_of(item) not in gone | set(new)]
    return (*kept, *new.values())


def _split(option: str, word: str, known: Mapping[str, object]) -> tuple[str, str]:
    key, equals, text = word.partition("=")
    if not equals:
        raise InputError(option, repr(word[:80]), "ID=VALUE")
    _known(option, key, known)
    return key, text


def _known(option: str, key: str, known: Mapping[str, object]) -> None:
    if key not in known:
        near = difflib.get_close_matches(key, known, n=3, cutoff=0.0)
        wanted = f"an id of the plan, as {', '.join(near)}" if near else "a plan that has some"
        raise InputError(option, repr(key[:80]), wanted)


def _name(text: str) -> str:
    if not text.strip() or len(text) > LONGEST_NAME:
        raise InputError(
            "--name", f"{len(text)} characters", f"a name of 1 to {LONGEST_NAME} characters"
        )
    return text


def _metres(option: str, word: str, text: str, low: float, high: float) -> float:
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not low <= value <= high:
        raise InputError(option, repr(word[:80]), f"{low:g} to {high:g} metres")
    return value


def _door_height(word: str, text: str, door: WallMark, plan: FloorPlan) -> KnownDoorHeight:
    metres, _, place = text.partition("@")
    keyframe, _, rows = place.rpartition(",")
    try:
        row, height = (float(part) for part in rows.split("/"))
    except ValueError:
        row = height = np.nan
    if keyframe not in {pose.id for pose in plan.trajectory}:
        raise InputError("--door-height", repr(word[:80]), "DOOR=M@KEYFRAME,ROW/HEIGHT of a camera")
    if not (height >= 16 and 0 <= row < height):
        raise InputError("--door-height", repr(word[:80]), "a row of an image of at least 16 rows")
    pixel = np.pi / height
    return KnownDoorHeight(
        door,
        _metres("--door-height", word, metres, 0.5, 10.0),
        keyframe,
        float(np.pi / 2 - pixel * (row + 0.5)),
        float(_ROW_SIGMA * pixel),
    )
