"""Lengths written along the walls of each room."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
import shapely.affinity

from panoplan.exporters.labels import width_em
from panoplan.exporters.sheet.layout import Placement
from panoplan.exporters.sheet.marks import Mark, Shape, Words
from panoplan.exporters.storeys import Storey, room_area
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Wall

_SIZES = (2.4, 1.7)
"""Of the text, mm: the smaller where the larger has no space."""

_OFFSET = 2.6
"""Between a wall's face and its dimension line, mm."""

BAND = _OFFSET + 0.6 * _SIZES[0]
"""How far from a wall's face its dimension reaches, mm."""

_TICK = 0.7
_APART = 0.4
"""Between a dimension and other text, mm."""

_BOLD = 1.15
"""Of bold letters: how much wider they are."""

_COLOUR = "#5B636E"


def dimensions(
    floor: Storey, placement: Placement, taken: Sequence[Words]
) -> tuple[tuple[Mark, ...], int]:
    """A dimension line with its length inside each wall that has the space for it.

    Args:
        floor: a metric storey.
        placement: where it lies on paper.
        taken: text that stands already and must not be crossed.

    Returns:
        The marks, longest wall first, and how many walls have no space.
    """
    marks: list[Mark] = []
    left_out = 0
    busy = shapely.union_all([text_box(words) for words in taken])
    inside = {wall.id: room_area(room) for room in floor.rooms for wall in room.walls}
    for wall in sorted(floor.walls.values(), key=wall_length, reverse=True):
        space = shapely.Polygon(placement.on_paper(_corners(inside[wall.id])))
        for size in _SIZES:
            line, text = _dimension(wall, placement, size)
            box = text_box(text)
            needed = width_em(text.text) * size + 2 * _TICK
            fits = wall_length(wall) * placement.mm_per_m >= needed and space.covers(box)
            if fits and not busy.intersects(shapely.union(box.buffer(_APART), _stroke(line))):
                busy = shapely.union(busy, box)
                marks += [line, text]
                break
        else:
            left_out += 1
    return tuple(marks), left_out


def wall_length(wall: Wall) -> float:
    """Length of a wall in plan units."""
    return float(np.hypot(*(wall.b - wall.a)))


def inward(wall: Wall) -> FloatArray:
    """(2,) unit normal into the wall's room, plan frame."""
    x, y = wall.b - wall.a
    return np.array([-y, x]) / max(float(np.hypot(x, y)), 1e-12)


def text_box(words: Words) -> Any:
    """The shapely rectangle that a line of text takes on paper, by estimate."""
    width = width_em(words.text) * words.size * (_BOLD if words.bold else 1.0)
    height = 1.1 * words.size
    shift = {"start": width / 2, "middle": 0.0, "end": -width / 2}[words.anchor]
    box = shapely.box(shift - width / 2, -height / 2, shift + width / 2, height / 2)
    turned = shapely.affinity.rotate(box, -words.angle_deg, origin=(0.0, 0.0))
    return shapely.affinity.translate(turned, *words.at)


def _corners(area: Any) -> FloatArray:
    parts = shapely.get_parts(area)
    largest = parts[int(np.argmax(shapely.area(parts)))]
    return np.asarray(shapely.get_coordinates(largest.exterior))


def _stroke(line: Shape) -> Any:
    return shapely.MultiLineString(list(line.rings[:2]))


def _dimension(wall: Wall, placement: Placement, size: float) -> tuple[Shape, Words]:
    text = f"{wall_length(wall):.2f}"
    shift = inward(wall) * _OFFSET / placement.mm_per_m
    a, b = placement.on_paper(np.array([wall.a, wall.b]) + shift)
    along = (b - a) / max(float(np.hypot(*(b - a))), 1e-9)
    centre = (a + b) / 2
    gap = along * min((width_em(text) + 0.6) * size, float(np.hypot(*(b - a)))) / 2
    slash = np.array([along[0] - along[1], along[0] + along[1]]) * _TICK / np.sqrt(2)
    lines = (
        np.array([a, centre - gap]),
        np.array([centre + gap, b]),
        np.array([a - slash, a + slash]),
        np.array([b - slash, b + slash]),
    )
    angle = float(np.degrees(np.arctan2(-along[1], along[0])))
    # Text reads from below or from the right.
    readable = angle - 180.0 if angle > 90.01 else angle + 180.0 if angle <= -89.99 else angle
    place = (float(centre[0]), float(centre[1]))
    return (
        Shape(lines, closed=False, stroke=_COLOUR, width=0.13),
        Words(place, text, size, angle_deg=readable, colour=_COLOUR),
    )
