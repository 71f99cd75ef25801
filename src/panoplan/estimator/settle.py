"""Rooms told apart anew from all their views, and shaped."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from panoplan.config import Config
from panoplan.estimator.state import Composition, PlacedCamera, RoomState, State, room_id
from panoplan.stages import rooms
from panoplan.stages.plan.adjust import Faces, Stretch, adjust
from panoplan.stages.plan.apertures import apertures, stretches
from panoplan.stages.plan.floorplan import plan_rooms
from panoplan.stages.plan.misplaced import is_tour, misplaced
from panoplan.stages.plan.partition import facing_walls, partition
from panoplan.types.events import CamerasMisplaced, Event, RoomShaped, RoomsRegrouped
from panoplan.types.plan import Skipped
from panoplan.types.room import RoomDensity, RoomShape, WallStretch
from panoplan.types.view import CorrectedLayouts, Correction, RegisteredLayout


def settle_around(state: State, index: int, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Settles the room that was left, with the rooms that claim most of its floor.

    So many of them, and so many of their views, that it takes no longer however large the building
    is or however long the camera stayed.

    Args:
        state: what is known.
        index: of the room in `state.rooms`.
        config: settings.

    Returns:
        What is known now, and what happened.
    """
    left = state.rooms[index]
    common = {
        k: rooms.overlap(left.density, other.density)
        for k, other in enumerate(state.rooms)
        if other is not left and other.level == left.level
    }
    near, views = [index], len(left.views)
    for k in sorted(common, key=lambda k: -common[k]):
        views += len(state.rooms[k].views)
        if common[k] <= _TOUCHING or views > config.grouping.around_views:
            break
        near.append(k)
    representatives = _representatives(state, near, config.grouping.around_views)
    now = _regrouped(state, representatives, config)
    if config.adjust.rounds and len(representatives) >= config.adjust.min_views:
        now, _ = _adjusted(now, representatives, 0, 0.0, config)
        now = _regrouped(now, representatives, config)
    return _settled(state, now, representatives, config)


_TOUCHING = 0.05
"""Rooms with less floor in common than this share of the smaller one's are not mixed up."""


