"""A plan drawn on matplotlib axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from panoplan.exporters.labels import (
    RoomLabel,
    label_place,
    printable,
    room_label,
    width_em,
)
from panoplan.exporters.storeys import room_area
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import FloorPlan, Room, Unit

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

ROOM_COLOURS = (
    "#A9D3E6", "#F7CBA4", "#C3E2B1", "#DCC6EC", "#FBE59B", "#F4B9B8",
    "#B4E0D2", "#C1CBF2", "#E0D0BA", "#D6E79F", "#F3C9E2", "#BFD2DA",
)  # fmt: skip
WALL_COLOUR = "#2B3038"
CORNER_COLOUR = "#D6336C"
PATH_COLOUR = "#2563A8"
WINDOW_COLOUR = "#4AA3DF"
DOOR_COLOUR = "#9A6B3F"
QUIET_COLOUR = "#5B636E"
FONT = "DejaVu Sans"

_MARGIN_PT = 22.0
_NOTE_LINES = 6


@dataclass(frozen=True)
class Shown:
    """What is drawn of a plan.

    Attributes:
        corners: dots on the rooms' corners.
        path: the cameras.
        labels: names and areas.
        footer: scale bar, totals and notes.
        note_lines: space kept for so many lines of notes, whether or not there is a footer, so
            that several drawings come out alike; None for as many as the notes need.
    """

    corners: bool = True
    path: bool = True
    labels: bool = True
    footer: bool = True
    note_lines: int | None = None


@dataclass(frozen=True, eq=False)
class Sheet:
    """How the plan lies on its axes.

    Attributes:
        low: (2,) least coordinates of what is drawn.
        high: (2,) greatest coordinates of what is drawn.
        points_per_unit: printer's points a plan unit.
        weight: factor of line widths and font sizes, 1 on a page of 10 inches.
    """

    low: FloatArray
    high: FloatArray
    points_per_unit: float
    weight: float

    def units(self, points: float) -> float:
        """Printer's points as a length in plan units."""
        return points / self.points_per_unit

    def points(self, units: float) -> float:
        """A length in plan units as printer's points."""
        return units * self.points_per_unit


def content_bounds(plan: FloorPlan) -> tuple[FloatArray, FloatArray]:
    """Least and greatest coordinates of all that a plan holds, (0, 0) and (1, 1) if nothing."""
    parts = [room.polygon for room in plan.rooms if room.polygon is not None]
    parts += [camera.position[None] for camera in plan.trajectory]
    parts += [item.segment for item in (*plan.doors, *plan.openings, *plan.windows)]
    if not parts:
        return np.zeros(2), np.ones(2)
    points = np.concatenate(parts)
    low, high = points.min(axis=0), points.max(axis=0)
    # A single camera has no extent of its own.
    grow = max(0.0, 1.0 - float((high - low).max())) / 2
    return low - grow, high + grow


def room_colours(rooms: Sequence[Room]) -> dict[str, str]:
    """A fill colour for each room with a polygon, different from those of its neighbours.

    Returns:
        Colours by room id.
    """
    shaped = [room for room in rooms if room.polygon is not None]
    areas = [room_area(room) for room in shaped]
    found: dict[str, str] = {}
    for k, (room, area) in enumerate(zip(shaped, areas, strict=True)):
        reach = 0.3 * float(np.sqrt(max(area.area, 0.0)))
        near = {found[shaped[j].id] for j in range(k) if areas[j].distance(area) <= reach}
        turns = [ROOM_COLOURS[(k + step) % len(ROOM_COLOURS)] for step in range(len(ROOM_COLOURS))]
        found[room.id] = next((colour for colour in turns if colour not in near), turns[0])
    return found


