"""A plan beside the true one, and the two on top of one another."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from panoplan.exporters.drawing import (
    WALL_COLOUR,
    Sheet,
    Shown,
    content_bounds,
    draw_plan,
    footer_left,
    outline_path,
    plan_text,
    room_colours,
    room_outlines,
)
from panoplan.exporters.labels import width_em
from panoplan.exporters.layers import add_layer
from panoplan.exporters.pictures import write_picture
from panoplan.exporters.storeys import room_area, spread, spread_pitch
from panoplan.metrics.alignment import Freedom, transformed
from panoplan.metrics.levels import camera_levels
from panoplan.metrics.report import Report, RoomsKind, evaluate
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Aperture, FloorPlan, PlanPose, Room, ScaleEstimate
from panoplan.types.truth import GroundTruth, TruePlan, TrueRoom

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

UNMATCHED_COLOUR = "#D5D8DC"
BOTH_COLOUR = "#E4E7EA"
MISSED_COLOUR = "#8FB8DE"
EXTRA_COLOUR = "#F2A97E"
TRUE_COLOUR = "#1D4E89"
PREDICTED_COLOUR = "#C2410C"

_PANEL_IN = 4.4
_NOTE_LINES = 3
_CAPTION_IN = 0.55
_TITLE_IN = 0.8


def true_plan(truth: GroundTruth, rooms: RoomsKind = "rooms") -> FloorPlan:
    """The truth as a plan, to be drawn like one.

    Args:
        truth: the truth.
        rooms: complete rooms, or those split at openings.
    """
    plan, walked = truth.plan, truth.trajectory
    true_rooms: tuple[TrueRoom, ...] = getattr(plan, rooms)
    cameras: tuple[PlanPose, ...] = ()
    if walked is not None:
        positions = walked.translations[:, [0, 2]]
        on = [0] * len(positions)
        if plan.levels is not None:
            on = camera_levels(walked.translations, plan.levels).tolist()
        cameras = tuple(
            PlanPose(label, position, 0.0, _room_of(true_rooms, level))
            for label, position, level in zip(walked.labels, positions, on, strict=True)
        )
    return FloorPlan(
        unit="m",
        level_rotation=np.eye(3),
        scale=ScaleEstimate(None, "given"),
        camera_height_m=plan.camera_height_m,
        rooms=tuple(
            Room(
                room.id,
                room.label or room.id,
                room.polygon,
                None,
                (),
                holes=room.holes,
                level=room.level,
            )
            for room in true_rooms
        ),
        trajectory=cameras,
        doors=_apertures("door", plan, true_rooms),
        openings=_apertures("opening", plan, true_rooms),
        windows=_apertures("window", plan, true_rooms),
    )


def _apertures(kind: str, plan: TruePlan, rooms: tuple[TrueRoom, ...]) -> tuple[Aperture, ...]:
    segments: tuple[FloatArray, ...] = getattr(plan, f"{kind}s")
    on: tuple[int, ...] = getattr(plan.levels, f"{kind}s", ()) or (0,) * len(segments)
    return tuple(
        Aperture(f"{kind}_{k + 1:02d}", segment, (_room_of(rooms, level),))
        for k, (segment, level) in enumerate(zip(segments, on, strict=True))
    )


def _room_of(rooms: tuple[TrueRoom, ...], level: int) -> str:
    """Any room of a storey: it says on which a camera or an aperture is."""
    return next((room.id for room in rooms if room.level == level), rooms[0].id)


def draw_comparison(
    plan: FloorPlan,
    truth: GroundTruth,
    *,
    rooms: RoomsKind = "rooms",
    align: Freedom = "scale",
) -> Figure:
    """A figure of three panels at one scale: truth, prediction, and both on top of one another.

    Matched rooms (IoU 0.5 or more) have the colour of their true room, other predictions are
    grey. In the overlay blue is missed, orange is too much.

    Args:
        plan: the prediction, with or without rooms.
        truth: the truth.
        rooms: complete true rooms, or those split at openings.
        align: how the plan is brought onto the truth.

    Raises:
        InputError: as `evaluate`.

    Source: Fig. 5 of the paper.
    """
    report = evaluate(plan, truth, rooms=rooms, align=align)
    moved = transformed(plan, report.alignment.true_from_plan)
    true = true_plan(truth, rooms)
    if truth.plan.levels is not None:
        pitch = max(spread_pitch(true), spread_pitch(moved))
        true, moved = spread(true, pitch), spread(moved, pitch)
    bounds = _common_bounds(true, moved)
    figure, (left, middle, right) = _panels(bounds)
    true_colours = room_colours(true.rooms)
    shown = Shown(note_lines=_NOTE_LINES)
    draw_plan(left, true, shown=shown, colours=true_colours, bounds=bounds, title="Truth")
    colours = {pair.predicted: true_colours[pair.true] for pair in report.rooms.pairs}
    grey = {room.id: UNMATCHED_COLOUR for room in moved.rooms}
    draw_plan(
        middle, moved, shown=shown, colours={**grey, **colours}, bounds=bounds, title="Prediction"
    )
    _draw_overlay(right, true, moved, bounds)
    _caption(figure, report)
    return figure


def write_comparison(
    path: Path,
    plan: FloorPlan,
    truth: GroundTruth,
    *,
    rooms: RoomsKind = "rooms",
    align: Freedom = "scale",
) -> None:
    """Writes the comparison as PNG or SVG, by the path's suffix.

    Raises:
        InputError: another suffix, a place that cannot be written, or as `evaluate`.
    """
    write_picture(path, draw_comparison(plan, truth, rooms=rooms, align=align), 3600)


def _common_bounds(true: FloorPlan, moved: FloorPlan) -> tuple[FloatArray, FloatArray]:
    lows, highs = zip(content_bounds(true), content_bounds(moved), strict=True)
    return np.minimum(*lows), np.maximum(*highs)


def _panels(bounds: tuple[FloatArray, FloatArray]) -> tuple[Figure, list[Axes]]:
    """Three axes in a row, or one above the other for a long and flat plan."""
    from matplotlib.figure import Figure

    width, height = bounds[1] - bounds[0]
    ratio = float(np.clip(height / max(width, 1e-9), 0.3, 2.2))
    beside = ratio > 0.45
    columns, rows = (3, 1) if beside else (1, 3)
    panel = np.array([_PANEL_IN, _PANEL_IN * ratio + _TITLE_IN])
    if not beside:
        panel = np.array([1.8 * _PANEL_IN, 1.8 * _PANEL_IN * ratio + _TITLE_IN])
    size = panel * (columns, rows) + (0.0, _CAPTION_IN)
    figure = Figure(figsize=(float(size[0]), float(size[1])), facecolor="white")
    w, h = panel / size
    axes = [
        figure.add_axes((w * (k % columns), 1.0 - h * (k // columns + 1), w, h)) for k in range(3)
    ]
    return figure, axes


def _draw_overlay(
    axes: Axes, true: FloorPlan, moved: FloorPlan, bounds: tuple[FloatArray, FloatArray]
) -> None:
    """What both have in grey, what only one has in colour, and both outlines."""
    from matplotlib.patches import PathPatch

    nothing = Shown(corners=False, path=False, labels=False, footer=False, note_lines=_NOTE_LINES)
    empty = replace(true, rooms=(), trajectory=(), doors=(), openings=(), windows=())
    sheet = draw_plan(axes, empty, shown=nothing, bounds=bounds, title="Overlay")
    floor, ours = _floor(true), _floor(moved)
    parts = (
        (floor.intersection(ours), BOTH_COLOUR, "both"),
        (floor.difference(ours), MISSED_COLOUR, "missed"),
        (ours.difference(floor), EXTRA_COLOUR, "extra"),
    )
    fills: list[Artist] = [
        PathPatch(outline_path(area), facecolor=colour, edgecolor="none", gid=name)
        for area, colour, name in parts
        if area.area > 0
    ]
    add_layer(axes, "overlay", fills, 10)
    add_layer(axes, "true_outlines", room_outlines(true, sheet, TRUE_COLOUR, 1.0), 11)
    add_layer(axes, "predicted_outlines", room_outlines(moved, sheet, PREDICTED_COLOUR, 1.3), 12)
    add_layer(axes, "predicted_corners", _dots(moved, sheet), 13)
    _legend(axes, sheet)


def _floor(plan: FloorPlan) -> Any:
    areas = [room_area(room) for room in plan.rooms if room.polygon is not None]
    return shapely.union_all(areas)


def _dots(plan: FloorPlan, sheet: Sheet) -> list[Artist]:
    from matplotlib.lines import Line2D

    rings = [room.polygon for room in plan.rooms if room.polygon is not None]
    if not rings:
        return []
    x, y = np.concatenate(rings).T
    size = 2.6 * sheet.weight
    return [Line2D(x, y, linestyle="none", marker="o", markersize=size, color=PREDICTED_COLOUR)]


def _legend(axes: Axes, sheet: Sheet) -> None:
    """Says what the colours of the overlay mean, on two lines below the plan."""
    fills = (("in both", BOTH_COLOUR), ("missed", MISSED_COLOUR), ("too much", EXTRA_COLOUR))
    lines = (("true outline", TRUE_COLOUR), ("predicted outline", PREDICTED_COLOUR))
    marks: list[Artist] = []
    for row, entries in enumerate((fills, lines)):
        y = float(sheet.low[1]) - sheet.units((18.0 + 14.0 * row) * sheet.weight)
        marks += _legend_row(sheet, y, entries, filled=row == 0)
    add_layer(axes, "legend", marks, 14)


def _legend_row(
    sheet: Sheet, y: float, entries: tuple[tuple[str, str], ...], *, filled: bool
) -> list[Artist]:
    from matplotlib.patches import Rectangle

    size = 8.0 * sheet.weight
    side, x = sheet.units(size), footer_left(sheet)
    marks: list[Artist] = []
    for name, colour in entries:
        marks.append(
            Rectangle(
                (x, y - side / 2),
                side,
                side,
                facecolor=colour if filled else "white",
                edgecolor="none" if filled else colour,
                linewidth=1.3 * sheet.weight,
            )
        )
        marks.append(plan_text(x + 1.4 * side, y, name, size, WALL_COLOUR, ha="left", va="center"))
        x += side * (2.8 + width_em(name))
    return marks


def _caption(figure: Figure, report: Report) -> None:
    """The figures that matter most, below the panels."""
    score = report.rooms.scores[1]
    visited = report.rooms.scores_visited
    corner = report.corners.true_to_predicted.median_cm
    told = [f"{score.hits} of {score.true} rooms at IoU {score.iou}"]
    if visited is not None:
        told.append(f"{visited[1].hits} of {visited[1].true} visited rooms")
    told.append(f"floor IoU {report.rooms.floor_iou:.2f}")
    if corner is not None:
        told.append(f"corners {corner:.0f} cm (median)")
    if report.rooms.area_error_median_percent is not None:
        told.append(f"area {report.rooms.area_error_median_percent:+.1f} % (median)")
    text = plan_text(
        0.5,
        0.28 * _CAPTION_IN / float(figure.get_size_inches()[1]),
        "   ·   ".join(told),
        8.5,
        WALL_COLOUR,
        ha="center",
        va="bottom",
    )
    text.set_transform(figure.transFigure)
    figure.add_artist(text)