def settle_level(state: State, level: int, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Settles all rooms of a level, cameras and walls adjusted over all of them.

    Args:
        state: what is known.
        level: storey.
        config: settings.

    Returns:
        What is known now, and what happened.
    """
    there = _on(state, level)
    if not there:
        return state, ()
    now, replaced = _placed_anew(state, there, config)
    every = _representatives(now, _on(now, level))
    # The outlines of rooms that have been left are enough to begin with.
    all_anew = bool(replaced) or not config.adjust.rounds
    begun = [k for k in _on(now, level) if all_anew or now.rooms[k].stale]
    if begun:
        now = _regrouped(now, _representatives(now, begun), config)
    scale = state.scale
    sigma = 0.0 if scale is None or scale.method != "entropy" else scale.sigma or 0.0
    for number in range(config.adjust.rounds):
        now, moved = _adjusted(now, every, number, sigma, config)
        if number and moved < _MOVED_CH:
            break
        now = _regrouped(now, every, config, keep=number > 0)
    now, told = _settled(state, now, every, config)
    return now, (*replaced, *told)


_MOVED_CH = 0.003
"""Corrections that move no camera and no wall by more than this, half a centimetre, are done."""


def _on(state: State, level: int) -> list[int]:
    """The rooms of a level."""
    return [k for k, room in enumerate(state.rooms) if room.level == level]


def _placed_anew(
    state: State, chosen: Sequence[int], config: Config
) -> tuple[State, tuple[Event, ...]]:
    """Misplaced cameras of a tour moved to where their doors are, or left out."""
    views = _views(state, chosen)
    events: list[Event] = []
    # None for a view that is left out.
    moved: dict[int, RegisteredLayout | None] = {}
    cameras = list(state.cameras)
    skipped = list(state.skipped)
    for item in misplaced(views, config.misplaced, config.grouping):
        names = tuple(views[k].keyframe for k in item.members)
        events.append(CamerasMisplaced(names, item.shift))
        for view in (views[k] for k in item.members):
            camera = cameras[view.index]
            if item.shift is None:
                moved[view.index] = None
                cameras[view.index] = replace(camera, room=None)
                skipped.append(Skipped(view.keyframe, "keyframe", _CONTRADICTED))
            else:
                moved[view.index] = Correction(item.shift).apply(view)
                there = camera.position_su + np.array(item.shift) / state.ch_per_su
                cameras[view.index] = replace(camera, position_su=there)
                skipped.append(Skipped(view.keyframe, "pose", _ELSEWHERE))
    if not events:
        return state, ()
    rooms = []
    for room in state.rooms:
        own = [moved.get(view.index, view) for view in room.views]
        left = tuple(view for view in own if view is not None)
        if left != room.views:
            corrected = [cameras[view.index].correction.apply(view) for view in left]
            density = _density(corrected, config) if left else room.density
            room = replace(room, views=left, density=density)
        rooms.append(room)
    current = None if state.current is None else state.rooms[state.current].number
    kept = tuple(room for room in rooms if room.views)
    return replace(
        state,
        rooms=kept,
        current=next((k for k, room in enumerate(kept) if room.number == current), None),
        cameras=tuple(cameras),
        skipped=tuple(skipped),
    ), tuple(events)


_CONTRADICTED = "misplaced: its walls stand where others see none, and no other place is certain"
_ELSEWHERE = "misplaced: its doors are elsewhere, so it was placed there"


_Representatives = Mapping[int, int]
"""Which view is looked at in place of each of some views, by places in the walk; mostly itself."""


def _representatives(
    state: State, chosen: Sequence[int], most: int | None = None
) -> _Representatives:
    """One for each view of some rooms: itself, or one of `most` spread evenly over each room."""
    count = sum(len(state.rooms[k].views) for k in chosen)
    stride = 1 if most is None else math.ceil(count / most)
    return {
        view.index: views[place - place % stride].index
        for views in (state.rooms[k].views for k in chosen)
        for place, view in enumerate(views)
    }


def _settled(
    before: State, now: State, representatives: _Representatives, config: Config
) -> tuple[State, tuple[Event, ...]]:
    """The rooms that hold these views as settled, the levels to be composed; what changed."""
    held = set(_holding(now, representatives))
    settled = tuple(
        replace(room, stale=False, stretches=_stretches(now, room, representatives, config))
        if k in held
        else room
        for k, room in enumerate(now.rooms)
    )
    now = replace(now, rooms=settled, compositions=None)
    return now, _told(before, now, representatives)


def _stretches(
    state: State, room: RoomState, representatives: _Representatives, config: Config
) -> tuple[WallStretch, ...]:
    assert room.shape is not None
    views = [
        state.cameras[view.index].correction.apply(view)
        for view in room.views
        if representatives[view.index] == view.index
    ]
    return stretches(room.shape, views, config.apertures)


def _holding(state: State, keyframes: Collection[int]) -> list[int]:
    """The rooms that hold some of these views."""
    return [
        k
        for k, room in enumerate(state.rooms)
        if any(view.index in keyframes for view in room.views)
    ]


def _adjusted(
    state: State, representatives: _Representatives, number: int, scale_sigma: float, config: Config
) -> tuple[State, float]:
    """Corrects the cameras of some rooms, and the scale, which are then to be settled again.

    A view that another represents moves as that one does.

    Returns:
        What is known now, and how far the corrections moved a camera or a wall at most.
    """
    chosen = _holding(state, representatives)
    views = _looked_at(state, chosen, representatives)
    place = {view.index: k for k, view in enumerate(views)}
    outlined = [
        ([place[v.index] for v in state.rooms[k].views if v.index in place], shape.polygon)
        for k in chosen
        if (shape := state.rooms[k].shape) is not None and shape.polygon is not None
    ]
    # What odometry holds, walls of one thickness would rather bend.
    gap = config.partition.thickness_ch if is_tour(views, config.misplaced) else None
    faces = Faces(*facing_walls([ring for _, ring in outlined], config.partition), gap)
    found = adjust(
        views,
        state.ch_per_su * np.array([state.cameras[view.index].way_su for view in views]),
        outlined,
        [state.cameras[view.index].correction for view in views],
        Stretch(state.stretch, scale_sigma),
        faces,
        config.adjust.reach_ch / (1 + number),
        config.adjust,
    )
    cameras = list(state.cameras)
    moved = 0.0
    for index, representative in representatives.items():
        k = place[representative]
        old, new = cameras[index].correction, found.corrections[k]
        wall = abs(new.turn - old.turn) + abs(new.factor - old.factor)
        moved = max(moved, math.dist(new.shift, old.shift), wall * _WALL_CH)
        covariance = found.covariances.get(k) if index == representative else None
        cameras[index] = replace(cameras[index], correction=new, covariance=covariance)
    return replace(state, cameras=tuple(cameras), stretch=found.stretch), moved


_WALL_CH = 2.0
"""Distance of a usual wall from a camera."""


def _views(state: State, chosen: Sequence[int]) -> list[RegisteredLayout]:
    """Views of some rooms in the order of the walk, where the odometry has them."""
    views = (view for k in chosen for view in state.rooms[k].views)
    return sorted(views, key=lambda view: view.index)


def _looked_at(
    state: State, chosen: Sequence[int], representatives: _Representatives
) -> list[RegisteredLayout]:
    """The representatives among the views of some rooms, in the order of the walk."""
    return [view for view in _views(state, chosen) if representatives[view.index] == view.index]


def carried(state: State, index: int) -> tuple[PlacedCamera, ...]:
    """The cameras, one of them with the correction of the last one placed before it.

    Args:
        state: what is known.
        index: place in the walk of a new camera.

    Returns:
        All cameras; the new one moves rigidly with the one before.
    """
    placed_before = (k for k in range(index - 1, -1, -1) if state.cameras[k].room is not None)
    before = next((state.cameras[k] for k in placed_before), None)
    if before is None or (before.correction == Correction() and state.stretch == 1.0):
        return state.cameras
    camera, old = state.cameras[index], before.correction
    step = state.ch_per_su * (camera.position_su - before.position_su)
    c, s = state.stretch * np.cos(old.turn), state.stretch * np.sin(old.turn)
    shift = old.shift + np.array([[c, -s], [s, c]]) @ step - step
    moved = Correction((float(shift[0]), float(shift[1])), old.turn)
    placed = replace(camera, correction=moved)
    return (*state.cameras[:index], placed, *state.cameras[index + 1 :])


def _regrouped(
    state: State, representatives: _Representatives, config: Config, *, keep: bool = False
) -> State:
    """Tells the views of some rooms apart anew and shapes the rooms that they are of.

    A view is of the room of that which represents it. A room that comes out keeps the number of the
    room that most of its views were in; where two claim one number, the one with more of its views
    has it, the other gets a new one. With `keep` the views stay together as they are; what the walk
    knows of its rooms counts more.
    """
    chosen = _holding(state, representatives)
    before = {view.index: state.rooms[k].number for k in chosen for view in state.rooms[k].views}
    raw = _looked_at(state, chosen, representatives)
    views = CorrectedLayouts(raw, [state.cameras[view.index].correction for view in raw])
    known = state.walk.rooms or (before if keep else None)
    together = None if known is None else _together([known[view.index] for view in raw])
    planned = plan_rooms(views, config, together)
    spoken_for: dict[int, list[RegisteredLayout]] = {}
    for view in _views(state, chosen):
        spoken_for.setdefault(representatives[view.index], []).append(view)
    used = max(room.number for room in state.rooms)
    members = [
        sorted((v for k in room.members for v in spoken_for[raw[k].index]), key=lambda v: v.index)
        for room in planned
    ]
    claims = [[before[view.index] for view in own] for own in members]
    old = {state.rooms[k].number: state.rooms[k] for k in chosen}
    level = state.rooms[chosen[0]].level
    made = []
    for room, own, number in zip(planned, members, _numbers(claims, used), strict=True):
        was = old.get(number)
        if was is not None and [v.index for v in was.views] == [v.index for v in own]:
            made.append(replace(was, shape=room.shape))
            continue
        moved = [state.cameras[view.index].correction.apply(view) for view in own]
        made.append(
            RoomState(
                number,
                _density(moved, config),
                (),
                (),
                views=tuple(own),
                level=level,
                shape=room.shape,
                away=-1 if was is None else was.away,
            )
        )
    after = {view.index: room.number for room in made for view in room.views}
    current = None if state.current is None else state.rooms[state.current].number
    if current in old:
        # The camera goes on in the room of its last keyframe.
        current = after[max(k for k, number in before.items() if number == current)]
    kept = [room for k, room in enumerate(state.rooms) if k not in chosen]
    every = tuple(sorted([*kept, *made], key=lambda room: room.number))
    return replace(
        state,
        rooms=every,
        current=next((k for k, room in enumerate(every) if room.number == current), None),
        cameras=tuple(
            replace(camera, room=after[k]) if k in after and camera.room != after[k] else camera
            for k, camera in enumerate(state.cameras)
        ),
    )


def _together(numbers: Sequence[int]) -> list[list[int]]:
    """The places of each number."""
    return [np.flatnonzero(np.equal(numbers, k)).tolist() for k in np.unique(numbers)]


def compose(state: State, config: Config) -> State:
    """Makes the rooms of each level one plan, where they were settled since that was last done.

    Args:
        state: what is known.
        config: settings.

    Returns:
        What is known now.
    """
    if state.compositions is not None:
        return state
    out = []
    for level in range(len(state.levels)):
        there = [room for room in state.rooms if room.level == level and room.shape is not None]
        shapes, facings = partition([r.shape for r in there if r.shape], config.partition)
        found = apertures(
            shapes,
            [room.stretches for room in there],
            [
                (view.index, view.camera + state.cameras[view.index].correction.shift)
                for room in there
                for view in room.views
            ],
            facings,
            config.apertures,
        )
        out.append(Composition(tuple(room.number for room in there), shapes, facings, found))
    return replace(state, compositions=tuple(out))


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


def _density(views: Sequence[RegisteredLayout], config: Config) -> RoomDensity:
    density = rooms.clipped_patch(views[0], config.rooms).density
    for view in views[1:]:
        density = rooms.add(density, rooms.clipped_patch(view, config.rooms).density, config.rooms)
    return density


def _told(before: State, now: State, keyframes: Collection[int]) -> tuple[Event, ...]:
    """What changed in the rooms that hold some views."""
    events: list[Event] = []
    moved = sum(before.cameras[k].room != now.cameras[k].room for k in keyframes)
    made = [now.rooms[k] for k in _holding(now, keyframes)]
    old = {before.rooms[k].number: before.rooms[k] for k in _holding(before, keyframes)}
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
        if was is None or not _same_outline(was, room.shape):
            events.append(RoomShaped(room_id(room.number), room.shape.polygon, room.shape.failure))
    return tuple(events)


def _same_outline(one: RoomShape, other: RoomShape) -> bool:
    """Whether two outlines differ by less than what is told."""
    if one.polygon is None or other.polygon is None:
        return one.polygon is other.polygon and one.failure == other.failure
    if one.polygon.shape != other.polygon.shape:
        return False
    first = int(np.argmin(np.hypot(*(other.polygon - one.polygon[0]).T)))
    apart = np.roll(other.polygon, -first, axis=0) - one.polygon
    return bool(np.abs(apart).max() < _MOVED_CH)
