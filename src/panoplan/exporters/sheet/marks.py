"""What a sheet is made of: millimetres from its upper left corner, second axis down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from panoplan.types.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Shape:
    """Rings that are filled, or lines.

    Attributes:
        rings: (N, 2) points each, mm; holes run against their outer ring.
        closed: whether each ends where it began.
        fill: colour, None for none.
        stroke: colour, None for none.
        width: of the stroke, mm.
        dash: lengths of dashes and gaps, mm; empty for a whole line.
        id: unique on the sheet, may be empty.
        title: what it is, in words; may be empty.
    """

    rings: tuple[FloatArray, ...]
    closed: bool = True
    fill: str | None = None
    stroke: str | None = None
    width: float = 0.18
    dash: tuple[float, ...] = ()
    id: str = ""
    title: str = ""


@dataclass(frozen=True, eq=False)
class Words:
    """One line of text, never markup.

    Attributes:
        at: (x, y) of its anchor, mm.
        text: printable.
        size: of the font, mm.
        anchor: which part of the line is at `at`; its middle is so in height.
        angle_deg: counter-clockwise as seen.
        colour: of the letters.
        bold: whether heavy.
    """

    at: tuple[float, float]
    text: str
    size: float
    anchor: Literal["start", "middle", "end"] = "middle"
    angle_deg: float = 0.0
    colour: str = "#1D2127"
    bold: bool = False


Mark = Shape | Words


@dataclass(frozen=True)
class Paper:
    """A size of paper, wide or tall.

    Attributes:
        name: "A3".
        width: mm.
        height: mm.
    """

    name: str
    width: float
    height: float

    @property
    def turned(self) -> Paper:
        """The same the other way round."""
        return Paper(self.name, self.height, self.width)


PAPERS = {
    name: Paper(name, width, height)
    for name, width, height in (
        ("A4", 297.0, 210.0),
        ("A3", 420.0, 297.0),
        ("A2", 594.0, 420.0),
        ("A1", 841.0, 594.0),
        ("A0", 1189.0, 841.0),
    )
}


@dataclass(frozen=True, eq=False)
class Sheet:
    """One page.

    Attributes:
        paper: its size.
        denominator: 50 for a scale of 1:50.
        title: printable.
        layers: marks by the layer's name, drawn in this order.
    """

    paper: Paper
    denominator: int
    title: str
    layers: dict[str, tuple[Mark, ...]]
