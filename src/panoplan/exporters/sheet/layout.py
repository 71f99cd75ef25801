"""Where a plan lies on paper: scale, size and turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from panoplan.errors import InputError
from panoplan.exporters.sheet.marks import PAPERS, Paper
from panoplan.exporters.storeys import Storey, bounds
from panoplan.types.arrays import FloatArray

SCALES = (50, 100, 200, 500, 1000)
MARGIN = 10.0
"""Between the edge of the paper and its frame, mm."""

STRIP = 26.0
"""Height of the strip with the title block below the drawing, mm."""

_AIR = 5.0
_EVERYDAY = ("A4", "A3")


@dataclass(frozen=True, eq=False)
class Placement:
    """How the plan frame lies on the paper.

    Attributes:
        paper: chosen.
        denominator: of the scale.
        turn: rad, counter-clockwise, that makes most walls parallel to the paper's edges.
        centre: (2,) point of the turned plan that lies in the middle of the drawing.
    """

    paper: Paper
    denominator: int
    turn: float
    centre: FloatArray

    @property
    def mm_per_m(self) -> float:
        """Millimetres of paper a metre."""
        return 1000.0 / self.denominator

    def on_paper(self, points: FloatArray) -> FloatArray:
        """(N, 2) points of the plan as mm from the paper's upper left corner."""
        middle = np.array([self.paper.width, self.paper.height - STRIP]) / 2
        moved = (np.asarray(points) @ _turned(self.turn).T - self.centre) * self.mm_per_m
        return np.asarray(moved * (1.0, -1.0) + middle)


def place(floors: Sequence[Storey], paper: str | None = None) -> Placement:
    """Chooses scale and paper: 1:50 or 1:100 on A4 or A3, else on larger paper, else smaller.

    All storeys lie alike, so that their sheets can be laid over one another.

    Args:
        floors: metric storeys.
        paper: a name of `PAPERS` that has to do, or None.

    Raises:
        InputError: too large for every scale.
    """
    turn = main_turn(floors)
    ends = np.array([end for floor in floors for end in bounds(floor, _turned(turn))])
    low, high = ends.min(axis=0), ends.max(axis=0)
    extent = (high - low) * 1000.0
    everyday = [PAPERS[name] for name in _EVERYDAY]
    large = [size for name, size in PAPERS.items() if name not in _EVERYDAY]
    tried = [(scale, size) for scale in SCALES[:2] for size in everyday]
    tried += [(scale, size) for scale in reversed(SCALES[:2]) for size in large]
    tried += [(scale, size) for scale in SCALES[2:] for size in PAPERS.values()]
    if paper is not None:
        tried = [(scale, PAPERS[paper]) for scale in SCALES]
    for scale, size in tried:
        for sheet in (size, size.turned):
            room = np.array([sheet.width, sheet.height - STRIP]) - 2 * (MARGIN + _AIR)
            if np.all(extent / scale <= room):
                return Placement(sheet, scale, turn, (low + high) / 2)
    raise InputError(
        "plan",
        f"{extent.max() / 1000:.6g} m from end to end",
        f"a plan that fits on {paper or 'A0'} at 1:{SCALES[-1]}",
    )


def main_turn(floors: Sequence[Storey]) -> float:
    """The turn in (-π/4, π/4] rad after which most wall length is parallel to the axes."""
    walls = [wall for floor in floors for wall in floor.walls.values()]
    if not walls:
        return 0.0
    along = np.array([wall.b - wall.a for wall in walls])
    angles = np.arctan2(along[:, 1], along[:, 0])
    lengths = np.hypot(along[:, 0], along[:, 1])
    return float(-np.angle((lengths * np.exp(4j * angles)).sum()) / 4)


def _turned(turn: float) -> FloatArray:
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, -s], [s, c]])