def draw_plan(
    axes: Axes,
    plan: FloorPlan,
    *,
    shown: Shown | None = None,
    colours: Mapping[str, str] | None = None,
    bounds: tuple[FloatArray, FloatArray] | None = None,
    title: str = "",
    points_per_unit: float | None = None,
) -> Sheet:
    """Draws a plan seen from above: first axis to the right, second up, both at one scale.

    The limits of the axes are set so that all of it fits; their frame and ticks are hidden.
    Rooms without a polygon are listed below; rooms too small for their name have a number.

    Args:
        axes: empty axes of a figure whose size is settled.
        plan: the plan, with or without rooms.
        shown: what is drawn; None for everything.
        colours: fill by room id, instead of those of `room_colours`.
        bounds: least and greatest coordinates to be shown, instead of the plan's own.
        title: text above the plan.
        points_per_unit: printer's points a plan unit, where the sheet is large enough for it;
            None for as large as fits.

    Returns:
        How the plan lies on the axes, for marks to be added.
    """
    shown = shown or Shown()
    low, high = content_bounds(plan) if bounds is None else bounds
    notes = _notes(plan) if shown.footer else []
    sheet, lines = _laid_out(axes, low, high, notes, shown, bool(title), points_per_unit)
    fills = room_colours(plan.rooms) if colours is None else colours
    labels, small = _room_labels(plan, sheet) if shown.labels else ([], [])
    if small and shown.footer:
        sheet, lines = _laid_out(
            axes, low, high, [*small, *notes], shown, bool(title), points_per_unit
        )
        labels, _ = _room_labels(plan, sheet)
    from panoplan.exporters.layers import add_layer

    layers: list[tuple[str, list[Artist]]] = [
        ("rooms", _fills(plan, fills)),
        ("walls", room_outlines(plan, sheet, WALL_COLOUR, 1.9)),
        ("openings", _segments(plan, sheet)),
    ]
    if shown.path:
        layers.append(("path", _path(plan, sheet)))
    if shown.corners:
        layers.append(("corners", _corners(plan, sheet)))
    if shown.labels:
        layers.append(("labels", [_label(label) for label in labels]))
    if shown.footer:
        told = _totals(plan)
        if points_per_unit is not None and plan.unit == "m":
            told += f"   1:{72.0 / 0.0254 / points_per_unit:.0f}"
        layers.append(("scale", _footer(plan.unit, sheet, told, lines)))
    if title:
        layers.append(("title", [_title(title, sheet)]))
    for order, (name, marks) in enumerate(layers):
        add_layer(axes, name, marks, order)
    return sheet


def draw_sheet(
    axes: Axes,
    bounds: tuple[FloatArray, FloatArray],
    unit: Unit,
    *,
    title: str = "",
    told: str = "",
    weight: float | None = None,
) -> Sheet:
    """Lays out axes as `draw_plan` does, with title and scale bar, for other marks than a plan's.

    Args:
        axes: empty axes of a figure whose size is settled.
        bounds: least and greatest coordinates to be shown.
        unit: of the coordinates.
        title: text above.
        told: text beside the scale bar.
        weight: factor of line widths and font sizes; None for that of a plan on these axes.

    Returns:
        How the plane lies on the axes.
    """
    from panoplan.exporters.layers import add_layer

    sheet, _ = _laid_out(axes, *bounds, [], Shown(), bool(title), weight=weight)
    add_layer(axes, "scale", _footer(unit, sheet, told, []), 20)
    if title:
        add_layer(axes, "title", [_title(title, sheet)], 21)
    return sheet


def plan_figure(plan: FloorPlan, *, long_side_in: float = 10.0) -> Figure:
    """A figure of a plan that is no larger than the plan needs.

    Args:
        plan: the plan.
        long_side_in: its longer side in inches.
    """
    low, high = content_bounds(plan)
    width, height = high - low
    # Never so narrow that scale bar and notes have no room.
    shape = np.array([max(width, 0.6 * height), max(height, 0.35 * width)]) + 0.08 * max(
        width, height
    )
    return _figure(plan, *(long_side_in * shape / shape.max()))


def scaled_figure(plan: FloorPlan, denominator: float) -> Figure:
    """A figure of a metric plan in which a metre is 1 / `denominator` of a metre.

    Args:
        plan: in metres.
        denominator: 100 for a scale of 1:100.
    """
    points_per_unit = 72.0 / 0.0254 / denominator
    low, high = content_bounds(plan)
    width, height = (high - low) * points_per_unit
    page = np.array([max(width, 240.0) + 2 * _MARGIN_PT, height + 2 * _MARGIN_PT])
    for _ in range(3):
        weight = _weight(*page)
        # As draw_plan lays it out: the footer's height depends on the notes, these on the size.
        sheet = Sheet(low, high, points_per_unit, weight)
        small = _room_labels(plan, sheet)[1]
        lines = _wrapped([*small, *_notes(plan)], page[0] - 2 * _MARGIN_PT, weight)
        page[1] = height + 2 * _MARGIN_PT + _footer_pt(len(lines), weight)
    return _figure(plan, float(page[0]) / 72.0, float(page[1]) / 72.0, points_per_unit)


