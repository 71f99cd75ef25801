"""Frame, scale bar, arrow, notes and title block of a sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap

import numpy as np

from panoplan.exporters.labels import printable
from panoplan.exporters.sheet.layout import MARGIN, STRIP, Placement
from panoplan.exporters.sheet.marks import Mark, Shape, Words
from panoplan.types.arrays import FloatArray

AREA_RULE = (
    "Areas are floor between the inner faces of the walls, without walls, reveals and holes."
)
"""What the areas in drawings and schedules count."""

_INK = "#1D2127"
_QUIET = "#5B636E"
_NOTES = (2.3, 1.9)
"""Sizes of notes, mm: the smaller where the larger is too much."""

_LINE = 1.35
_EM = 0.56


@dataclass(frozen=True)
class Told:
    """What the strip below a drawing tells.

    Attributes:
        title: printable.
        rooms: how many.
        area: of all of them, m².
        north: rad, from the plan's second axis towards its first, or None.
        heading: that of the first camera, or None.
        notes: printable lines.
        version: of panoplan, may be empty.
    """

    title: str
    rooms: int
    area: float
    north: float | None
    heading: float | None
    notes: tuple[str, ...]
    version: str


def title_block(placement: Placement, told: Told) -> tuple[Mark, ...]:
    """The frame of the sheet and the strip at its foot: bar, arrow, notes, title."""
    paper = placement.paper
    left, right = MARGIN, paper.width - MARGIN
    foot, top = paper.height - MARGIN, paper.height - MARGIN - STRIP
    bar_end = left + 0.30 * (right - left)
    arrow_end = bar_end + 18.0
    block = right - 0.30 * (right - left)
    marks: list[Mark] = [
        Shape((_box(left, MARGIN, right, foot),), stroke=_INK, width=0.35),
        Shape(
            (
                np.array([[left, top], [right, top]]),
                *(np.array([[x, top], [x, foot]]) for x in (bar_end, arrow_end, block)),
            ),
            closed=False,
            stroke=_INK,
            width=0.18,
        ),
    ]
    marks += _scale_bar(placement, left + 5.0, top + 12.0, bar_end - left - 16.0)
    marks += _arrow(placement, told, np.array([(bar_end + arrow_end) / 2, top + 10.0]))
    marks += _notes((AREA_RULE, *told.notes), arrow_end + 3.0, block - 3.0, top)
    marks += _title(placement, told, block + 3.0, right - 3.0, top)
    return tuple(marks)


def _box(left: float, top: float, right: float, foot: float) -> FloatArray:
    return np.array([[left, top], [right, top], [right, foot], [left, foot]])


def _scale_bar(placement: Placement, left: float, y: float, longest: float) -> list[Mark]:
    """Alternating fields of a round length with their distances, as long as fits."""
    lengths = [base * 10**power for power in range(-1, 4) for base in (1.0, 2.0, 5.0)]
    metres = max(m for m in lengths if m * placement.mm_per_m <= longest or m == lengths[0])
    fields = 5 if f"{metres:e}"[0] == "5" else 4 if f"{metres:e}"[0] == "2" else 2
    step = metres * placement.mm_per_m / fields
    marks: list[Mark] = [
        Shape(
            (_box(left + k * step, y, left + (k + 1) * step, y + 1.8),),
            fill=_INK if k % 2 == 0 else "#FFFFFF",
            stroke=_INK,
            width=0.18,
        )
        for k in range(fields)
    ]
    marks.append(
        Shape(
            (np.array([[left, y], [left + fields * step, y]]),),
            closed=False,
            stroke=_INK,
            id="scale_bar",
            title=f"{metres:g} m",
        )
    )
    for at, text in ((0.0, "0"), (fields * step, f"{metres:g} m")):
        marks.append(Words((left + at, y + 4.6), text, 2.3))
    marks.append(
        Words((left, y - 4.5), f"1:{placement.denominator}", 3.6, anchor="start", bold=True)
    )
    marks.append(
        Words((left + 16.0, y - 4.2), "print at 100 %", 1.9, anchor="start", colour=_QUIET)
    )
    return marks


def _arrow(placement: Placement, told: Told, centre: FloatArray) -> list[Mark]:
    """Towards north, or where the first camera looked."""
    bearing = told.heading if told.north is None else told.north
    if bearing is None:
        return []
    turned = placement.turn
    direction = np.array([np.sin(bearing - turned), -np.cos(bearing - turned)])
    across = np.array([-direction[1], direction[0]])
    tip, tail = centre + 7.0 * direction, centre - 6.0 * direction
    head = np.array([tip, centre + 2.6 * across, centre - 2.6 * across])
    name = "first view" if told.north is None else "north"
    half = head[[0, 1]]
    return [
        Shape((np.array([tail, centre]),), closed=False, stroke=_INK, width=0.3),
        Shape((np.concatenate([half, centre[None]]),), fill=_INK, stroke=_INK),
        Shape((head,), stroke=_INK, width=0.25, id="arrow", title=name),
        Words((float(centre[0]), float(centre[1]) + 12.6), name, 2.2, colour=_QUIET),
    ]


def _notes(notes: Sequence[str], left: float, right: float, top: float) -> list[Mark]:
    """Notes broken into lines, the last saying if there are more than fit."""
    for size in _NOTES:
        most = int((STRIP - 3.0) / (size * _LINE))
        width = int((right - left) / (size * _EM))
        lines = [line for note in notes for line in wrap(note, width)]
        if len(lines) <= most:
            break
    else:
        lines = [*lines[: most - 1], f"… and {len(lines) - most + 1} more lines: rooms.csv"]
    return [
        Words((left, top + 1.5 * size + k * size * _LINE), line, size, "start", colour=_QUIET)
        for k, line in enumerate(lines)
    ]


def _title(placement: Placement, told: Told, left: float, right: float, top: float) -> list[Mark]:
    size = 4.2
    longest = int((right - left) / (size * 0.62))
    rooms = "1 room" if told.rooms == 1 else f"{told.rooms} rooms"
    small = [
        f"{rooms}, {told.area:.1f} m²",
        f"Floor plan, {placement.paper.name}, 1:{placement.denominator}, lengths in metres",
        "panoplan " + told.version,
    ]
    return [
        Words((left, top + 6.0), printable(told.title, longest), size, "start", bold=True),
        *(
            Words((left, top + 12.0 + 4.2 * k), line, 2.3, "start", colour=_QUIET)
            for k, line in enumerate(small)
        ),
    ]
