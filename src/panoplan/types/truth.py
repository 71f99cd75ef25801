"""The true plan of a scene: for metrics and datasets only, never for the method."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.types.arrays import FloatArray
from panoplan.types.pose import Trajectory


@dataclass(frozen=True, eq=False)
class TrueRoom:
    """A room as annotated or simulated.

    Attributes:
        id: unique in the scene.
        label: what it is called, may be empty.
        polygon: (N, 2) open polygon, counter-clockwise, metres, plan frame.
        holes: open polygons inside it that are not room.
        level: its storey, from 0.
    """

    id: str
    label: str
    polygon: FloatArray
    holes: tuple[FloatArray, ...] = ()
    level: int = 0


@dataclass(frozen=True)
class TrueLevels:
    """The storeys of a scene.

    Attributes:
        floors_m: how high each storey's floor lies above that of storey 0, metres.
        doors: storey of each door.
        openings: storey of each opening.
        windows: storey of each window.
    """

    floors_m: tuple[float, ...]
    doors: tuple[int, ...] = ()
    openings: tuple[int, ...] = ()
    windows: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class TruePlan:
    """The true plan of a scene, in metres, plan frame (x, z) of the true trajectory's world.

    Attributes:
        rooms: as the scene calls them.
        rooms_partial: split at openings, empty where the scene does not say.
        doors: (2, 2) segments.
        openings: (2, 2) segments.
        windows: (2, 2) segments.
        axis: (2,) direction made axis-parallel for the paper's corner metric, or None.
        camera_height_m: metres, or None.
        levels: of a scene that is known to have several storeys; the world's origin is as high
            above storey 0 as its cameras. None: all is one.
    """

    rooms: tuple[TrueRoom, ...]
    rooms_partial: tuple[TrueRoom, ...] = ()
    doors: tuple[FloatArray, ...] = ()
    openings: tuple[FloatArray, ...] = ()
    windows: tuple[FloatArray, ...] = ()
    axis: FloatArray | None = None
    camera_height_m: float | None = None
    levels: TrueLevels | None = None


@dataclass(frozen=True, eq=False)
class GroundTruth:
    """All that is true of a scene.

    Attributes:
        plan: the true plan.
        trajectory: the true poses in metres, one a keyframe in the order of the walk, or None.
    """

    plan: TruePlan
    trajectory: Trajectory | None = None
