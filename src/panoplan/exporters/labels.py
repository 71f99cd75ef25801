"""Text that fits where it stands."""

from __future__ import annotations

import textwrap
import unicodedata
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from panoplan.types.arrays import FloatArray

_EM_A_CHARACTER = 0.6
_LINE_HEIGHT = 1.25


@dataclass(frozen=True, eq=False)
class RoomLabel:
    """What is written into a room.

    Attributes:
        position: (2,) centre, plan frame.
        lines: one a line of text.
        size_pt: font size.
    """

    position: FloatArray
    lines: tuple[str, ...]
    size_pt: float


def printable(text: str, longest: int = 60) -> str:
    """Text on one line without control characters, shortened with an ellipsis."""
    clean = "".join(c if c.isprintable() else " " for c in text)
    return textwrap.shorten(clean, longest, placeholder=" …") or clean[:longest].strip()


def width_em(line: str) -> float:
    """Estimated width of a line of text in font sizes."""
    wide = sum(unicodedata.east_asian_width(c) in "WF" for c in line)
    return wide * 1.0 + (len(line) - wide) * _EM_A_CHARACTER


def room_label(
    area: Any, name: str, figure: str, points_per_unit: float, size_pt: float, smallest_pt: float
) -> RoomLabel | None:
    """The room's name over its area, wrapped and sized to fit.

    Args:
        area: shapely area of the room.
        name: printable.
        figure: its area in words, on the last line.
        points_per_unit: printer's points a plan unit in the drawing.
        size_pt: largest font size.
        smallest_pt: least font size that can be read.

    Returns:
        The label in its largest wrapping that fits, or None where none is readable.
    """
    centre, radius = _widest_place(area)
    best: RoomLabel | None = None
    for wrapped in _wrappings(name):
        lines = (*wrapped, figure)
        size = _fitting_size(area, centre, radius, lines, points_per_unit, size_pt)
        if size >= smallest_pt and (best is None or size > best.size_pt + 0.1):
            best = RoomLabel(centre, lines, size)
    return best


def label_place(area: Any) -> FloatArray:
    """(2,) centre of the largest circle inside a room."""
    return _widest_place(area)[0]


def _widest_place(area: Any) -> tuple[FloatArray, float]:
    parts = shapely.get_parts(area)
    largest = parts[int(np.argmax(shapely.area(parts)))]
    size = float(np.ptp(np.array(largest.bounds).reshape(2, 2), axis=0).max())
    radius = shapely.maximum_inscribed_circle(largest, tolerance=max(size / 200, 1e-9))
    ends = shapely.get_coordinates(radius)
    return ends[0], float(np.hypot(*(ends[1] - ends[0])))


def _wrappings(name: str) -> list[tuple[str, ...]]:
    found: list[tuple[str, ...]] = [(name,)]
    for count in (2, 3):
        width = max(4, -(-len(name) // count) + 2)
        lines = tuple(textwrap.wrap(name, width, break_long_words=False))
        if 1 < len(lines) <= 3 and lines not in found:
            found.append(lines)
    return found


def _fitting_size(
    area: Any,
    centre: FloatArray,
    radius: float,
    lines: tuple[str, ...],
    points_per_unit: float,
    size_pt: float,
) -> float:
    """Largest font size at which the block of text stays inside the room."""
    em = max(width_em(line) for line in lines) + 0.6
    height = len(lines) * _LINE_HEIGHT + 0.2
    # The square inside the largest circle always fits; wider rooms allow more.
    low = 2 * radius / np.hypot(em, height) * points_per_unit
    for size in np.arange(size_pt, low, -0.25):
        half = np.array([em, height]) * size / points_per_unit / 2
        if shapely.box(*(centre - half), *(centre + half)).within(area):
            return float(size)
    return float(min(low, size_pt))