def _figure(
    plan: FloorPlan, width_in: float, height_in: float, points_per_unit: float | None = None
) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_in, height_in), facecolor="white")
    draw_plan(figure.add_axes((0.0, 0.0, 1.0, 1.0)), plan, points_per_unit=points_per_unit)
    return figure


def _weight(width_pt: float, height_pt: float) -> float:
    return float(np.clip(max(width_pt, height_pt) / 720.0, 0.55, 1.3))


def _laid_out(
    axes: Axes,
    low: FloatArray,
    high: FloatArray,
    notes: list[str],
    shown: Shown,
    title: bool,
    points_per_unit: float | None = None,
    weight: float | None = None,
) -> tuple[Sheet, list[str]]:
    """Sets the limits of the axes and says how the plan lies in them."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    box = axes.get_window_extent()
    width, height = box.width * 72.0 / figure.dpi, box.height * 72.0 / figure.dpi
    weight = weight or _weight(width, height)
    margin = min(_MARGIN_PT, 0.06 * min(width, height))
    most = _NOTE_LINES if shown.note_lines is None else shown.note_lines
    lines = _wrapped(notes, width - 2 * margin, weight, most) if shown.footer else []
    below = 0.0
    if shown.footer or shown.note_lines is not None:
        below = _footer_pt(shown.note_lines or len(lines), weight)
    above = 18.0 * weight if title else 0.0
    room = np.array([width - 2 * margin, max(height - 2 * margin - below - above, 1.0)])
    scale = points_per_unit or float((room / np.maximum(high - low, 1e-9)).min())
    centre = (low + high) / 2
    bottom = (high - low)[1] * scale
    spare = (room[1] - bottom) / 2
    first = low[1] - (margin + spare + below) / scale
    axes.set_axis_off()
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlim(centre[0] - width / scale / 2, centre[0] + width / scale / 2)
    axes.set_ylim(first, first + height / scale)
    return Sheet(low, high, scale, weight), lines


def _footer_pt(lines: int, weight: float) -> float:
    return (34.0 + 10.5 * lines) * weight


def _wrapped(
    notes: Sequence[str], width_pt: float, weight: float, most: int = _NOTE_LINES
) -> list[str]:
    """Notes broken into lines of the page, the last saying if there are more than fit."""
    characters = max(20, int(width_pt / (6.5 * weight * 0.56)))
    lines = [line for note in notes for line in wrap(note, characters)]
    if len(lines) > most:
        lines = [*lines[: most - 1], f"… and {len(lines) - most + 1} more lines"]
    return lines


def _notes(plan: FloorPlan) -> list[str]:
    missing = [room for room in plan.rooms if room.polygon is None]
    if not missing:
        return []
    told = (
        f"{printable(room.name)} ({printable(room.failure or 'no shape found')})"
        for room in missing
    )
    return ["Without a shape: " + "; ".join(told) + "."]


def _area_text(area: float, plan: FloorPlan) -> str:
    return f"{area:.1f} m²" if plan.unit == "m" else f"{area:.2f} ch²"


def _room_labels(plan: FloorPlan, sheet: Sheet) -> tuple[list[RoomLabel], list[str]]:
    """Labels of the rooms, and the line that tells what the numbers in small rooms mean."""
    labels: list[RoomLabel] = []
    small: list[str] = []
    cameras = np.array([camera.position for camera in plan.trajectory]).reshape(-1, 2)
    sizes = (4.4 * sheet.weight, 9.0 * sheet.weight)
    for room in plan.rooms:
        area = room_area(room)
        if area.is_empty or area.area <= 0:
            continue
        name, figure = printable(room.name), _area_text(area.area, plan)
        label = room_label(area, name, figure, sheet.points_per_unit, sizes, cameras)
        if label is None:
            small.append(f"{len(small) + 1} {name}, {figure}")
            label = RoomLabel(label_place(area), (str(len(small)),), 6.0 * sheet.weight)
        labels.append(label)
    return labels, ["  ·  ".join(small)] if small else []


def outline_path(area: Any) -> Any:
    """A matplotlib path of an area with its holes."""
    from matplotlib.path import Path

    rings = [ring for part in shapely.get_parts(area) for ring in (part.exterior, *part.interiors)]
    return Path.make_compound_path(
        *(Path(shapely.get_coordinates(ring), closed=True) for ring in rings)
    )


def _shaped(plan: FloorPlan) -> list[tuple[Room, Any]]:
    areas = [(room, room_area(room)) for room in plan.rooms if room.polygon is not None]
    return [(room, area) for room, area in areas if not area.is_empty]


def _fills(plan: FloorPlan, colours: Mapping[str, str]) -> list[Artist]:
    from matplotlib.patches import PathPatch

    return [
        PathPatch(
            outline_path(area),
            facecolor=colours.get(room.id, "#E6E8EB"),
            edgecolor="none",
            gid=f"fill_{room.id}",
        )
        for room, area in _shaped(plan)
    ]


def room_outlines(plan: FloorPlan, sheet: Sheet, colour: str, width: float) -> list[Artist]:
    """The outlines of the rooms, `width` points wide on a sheet of weight 1."""
    from matplotlib.patches import PathPatch

    return [
        PathPatch(
            outline_path(area),
            facecolor="none",
            edgecolor=colour,
            linewidth=width * sheet.weight,
            joinstyle="miter",
            gid=f"outline_{room.id}",
        )
        for room, area in _shaped(plan)
    ]


def _segments(plan: FloorPlan, sheet: Sheet) -> list[Artist]:
    from matplotlib.collections import LineCollection

    found: list[Artist] = []
    # A door goes through both faces of a shared wall.
    through = {frozenset(wall.walls): sheet.points(wall.thickness) for wall in plan.shared_walls}
    kinds = (
        ("doors", plan.doors, DOOR_COLOUR, "solid"),
        ("passages", plan.openings, QUIET_COLOUR, (0, (2.0, 1.5))),
        ("windows", plan.windows, WINDOW_COLOUR, "solid"),
    )
    for name, items, colour, style in kinds:
        if not items:
            continue
        gaps = [3.4 * sheet.weight + through.get(frozenset(item.walls), 0.0) for item in items]
        for widths, ink, dash in (
            (gaps, "white", "solid"),
            ([1.3 * sheet.weight] * len(items), colour, style),
        ):
            lines = LineCollection(
                [item.segment for item in items],
                colors=ink,
                linewidths=widths,
                linestyles=[dash],
                capstyle="butt",
            )
            lines.set_gid(name if ink != "white" else f"{name}_gap")
            found.append(lines)
    return found


def _path(plan: FloorPlan, sheet: Sheet) -> list[Artist]:
    from matplotlib.lines import Line2D

    if not plan.trajectory:
        return []
    places = np.array([camera.position for camera in plan.trajectory])
    x, y = places.T
    of_room = {room.id: room.level for room in plan.rooms}
    on = np.array([of_room.get(camera.room or "", 0) for camera in plan.trajectory])
    # Storeys lie beside one another; no line joins them.
    way = np.insert(places, np.flatnonzero(np.diff(on)) + 1, np.nan, axis=0)
    line = Line2D(*way.T, color=PATH_COLOUR, linewidth=0.7 * sheet.weight, alpha=0.55)
    size = float(np.clip(3.4 - 0.004 * len(x), 1.6, 3.4)) * sheet.weight
    dots = Line2D(
        x,
        y,
        color=PATH_COLOUR,
        linestyle="none",
        marker="o",
        markersize=size,
        markeredgecolor="white",
        markeredgewidth=0.3 * sheet.weight,
    )
    line.set_gid("path_line")
    dots.set_gid("path_cameras")
    return [line, dots]


def _corners(plan: FloorPlan, sheet: Sheet) -> list[Artist]:
    from matplotlib.lines import Line2D

    rings = [
        ring
        for room in plan.rooms
        if room.polygon is not None
        for ring in (room.polygon, *room.holes)
    ]
    if not rings:
        return []
    x, y = np.concatenate(rings).T
    return [
        Line2D(
            x,
            y,
            linestyle="none",
            marker="o",
            markersize=3.8 * sheet.weight,
            markerfacecolor=CORNER_COLOUR,
            markeredgecolor="white",
            markeredgewidth=0.45 * sheet.weight,
        )
    ]


def plan_text(x: float, y: float, text: str, size: float, colour: str, **place: Any) -> Text:
    """Text that is never markup, at (x, y) in data units; `place` as matplotlib's Text has it."""
    from matplotlib.text import Text

    return Text(x, y, text, fontsize=size, color=colour, fontfamily=FONT, parse_math=False, **place)


