"""A plan as DXF: metres, AIA layers, closed rooms, real dimensions."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from panoplan.errors import MissingExtraError
from panoplan.exporters.labels import RoomLabel, label_place, printable, room_label
from panoplan.exporters.sheet.dimensions import wall_length
from panoplan.exporters.storeys import (
    Storey,
    aperture_area,
    by_faces,
    inner_walls,
    metric_storeys,
    room_area,
    through,
)
from panoplan.types.plan import Aperture, FloorPlan, Room

if TYPE_CHECKING:
    from ezdxf.document import Drawing

LAYERS = {
    "A-WALL": 7,
    "A-WALL-PATT": 8,
    "A-DOOR": 30,
    "A-FLOR-OPNG": 9,
    "A-GLAZ": 5,
    "A-AREA": 3,
    "A-AREA-IDEN": 7,
    "A-ANNO-DIMS": 8,
}
"""Layers by the AIA CAD layer guidelines and their colours (AutoCAD colour index)."""

_METRES = 6
_BY_LAYER = 256
_SYMBOL_M = 0.05
_NAME_EM_M = (0.06, 0.2)
"""Font sizes of rooms' names, least and largest; capitals are 0.7 as high."""

_CAPITAL_EM = 0.7


@dataclass(frozen=True)
class _Lettering:
    """A dimension style: heights and distances in metres."""

    style: str
    text: float
    offset: float

    @property
    def band(self) -> float:
        """How far from a wall its dimension reaches."""
        return self.offset + self.text


_LARGE = _Lettering("PANOPLAN", 0.10, 0.15)
_SMALL = _Lettering("PANOPLAN-SMALL", 0.045, 0.07)
"""For rooms whose name would have no space between dimensions of the other."""


def plan_dxf(plan: FloorPlan) -> bytes:
    """A plan as DXF R2018 in metres, in the plan frame; the same plan gives the same bytes.

    Each room is a closed LWPOLYLINE (holes too) on A-AREA with its name and area on A-AREA-IDEN,
    each wall face a LINE on A-WALL with an aligned DIMENSION (in small rooms of the style
    PANOPLAN-SMALL, else PANOPLAN), the bodies of shared walls, less their doors and openings, a
    HATCH on A-WALL-PATT, doors, openings and windows closed LWPOLYLINEs through their wall. A plan
    of several storeys has a set of layers for each, ending in -L0, -L1.

    Raises:
        InputError: not metric or without rooms; MissingExtraError: ezdxf is not installed.
    """
    try:
        import ezdxf
    except ImportError:
        raise MissingExtraError("DXF", "ezdxf", "export") from None

    floors = metric_storeys(plan)
    with _reproducible():
        document = ezdxf.new("R2018", units=_METRES)
        for lettering in (_LARGE, _SMALL):
            _dimension_style(document, lettering)
        for floor in floors:
            _draw(document, floor, "" if len(floors) == 1 else f"-L{floor.level}")
        stream = io.StringIO()
        document.write(stream)
    return stream.getvalue().encode("utf-8")


@contextmanager
def _reproducible() -> Iterator[None]:
    """Keeps clocks and random ids out of the file."""
    import ezdxf

    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def _dimension_style(document: Drawing, lettering: _Lettering) -> None:
    style: Any = document.dimstyles.new(lettering.style)
    style.set_tick(size=0.4 * lettering.text)
    style.dxf.dimtxt = lettering.text
    style.dxf.dimgap = 0.2 * lettering.text
    style.dxf.dimexe = 0.0
    style.dxf.dimexo = 0.0
    style.dxf.dimse1 = style.dxf.dimse2 = 1
    style.dxf.dimclrd = style.dxf.dimclrt = _BY_LAYER
    style.dxf.dimdec = 2
    style.dxf.dimdsep = ord(".")
    style.dxf.dimzin = 0
    style.dxf.dimtad = 0
    style.dxf.dimtih = style.dxf.dimtoh = 0


