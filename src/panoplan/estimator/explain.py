"""What a state came from: computed anew, so that a run that is not explained pays nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from panoplan.config import Config
from panoplan.estimator.state import RoomState, State, room_id
from panoplan.stages import planes, rooms
from panoplan.stages.plan.fusion import fuse
from panoplan.stages.plan.sight import sights
from panoplan.stages.registration import cast, register
from panoplan.types.arrays import FloatArray
from panoplan.types.explain import ExplainedRoom, Explanation, Raster
from panoplan.types.keyframe import Keyframe
from panoplan.types.room import RoomShape
from panoplan.types.view import CastLayout

SCALE_FACTORS = (0.9, 1.0, 1.1)
"""Scales that the cloud of boundary points is shown at, relative to the one that was found."""


def explain(state: State, keyframes: Sequence[Keyframe], config: Config) -> Explanation:
    """Gathers what each stage made of a walk.

    Args:
        state: after the walk.
        keyframes: of the walk, from its first on.
        config: settings of the walk.

    Returns:
        The explanation.
    """
    frame = state.frame
    ch_per_su = 0.0 if state.scale is None else state.scale.ch_per_su or 0.0
    layouts: dict[int, CastLayout] = {}
    for index, keyframe in enumerate(keyframes):
        if frame is not None and keyframe.layout is not None and index < len(state.cameras):
            layouts[index] = cast(
                keyframe, index, frame.origin_su, frame.walk_from_world, config.registration
            )
    level = {room.number: room.level for room in state.rooms}
    for index, camera in enumerate(state.cameras):
        if camera.room is not None and index in layouts:
            base = state.levels[level[camera.room]]
            layouts[index] = replace(layouts[index], rise_su=layouts[index].rise_su - base)
    composed = {
        number: shape
        for composition in state.compositions or ()
        for number, shape in zip(composition.numbers, composition.shapes, strict=True)
    }
    placed = [camera for camera in state.cameras if camera.room is not None]
    path = [ch_per_su * c.position_su + c.correction.shift for c in placed]
    return Explanation(
        scale=state.scale,
        clouds=tuple(
            (factor, _cloud(layouts, factor * ch_per_su))
            for factor in (SCALE_FACTORS if ch_per_su else (1.0,))
        ),
        rooms=tuple(
            _room(room, state, layouts, ch_per_su, composed.get(room.number), config)
            for room in state.rooms
        ),
        path=np.array(path).reshape(-1, 2),
    )


def _cloud(layouts: Mapping[int, CastLayout], ch_per_su: float) -> FloatArray:
    points = [register(layout, ch_per_su).boundary for layout in layouts.values()]
    together = np.concatenate(points) if points else np.empty((0, 2))
    return np.asarray(together[np.isfinite(together[:, 0])])


def _room(
    room: RoomState,
    state: State,
    layouts: Mapping[int, CastLayout],
    ch_per_su: float,
    composed: RoomShape | None,
    config: Config,
) -> ExplainedRoom:
    members = [k for k, camera in enumerate(state.cameras) if camera.room == room.number]
    shape = room.shape or RoomShape(None, "the camera has not left it yet")
    cameras = [
        ch_per_su * state.cameras[k].position_su + state.cameras[k].correction.shift
        for k in members
    ]
    cell = config.rooms.cell_ch
    explained = ExplainedRoom(
        id=room_id(room.number),
        cameras=np.array(cameras).reshape(-1, 2),
        density=Raster(
            cell * np.array(room.density.first_cell, dtype=float),
            cell,
            rooms.density(room.density, config.rooms),
        ),
        rounds=shape.rounds,
        outline=shape.polygon,
        polygon=shape.polygon if composed is None else composed.polygon,
        sigmas=shape.sigmas,
        failure=shape.failure if composed is None else composed.failure,
    )
    if config.shape.method == "ispa":
        rejected = []
        for k in members:
            if k not in layouts:
                continue
            layout = register(layouts[k], ch_per_su)
            rng = np.random.default_rng([config.seed, k])
            for piece in planes.wall_pieces(layout, config.planes, rng)[1]:
                first, last = piece.columns
                width = len(layout.boundary)
                columns = (first + np.arange((last - first) % width + 1)) % width
                rejected.append((piece.reason, layout.boundary[columns]))
        kept = tuple(wall.ends for wall in room.walls)
        return replace(explained, kept=kept, rejected=tuple(rejected))
    views = [state.cameras[view.index].correction.apply(view) for view in room.views]
    evidence = fuse(sights(views), config.fusion)
    known = evidence.weight > 0
    mean = np.divide(evidence.total, evidence.weight, out=np.full(known.shape, np.nan), where=known)
    boundary = np.concatenate([view.boundary for view in views])
    return replace(
        explained,
        distance=Raster(
            config.fusion.cell_ch * np.array(evidence.first_cell, dtype=float),
            config.fusion.cell_ch,
            mean,
        ),
        columns=boundary[np.isfinite(boundary[:, 0])],
    )
