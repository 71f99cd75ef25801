"""The floor plan.

Plan frame: 2-D, (x, z) of the trajectory's levelled world times the scale. `FloorPlan.unit` says
whether that is metres or camera heights. Polygons are counter-clockwise in (x, z).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from panoplan.types.arrays import FloatArray

Unit = Literal["m", "ch"]
ApertureKind = Literal["door", "opening", "window"]
MetricSource = Literal["camera height", "trajectory", "length", "door height"]
ApertureSource = Literal["assumed width", "border", "leak", "seen", "walked"]
"""What speaks for a door, opening or window: layouts show it; their boundary goes through it; the
camera walked through it; two rooms end without a wall between. Or its width is a guess."""


@dataclass(frozen=True, eq=False)
class ScaleEstimate:
    """Scale of the trajectory relative to the layouts, and how it was found.

    Attributes:
        ch_per_su: camera heights a trajectory unit, s* of Eq. 4; None where it cannot be known.
        method: "entropy", "given" (unit and camera height known) or "unknown".
        sigma: relative standard deviation of `ch_per_su`, None where not known.
        search_range: (low, high) of s that was searched, or None.
        curve: (M, 2) of s and the objective at it, sorted by s.
        at_edge: whether the optimum lies at the edge of the range.
        converged: whether the estimate had settled when it was frozen.
        keyframes_used: how many keyframes took part.
    """

    ch_per_su: float | None
    method: Literal["entropy", "given", "unknown"]
    sigma: float | None = None
    search_range: tuple[float, float] | None = None
    curve: FloatArray | None = None
    at_edge: bool = False
    converged: bool = True
    keyframes_used: int = 0


@dataclass(frozen=True)
class MetricScale:
    """Where the metres of a plan come from.

    Attributes:
        source: what was known in metres.
        sigma: relative standard deviation of all lengths together.
    """

    source: MetricSource
    sigma: float


@dataclass(frozen=True, eq=False)
class Wall:
    """One straight wall of a room, from a to b with the room on its left.

    Attributes:
        id: unique in the plan.
        a: (2,) start, plan frame.
        b: (2,) end, plan frame.
        sigma: standard deviation across the wall in plan units, None where not known.
        length_sigma: standard deviation of its length in plan units, without what all lengths of
            the plan err in common; None where not known.
    """

    id: str
    a: FloatArray
    b: FloatArray
    sigma: float | None = None
    length_sigma: float | None = None


@dataclass(frozen=True, eq=False)
class Room:
    """One room.

    Attributes:
        id: "room_01", ...: numbered by the first keyframe that was assigned to it.
        name: what people call it.
        polygon: (N, 2) open polygon, counter-clockwise, plan frame; None where no shape was found.
        failure: why there is no polygon, else None.
        keyframes: ids of the keyframes assigned to it, in the order of the walk.
        walls: one a polygon edge, in order.
        holes: open polygons, clockwise, of what is not room inside `polygon`.
        area_sigma: standard deviation of the area in square plan units, None where not known.
        ceiling_height: floor to ceiling in plan units, None where not known.
        level: storey, 0 for that of the first keyframe.
        orientations: directions of the walls in [0, π) rad, plan frame, best supported first.
        flags: what is to be known about this room ("orientation_below_gate", ...).
    """

    id: str
    name: str
    polygon: FloatArray | None
    failure: str | None
    keyframes: tuple[str, ...]
    walls: tuple[Wall, ...] = ()
    holes: tuple[FloatArray, ...] = ()
    area_sigma: float | None = None
    ceiling_height: float | None = None
    level: int = 0
    orientations: tuple[float, ...] = ()
    flags: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SharedWall:
    """Two walls of two rooms that are the faces of one.

    Attributes:
        id: unique in the plan.
        walls: ids of the two faces.
        thickness: plan units, over what the two have in common.
        measured: whether both faces were; else the thickness is that of the plan's other walls, or
            a usual one.
        solid: false where the rooms only end here, as at an opening.
    """

    id: str
    walls: tuple[str, str]
    thickness: float
    measured: bool
    solid: bool


@dataclass(frozen=True, eq=False)
class Aperture:
    """A door, opening or window.

    Attributes:
        id: unique in the plan.
        segment: (2, 2) from side to side, plan frame; in the middle of a shared wall, else on the
            face that is known.
        rooms: ids of the rooms that it leads to, one or two.
        walls: ids of their walls that it is in.
        sources: what speaks for it.
    """

    id: str
    segment: FloatArray
    rooms: tuple[str, ...] = ()
    walls: tuple[str, ...] = ()
    sources: tuple[ApertureSource, ...] = ()


@dataclass(frozen=True, eq=False)
class PlanPose:
    """A keyframe's camera in the plan.

    Attributes:
        id: the keyframe's.
        position: (2,) plan frame.
        heading: rad, of the camera's z axis, from the plan's second axis towards its first
            (clockwise seen from above).
        room: id of the room it was assigned to, or None.
    """

    id: str
    position: FloatArray
    heading: float
    room: str | None


@dataclass(frozen=True)
class Skipped:
    """Something that did not become part of the plan.

    Attributes:
        keyframe: id.
        what: "keyframe", "wall", or "pose": the keyframe is in the plan, yet not where it was said
            to be.
        reason: why, in words.
        count: how many times.
    """

    keyframe: str
    what: Literal["keyframe", "wall", "pose"]
    reason: str
    count: int = 1


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """The whole plan.

    Attributes:
        unit: of every length in it: "m" or "ch" (camera heights).
        level_rotation: (3, 3) levelled_world_from_world that was applied to the trajectory.
        scale: how the trajectory was scaled.
        camera_height_m: metres a camera height, None where not known.
        rooms: in the order of their ids.
        trajectory: every keyframe that was placed, in the order of the walk.
        skipped: what was left out and why.
        shared_walls: faces of one wall between two rooms.
        doors: with or without a leaf.
        openings: where a room goes on into the next without a door.
        windows: in outer walls.
        metric: where its metres come from, None for a plan in camera heights.
        settings: the resolved settings as nested plain values.
        version: of panoplan.
    """

    unit: Unit
    level_rotation: FloatArray
    scale: ScaleEstimate
    camera_height_m: float | None
    rooms: tuple[Room, ...]
    trajectory: tuple[PlanPose, ...]
    skipped: tuple[Skipped, ...] = ()
    shared_walls: tuple[SharedWall, ...] = ()
    doors: tuple[Aperture, ...] = ()
    openings: tuple[Aperture, ...] = ()
    windows: tuple[Aperture, ...] = ()
    metric: MetricScale | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    version: str = ""
