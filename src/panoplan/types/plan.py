"""The floor plan.

Plan frame: 2-D, (x, z) of the trajectory's levelled world times the scale. `FloorPlan.unit` says
whether that is metres or camera heights. Polygons are counter-clockwise in (x, z).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from panoplan.types.arrays import FloatArray

Unit = Literal["m", "ch"]


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


@dataclass(frozen=True, eq=False)
class Wall:
    """One straight wall of a room, from a to b with the room on its left.

    Attributes:
        id: unique in the plan.
        a: (2,) start, plan frame.
        b: (2,) end, plan frame.
        sigma: standard deviation across the wall in plan units, None where not known.
    """

    id: str
    a: FloatArray
    b: FloatArray
    sigma: float | None = None


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
    ceiling_height: float | None = None
    level: int = 0
    orientations: tuple[float, ...] = ()
    flags: tuple[str, ...] = ()


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
        what: "keyframe" or "wall".
        reason: why, in words.
        count: how many times.
    """

    keyframe: str
    what: Literal["keyframe", "wall"]
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
        doors: (D, 2, 2) segments.
        openings: (O, 2, 2) segments.
        windows: (W, 2, 2) segments.
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
    doors: tuple[FloatArray, ...] = ()
    openings: tuple[FloatArray, ...] = ()
    windows: tuple[FloatArray, ...] = ()
    settings: dict[str, Any] = field(default_factory=dict)
    version: str = ""