def _draw(document: Drawing, floor: Storey, suffix: str) -> None:
    for layer, colour in LAYERS.items():
        document.layers.add(layer + suffix, color=colour)
    space = document.modelspace()

    def on(layer: str) -> dict[str, Any]:
        return {"layer": layer + suffix}

    shared = by_faces(floor)

    def box(item: Aperture) -> Any:
        return aperture_area(item, max(through(item, shared), _SYMBOL_M))

    # A little more than the doors, so that no slivers stay.
    doors = shapely.union_all([box(door).buffer(0.01, join_style="mitre") for door in floor.doors])
    solid = inner_walls(floor).difference(doors)
    for part in shapely.get_parts(solid):
        if isinstance(part, shapely.Polygon) and not part.is_empty:
            hatch = space.add_hatch(color=_BY_LAYER, dxfattribs=on("A-WALL-PATT"))
            for number, ring in enumerate((part.exterior, *part.interiors)):
                flags = 1 if number == 0 else 16
                hatch.paths.add_polyline_path(_points(ring), is_closed=True, flags=flags)
    for room in floor.rooms:
        _draw_room(space, room, on)
    kinds: tuple[tuple[str, tuple[Aperture, ...]], ...] = (
        ("A-DOOR", floor.doors),
        ("A-FLOR-OPNG", floor.openings),
        ("A-GLAZ", floor.windows),
    )
    for layer, items in kinds:
        for item in items:
            ring = _points(box(item).exterior)
            space.add_lwpolyline(ring, close=True, dxfattribs=on(layer))


def _draw_room(space: Any, room: Room, on: Any) -> None:
    area = room_area(room)
    for part in shapely.get_parts(area):
        for ring in (part.exterior, *part.interiors):
            space.add_lwpolyline(_points(ring), close=True, dxfattribs=on("A-AREA"))
    label, lettering = _label(area, plain(room.name))
    height = _CAPITAL_EM * label.size_pt
    x, y = label.position
    for line, text in enumerate(label.lines):
        words = space.add_text(text, height=height, dxfattribs=on("A-AREA-IDEN"))
        words.set_placement((x, y + (0.8 - 1.6 * line) * height), align=_middle())
    for wall in room.walls:
        space.add_line(wall.a, wall.b, dxfattribs=on("A-WALL"))
        if wall_length(wall) < 1e-6:
            continue
        # From left to right, so that its text reads from below; inside the room all the same.
        rightwards = tuple(wall.a - wall.b) < (0.0, 0.0)
        ends = (wall.a, wall.b) if rightwards else (wall.b, wall.a)
        made = space.add_aligned_dim(
            p1=tuple(ends[0]),
            p2=tuple(ends[1]),
            distance=lettering.offset if rightwards else -lettering.offset,
            dimstyle=lettering.style,
            dxfattribs=on("A-ANNO-DIMS"),
        )
        made.render()


def _label(area: Any, name: str) -> tuple[RoomLabel, _Lettering]:
    """A room's name and area, clear of its dimensions where it can be, and their lettering."""
    figure, nothing = f"{area.area:.2f} m²", np.empty((0, 2))
    for lettering, band in ((_LARGE, _LARGE.band), (_SMALL, _SMALL.band), (_SMALL, 0.0)):
        inside = area.buffer(-band)
        least = _NAME_EM_M[1] / 2 if lettering is _LARGE else _NAME_EM_M[0]
        if not inside.is_empty:
            sizes = (least, _NAME_EM_M[1])
            label = room_label(inside, name, figure, 1.0, sizes, nothing, wrap=False)
            if label is not None:
                return label, lettering
    return RoomLabel(label_place(area), (name, figure), _NAME_EM_M[0]), _SMALL


def _middle() -> Any:
    from ezdxf.enums import TextEntityAlignment

    return TextEntityAlignment.MIDDLE_CENTER


def _points(ring: Any) -> Any:
    return np.asarray(shapely.get_coordinates(ring))[:-1].tolist()


def plain(text: str) -> str:
    """A printable name without what DXF takes for codes: %%c, ^J, \\U+00B2."""
    apart = re.sub("%(?=%)", "% ", printable(text))
    apart = re.sub(r"\^(?! )", "^ ", apart)
    return re.sub(r"\\(?=[UuMm]\+)", "/", apart)
