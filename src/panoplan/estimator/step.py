"""One keyframe: step(state, keyframe, config) → (state', events)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from panoplan.config import Config
from panoplan.errors import ConfigError
from panoplan.estimator.settle import carried, compose, settle_around, settle_level
from panoplan.estimator.state import PlacedCamera, RoomState, State, WalkFrame, room_id
from panoplan.geometry.rigid import heading_of, turn
from panoplan.stages import orientation, planes, rooms, scale
from panoplan.stages.registration import cast, register
from panoplan.stages.shape.ispa import RoomEvidence, room_shape
from panoplan.types.events import (
    Event,
    KeyframePlaced,
    KeyframeSkipped,
    KeyframeWaiting,
    LevelReached,
    RoomOpened,
    RoomShaped,
    RoomsJoined,
    ScaleFrozen,
)
from panoplan.types.keyframe import Keyframe
from panoplan.types.plan import ScaleEstimate, Skipped
from panoplan.types.room import RejectedPiece, WallPiece
from panoplan.types.view import CastLayout, RegisteredLayout


def step(state: State, keyframe: Keyframe, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Takes in one keyframe.

    Args:
        state: what is known so far.
        keyframe: the next of the walk.
        config: settings, the same at every step.

    Returns:
        What is known now, and what happened.

    Raises:
        ConfigError: the warm-up is a fraction of a walk whose length is not known.
    """
    if state.frame is None:
        turned = turn(-heading_of(keyframe.pose.rotation))
        state = replace(state, frame=WalkFrame(keyframe.pose.translation, turned))
    frame = state.frame
    assert frame is not None
    index = state.seen
    moved = (keyframe.pose.translation - frame.origin_su)[[0, 2]]
    position = frame.walk_from_world @ moved
    way = 0.0
    if state.cameras:
        before = state.cameras[-1]
        way = before.way_su + float(np.hypot(*(position - before.position_su)))
    camera = PlacedCamera(
        keyframe.id, position, heading_of(keyframe.pose.rotation), None, way_su=way
    )
    state = replace(state, seen=index + 1, cameras=(*state.cameras, camera))
    view = None
    if keyframe.layout is not None:
        view = cast(keyframe, index, frame.origin_su, frame.walk_from_world, config.registration)
    if view is None or not np.isfinite(view.offsets).any():
        reason = (
            keyframe.missing if view is None else "no column of the layout is below the horizon"
        )
        skipped = Skipped(keyframe.id, "keyframe", reason)
        state = replace(state, skipped=(*state.skipped, skipped))
        return state, (KeyframeSkipped(keyframe.id, reason),)
    if state.scale is not None:
        state, events = _on_level(state, view, config)
        state, left = _leave(state, events, config)
        return compose(state, config), (*events, *left)
    state = replace(state, waiting=(*state.waiting, view))
    waiting: Event = KeyframeWaiting(keyframe.id, len(state.waiting))
    state, frozen = _warm_up(state, config)
    return compose(state, config), (waiting, *frozen)


