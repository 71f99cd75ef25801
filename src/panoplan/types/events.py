"""What the estimator tells while the camera walks."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.types.arrays import FloatArray
from panoplan.types.plan import ScaleEstimate


@dataclass(frozen=True)
class KeyframeWaiting:
    """A keyframe is kept until the scale or its level is known; `waiting` of them are."""

    keyframe: str
    waiting: int


@dataclass(frozen=True, eq=False)
class ScaleFrozen:
    """The scale is known; waiting keyframes are replayed."""

    scale: ScaleEstimate


@dataclass(frozen=True)
class KeyframeSkipped:
    """A keyframe takes no part in the plan, and why."""

    keyframe: str
    reason: str


@dataclass(frozen=True)
class RoomOpened:
    """A keyframe is in a room not seen before."""

    keyframe: str
    room: str


@dataclass(frozen=True)
class LevelReached:
    """The camera came to a storey: 0 is that of the first keyframe, others count by arrival."""

    keyframe: str
    level: int


@dataclass(frozen=True)
class KeyframePlaced:
    """A keyframe was assigned to a room; `walls` pieces were accepted, `rejected` were not."""

    keyframe: str
    room: str
    walls: int
    rejected: int


@dataclass(frozen=True)
class RoomsJoined:
    """Two rooms proved to be one; `gone` lives on as `kept`."""

    kept: str
    gone: str


@dataclass(frozen=True)
class RoomsRegrouped:
    """Views proved to be of other rooms than first thought.

    Attributes:
        moved: how many keyframes changed their room.
        rooms: ids of the rooms that the keyframes looked at are in now.
        gone: ids of rooms that no keyframe is in any more.
    """

    moved: int
    rooms: tuple[str, ...]
    gone: tuple[str, ...]


@dataclass(frozen=True)
class CamerasMisplaced:
    """Cameras of a tour do not stand where they were said to.

    Attributes:
        keyframes: their ids.
        shift: (x, y) by which they were moved, walk frame, camera heights; None where they were
            left out.
    """

    keyframes: tuple[str, ...]
    shift: tuple[float, float] | None


@dataclass(frozen=True, eq=False)
class RoomShaped:
    """A room's shape was found (or not), when the camera left it or at the end.

    Attributes:
        room: id.
        polygon: (N, 2) walk frame, camera heights, or None.
        failure: why there is none.
    """

    room: str
    polygon: FloatArray | None
    failure: str | None


Event = (
    KeyframeWaiting
    | ScaleFrozen
    | KeyframeSkipped
    | LevelReached
    | RoomOpened
    | KeyframePlaced
    | RoomsJoined
    | RoomsRegrouped
    | CamerasMisplaced
    | RoomShaped
)
