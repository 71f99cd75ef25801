"""What is known of a room while the camera walks. Walk frame, camera heights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from panoplan.types.arrays import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class RoomDensity:
    """Evidence for and against each cell being part of a room.

    Cell (i, j) of the arrays has its centre at ((i + first_cell[0] + ½)·cell, ...).

    Attributes:
        first_cell: lattice index of the arrays' first cell.
        free: (n, m) sum of the views that hold the cell, as the normalisation wants it.
        against: (n, m) sum of the weights that speak against it.
        mask: (n, m) the cells that belong to the room.
        mask_box: lattice index of the mask's first row and column, and of those after its last;
            all 0 where the mask is empty.
        mask_cells: number of cells in the mask.
    """

    first_cell: tuple[int, int]
    free: NDArray[np.float32]
    against: NDArray[np.float32]
    mask: BoolArray
    mask_box: tuple[int, int, int, int]
    mask_cells: int


@dataclass(frozen=True, eq=False)
class WallPiece:
    """A piece of one layout's boundary that lies on one plane.

    Attributes:
        keyframe: id.
        ends: (2, 2) first and last inlier, projected onto the plane.
        direction: of the wall in [0, π) rad, from the first axis.
        distance: from the camera to the plane.
        points: (N, 2) the inliers.
    """

    keyframe: str
    ends: FloatArray
    direction: float
    distance: float
    points: FloatArray


@dataclass(frozen=True)
class RejectedPiece:
    """A piece of boundary that is no evidence of a wall.

    Attributes:
        keyframe: id.
        columns: first and last image column.
        reason: why.
    """

    keyframe: str
    columns: tuple[int, int]
    reason: Literal["too few columns", "no plane fits", "seen edge-on", "too far"]


@dataclass(frozen=True)
class Orientation:
    """One wall direction of a room, as a normal distribution (Eq. 7).

    Attributes:
        direction: mean in [0, π) rad, from the first axis.
        sigma: standard deviation in rad.
        support: number of walls that took part.
    """

    direction: float
    sigma: float
    support: int


@dataclass(frozen=True, eq=False)
class RoomShape:
    """A room's outline, or why there is none.

    Attributes:
        polygon: (N, 2) simple, counter-clockwise; None where none was found.
        failure: the reason, None where there is a polygon.
        rounds: (N, 2) polygon of each round of iSPA.
        sigmas: (N,) standard deviation across the wall that begins at each corner, NaN where not
            known; None where the method tells none.
        holes: open polygons, clockwise, of what is not room inside.
    """

    polygon: FloatArray | None
    failure: str | None
    rounds: tuple[FloatArray, ...] = ()
    sigmas: FloatArray | None = None
    holes: tuple[FloatArray, ...] = ()


@dataclass(frozen=True, eq=False)
class WallStretch:
    """A stretch of a room's wall where its views show something, or see through.

    Attributes:
        segment: (2, 2) along the wall.
        votes: weight of the views that call it a door, an opening, a window.
        telling: views that tell it.
        able: views that look at it and tell such things.
        leaking: views whose boundary goes on behind it.
        looking: views that look at it.
    """

    segment: FloatArray
    votes: tuple[float, float, float]
    telling: int
    able: int
    leaking: int
    looking: int