def _label(label: RoomLabel) -> Text:
    x, y = label.position
    text = plan_text(
        x,
        y,
        "\n".join(label.lines),
        label.size_pt,
        WALL_COLOUR,
        ha="center",
        va="center",
        multialignment="center",
        linespacing=1.15,
    )
    text.set_bbox(
        {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.72}
    )
    return text


def _title(title: str, sheet: Sheet) -> Text:
    x = (sheet.low[0] + sheet.high[0]) / 2
    y = sheet.high[1] + sheet.units(9.0 * sheet.weight)
    return plan_text(
        x, y, printable(title), 11.0 * sheet.weight, WALL_COLOUR, ha="center", va="bottom"
    )


def footer_left(sheet: Sheet) -> float:
    """Where a footer begins: below the plan's left edge, or further left below a narrow plan."""
    least = sheet.units(220.0 * sheet.weight)
    centre = float(sheet.low[0] + sheet.high[0]) / 2
    return min(float(sheet.low[0]), centre - least / 2)


def bar_length(extent: float) -> float:
    """A round length (1, 2 or 5 times a power of ten) of a tenth to a quarter of an extent."""
    goal = extent / 4
    power = 10.0 ** np.floor(np.log10(goal))
    return float(max(step * power for step in (1, 2, 5) if step * power <= goal))


