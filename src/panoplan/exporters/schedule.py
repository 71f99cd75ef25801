"""A plan's rooms as a table."""

from __future__ import annotations

import csv
import io

from panoplan.exporters.labels import printable
from panoplan.exporters.sheet.title import AREA_RULE
from panoplan.exporters.storeys import metric_storeys, room_area
from panoplan.types.plan import Aperture, FloorPlan, Room

_COLUMNS = (
    "level", "id", "name", "area_m2", "area_sigma_m2", "perimeter_m", "ceiling_height_m",
    "doors", "openings", "windows", "keyframes", "flags", "area_rule",
)  # fmt: skip
_FORMULA = ("=", "+", "-", "@")


def room_schedule(plan: FloorPlan) -> bytes:
    """A line a room, UTF-8, RFC 4180; unknown values are empty.

    Raises:
        InputError: not metric or without rooms.
    """
    stream = io.StringIO()
    writer = csv.writer(stream)
    writer.writerow(_COLUMNS)
    for floor in metric_storeys(plan):
        for room in floor.rooms:
            area = room_area(room)
            writer.writerow(
                [
                    floor.level,
                    text_cell(room.id),
                    text_cell(room.name),
                    f"{area.area:.3f}",
                    _number(room.area_sigma),
                    f"{area.length:.3f}",
                    _number(room.ceiling_height),
                    *(_count(room, kind) for kind in (floor.doors, floor.openings, floor.windows)),
                    len(room.keyframes),
                    text_cell(" ".join(room.flags)),
                    AREA_RULE,
                ]
            )
    return stream.getvalue().encode("utf-8")


def text_cell(text: str) -> str:
    """A name as a cell that no spreadsheet takes for a formula."""
    clean = printable(text)
    return f"'{clean}" if clean.startswith(_FORMULA) else clean


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"


def _count(room: Room, items: tuple[Aperture, ...]) -> int:
    return sum(room.id in item.rooms for item in items)
