"""Whole scenes: what the method is given, and apart from it what is true."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.geometry.rigid import heading_of
from panoplan.simulate.buildings import Building, Passage, PassageKind
from panoplan.simulate.flats import make_flat
from panoplan.simulate.leaks import draw_leaks, partly_closed
from panoplan.simulate.noise import GRADES, NoiseModel
from panoplan.simulate.noisy_layouts import noisy_layout
from panoplan.simulate.odometry import drifted, in_units, toured, wandered
from panoplan.simulate.views import View, ViewCaster, tilted
from panoplan.simulate.walks import Walk, about_y, stills, walk
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TrueLevels, TruePlan, TrueRoom

Grade = Literal["exact", "mild", "hard", "measured"]
_DOORWAY_M = 0.25
_BELOW_CEILING_M = 0.2


@dataclass(frozen=True, eq=False)
class SimulatedScene:
    """A simulated recording and its truth.

    Attributes:
        name: of the scene.
        keyframes: in the order of the walk: odometry poses in units of `metres_per_su` metres,
            which agree with the true ones at the first keyframe, and noisy layouts.
        truth: the true plan and the true poses, metres, in one frame.
        camera_height_m: nominal height of the camera above the floor.
        metres_per_su: metres a trajectory unit.
        noise: the grade it was made with.
        building: what was walked through.
        keyframe_rooms: index of the room each keyframe's view is of.
        views: what a level camera in each keyframe's place and heading truly sees.
        frames: the true pose of every frame of the video, labelled with its number from 1; None
            where there is no video.
    """

    name: str
    keyframes: tuple[Keyframe, ...]
    truth: GroundTruth
    camera_height_m: float
    metres_per_su: float
    noise: NoiseModel
    building: Building
    keyframe_rooms: tuple[int, ...]
    views: tuple[View, ...]
    frames: Trajectory | None = None

    @property
    def ch_per_su(self) -> float:
        """Heights of the first camera, bob included, a unit: what scale recovery should find."""
        assert self.truth.trajectory is not None
        first_m = self.camera_height_m - float(self.truth.trajectory.translations[0, 1])
        return self.metres_per_su / first_m

    @property
    def true_layouts(self) -> Iterator[Layout]:
        """The true layout of each keyframe: its room, closed at doors and openings."""
        true = self.truth.trajectory
        assert true is not None
        for view, rotation in zip(self.views, true.rotations, strict=True):
            heading = heading_of(rotation)
            yield _as_held(view.closed_layout, _level_from_cam(rotation, heading))

    @property
    def odometry(self) -> Trajectory:
        """The keyframes' poses."""
        return Trajectory(
            tuple(k.id for k in self.keyframes),
            np.array([k.pose.rotation for k in self.keyframes]),
            np.array([k.pose.translation for k in self.keyframes]),
        )


def simulate_flat(
    seed: int,
    grade: Grade | NoiseModel = "mild",
    *,
    stills: bool = False,
    rooms: int | None = None,
    skewed: bool | None = None,
    opening_share: float = 0.1,
    step_m: float = 0.4,
    keyframes_per_room: int | None = None,
    metres_per_su: float | None = None,
    tilt_deg: float = 0.0,
) -> SimulatedScene:
    """A walk through a made-up flat.

    Args:
        seed: the same seed gives the same flat, the same way through it and the same noise; the
            flat and the way do not depend on the grade.
        grade: "exact", "mild", "hard", "measured" or a noise model.
        stills: sparse photos instead of a walk.
        rooms: how many, 5-9; drawn where None.
        skewed: whether some walls are not at right angles; drawn where None.
        opening_share: probability that a passage is an opening.
        step_m: mean way between keyframes, metres.
        keyframes_per_room: at least about so many a room; by the room's size where None.
        metres_per_su: metres a trajectory unit; log-uniform over 0.1-10 where None.
        tilt_deg: standard deviation of the camera's pitch and roll.

    Returns:
        The scene.
    """
    return simulate(
        make_flat(seed, rooms=rooms, skewed=skewed, opening_share=opening_share),
        seed,
        grade,
        as_stills=stills,
        step_m=step_m,
        keyframes_per_room=keyframes_per_room,
        metres_per_su=metres_per_su,
        tilt_deg=tilt_deg,
    )


