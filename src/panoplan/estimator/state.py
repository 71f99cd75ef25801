"""The estimator's state: a value that can be saved, resumed and replayed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from panoplan.types.arrays import FloatArray
from panoplan.types.plan import ScaleEstimate, Skipped
from panoplan.types.room import Orientation, RoomDensity, RoomShape, WallPiece
from panoplan.types.view import CastLayout, RegisteredLayout


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
    """

    trajectory_unit: Literal["unknown", "m"] = "unknown"
    camera_height_m: float | None = None
    expected_keyframes: int | None = None


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
    """A keyframe of the walk: position (2,) in trajectory units, heading in the world, room."""

    keyframe: str
    position_su: FloatArray
    heading: float
    room: int | None


@dataclass(frozen=True, eq=False)
class RoomState:
    """One room while the camera walks.

    Attributes:
        number: counts up from 1 by the first keyframe.
        density: evidence for each cell.
        walls: accepted pieces.
        orientations: wall directions.
        views: registered layouts, in the order of the walk; none where iSPA makes the shapes.
        shape: as last computed, or None.
        stale: whether evidence came since then.
        away: keyframes in a row assigned elsewhere; −1 once the room has been left.
    """

    number: int
    density: RoomDensity
    walls: tuple[WallPiece, ...]
    orientations: tuple[Orientation, ...]
    views: tuple[RegisteredLayout, ...] = ()
    shape: RoomShape | None = None
    stale: bool = True
    away: int = 0


@dataclass(frozen=True, eq=False)
class State:
    """All that the estimator knows.

    Attributes:
        walk: what was known before.
        seen: number of keyframes fed.
        frame: where the walk frame lies; None before the first keyframe.
        waiting: layouts that wait for the scale.
        estimates: scales of the warm-up so far, for the test whether they have settled.
        next_estimate: number of waiting layouts at which the next estimate is due.
        scale: frozen scale; None while keyframes wait.
        median_height: of the warm-up's cameras, in heights of the first.
        rooms: by number.
        current: index into `rooms` of the room last assigned.
        cameras: every keyframe fed, in order.
        skipped: what was left out.
    """

    walk: Walk
    seen: int = 0
    frame: WalkFrame | None = None
    waiting: tuple[CastLayout, ...] = ()
    estimates: tuple[float, ...] = ()
    next_estimate: int = 0
    scale: ScaleEstimate | None = None
    median_height: float = 1.0
    rooms: tuple[RoomState, ...] = ()
    current: int | None = None
    cameras: tuple[PlacedCamera, ...] = ()
    skipped: tuple[Skipped, ...] = ()
