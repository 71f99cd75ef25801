"""A storey drawn on paper: rooms, walls, doors, dimensions, names."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from panoplan.exporters.drawing import room_colours
from panoplan.exporters.labels import RoomLabel, label_place, printable, room_label
from panoplan.exporters.metres import metres_told
from panoplan.exporters.sheet.dimensions import BAND, dimensions
from panoplan.exporters.sheet.layout import Placement, place
from panoplan.exporters.sheet.marks import Mark, Shape, Sheet, Words
from panoplan.exporters.sheet.title import Told, title_block
from panoplan.exporters.storeys import (
    Storey,
    by_faces,
    inner_walls,
    metric_storeys,
    room_area,
    through,
)
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Aperture, FloorPlan

INK = "#1D2127"
SOLID = "#4A515B"
DOOR = "#8A5A2B"
GLASS = "#2F7FB8"
QUIET = "#5B636E"

_MM_PER_PT = 25.4 / 72
_LABEL_PT = (5.0, 9.5)
_LINE = 1.2
_SYMBOL_MM = 1.1


def sheets(
    plan: FloorPlan, *, title: str, north: float | None = None, paper: str | None = None
) -> tuple[Sheet, ...]:
    """A sheet a storey, lowest first, all at one scale on one size of paper.

    Args:
        plan: metric.
        title: of the drawing.
        north: rad, from the plan's second axis towards its first; None where not known: then the
            heading of the first camera is shown instead.
        paper: "A4" to "A0", or None for what suits.

    Raises:
        InputError: not metric, without rooms, or too large for paper.
    """
    floors = metric_storeys(plan)
    placement = place(floors, paper)
    titles = [title if len(floors) == 1 else f"{title}, {floor.name}" for floor in floors]
    return tuple(
        _sheet(plan, floor, placement, name, north)
        for floor, name in zip(floors, titles, strict=True)
    )


def _sheet(
    plan: FloorPlan, floor: Storey, placement: Placement, title: str, north: float | None
) -> Sheet:
    labels, numbered = _labels(floor, placement)
    lengths, left_out = dimensions(floor, placement, labels)
    notes = [metres_told(plan), *numbered]
    if left_out:
        notes.append(f"{left_out} lengths have no space here; plan.dxf has them all.")
    missing = [r for r in plan.rooms if r.polygon is None and r.level == floor.level]
    if missing:
        names = "; ".join(f"{printable(r.name)} ({printable(r.failure or '')})" for r in missing)
        notes.append(f"Without a shape: {names}.")
    heading = plan.trajectory[0].heading if plan.trajectory else None
    told = Told(
        title=printable(title),
        rooms=len(floor.rooms),
        area=sum(float(room_area(room).area) for room in floor.rooms),
        north=north,
        heading=heading,
        notes=tuple(notes),
        version=printable(plan.version),
    )
    layers: dict[str, tuple[Mark, ...]] = {
        "rooms": _rooms(floor, placement),
        "walls": _walls(floor, placement),
        "doors": _doors(floor, placement),
        "openings": _openings(floor, placement),
        "windows": _windows(floor, placement),
        "dimensions": lengths,
        "labels": labels,
        "title": title_block(placement, told),
    }
    return Sheet(placement.paper, placement.denominator, told.title, layers)


def _rings(area: object, placement: Placement) -> tuple[FloatArray, ...]:
    rings = []
    for part in shapely.get_parts(area):
        if isinstance(part, shapely.Polygon) and not part.is_empty:
            rings += [part.exterior, *part.interiors]
    return tuple(placement.on_paper(shapely.get_coordinates(ring)[:-1]) for ring in rings)


def _rooms(floor: Storey, placement: Placement) -> tuple[Mark, ...]:
    colours = room_colours(floor.rooms)
    return tuple(
        Shape(
            _rings(room_area(room), placement),
            fill=_paler(colours[room.id]),
            id=room.id,
            title=printable(room.name),
        )
        for room in floor.rooms
    )


def _paler(colour: str) -> str:
    """A colour half way to white, so that print stays legible."""
    parts = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return "#" + "".join(f"{(part + 255) // 2:02X}" for part in parts)


def _walls(floor: Storey, placement: Placement) -> tuple[Mark, ...]:
    solid = Shape(_rings(inner_walls(floor), placement), fill=SOLID, id="solid")
    faces = tuple(
        Shape(_rings(room_area(room), placement), stroke=INK, width=0.5, id=f"outline_{room.id}")
        for room in floor.rooms
    )
    return (solid, *faces) if solid.rings else faces


def _box(item: Aperture, floor: Storey, placement: Placement) -> FloatArray:
    """(4, 2) rectangle of an aperture through its wall on paper: along it, then back."""
    a, b = placement.on_paper(item.segment)
    along = (b - a) / max(float(np.hypot(*(b - a))), 1e-9)
    across = np.array([-along[1], along[0]])
    thick = through(item, by_faces(floor)) * placement.mm_per_m
    half = max(thick, _SYMBOL_MM) / 2 + 0.26
    return np.array([a + across * half, b + across * half, b - across * half, a - across * half])


def _sides(box: FloatArray) -> tuple[FloatArray, ...]:
    """The two sides of the rectangle across the wall, where the jambs are."""
    return (box[[0, 3]], box[[1, 2]])


def _doors(floor: Storey, placement: Placement) -> tuple[Mark, ...]:
    marks: list[Mark] = []
    for item in floor.doors:
        box = _box(item, floor, placement)
        leaf = placement.on_paper(item.segment)
        marks += [
            Shape((box,), fill="#FFFFFF", id=item.id, title="door"),
            Shape(_sides(box), closed=False, stroke=INK, width=0.25),
            Shape((leaf,), closed=False, stroke=DOOR, width=0.45),
        ]
    return tuple(marks)


def _openings(floor: Storey, placement: Placement) -> tuple[Mark, ...]:
    marks: list[Mark] = []
    for item in floor.openings:
        box = _box(item, floor, placement)
        faces = (box[[0, 1]], box[[3, 2]])
        marks += [
            Shape((box,), fill="#FFFFFF", id=item.id, title="opening"),
            Shape(faces, closed=False, stroke=QUIET, width=0.18, dash=(1.2, 0.8)),
        ]
    return tuple(marks)


def _windows(floor: Storey, placement: Placement) -> tuple[Mark, ...]:
    marks: list[Mark] = []
    for item in floor.windows:
        box = _box(item, floor, placement)
        glass = placement.on_paper(item.segment)
        marks += [
            Shape((box,), fill="#FFFFFF", stroke=GLASS, width=0.25, id=item.id, title="window"),
            Shape((glass,), closed=False, stroke=GLASS, width=0.25),
        ]
    return tuple(marks)


def _labels(floor: Storey, placement: Placement) -> tuple[tuple[Words, ...], list[str]]:
    """Names and areas of the rooms, and the line that tells what numbers in small ones mean."""
    marks: list[Words] = []
    small: list[str] = []
    for room in floor.rooms:
        area = _flat(_rings(room_area(room), placement))
        name, figure = printable(room.name), f"{room_area(room).area:.1f} m²"
        label = _fitted(area, name, figure)
        if label is None:
            small.append(f"{len(small) + 1} {name}, {figure}")
            label = RoomLabel(label_place(area), (str(len(small)),), _LABEL_PT[0])
        marks += _written(label)
    return tuple(marks), ["  ·  ".join(small)] if small else []


def _flat(rings: Sequence[FloatArray]) -> shapely.Geometry:
    """The area that rings enclose on paper."""
    area = shapely.Polygon()
    for ring in rings:
        area = area.symmetric_difference(shapely.Polygon(ring).buffer(0))
    return area


def _fitted(area: shapely.Geometry, name: str, figure: str) -> RoomLabel | None:
    """A label clear of the dimensions along the walls, or where it fits at all."""
    nothing = np.empty((0, 2))
    for inside in (area.buffer(-BAND), area):
        if not inside.is_empty:
            label = room_label(inside, name, figure, 1 / _MM_PER_PT, _LABEL_PT, nothing)
            if label is not None:
                return label
    return None


def _written(label: RoomLabel) -> list[Words]:
    size = label.size_pt * _MM_PER_PT
    x, y = label.position
    top = y - _LINE * size * (len(label.lines) - 1) / 2
    last = len(label.lines) - 1
    return [
        Words((float(x), float(top + k * _LINE * size)), line, size, bold=k < max(last, 1))
        for k, line in enumerate(label.lines)
    ]