def simulate(
    building: Building,
    seed: int,
    grade: Grade | NoiseModel = "mild",
    *,
    as_stills: bool = False,
    step_m: float = 0.4,
    keyframes_per_room: int | None = None,
    metres_per_su: float | None = None,
    tilt_deg: float = 0.0,
    width: int = 1024,
) -> SimulatedScene:
    """A walk through a building.

    Args:
        building: connected.
        seed: of the way, the noise and the unit.
        grade: "exact", "mild", "hard", "measured" or a noise model.
        as_stills: sparse photos instead of a walk.
        step_m: mean way between keyframes, metres.
        keyframes_per_room: at least about so many a room; by the room's size where None.
        metres_per_su: metres a trajectory unit; log-uniform over 0.1-10 where None.
        tilt_deg: standard deviation of the camera's pitch and roll.
        width: number of columns of the layouts.

    Returns:
        The scene.

    Raises:
        InputError: an unknown grade, a unit that is not positive, or a building that cannot be
            walked.
    """
    model = noise_model(grade)
    way_rng, unit_rng, noise_rng, drift_rng = (
        np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(4)
    )
    unit = float(10 ** unit_rng.uniform(-1, 1)) if metres_per_su is None else metres_per_su
    if not (np.isfinite(unit) and unit > 0):
        raise InputError("metres_per_su", str(unit), "a positive number")
    if as_stills:
        way = stills(building, way_rng)
    else:
        way = walk(
            building,
            way_rng,
            step_m=step_m,
            keyframes_per_room=keyframes_per_room,
            tilt_deg=tilt_deg,
        )
    return recorded(building, way, model, unit, noise_rng, drift_rng, width=width)


def recorded(
    building: Building,
    way: Walk,
    model: NoiseModel,
    metres_per_su: float,
    noise_rng: np.random.Generator,
    drift_rng: np.random.Generator,
    *,
    width: int = 1024,
) -> SimulatedScene:
    """The scene that a given walk records.

    Args:
        building: where it goes.
        way: true poses.
        model: the grade.
        metres_per_su: metres a trajectory unit.
        noise_rng: of the layouts' errors.
        drift_rng: of the odometry's.
        width: number of columns of the layouts.

    Returns:
        The scene.
    """
    kind = "walk" if len(way.path) != len(way.trajectory) else "stills"
    kept = np.arange(len(way.trajectory))
    if kind == "walk" and model.odometry is not None:
        odometry, there = wandered(way.trajectory, model.odometry, drift_rng)
        kept = np.flatnonzero(there)
    elif kind == "stills" and model.tour is not None:
        odometry = toured(way.trajectory, way.rooms, model.tour, drift_rng)
    else:
        odometry = drifted(way.trajectory, model.drift_m, model.drift_deg, drift_rng)
    odometry = in_units(odometry, metres_per_su)
    caster = ViewCaster(building)
    rngs = noise_rng.spawn(len(way.trajectory))
    made = [noisy_view(caster, way, k, model, rngs[k], width) for k in kept.tolist()]
    keyframes = tuple(
        Keyframe(way.trajectory.labels[k], odometry[k], layout)
        for k, (_, layout) in zip(kept.tolist(), made, strict=True)
    )
    return SimulatedScene(
        name=f"{building.name}_{kind}_{model.name}",
        keyframes=keyframes,
        truth=GroundTruth(true_plan(building, way.camera_height_m), _some(way.trajectory, kept)),
        camera_height_m=way.camera_height_m,
        metres_per_su=metres_per_su,
        noise=model,
        building=building,
        keyframe_rooms=tuple(int(k) for k in way.rooms[kept]),
        views=tuple(view for view, _ in made),
        frames=way.frames,
    )


def true_plan(building: Building, camera_height_m: float | None = None) -> TruePlan:
    """The true plan of a building.

    Rooms end at openings, as the layouts see them: `rooms` and `rooms_partial` are the same.
    Doors and openings are listed with both faces of their wall, blind ones with their one face.

    Args:
        building: in the plan frame.
        camera_height_m: nominal, or None.

    Returns:
        The plan.
    """
    rooms = tuple(
        TrueRoom(f"room_{k + 1:02d}", room.label, room.polygon, room.holes, room.level)
        for k, room in enumerate(building.rooms)
    )
    longest = max(
        (edge for r in building.rooms for edge in np.roll(r.polygon, -1, axis=0) - r.polygon),
        key=lambda edge: float(np.hypot(*edge)),
    )
    return TruePlan(
        rooms=rooms,
        rooms_partial=rooms,
        doors=_faces(building, "door"),
        openings=_faces(building, "opening"),
        windows=tuple(w.segment for w in building.windows),
        axis=longest / np.hypot(*longest),
        camera_height_m=camera_height_m,
        levels=_true_levels(building) if building.stairs else None,
    )


