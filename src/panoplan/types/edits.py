"""What people know better than the estimate: kept apart from it, and applied to it again."""

from __future__ import annotations

from dataclasses import dataclass, field

from panoplan.types.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class RoomMark:
    """A room as it lay in the plan when it was edited.

    Attributes:
        id: what it was called then.
        level: its storey.
        polygon: (N, 2) its outline, plan units of the edits.
    """

    id: str
    level: int
    polygon: FloatArray


@dataclass(frozen=True, eq=False)
class WallMark:
    """A wall, or a door across, as it lay in the plan when it was edited.

    Attributes:
        id: what it was called then.
        level: its storey.
        a: (2,) start, plan units of the edits.
        b: (2,) end.
    """

    id: str
    level: int
    a: FloatArray
    b: FloatArray


@dataclass(frozen=True, eq=False)
class RoomName:
    """A room's name."""

    room: RoomMark
    name: str


@dataclass(frozen=True, eq=False)
class KnownLength:
    """The true length of a wall, corner to corner, in metres."""

    wall: WallMark
    metres: float


@dataclass(frozen=True, eq=False)
class Nudge:
    """How many metres a wall lies further out of its room than was estimated."""

    wall: WallMark
    metres: float


@dataclass(frozen=True, eq=False)
class KnownDoorHeight:
    """The true height of a door, and where its upper edge is seen.

    Attributes:
        door: the door.
        metres: from the floor to its upper edge.
        keyframe: id of the camera that sees it.
        elevation: rad above the horizon at which its upper edge is seen over its middle.
        sigma: standard deviation of the elevation, rad.
    """

    door: WallMark
    metres: float
    keyframe: str
    elevation: float
    sigma: float


@dataclass(frozen=True, eq=False)
class Edits:
    """All edits of a plan.

    Attributes:
        units_per_su: plan units, in which the marks are, a trajectory unit; None where not known.
        names: at most one a room.
        lengths: at most one a wall.
        nudges: at most one a wall.
        door_heights: at most one a door.
    """

    units_per_su: float | None = None
    names: tuple[RoomName, ...] = field(default=())
    lengths: tuple[KnownLength, ...] = field(default=())
    nudges: tuple[Nudge, ...] = field(default=())
    door_heights: tuple[KnownDoorHeight, ...] = field(default=())
