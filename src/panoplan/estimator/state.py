"""The estimator's state: a value that can be saved, resumed and replayed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from panoplan.stages.plan.apertures import WallAperture
from panoplan.stages.plan.partition import Facing
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import ScaleEstimate, Skipped
from panoplan.types.room import Orientation, RoomDensity, RoomShape, WallPiece, WallStretch
from panoplan.types.view import CastLayout, Correction, RegisteredLayout


def room_id(number: int) -> str:
    """Id of the room with this number."""
    return f"room_{number:02d}"


@dataclass(frozen=True)
class Walk:
    """What is known of a walk before it begins.

    Attributes:
        trajectory_unit: "m" where the trajectory is metric, else "unknown".
        camera_height_m: of the cameras above the floor in metres, or None; where they bob, of the
            median one of the warm-up.
        expected_keyframes: length of the walk, needed where the warm-up is a fraction of it.
        rooms: a number for each keyframe, the same for those of one room, where that is known; only
            a method that tells rooms apart by all their views heeds it.
    """

    trajectory_unit: Literal["unknown", "m"] = "unknown"
    camera_height_m: float | None = None
    expected_keyframes: int | None = None
    rooms: tuple[int, ...] | None = None


@dataclass(frozen=True, eq=False)
class WalkFrame:
    """Where the walk frame lies in the trajectory's world.

    Attributes:
        origin_su: (3,) camera of the first keyframe.
        walk_from_world: (2, 2) turns (x, z) of the world into the walk frame.
    """

    origin_su: FloatArray
    walk_from_world: FloatArray


@dataclass(frozen=True, eq=False)
class PlacedCamera:
    """A keyframe of the walk.

    Attributes:
        keyframe: id.
        position_su: (2,) walk frame, trajectory units.
        heading: in the world.
        room: number of its room, or None.
        ceiling: its height above the floor in camera heights, NaN where unknown.
        way_su: way gone until here, trajectory units.
        correction: of what the odometry says, by bundle adjustment.
        covariance: (3, 3) of x, y and turn after it, camera heights and rad, for one camera a
            room; else None.
    """

    keyframe: str
    position_su: FloatArray
    heading: float
    room: int | None
    ceiling: float = math.nan
    way_su: float = 0.0
    correction: Correction = field(default_factory=Correction)
    covariance: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class RoomState:
    """One room while the camera walks.

    Attributes:
        number: counts up from 1 by the first keyframe.
        density: evidence for each cell.
        walls: accepted pieces.
        orientations: wall directions.
        views: layouts registered by the odometry, in the order of the walk; none where iSPA makes
            the shapes.
        level: storey that it is on.
        shape: as last computed, or None.
        stretches: of its walls where its views show something.
        stale: whether evidence came since then.
        away: keyframes in a row assigned elsewhere; −1 once the room has been left.
    """

    number: int
    density: RoomDensity
    walls: tuple[WallPiece, ...]
    orientations: tuple[Orientation, ...]
    views: tuple[RegisteredLayout, ...] = ()
    level: int = 0
    shape: RoomShape | None = None
    stretches: tuple[WallStretch, ...] = ()
    stale: bool = True
    away: int = 0


@dataclass(frozen=True, eq=False)
class Composition:
    """The rooms of one level as one plan.

    Attributes:
        numbers: of its rooms.
        shapes: their outlines, disjoint, in the same order.
        facings: walls that they share, by place in that order.
        apertures: doors, openings and windows, by place in that order.
    """

    numbers: tuple[int, ...]
    shapes: tuple[RoomShape, ...]
    facings: tuple[Facing, ...]
    apertures: tuple[WallAperture, ...]


@dataclass(frozen=True, eq=False)
class State:
    """All that the estimator knows.

    Attributes:
        walk: what was known before.
        seen: number of keyframes fed.
        finished: number of them when the walk was last ended.
        frame: where the walk frame lies; None before the first keyframe.
        waiting: layouts that wait for the scale.
        estimates: scales of the warm-up so far, for the test whether they have settled.
        next_estimate: number of waiting layouts at which the next estimate is due.
        scale: frozen scale; None while keyframes wait.
        levels: how much higher each storey's floor is than that of the first, trajectory units.
        level: storey that the camera is on.
        cruise_su: how much higher than at the level's start the camera lately was.
        climbing: layouts that wait until their level is known.
        stretch: factor on the scale by bundle adjustment.
        median_height: of the warm-up's cameras, in heights of the first.
        rooms: by number.
        current: index into `rooms` of the room last assigned.
        compositions: the plan of each level as last settled, None where it is to be made anew;
            empty where iSPA makes the shapes.
        cameras: every keyframe fed, in order.
        skipped: what was left out.
    """

    walk: Walk
    seen: int = 0
    finished: int = 0
    frame: WalkFrame | None = None
    waiting: tuple[CastLayout, ...] = ()
    estimates: tuple[float, ...] = ()
    next_estimate: int = 0
    scale: ScaleEstimate | None = None
    levels: tuple[float, ...] = (0.0,)
    level: int = 0
    cruise_su: float = 0.0
    climbing: tuple[CastLayout, ...] = ()
    stretch: float = 1.0
    median_height: float = 1.0
    rooms: tuple[RoomState, ...] = ()
    current: int | None = None
    compositions: tuple[Composition, ...] | None = ()
    cameras: tuple[PlacedCamera, ...] = ()
    skipped: tuple[Skipped, ...] = ()

    @property
    def ch_per_su(self) -> float:
        """Camera heights a trajectory unit, as keyframes are placed; 0 while it is not known."""
        return (None if self.scale is None else self.scale.ch_per_su) or 0.0

    @property
    def composed(self) -> dict[int, RoomShape]:
        """The rooms' outlines as part of one plan, by room number."""
        return {
            number: shape
            for level in self.compositions or ()
            for number, shape in zip(level.numbers, level.shapes, strict=True)
        }