def _faces(building: Building, kind: PassageKind) -> tuple[FloatArray, ...]:
    """Both faces of passages and the one of blind doors."""
    return (
        *(face for p in building.passages if p.kind == kind for face in p.faces),
        *(d.segment for d in building.blind_doors if d.kind == kind),
    )


def _true_levels(building: Building) -> TrueLevels:
    def of(kind: PassageKind) -> tuple[int, ...]:
        rooms = [p.rooms[0] for p in building.passages if p.kind == kind for _ in p.faces]
        rooms += [d.room for d in building.blind_doors if d.kind == kind]
        return tuple(building.rooms[k].level for k in rooms)

    windows = tuple(building.rooms[w.room].level for w in building.windows)
    return TrueLevels(building.floors_m, of("door"), of("opening"), windows)


def noise_model(grade: Grade | NoiseModel) -> NoiseModel:
    """The noise model that a grade means.

    Raises:
        InputError: an unknown grade.
    """
    if isinstance(grade, NoiseModel):
        return grade
    if grade not in GRADES:
        raise InputError("grade", repr(grade), " | ".join(GRADES))
    return GRADES[grade]


def noisy_view(
    caster: ViewCaster,
    way: Walk,
    index: int,
    model: NoiseModel,
    rng: np.random.Generator,
    width: int = 1024,
) -> tuple[View, Layout]:
    """What one camera of a walk truly sees, and its layout.

    Args:
        caster: of the building.
        way: true poses.
        index: of the camera.
        model: the grade.
        rng: of the errors.
        width: number of columns.

    Returns:
        The exact view of a level camera at its place, leaks included, and the layout with its
        errors and the camera's tilt.
    """
    building, room = caster.building, int(way.rooms[index])
    pose = way.trajectory[index]
    eye_m = way.camera_height_m - float(pose.translation[1]) - building.floor_m(room)
    position, heading = pose.translation[[0, 2]], heading_of(pose.rotation)
    behind = [k for k, _ in building.neighbours(room)]
    near = [k for k in behind if _before(building.passages[k], position)]
    # The leaks of a camera that stands in a passage begin there. The coarser grades do without.
    begin = {
        k: _depth_within(building.passages[k], room, position)
        for k in (near if model.doorway_leak else [])
    }
    leaks = draw_leaks(
        [k for k in behind if building.passages[k].kind == "door"],
        [k for k in behind if building.passages[k].kind == "opening"],
        model,
        rng,
        near,
    )
    view = caster.view(
        position,
        heading,
        # On stairs it may be above the lower room's ceiling.
        min(eye_m, building.rooms[room].ceiling_height_m - _BELOW_CEILING_M),
        width=width,
        leaks={k: leak.depth_m + begin.get(k, 0.0) for k, leak in leaks.items()},
        room=room,
    )
    view = partly_closed(view, leaks, rng)
    layout = noisy_layout(view, model, rng)
    return view, _as_held(layout, _level_from_cam(pose.rotation, heading))


def _as_held(layout: Layout, level_from_cam: FloatArray) -> Layout:
    """A level camera's layout as the camera sees it that is held a little aslant."""
    if np.abs(level_from_cam - np.eye(3)).max() < 1e-12:
        return layout
    return tilted(layout, level_from_cam)


def _before(passage: Passage, position: FloatArray) -> bool:
    """Whether a camera stands in a passage or closer to it than `_DOORWAY_M`."""
    away = shapely.distance(shapely.Polygon(passage.area), shapely.Point(position))
    return bool(away < _DOORWAY_M)


def _depth_within(passage: Passage, room: int, position: FloatArray) -> float:
    """How far beyond its room's face of a passage a camera stands, metres; 0 before it."""
    side = passage.side(room)
    beyond = passage.outward_from(room) @ (position - passage.faces[side, 0])
    return max(float(beyond), 0.0)


def _some(trajectory: Trajectory, kept: IntArray) -> Trajectory:
    return Trajectory(
        tuple(trajectory.labels[k] for k in kept),
        trajectory.rotations[kept],
        trajectory.translations[kept],
    )


def _level_from_cam(rotation: FloatArray, heading: float) -> FloatArray:
    return np.asarray(about_y(np.array([-heading]))[0] @ rotation)
