"""What a plan was made from, stage by stage, to be drawn. Plan frame and plan units throughout."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.config import Config
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.plan import ScaleEstimate, Unit


@dataclass(frozen=True, eq=False)
class Raster:
    """Values on square cells, whose rows may be turned against the plan's axes.

    Attributes:
        origin: (2,) corner of the first cell.
        axes: (2, 2) rows are the steps to the next cell along the first and the second index.
        values: (n, m).
    """

    origin: FloatArray
    axes: FloatArray
    values: FloatArray

    @property
    def cell(self) -> float:
        """Side of a cell."""
        return float((self.axes[0] @ self.axes[0]) ** 0.5)

    def at(self, cells: FloatArray) -> FloatArray:
        """(N, 2) places in the plan; cell (i, j) is the square [i, i + 1] × [j, j + 1]."""
        return self.origin + cells @ self.axes


@dataclass(frozen=True, eq=False)
class Cloud:
    """All boundary points of one level.

    Attributes:
        ch_per_su: scale that they are registered with.
        points: (N, 2).
        adjusted: whether the cameras are corrected by bundle adjustment.
    """

    ch_per_su: float
    points: FloatArray
    adjusted: bool = False


@dataclass(frozen=True, eq=False)
class ExplainedScale:
    """How the trajectory was scaled.

    Attributes:
        used: the scale that keyframes were placed with; None where it was never found.
        searched: the entropy's own answer with its curve: `used`, or, where that was given, a
            search made to compare; None where too little is known for one.
        adjusted_ch_per_su: scale after bundle adjustment, None without.
        clouds: at some scales around the one used, then after bundle adjustment.
    """

    used: ScaleEstimate | None
    searched: ScaleEstimate | None
    adjusted_ch_per_su: float | None
    clouds: tuple[Cloud, ...]


@dataclass(frozen=True, eq=False)
class ExplainedView:
    """A keyframe that was placed.

    Attributes:
        keyframe: id.
        room: id of its room.
        level: storey.
        camera: (2,).
        boundary: (W, 2) registered boundary, NaN where unknown.
        doorway: whether it counts as a view from a doorway.
    """

    keyframe: str
    room: str
    level: int
    camera: FloatArray
    boundary: FloatArray
    doorway: bool = False


@dataclass(frozen=True, eq=False)
class ExplainedRound:
    """One round of iSPA.

    Attributes:
        wall: density of wall planes, 0-1, on the round's grid.
        mask: (n, m) the room's cells on the same grid.
        candidates: (N, 2) where corners may be.
        corners: (K, 2) of the shortest path, None where none closes.
    """

    wall: Raster
    mask: BoolArray
    candidates: FloatArray
    corners: FloatArray | None


@dataclass(frozen=True, eq=False)
class ExplainedWalls:
    """What iSPA shaped a room from.

    Attributes:
        kept: (2, 2) ends of each accepted piece of wall.
        rejected: reason and (N, 2) boundary points of each other piece.
        rounds: in their order, a failed one last.
    """

    kept: tuple[FloatArray, ...]
    rejected: tuple[tuple[str, FloatArray], ...]
    rounds: tuple[ExplainedRound, ...]


@dataclass(frozen=True, eq=False)
class ExplainedFloor:
    """What fusion shaped a room from.

    Attributes:
        distance: fused truncated signed distance in plan units, less the strongest other room's,
            positive inside.
        pieces: (N, 2) the zero line cut into straight pieces.
        fitted: (K, 2) corners of the walls fitted to the raw columns, None where they do not close.
        sigmas: (K,) standard deviation across each of these walls, NaN where not known.
    """

    distance: Raster
    pieces: tuple[FloatArray, ...]
    fitted: FloatArray | None
    sigmas: FloatArray | None


@dataclass(frozen=True, eq=False)
class ExplainedRoom:
    """How one room came about.

    Attributes:
        id: the room's.
        name: what people call it.
        density: share of the evidence that speaks for each cell.
        polygon: (N, 2) in the plan, None where there is none.
        failure: why there is none.
        walls: where iSPA shapes rooms, else None.
        floor: where fusion does; None, too, where the views agree on no floor.
    """

    id: str
    name: str
    density: Raster
    polygon: FloatArray | None
    failure: str | None
    walls: ExplainedWalls | None = None
    floor: ExplainedFloor | None = None


@dataclass(frozen=True, eq=False)
class Grouping:
    """Views of one level told apart by their common areas.

    Attributes:
        level: storey.
        views: (V,) places in `Explanation.views`, room by room.
        overlaps: (V, V) common area of each two views over that of the smaller, 0-1, in that order.
    """

    level: int
    views: IntArray
    overlaps: FloatArray


@dataclass(frozen=True, eq=False)
class Explanation:
    """A whole plan explained.

    Attributes:
        unit: of every length.
        config: settings of the walk.
        scale: of the trajectory.
        views: every keyframe that was placed, in the order of the walk.
        rooms: in the order of the plan.
        groupings: one a level where fusion shapes rooms, else none.
    """

    unit: Unit
    config: Config
    scale: ExplainedScale
    views: tuple[ExplainedView, ...]
    rooms: tuple[ExplainedRoom, ...]
    groupings: tuple[Grouping, ...] = ()

    def views_of(self, room: ExplainedRoom) -> list[ExplainedView]:
        """The keyframes of a room."""
        return [view for view in self.views if view.room == room.id]
