"""What a state came from: computed anew, so that a run that is not explained pays nothing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from panoplan.config import Config
from panoplan.estimator.assemble import PlanFrame, plan_frame
from panoplan.estimator.state import RoomState, State, room_id
from panoplan.estimator.step import evidence_of, walls_seen
from panoplan.geometry.polar import mutual_overlaps
from panoplan.stages import rooms
from panoplan.stages.plan.floorplan import PlannedRoom, plan_rooms
from panoplan.stages.plan.grouping import doorways
from panoplan.stages.plan.outline import cut
from panoplan.stages.plan.sight import sights
from panoplan.stages.registration import cast, register
from panoplan.stages.scale import recover_scale
from panoplan.stages.shape.ispa import Round, rounds
from panoplan.types.arrays import FloatArray
from panoplan.types.explain import (
    Cloud,
    ExplainedFloor,
    ExplainedRoom,
    ExplainedRound,
    ExplainedScale,
    ExplainedView,
    ExplainedWalls,
    Explanation,
    Grouping,
    Raster,
)
from panoplan.types.keyframe import Keyframe
from panoplan.types.room import RoomShape
from panoplan.types.view import CastLayout, RegisteredLayout

SCALE_FACTORS = (0.9, 1.0, 1.1)
"""Scales that the cloud of boundary points is shown at, relative to the one that was used."""

Layouts = Mapping[int, CastLayout]
Views = Mapping[int, RegisteredLayout]


def explain(state: State, keyframes: Sequence[Keyframe], config: Config) -> Explanation:
    """Gathers what each stage made of a walk.

    Args:
        state: after the walk.
        keyframes: of the walk, from its first on.
        config: settings of the walk.

    Returns:
        The explanation.
    """
    frame = plan_frame(state)
    layouts = _layouts(state, keyframes, config)
    odometry = {k: register(layout, state.ch_per_su) for k, layout in layouts.items()}
    views = {k: state.cameras[k].correction.apply(view) for k, view in odometry.items()}
    explain_room = _fused_rooms if config.shape.method == "fusion" else _ispa_rooms
    told = [_view(state, view, frame) for view in views.values()]
    groupings: list[Grouping] = []
    if config.shape.method == "fusion":
        for level in range(len(state.levels)):
            there = [place for place, view in enumerate(told) if view.level == level]
            if there:
                told, grouping = _grouped(level, there, told, list(views.values()), config)
                groupings.append(grouping)
    return Explanation(
        unit=frame.unit,
        config=config,
        scale=_scale(state, layouts, views, frame, config),
        views=tuple(told),
        rooms=explain_room(state, views, frame, config),
        groupings=tuple(groupings),
    )


def _layouts(state: State, keyframes: Sequence[Keyframe], config: Config) -> Layouts:
    """The layouts of all keyframes that are in a room, by their place in the walk."""
    frame = state.frame
    base = {room.number: state.levels[room.level] for room in state.rooms}
    found = {}
    for index, (keyframe, camera) in enumerate(zip(keyframes, state.cameras, strict=False)):
        if frame is None or camera.room is None:
            continue
        layout = cast(keyframe, index, frame.origin_su, frame.walk_from_world, config.registration)
        found[index] = replace(layout, rise_su=layout.rise_su - base[camera.room])
    return found


def _view(state: State, view: RegisteredLayout, frame: PlanFrame) -> ExplainedView:
    number = state.cameras[view.index].room
    assert number is not None
    return ExplainedView(
        keyframe=view.keyframe,
        room=room_id(number),
        level=next(room.level for room in state.rooms if room.number == number),
        camera=frame.to_plan(view.camera),
        boundary=frame.to_plan(view.boundary),
    )


def _scale(
    state: State, layouts: Layouts, views: Views, frame: PlanFrame, config: Config
) -> ExplainedScale:
    if not layouts:
        return ExplainedScale(state.scale, None, None, ())
    level = {room.number: room.level for room in state.rooms}
    levels = {k: level[state.cameras[k].room or 0] for k in layouts}
    shown = Counter(levels.values()).most_common(1)[0][0]
    there = [k for k in layouts if levels[k] == shown]
    used = state.ch_per_su
    clouds = [
        Cloud(s, _points([register(layouts[k], s) for k in there], frame))
        for s in ([factor * used for factor in SCALE_FACTORS] if used else [0.0])
    ]
    adjusted = None
    if any(state.cameras[k].correction.shift != (0.0, 0.0) for k in there):
        adjusted = state.stretch * used
        clouds.append(Cloud(adjusted, _points([views[k] for k in there], frame), adjusted=True))
    searched = state.scale
    if searched is None or searched.curve is None:
        # A scale that was given is compared with what the layouts say.
        first = [layouts[k] for k in there]
        searched = recover_scale(first, config.scale) if len(first) > 1 else None
    if searched is not None and searched.curve is None:
        searched = None
    return ExplainedScale(state.scale, searched, adjusted, tuple(clouds))


def _points(views: Sequence[RegisteredLayout], frame: PlanFrame) -> FloatArray:
    points = np.concatenate([view.boundary for view in views])
    return frame.to_plan(points[np.isfinite(points[:, 0])])


def _grouped(
    level: int,
    there: Sequence[int],
    told: Sequence[ExplainedView],
    views: Sequence[RegisteredLayout],
    config: Config,
) -> tuple[list[ExplainedView], Grouping]:
    """The views, those from a doorway marked, and the common areas of a level's, room by room."""
    order = sorted(there, key=lambda k: (told[k].room, k))
    seen = sights([views[k] for k in order])
    settings = config.grouping
    marked = list(told)
    for k, at_door in zip(order, doorways(seen, settings), strict=True):
        marked[k] = replace(told[k], doorway=bool(at_door))
    common = mutual_overlaps(seen.cameras, seen.profiles, settings.reach_ch, settings.cell_ch)
    return marked, Grouping(level, np.array(order, dtype=np.int64), common)


