"""The floor plan that a state amounts to."""

from __future__ import annotations

import numpy as np

from panoplan import __version__
from panoplan.config import Config, as_dict
from panoplan.estimator.state import RoomState, State
from panoplan.estimator.step import room_id
from panoplan.geometry.angles import line_angle
from panoplan.geometry.polygons import counter_clockwise
from panoplan.stages import orientation
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import FloorPlan, PlanPose, Room, ScaleEstimate, Unit, Wall


def assemble(state: State, config: Config) -> FloorPlan:
    """The plan so far.

    Rooms that the camera has not left yet have no polygon, and say so.

    Args:
        state: what is known.
        config: settings.

    Returns:
        The plan: (x, z) of the trajectory's world times the scale, in metres where the camera
        height or the trajectory's unit is known, else in camera heights.
    """
    scale = state.scale or ScaleEstimate(
        None, "unknown", converged=False, keyframes_used=len(state.waiting)
    )
    ch_per_su = scale.ch_per_su or 0.0
    # Metres a unit of length of the method: the first camera's height.
    length = 1.0
    unit: Unit = "ch"
    if state.walk.trajectory_unit == "m" and ch_per_su:
        length, unit = 1.0 / ch_per_su, "m"
    elif state.walk.camera_height_m is not None:
        length, unit = state.walk.camera_height_m / state.median_height, "m"
    frame = state.frame
    world_from_walk = np.eye(2) if frame is None else frame.walk_from_world.T
    origin = np.zeros(2) if frame is None else ch_per_su * frame.origin_su[[0, 2]]

    def to_plan(points: FloatArray) -> FloatArray:
        return np.asarray(length * (points @ world_from_walk.T + origin))

    rooms, walls = [], 0
    for room in state.rooms:
        made = _room(room, state, config, to_plan(_canonical(room)), walls, world_from_walk)
        walls += len(made.walls)
        rooms.append(made)
    trajectory = tuple(
        PlanPose(
            camera.keyframe,
            to_plan(ch_per_su * camera.position_su),
            camera.heading,
            None if camera.room is None else room_id(camera.room),
        )
        for camera in state.cameras
    )
    return FloorPlan(
        unit=unit,
        level_rotation=np.eye(3),
        scale=scale,
        camera_height_m=length * state.median_height if unit == "m" else None,
        rooms=tuple(rooms),
        trajectory=trajectory,
        skipped=state.skipped,
        settings=as_dict(config),
        version=__version__,
    )


def _canonical(room: RoomState) -> FloatArray:
    """The polygon from its first corner in the walk frame, so that wall numbers are stable."""
    if room.shape is None or room.shape.polygon is None:
        return np.empty((0, 2))
    polygon = room.shape.polygon
    first = int(np.lexsort((polygon[:, 1], polygon[:, 0]))[0])
    return np.roll(polygon, -first, axis=0)


def _room(
    room: RoomState,
    state: State,
    config: Config,
    polygon: FloatArray,
    walls_before: int,
    world_from_walk: FloatArray,
) -> Room:
    directions, flagged = orientation.accepted(room.orientations, config.orientation)
    angle = float(np.arctan2(world_from_walk[1, 0], world_from_walk[0, 0]))
    failure = None
    if room.shape is None:
        failure = "the camera has not left it yet"
    elif room.shape.polygon is None:
        failure = room.shape.failure
    ring = counter_clockwise(polygon) if len(polygon) else polygon
    walls = tuple(
        Wall(f"wall_{walls_before + k + 1:02d}", ring[k], ring[(k + 1) % len(ring)])
        for k in range(len(ring))
    )
    return Room(
        id=room_id(room.number),
        name=f"Room {room.number}",
        polygon=ring if len(ring) else None,
        failure=failure,
        keyframes=tuple(c.keyframe for c in state.cameras if c.room == room.number),
        walls=walls,
        orientations=tuple(float(line_angle(o.direction + angle)) for o in directions),
        flags=("orientation_below_gate",) if flagged else (),
    )