def finish(state: State, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Ends the walk: freezes the scale if it is not, and shapes every room that needs it.

    Layouts that still wait for their level are of a new one where they agree. The walk may still
    go on afterwards.

    Args:
        state: what is known.
        config: settings, as at every step.

    Returns:
        What is known now, and what happened.
    """
    events: list[Event] = []
    if state.scale is None and state.waiting:
        state, told = _freeze(state, _estimate(state, config), config, leaving=False)
        events += told
    if state.climbing:
        state, told = _end_climb(state, config)
        events += told
    if config.shape.method == "fusion":
        if state.finished == state.seen:
            return state, tuple(events)
        for level in range(len(state.levels)):
            state, told = settle_level(state, level, config)
            events += told
        return compose(replace(state, finished=state.seen), config), tuple(events)
    state, joined = _absorb(state, config)
    events += joined
    for index in range(len(state.rooms)):
        state, told = _shape(state, index, config)
        events += told
    return state, tuple(events)


def _warm_up(state: State, config: Config) -> tuple[State, tuple[Event, ...]]:
    count, mode = len(state.waiting), config.scale.warmup
    if state.walk.trajectory_unit == "m" and state.walk.camera_height_m:
        if count < config.scale.warmup_min:
            return state, ()
        return _freeze(state, _estimate(state, config), config)
    if mode == "converged":
        due = max(state.next_estimate, config.scale.warmup_min)
        if count < due:
            return state, ()
        estimate = _estimate(state, config)
        history = (*state.estimates, estimate.ch_per_su or 0.0)
        recent = history[-config.scale.settle_count :]
        settled = len(recent) == config.scale.settle_count and (
            max(recent) - min(recent) <= config.scale.settle_tolerance * recent[-1]
        )
        if settled or count >= config.scale.warmup_max:
            return _freeze(state, replace(estimate, converged=settled), config)
        grown = max(count + 1, int(np.ceil(count * config.scale.warmup_growth)))
        grown = min(grown, max(count + 1, config.scale.warmup_max))
        return replace(state, estimates=history, next_estimate=grown), ()
    if isinstance(mode, float):
        if state.walk.expected_keyframes is None:
            raise ConfigError("scale.warmup", f"the fraction {mode}", "a walk of known length")
        needed = max(2, int(np.ceil(mode * state.walk.expected_keyframes)))
        # The last keyframes may have no layout, so the fraction counts keyframes seen.
        enough = state.seen >= needed and count >= 2
    else:
        enough = count >= max(2, int(mode))
    if not enough:
        return state, ()
    return _freeze(state, replace(_estimate(state, config), converged=True), config)


def _estimate(state: State, config: Config) -> ScaleEstimate:
    walk = state.walk
    if walk.trajectory_unit == "m" and walk.camera_height_m:
        # The height given is the median camera's; the unit of length is the first one's.
        per_m = 1.0 / walk.camera_height_m
        rise_m = float(np.median([v.rise_su for v in _first_level(state, per_m, config)]))
        first_m = max(walk.camera_height_m - rise_m, walk.camera_height_m / 10)
        return ScaleEstimate(1.0 / first_m, "given", keyframes_used=len(state.waiting))
    if len(state.waiting) < 2:
        return ScaleEstimate(None, "unknown", converged=False, keyframes_used=len(state.waiting))
    estimate = scale.recover_scale(state.waiting, config.scale)
    there = _first_level(state, estimate.ch_per_su or 0.0, config)
    if len(there) < 2 or len(there) == len(state.waiting):
        return estimate
    # Layouts of two storeys lie on top of one another and agree by chance only.
    return scale.recover_scale(there, config.scale)


def _first_level(state: State, ch_per_su: float, config: Config) -> tuple[CastLayout, ...]:
    """The waiting layouts whose cameras are as high as the walk's first ones."""
    if config.levels.keyframes == 0:
        return state.waiting
    rises = np.array([view.rise_su for view in state.waiting])
    first = float(np.median(rises[: config.levels.keyframes]))
    near = ch_per_su * np.abs(rises - first) <= config.levels.step_ch
    return tuple(view for view, there in zip(state.waiting, near, strict=True) if there)


def _freeze(
    state: State, estimate: ScaleEstimate, config: Config, *, leaving: bool = True
) -> tuple[State, tuple[Event, ...]]:
    """Places the layouts that waited; without `leaving` no room is shaped on the way."""
    waiting = state.waiting
    there = _first_level(state, estimate.ch_per_su or 0.0, config)
    if estimate.method == "entropy" and estimate.ch_per_su is not None:
        sigma = scale.scale_sigma(there, estimate, config.scale)
        estimate = replace(estimate, sigma=sigma)
    rises = [view.rise_su for view in there]
    median_height = 1.0 + (estimate.ch_per_su or 0.0) * float(np.median(rises))
    state = replace(state, scale=estimate, median_height=median_height, waiting=())
    events: list[Event] = [ScaleFrozen(estimate)]
    for view in waiting:
        state, told = _on_level(state, view, config)
        events += told
        if leaving:
            state, left = _leave(state, told, config)
            events += left
    return state, tuple(events)


def _on_level(state: State, view: CastLayout, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Places a layout on the camera's level, or keeps it until it is known on which it is.

    A height that drifts slowly over the walk starts no level.
    """
    ch_per_su, levels = state.ch_per_su, config.levels
    higher = ch_per_su * (view.rise_su - state.levels[state.level] - state.cruise_su)
    if levels.keyframes == 0 or (abs(higher) <= levels.step_ch and not state.climbing):
        lag = view.rise_su - state.levels[state.level] - state.cruise_su
        state = replace(state, cruise_su=state.cruise_su + _FOLLOWING * lag)
        return _place(state, view, config)
    state = replace(state, climbing=(*state.climbing, view))
    if abs(higher) <= levels.step_ch:
        # Back where it was: the camera was only held higher or lower for a while.
        return _arrive(state, state.levels[state.level], config)
    recent = state.climbing[-levels.keyframes :]
    rises = ch_per_su * np.array([v.rise_su for v in recent])
    if len(recent) < levels.keyframes or np.ptp(rises) > levels.step_ch / 2:
        return state, (KeyframeWaiting(view.keyframe, len(state.climbing)),)
    return _arrive(state, float(np.median([v.rise_su for v in recent])), config)


_FOLLOWING = 0.1
"""What counts as the camera's usual height follows the last ten keyframes."""


def _arrive(state: State, rise_su: float, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Places the layouts that waited for their level, on that of a height."""
    ch_per_su, climbing = state.ch_per_su, state.climbing
    state = replace(state, climbing=())
    events: list[Event] = []
    away = [ch_per_su * abs(rise_su - base) for base in state.levels]
    level = int(np.argmin(away))
    if away[level] > config.levels.step_ch:
        level = len(state.levels)
        state = replace(state, levels=(*state.levels, rise_su))
    changed = level != state.level
    if changed:
        state = replace(state, level=level, cruise_su=0.0, current=None)
        events.append(LevelReached(climbing[-1].keyframe, level))
    for view in climbing:
        near = ch_per_su * abs(view.rise_su - state.levels[level]) <= config.levels.step_ch
        if near or not changed:
            state, told = _place(state, view, config)
        else:
            state, told = _between_levels(state, (view,))
        events += told
    return state, tuple(events)


def _end_climb(state: State, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Places the layouts that still wait for their level when the walk ends.

    Those that agree are of one level. Else the walk ends on stairs, or where it has just left
    them for a level that is known. A single layout makes no level.
    """
    rises = np.array([view.rise_su for view in state.climbing])
    step_su = config.levels.step_ch / state.ch_per_su
    if len(rises) == 1:
        return _arrive(state, state.levels[state.level], config)
    if np.ptp(rises) <= step_su / 2:
        return _arrive(state, float(np.median(rises)), config)
    if np.abs(np.array(state.levels) - rises[-1]).min() <= step_su:
        return _arrive(state, float(rises[-1]), config)
    return _between_levels(replace(state, climbing=()), state.climbing)


def _between_levels(state: State, views: Sequence[CastLayout]) -> tuple[State, tuple[Event, ...]]:
    """Leaves out layouts of stairs, whose floor is no room's."""
    reason = "between two levels, as on stairs"
    skipped = tuple(Skipped(view.keyframe, "keyframe", reason) for view in views)
    state = replace(state, skipped=(*state.skipped, *skipped))
    return state, tuple(KeyframeSkipped(view.keyframe, reason) for view in views)


def _place(state: State, view: CastLayout, config: Config) -> tuple[State, tuple[Event, ...]]:
    above = replace(view, rise_su=view.rise_su - state.levels[state.level])
    layout = register(above, state.ch_per_su)
    state = replace(state, cameras=carried(state, view.index))
    corrected = state.cameras[view.index].correction.apply(layout)
    reason = _astray(layout)
    if reason is not None:
        skipped = Skipped(view.keyframe, "keyframe", reason)
        return replace(state, skipped=(*state.skipped, skipped)), (
            KeyframeSkipped(view.keyframe, reason),
        )
    events: list[Event] = []
    patch = rooms.clipped_patch(corrected, config.rooms)
    here = [k for k, room in enumerate(state.rooms) if room.level == state.level]
    known = [state.rooms[k].density for k in here]
    current = None if state.current is None else here.index(state.current)
    chosen, _ = rooms.choose(patch, known, current, config.rooms)
    fused = config.shape.method == "fusion"
    walls, rejected = ((), ()) if fused else walls_seen(layout, config)
    views = (layout,) if fused else ()
    if chosen is None:
        number = max((room.number for room in state.rooms), default=0) + 1
        room = RoomState(number, patch.density, walls, (), views, state.level)
        chosen = len(state.rooms)
        events.append(RoomOpened(view.keyframe, room_id(number)))
    else:
        chosen = here[chosen]
        old = state.rooms[chosen]
        room = replace(
            old,
            density=rooms.add(old.density, patch.density, config.rooms),
            walls=(*old.walls, *walls),
            views=(*old.views, *views),
        )
    for wall in walls:
        room = replace(
            room, orientations=orientation.observe(room.orientations, wall, config.orientation)
        )
    room = replace(room, stale=True, away=0)
    events.append(KeyframePlaced(view.keyframe, room_id(room.number), len(walls), len(rejected)))
    counts = Counter(piece.reason for piece in rejected)
    state = replace(
        state,
        rooms=(*state.rooms[:chosen], room, *state.rooms[chosen + 1 :]),
        current=chosen,
        cameras=_assigned(state.cameras, layout, room.number),
        skipped=(
            *state.skipped,
            *(Skipped(view.keyframe, "wall", why, n) for why, n in sorted(counts.items())),
        ),
    )
    state, told = _join(state, config)
    return state, (*events, *told)


_HIGHEST_CH = 20.0
"""A camera is at most so far above the floor: the first one may lie on the ground."""
_FARTHEST_CH = 1e6
"""A camera is at most so far from the first one: a lost pose may lie anywhere."""


def _astray(layout: RegisteredLayout) -> str | None:
    """Why a camera cannot be where its pose says, or None."""
    if layout.height <= 0:
        return "its pose lies below the floor"
    if layout.height > _HIGHEST_CH:
        return f"its pose lies over {_HIGHEST_CH:g} camera heights above the floor"
    if np.abs(layout.camera).max() > _FARTHEST_CH:
        return f"its pose lies over {_FARTHEST_CH:g} camera heights away"
    return None


def walls_seen(
    layout: RegisteredLayout, config: Config
) -> tuple[tuple[WallPiece, ...], tuple[RejectedPiece, ...]]:
    """Pieces of wall in a layout and those rejected, the same whenever it is asked for."""
    rng = np.random.default_rng([config.seed, layout.index])
    return planes.wall_pieces(layout, config.planes, rng)


def _assigned(
    cameras: tuple[PlacedCamera, ...], layout: RegisteredLayout, number: int
) -> tuple[PlacedCamera, ...]:
    at = layout.index
    placed = replace(cameras[at], room=number, ceiling=layout.ceiling)
    return (*cameras[:at], placed, *cameras[at + 1 :])


def _join(state: State, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Joins the current room with those that prove to be the same."""
    events: list[Event] = []
    while state.current is not None:
        current = state.rooms[state.current]
        same = [
            i
            for i, other in enumerate(state.rooms)
            if i != state.current
            and other.level == current.level
            and rooms.overlap(current.density, other.density, config.rooms.merge_over)
            > config.rooms.merge_overlap
        ]
        if not same:
            break
        kept_at, gone_at = sorted((state.current, same[0]))
        state, joined = _merged(state, kept_at, gone_at, config)
        events.append(joined)
    return state, tuple(events)


def _absorb(state: State, config: Config) -> tuple[State, tuple[Event, ...]]:
    """Gives small rooms that prove to be parts of others to the one they overlap most."""
    events: list[Event] = []
    index = 0
    while index < len(state.rooms):
        room = state.rooms[index]
        others = [o for o in state.rooms if o is not room and o.level == room.level]
        few = sum(camera.room == room.number for camera in state.cameras)
        if (
            index == state.current
            or few > config.rooms.absorb_keyframes
            or rooms.claimed(room.density, [o.density for o in others]) <= config.rooms.absorb_share
        ):
            index += 1
            continue
        overlaps = [rooms.overlap(room.density, o.density) for o in others]
        into = state.rooms.index(others[int(np.argmax(overlaps))])
        kept_at, gone_at = sorted((index, into))
        state, joined = _merged(state, kept_at, gone_at, config)
        events.append(joined)
        index = 0
    return state, tuple(events)


def _merged(state: State, kept_at: int, gone_at: int, config: Config) -> tuple[State, Event]:
    kept, gone = state.rooms[kept_at], state.rooms[gone_at]
    orientations = kept.orientations
    for wall in gone.walls:
        orientations = orientation.observe(orientations, wall, config.orientation)
    joined = replace(
        kept,
        density=rooms.add(kept.density, gone.density, config.rooms),
        walls=(*kept.walls, *gone.walls),
        views=tuple(sorted((*kept.views, *gone.views), key=lambda view: view.index)),
        orientations=orientations,
        stale=True,
        away=kept.away if gone.away < 0 else 0,
    )
    remaining = list(state.rooms)
    remaining[kept_at] = joined
    del remaining[gone_at]
    current = state.current
    if current is not None:
        current = kept_at if current == gone_at else current - (current > gone_at)
    merged = replace(
        state,
        rooms=tuple(remaining),
        current=current,
        cameras=tuple(
            replace(camera, room=kept.number) if camera.room == gone.number else camera
            for camera in state.cameras
        ),
    )
    return merged, RoomsJoined(room_id(kept.number), room_id(gone.number))


def _leave(state: State, told: Sequence[Event], config: Config) -> tuple[State, tuple[Event, ...]]:
    """Counts keyframes away from each open room; shapes those that have been left."""
    if not any(isinstance(event, KeyframePlaced) for event in told):
        return state, ()
    left = []
    for index, room in enumerate(state.rooms):
        if index == state.current or room.away < 0:
            continue
        gone = room.away + 1 >= config.rooms.leave_after
        changed = replace(room, away=-1 if gone else room.away + 1)
        state = replace(state, rooms=(*state.rooms[:index], changed, *state.rooms[index + 1 :]))
        if gone:
            left.append(room.number)
    events: list[Event] = []
    for number in left:
        # Settling one room may renumber or remove another.
        for index, room in enumerate(state.rooms):
            if room.number == number:
                state, told = _shape(state, index, config)
                events += told
                break
    return state, tuple(events)


def _shape(state: State, index: int, config: Config) -> tuple[State, tuple[Event, ...]]:
    room = state.rooms[index]
    if not room.stale:
        return state, ()
    if config.shape.method == "fusion":
        return settle_around(state, index, config)
    shape = room_shape(evidence_of(room, config), config.shape)
    shaped = replace(room, shape=shape, stale=False)
    state = replace(state, rooms=(*state.rooms[:index], shaped, *state.rooms[index + 1 :]))
    return state, (RoomShaped(room_id(room.number), shape.polygon, shape.failure),)


def evidence_of(room: RoomState, config: Config) -> RoomEvidence:
    """What iSPA shapes a room from."""
    directions, _ = orientation.accepted(room.orientations, config.orientation)
    return RoomEvidence(
        rooms.density(room.density, config.rooms),
        room.density.first_cell,
        config.rooms.cell_ch,
        config.rooms.threshold,
        room.walls,
        directions,
    )
