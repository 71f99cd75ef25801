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
_PLACES = 17


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
    area: Any,
    name: str,
    figure: str,
    points_per_unit: float,
    sizes_pt: tuple[float, float],
    cameras: FloatArray,
    *,
    wrap: bool = True,
) -> RoomLabel | None:
    """The room's name over its area, wrapped, sized and placed so that it fits.

    Args:
        area: shapely area of the room.
        name: printable.
        figure: its area in words, on the last line.
        points_per_unit: printer's points a plan unit in the drawing.
        sizes_pt: least font size that can be read, and the largest.
        cameras: (K, 2) marks that the label should not hide.
        wrap: whether the name may take more than one line.

    Returns:
        The label in its largest wrapping that fits, or None where none is readable.
    """
    best: RoomLabel | None = None
    places = _places(area)
    for wrapped in _wrappings(name) if wrap else [(name,)]:
        lines = (*wrapped, figure)
        size, fitting = _fitting(area, places, lines, points_per_unit, sizes_pt)
        if len(fitting) and (best is None or size > best.size_pt + 0.1):
            half = _half_block(lines, size, points_per_unit)
            best = RoomLabel(_clearest(area, fitting, half, cameras), lines, size)
    return best


def label_place(area: Any) -> FloatArray:
    """(2,) centre of the largest circle inside a room."""
    parts = shapely.get_parts(area)
    largest = parts[int(np.argmax(shapely.area(parts)))]
    size = float(np.ptp(np.array(largest.bounds).reshape(2, 2), axis=0).max())
    radius = shapely.maximum_inscribed_circle(largest, tolerance=max(size / 200, 1e-9))
    return np.asarray(shapely.get_coordinates(radius)[0])


def _wrappings(name: str) -> list[tuple[str, ...]]:
    found: list[tuple[str, ...]] = [(name,)]
    for count in (2, 3):
        width = max(4, -(-len(name) // count) + 2)
        lines = tuple(textwrap.wrap(name, width, break_long_words=False))
        if 1 < len(lines) <= 3 and lines not in found:
            found.append(lines)
    return found


def _places(area: Any) -> FloatArray:
    """Places inside a room where a label may have its centre, (N, 2)."""
    low, high = np.array(area.bounds).reshape(2, 2)
    steps = (np.arange(_PLACES) + 0.5) / _PLACES
    x, y = np.meshgrid(*(low + steps[:, None] * (high - low)).T)
    grid = np.stack([x.ravel(), y.ravel()], axis=1)
    inside = grid[shapely.contains_xy(area, grid[:, 0], grid[:, 1])]
    middle = shapely.get_coordinates(area.centroid)
    return np.concatenate([middle, label_place(area)[None], inside])


def _half_block(lines: tuple[str, ...], size_pt: float, points_per_unit: float) -> FloatArray:
    """(2,) half the width and height of a block of text, in plan units."""
    em = max(width_em(line) for line in lines) + 0.6
    block = np.array([em, len(lines) * _LINE_HEIGHT + 0.3])
    return np.asarray(block * size_pt / points_per_unit / 2)


def _blocks(places: FloatArray, half: FloatArray) -> Any:
    return shapely.box(*(places - half).T, *(places + half).T)


def _fitting(
    area: Any,
    places: FloatArray,
    lines: tuple[str, ...],
    points_per_unit: float,
    sizes_pt: tuple[float, float],
) -> tuple[float, FloatArray]:
    """The largest font size at which the text fits anywhere, and all places where it does."""
    shapely.prepare(area)
    for size in np.linspace(sizes_pt[1], sizes_pt[0], 9):
        blocks = _blocks(places, _half_block(lines, float(size), points_per_unit))
        fits = shapely.contains(area, blocks)
        if fits.any():
            return float(size), places[fits]
    return 0.0, places[:0]


def _clearest(area: Any, places: FloatArray, half: FloatArray, cameras: FloatArray) -> FloatArray:
    """The place that hides the fewest cameras, and of those the one nearest to the middle."""
    middle = shapely.get_coordinates(area.centroid)[0]
    reach = half * 1.15
    hidden = (np.abs(cameras[None] - places[:, None]) <= reach).all(axis=2).sum(axis=1)
    distance = np.hypot(*(places - middle).T)
    return np.asarray(places[np.lexsort((distance, hidden))[0]])
