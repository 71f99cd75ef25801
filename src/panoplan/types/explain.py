"""What a plan was made from, stage by stage, to be drawn. Walk frame, camera heights."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.types.arrays import FloatArray
from panoplan.types.plan import ScaleEstimate


@dataclass(frozen=True, eq=False)
class Raster:
    """Values on square cells.

    Attributes:
        low: (2,) corner of the first cell.
        cell: side of a cell.
        values: (n, m), first axis first, NaN where there is nothing to say.
    """

    low: FloatArray
    cell: float
    values: FloatArray


@dataclass(frozen=True, eq=False)
class ExplainedRoom:
    """How one room came about.

    Attributes:
        id: the room's.
        cameras: (K, 2) of its keyframes.
        density: share of the evidence that speaks for each cell.
        kept: (2, 2) ends of each accepted piece of wall.
        rejected: (reason, (N, 2) boundary points) of each other piece.
        rounds: outline of each round of iSPA.
        distance: fused truncated signed distance, positive inside; None where iSPA shapes rooms.
        columns: (N, 2) raw boundary points that the walls are fitted to.
        outline: (N, 2) fitted walls, or None where there is no shape.
        polygon: (N, 2) the same as part of the whole plan, or None.
        sigmas: (N,) standard deviation of each wall of `outline`, NaN where not known.
        failure: why there is no shape.
    """

    id: str
    cameras: FloatArray
    density: Raster
    kept: tuple[FloatArray, ...] = ()
    rejected: tuple[tuple[str, FloatArray], ...] = ()
    rounds: tuple[FloatArray, ...] = ()
    distance: Raster | None = None
    columns: FloatArray | None = None
    outline: FloatArray | None = None
    polygon: FloatArray | None = None
    sigmas: FloatArray | None = None
    failure: str | None = None


@dataclass(frozen=True, eq=False)
class Explanation:
    """A whole plan explained.

    Attributes:
        scale: how the trajectory was scaled.
        clouds: (factor on the scale, (N, 2) all boundary points registered with it).
        rooms: in the order of the plan.
        path: (V, 2) every camera that was placed.
    """

    scale: ScaleEstimate | None
    clouds: tuple[tuple[float, FloatArray], ...]
    rooms: tuple[ExplainedRoom, ...]
    path: FloatArray