def _room(room: RoomState, shape: RoomShape, frame: PlanFrame, config: Config) -> ExplainedRoom:
    return ExplainedRoom(
        id=room_id(room.number),
        name=f"Room {room.number}",
        density=_lattice(
            room.density.first_cell,
            config.rooms.cell_ch,
            rooms.density(room.density, config.rooms),
            frame,
        ),
        polygon=None if shape.polygon is None else frame.to_plan(shape.polygon),
        failure=shape.failure,
    )


def _lattice(
    first_cell: tuple[int, int], cell_ch: float, values: FloatArray, frame: PlanFrame
) -> Raster:
    origin = frame.to_plan(cell_ch * np.array(first_cell, dtype=float))
    return Raster(origin, frame.length * cell_ch * frame.world_from_walk.T, values)


def _ispa_rooms(
    state: State, views: Views, frame: PlanFrame, config: Config
) -> tuple[ExplainedRoom, ...]:
    out = []
    for room in state.rooms:
        assert room.shape is not None
        rejected = []
        for view in (v for k, v in views.items() if state.cameras[k].room == room.number):
            width = len(view.boundary)
            for piece in walls_seen(view, config)[1]:
                first, last = piece.columns
                columns = (first + np.arange((last - first) % width + 1)) % width
                points = view.boundary[columns]
                known = np.isfinite(points[:, 0])
                rejected.append((piece.reason, frame.to_plan(points[known])))
        walls = ExplainedWalls(
            kept=tuple(frame.to_plan(wall.ends) for wall in room.walls),
            rejected=tuple(rejected),
            rounds=tuple(
                _round(made, frame) for made in rounds(evidence_of(room, config), config.shape)
            ),
        )
        out.append(replace(_room(room, room.shape, frame, config), walls=walls))
    return tuple(out)


def _round(made: Round, frame: PlanFrame) -> ExplainedRound:
    grid = made.grid
    corner = frame.to_plan(grid.to_walk(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])))
    wall = Raster(corner[0], corner[1:] - corner[0], made.wall)
    nodes = np.empty((0, 2)) if made.candidates is None else made.candidates.nodes
    corners = None if made.corners is None else wall.at(made.corners)
    return ExplainedRound(wall, made.mask, wall.at(nodes), corners)


def _fused_rooms(
    state: State, views: Views, frame: PlanFrame, config: Config
) -> tuple[ExplainedRoom, ...]:
    composed = state.composed
    planned: dict[int, PlannedRoom] = {}
    for level in range(len(state.levels)):
        planned |= _planned([room for room in state.rooms if room.level == level], views, config)
    out = []
    for room in state.rooms:
        explained = _room(room, composed[room.number], frame, config)
        made = planned.get(room.number)
        if made is not None and made.floor is not None:
            floor, shape = made.floor, made.shape
            cell = config.fusion.cell_ch
            told = ExplainedFloor(
                distance=_lattice(floor.first_cell, cell, frame.length * floor.field, frame),
                pieces=tuple(
                    frame.to_plan(piece) for piece in cut(floor, config.outline, config.fusion)
                ),
                fitted=None if shape.polygon is None else frame.to_plan(shape.polygon),
                sigmas=None if shape.sigmas is None else frame.length * shape.sigmas,
            )
            explained = replace(explained, floor=told)
        out.append(explained)
    return tuple(out)


def _planned(there: Sequence[RoomState], views: Views, config: Config) -> dict[int, PlannedRoom]:
    """The rooms of a level shaped once more from their views, by number."""
    number = {view.index: room.number for room in there for view in room.views}
    order = sorted(number)
    place = {index: k for k, index in enumerate(order)}
    found: dict[int, PlannedRoom] = {}
    known = [[place[view.index] for view in room.views] for room in there]
    for made in plan_rooms([views[index] for index in order], config, known):
        claims = Counter(number[order[k]] for k in made.members)
        found.setdefault(claims.most_common(1)[0][0], made)
    return found
