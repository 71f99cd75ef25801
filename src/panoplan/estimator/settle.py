"""Rooms told apart anew from all their views, and shaped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from panoplan.config import Config
from panoplan.estimator.state import Composition, RoomState, State, room_id
from panoplan.stages import rooms
from panoplan.stages.plan.apertures import apertures, stretches
from panoplan.stages.plan.floorplan import PlannedRoom, plan_rooms
from panoplan.stages.plan.partition import partition
from panoplan.types.events import Event, RoomShaped, RoomsRegrouped
from panoplan.types.room import RoomShape
from panoplan.types.view import RegisteredLayout


def settle_around(state: State, index: int, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Settles the room that was left, with the rooms that claim some of its floor.

    Args:
        state: what is known.
        index: of the room in `state.rooms`.
        config: settings.

    Returns:
        What is known now, and what happened.
    """
    left = state.rooms[index]
    near = [
        k
        for k, other in enumerate(state.rooms)
        if other is left
        or (other.level == left.level and rooms.overlap(left.density, other.density) > _TOUCHING)
    ]
    return settle(state, near, config)


_TOUCHING = 0.05
"""Rooms with less floor in common than this share of the smaller one's are not mixed up."""


def settle(state: State, chosen: Sequence[int], config: Config) -> tuple[State, tuple[Event, ...]]:
    """Tells some rooms' views apart anew and shapes the rooms that they are of.

    A room that comes out keeps the number of the room that most of its views were in; where two
    claim one number, the one with more of its views has it, the other gets a new one.

    Args:
        state: what is known.
        chosen: indices of the rooms in `state.rooms`, all of one level.
        config: settings.

    Returns:
        What is known now, and what happened.
    """
    if not any(state.rooms[k].stale for k in chosen):
        return state, ()
    before = {view.index: state.rooms[k].number for k in chosen for view in state.rooms[k].views}
    views = sorted((v for k in chosen for v in state.rooms[k].views), key=lambda v: v.index)
    planned = plan_rooms(views, config)
    members = [[views[k].index for k in room.members] for room in planned]
    used = max(room.number for room in state.rooms)
    numbers = _numbers([[before[k] for k in group] for group in members], used)
    old = {state.rooms[k].number: state.rooms[k] for k in chosen}
    level = state.rooms[chosen[0]].level
    made = []
    for room, number in zip(planned, numbers, strict=True):
        own = tuple(views[k] for k in sorted(room.members))
        made.append(_room(room, number, level, own, old.get(number), config))
    after = {view.index: room.number for room in made for view in room.views}
    current = None if state.current is None else state.rooms[state.current].number
    if current in old:
        # The camera goes on in the room of its last keyframe.
        current = after[max(k for k, number in before.items() if number == current)]
    kept = [room for k, room in enumerate(state.rooms) if k not in chosen]
    together = tuple(sorted([*kept, *made], key=lambda room: room.number))
    changed = replace(
        state,
        rooms=together,
        current=next((k for k, room in enumerate(together) if room.number == current), None),
        cameras=tuple(
            replace(camera, room=after[k]) if k in after and camera.room != after[k] else camera
            for k, camera in enumerate(state.cameras)
        ),
    )
    changed = replace(changed, compositions=_composed(changed, config))
    return changed, _told(before, after, made, old)


def _composed(state: State, config: Config) -> tuple[Composition, ...]:
    """The plan of each level."""
    out = []
    for level in range(len(state.levels)):
        there = [room for room in state.rooms if room.level == level and room.shape is not None]
        shapes, facings = partition([r.shape for r in there if r.shape], config.partition)
        found = apertures(
            shapes,
            [room.stretches for room in there],
            [(view.index, view.camera) for room in there for view in room.views],
            facings,
            config.apertures,
        )
        out.append(Composition(tuple(room.number for room in there), shapes, facings, found))
    return tuple(out)


def _numbers(groups: Sequence[Sequence[int]], used: int) -> list[int]:
    """Number of each group of views, from the numbers that they had."""
    claims = sorted(
        (-count, index, number)
        for index, group in enumerate(groups)
        for number, count in Counter(group).items()
    )
    given: dict[int, int] = {}
    for _, index, number in claims:
        if index not in given and number not in given.values():
            given[index] = number
    out = []
    for index in range(len(groups)):
        if index not in given:
            used += 1
        out.append(given.get(index, used))
    return out


def _room(
    planned: PlannedRoom,
    number: int,
    level: int,
    views: tuple[RegisteredLayout, ...],
    old: RoomState | None,
    config: Config,
) -> RoomState:
    found = stretches(planned.shape, views, config.apertures)
    same = old is not None and [v.index for v in old.views] == [v.index for v in views]
    if old is not None and same:
        return replace(old, shape=planned.shape, stretches=found, stale=False)
    density = rooms.clipped_patch(views[0], config.rooms).density
    for view in views[1:]:
        density = rooms.add(density, rooms.clipped_patch(view, config.rooms).density, config.rooms)
    return RoomState(
        number,
        density,
        (),
        (),
        views=views,
        level=level,
        shape=planned.shape,
        stretches=found,
        stale=False,
        away=-1 if old is None else old.away,
    )


def _told(
    before: dict[int, int],
    after: dict[int, int],
    made: Sequence[RoomState],
    old: dict[int, RoomState],
) -> tuple[Event, ...]:
    events: list[Event] = []
    moved = sum(before[k] != after[k] for k in before)
    if moved:
        numbers = {room.number for room in made}
        events.append(
            RoomsRegrouped(
                moved,
                tuple(room_id(k) for k in sorted(numbers)),
                tuple(room_id(k) for k in sorted(set(old) - numbers)),
            )
        )
    for room in made:
        assert room.shape is not None
        was = old[room.number].shape if room.number in old else None
        if was is not None and _same_outline(was, room.shape):
            continue
        events.append(RoomShaped(room_id(room.number), room.shape.polygon, room.shape.failure))
    return tuple(events)


def _same_outline(one: RoomShape, other: RoomShape) -> bool:
    if one.polygon is None or other.polygon is None:
        return one.polygon is other.polygon and one.failure == other.failure
    return np.array_equal(one.polygon, other.polygon)