def unit_name(unit: Unit, length: float) -> str:
    """What a length in plan units is followed by."""
    return "m" if unit == "m" else "camera height" if length == 1 else "camera heights"


def _footer(unit: Unit, sheet: Sheet, totals: str, lines: Sequence[str]) -> list[Artist]:
    left = footer_left(sheet)
    bar = float(sheet.low[1]) - sheet.units(20.0 * sheet.weight)
    marks = _scale_bar(unit, sheet, (left, bar), totals)
    for k, line in enumerate(lines):
        y = bar - sheet.units((14.0 + 10.5 * k) * sheet.weight)
        marks.append(
            plan_text(left, y, line, 6.5 * sheet.weight, QUIET_COLOUR, ha="left", va="top")
        )
    return marks


def _scale_bar(unit: Unit, sheet: Sheet, place: tuple[float, float], totals: str) -> list[Artist]:
    """A bar of two fields, its length beside it, and the totals."""
    from matplotlib.patches import Rectangle

    (left, y), size = place, 7.5 * sheet.weight
    length = bar_length(float((sheet.high - sheet.low).max()))
    height = sheet.units(4.0 * sheet.weight)
    marks: list[Artist] = [
        Rectangle(
            (left + k * length / 2, y),
            length / 2,
            height,
            facecolor=colour,
            edgecolor=WALL_COLOUR,
            linewidth=0.7 * sheet.weight,
        )
        for k, colour in enumerate((WALL_COLOUR, "white"))
    ]
    told = f"{length:g} {unit_name(unit, length)}"
    start = left + length + sheet.units(6.0 * sheet.weight)
    middle = y + height / 2
    marks.append(plan_text(start, middle, told, size, WALL_COLOUR, ha="left", va="center"))
    end = start + sheet.units(size * (width_em(told) + 2.0))
    marks.append(plan_text(end, middle, totals, size, QUIET_COLOUR, ha="left", va="center"))
    return marks


def _totals(plan: FloorPlan) -> str:
    areas = [float(area.area) for _, area in _shaped(plan)]
    if not areas:
        return "no room found" if plan.trajectory else "nothing found"
    rooms = "1 room" if len(areas) == 1 else f"{len(areas)} rooms"
    return f"{rooms}, {_area_text(sum(areas), plan)}"
