"""The floor plan that a state amounts to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from panoplan import __version__
from panoplan.config import Config, as_dict
from panoplan.estimator.state import PlacedCamera, RoomState, State, room_id
from panoplan.geometry.angles import line_angle, wrapped
from panoplan.geometry.hits import edge_directions
from panoplan.geometry.polygons import signed_area
from panoplan.stages import orientation
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import (
    Aperture,
    ApertureKind,
    FloorPlan,
    MetricScale,
    PlanPose,
    Room,
    ScaleEstimate,
    SharedWall,
    Unit,
    Wall,
)
from panoplan.types.room import RoomShape


@dataclass(frozen=True, eq=False)
class PlanFrame:
    """Where the plan lies against the walk frame.

    Attributes:
        unit: of the plan.
        length: plan units a camera height.
        world_from_walk: (2, 2) turns vectors of the walk frame.
        origin: (2,) of the walk frame in the plan, camera heights.
    """

    unit: Unit
    length: float
    world_from_walk: FloatArray
    origin: FloatArray

    def to_plan(self, points: FloatArray) -> FloatArray:
        """(N, 2) points of the walk frame, camera heights, in the plan."""
        return np.asarray(self.length * (points @ self.world_from_walk.T + self.origin))


def plan_frame(state: State) -> PlanFrame:
    """The plan's frame: metric where the camera height or the trajectory's unit is known.

    Args:
        state: what is known.
    """
    ch_per_su = state.ch_per_su
    # Metres a unit of length of the method: the first camera's height.
    length = 1.0
    unit: Unit = "ch"
    if state.walk.trajectory_unit == "m" and ch_per_su:
        length, unit = 1.0 / ch_per_su, "m"
    elif state.walk.camera_height_m is not None:
        length, unit = state.walk.camera_height_m / state.median_height, "m"
    if state.frame is None:
        return PlanFrame(unit, length, np.eye(2), np.zeros(2))
    origin = state.stretch * ch_per_su * state.frame.origin_su[[0, 2]]
    return PlanFrame(unit, length, state.frame.walk_from_world.T, origin)


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
    ch_per_su = state.ch_per_su
    if state.stretch != 1.0 and scale.ch_per_su is not None:
        scale = replace(scale, ch_per_su=state.stretch * scale.ch_per_su)
    frame = plan_frame(state)
    unit, length, to_plan = frame.unit, frame.length, frame.to_plan
    members: dict[int, list[PlacedCamera]] = {room.number: [] for room in state.rooms}
    for camera in state.cameras:
        if camera.room is not None:
            members[camera.room].append(camera)
    composed = state.composed
    rooms: dict[int, Room] = {}
    walls = 0
    for room in state.rooms:
        shaped = replace(room, shape=composed.get(room.number, room.shape))
        made = _room(
            shaped,
            members[room.number],
            config,
            to_plan,
            length,
            ch_per_su,
            scale.sigma or 0.0,
            walls,
        )
        walls += len(made.walls)
        rooms[room.number] = made
    shared, found = _joints(state, rooms, composed, to_plan, length)
    positions = np.array([camera.position_su for camera in state.cameras]).reshape(-1, 2)
    shifts = np.array([camera.correction.shift for camera in state.cameras]).reshape(-1, 2)
    # The heading runs clockwise, the correction counter-clockwise.
    headings = wrapped(np.array([c.heading - c.correction.turn for c in state.cameras]))
    trajectory = tuple(
        PlanPose(
            camera.keyframe, place, heading, None if camera.room is None else room_id(camera.room)
        )
        for camera, place, heading in zip(
            state.cameras,
            to_plan(ch_per_su * positions + shifts),
            headings.tolist(),
            strict=True,
        )
    )
    return FloorPlan(
        unit=unit,
        metric=_metric(state, scale.sigma),
        level_rotation=np.eye(3),
        scale=scale,
        camera_height_m=length * state.median_height if unit == "m" else None,
        rooms=tuple(rooms.values()),
        trajectory=trajectory,
        skipped=state.skipped,
        shared_walls=shared,
        doors=found["door"],
        openings=found["opening"],
        windows=found["window"],
        settings=as_dict(config),
        version=__version__,
    )


def _metric(state: State, scale_sigma: float | None) -> MetricScale | None:
    """Where the metres come from, as `plan_frame` has it, and how sure they are."""
    if state.walk.trajectory_unit == "m" and state.ch_per_su:
        own = _COMMON_SIGMA if scale_sigma is None else scale_sigma
        return MetricScale("trajectory", own)
    height = state.walk.camera_height_m
    if height is None:
        return None
    return MetricScale("camera height", float(np.hypot(_HEIGHT_SIGMA_M / height, _COMMON_SIGMA)))


_HEIGHT_SIGMA_M = 0.01
"""How well people know the height of their camera."""

_COMMON_SIGMA = 0.006
"""Relative error of size that the layouts of a whole walk have in common: on simulated flats."""


def _joints(
    state: State,
    rooms: dict[int, Room],
    composed: dict[int, RoomShape],
    to_plan: Callable[[FloatArray], FloatArray],
    length: float,
) -> tuple[tuple[SharedWall, ...], dict[ApertureKind, tuple[Aperture, ...]]]:
    """Shared walls, and doors, openings and windows; without those of rooms that are gone."""

    def wall_id(number: int, wall: int) -> str:
        polygon = composed[number].polygon
        assert polygon is not None
        own = rooms[number].walls
        return own[(wall - _first_corner(polygon)) % len(own)].id

    shared: list[SharedWall] = []
    found: dict[ApertureKind, list[Aperture]] = {"door": [], "opening": [], "window": []}
    for level in state.compositions or ():
        numbers = level.numbers
        for face in level.facings:
            of = [numbers[k] for k in face.rooms]
            if not all(number in rooms for number in of):
                continue
            one, other = (wall_id(n, w) for n, w in zip(of, face.walls, strict=True))
            shared.append(
                SharedWall(
                    f"shared_{len(shared) + 1:02d}",
                    (one, other),
                    length * face.thickness,
                    face.measured,
                    face.solid,
                )
            )
        for item in level.apertures:
            there = [(numbers[k], wall) for k, wall in item.walls]
            if not all(number in rooms for number, _ in there):
                continue
            own = found[item.kind]
            own.append(
                Aperture(
                    f"{item.kind}_{len(own) + 1:02d}",
                    to_plan(item.segment),
                    tuple(rooms[number].id for number, _ in there),
                    tuple(wall_id(number, wall) for number, wall in there),
                    item.sources,
                )
            )
    return tuple(shared), {kind: tuple(items) for kind, items in found.items()}


def _first_corner(polygon: FloatArray) -> int:
    """The corner to begin at, by its place in the walk frame, so that wall numbers are stable."""
    return int(np.lexsort((polygon[:, 1], polygon[:, 0]))[0])


def _room(
    room: RoomState,
    cameras: Sequence[PlacedCamera],
    config: Config,
    to_plan: Callable[[FloatArray], FloatArray],
    length: float,
    ch_per_su: float,
    scale_sigma: float,
    walls_before: int,
) -> Room:
    shape = room.shape or RoomShape(None, "the camera has not left it yet")
    made = Room(
        id=room_id(room.number),
        name=f"Room {room.number}",
        polygon=None,
        failure=shape.failure,
        keyframes=tuple(camera.keyframe for camera in cameras),
        ceiling_height=_ceiling(cameras, length),
        level=room.level,
    )
    directions, flagged = orientation.accepted(room.orientations, config.orientation)
    if directions:
        turned = to_plan(np.eye(2)) - to_plan(np.zeros((2, 2)))
        angle = float(np.arctan2(turned[0, 1], turned[0, 0]))
        made = replace(
            made,
            orientations=tuple(float(line_angle(o.direction + angle)) for o in directions),
            flags=("orientation_below_gate",) if flagged else (),
        )
    if shape.polygon is None:
        return made
    first = _first_corner(shape.polygon)
    ring = to_plan(np.roll(shape.polygon, -first, axis=0))
    sigmas: list[float | None] = [None] * len(ring)
    length_sigmas = sigmas
    area_sigma = None
    if shape.sigmas is not None:
        placed = _place_sigmas(
            shape.polygon, cameras, ch_per_su, scale_sigma, config.adjust.sigma_factor
        )
        across = np.hypot(shape.sigmas, placed)
        sigmas = _told(length * np.roll(across, -first))
        own = _length_sigmas(shape, across, len(cameras), config)
        length_sigmas = _told(length * np.roll(own, -first))
        area_sigma = length**2 * _area_sigma(shape, across, len(cameras), scale_sigma, config)
    walls = tuple(
        Wall(
            f"wall_{walls_before + k + 1:02d}",
            ring[k],
            ring[(k + 1) % len(ring)],
            sigmas[k],
            length_sigmas[k],
        )
        for k in range(len(ring))
    )
    holes = tuple(to_plan(hole) for hole in shape.holes)
    return replace(made, polygon=ring, walls=walls, holes=holes, area_sigma=area_sigma)


def _told(values: FloatArray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


_WITHIN = 0.4
"""Walls of a room err against one another by this share of what they err by in place, as the way
between those who saw them is a part of the whole way: on simulated flats."""


def _length_sigmas(shape: RoomShape, across: FloatArray, views: int, config: Config) -> FloatArray:
    """(N,) standard deviation of each wall's length in camera heights, NaN where not known.

    Of the walls that it ends at, by themselves and by the ways between their cameras, and of the
    room's own size.

    Args:
        shape: of the room.
        across: (N,) standard deviation of where each wall lies.
        views: how many saw the room.
        config: settings.
    """
    assert shape.polygon is not None
    assert shape.sigmas is not None
    _, length = edge_directions(shape.polygon)
    variance = shape.sigmas**2 + (_WITHIN * across) ** 2
    own = _size_sigma(views, config) * length
    return np.asarray(np.sqrt(np.roll(variance, 1) + np.roll(variance, -1) + own**2))


def _size_sigma(views: int, config: Config) -> float:
    """Relative standard deviation of a room's size, by the factors that its views err by.

    Views from several places tell each other's factor by the odometry between them.
    """
    return config.registration.scale_bias / float(np.sqrt(1 + _TOLD * max(0, views - 1)))


def _area_sigma(
    shape: RoomShape, across: FloatArray, views: int, scale_sigma: float, config: Config
) -> float:
    """Standard deviation of a room's area in square camera heights.

    Of its walls, as those of their lengths; and of its size, which all views err in together by the
    scale, and each by its own factor. Where the room lies does not matter.
    """
    assert shape.polygon is not None
    assert shape.sigmas is not None
    _, length = edge_directions(shape.polygon)
    within = np.hypot(shape.sigmas, _WITHIN * across)
    sigmas = np.where(np.isnan(within), config.partition.unfitted_sigma_ch, within)
    own = _size_sigma(views, config)
    size = 2 * abs(signed_area(shape.polygon)) * np.hypot(scale_sigma, own)
    return float(np.sqrt(((length * sigmas) ** 2).sum() + size**2))


_TOLD = 4.0
"""A further view tells as much of the size as four more of the same place: on simulated flats."""


def _place_sigmas(
    polygon: FloatArray,
    cameras: Sequence[PlacedCamera],
    ch_per_su: float,
    scale_sigma: float,
    factor: float,
) -> FloatArray:
    """(N,) across each wall, of where the room lies: by its cameras and by the scale."""
    along, _ = edge_directions(polygon)
    outward = np.stack([along[:, 1], -along[:, 0]], axis=-1)
    middle = (polygon + np.roll(polygon, -1, axis=0)) / 2
    # The walk frame begins at the first camera, from where an error of scale stretches it.
    variance = (scale_sigma * (middle * outward).sum(axis=1)) ** 2
    known = [camera for camera in cameras if camera.covariance is not None]
    if known:
        camera = known[len(known) // 2]
        assert camera.covariance is not None
        arm = middle - ch_per_su * camera.position_su - camera.correction.shift
        turning = outward[:, 1] * arm[:, 0] - outward[:, 0] * arm[:, 1]
        moves = np.column_stack([outward, turning])
        placed = np.einsum("ni,ij,nj->n", moves, camera.covariance, moves)
        variance = variance + factor**2 * placed
    return np.asarray(np.sqrt(variance))


def _ceiling(cameras: Sequence[PlacedCamera], length: float) -> float | None:
    """The median over the room's views that tell it, in plan units."""
    told = [camera.ceiling for camera in cameras if np.isfinite(camera.ceiling)]
    return length * float(np.median(told)) if told else None
