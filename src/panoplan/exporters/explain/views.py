"""Which views are of one room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from panoplan.exporters.drawing import FONT, QUIET_COLOUR, WALL_COLOUR, draw_sheet, room_colours
from panoplan.exporters.explain.marks import (
    CONTEXT_COLOUR,
    FRAME_COLOUR,
    INK,
    bounds_of,
    colour_map,
    dots,
    lines_of,
    path_of,
    put,
)
from panoplan.exporters.explain.page import (
    WEIGHT,
    axes_at,
    blank_page,
    dot,
    heading,
    legend,
    stroke,
    swatch,
)
from panoplan.types.explain import ExplainedRoom, Explanation, Grouping
from panoplan.types.plan import Room

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure


def views_figure(explanation: Explanation, grouping: Grouping) -> Figure:
    """What each view sees, in its room's colour, and the common areas that they are grouped by."""
    config = explanation.config.grouping
    views = [explanation.views[k] for k in grouping.views]
    bounds = bounds_of(
        [view.boundary[np.isfinite(view.boundary[:, 0])] for view in views], share=0.01
    )
    side, rim = 6.6, 1.1
    width, height = bounds[1] - bounds[0]
    wide = float(np.clip(side * width / height, 6.0, 9.5))
    figure = blank_page(wide + side + rim, side)
    doors = sum(view.doorway for view in views)
    heading(
        figure,
        "Views grouped into rooms" + (f", level {grouping.level}" if _several(explanation) else ""),
        "Left, the boundary that each keyframe sees, in the colour of its room. Right, common "
        "area of each two views over that of the smaller: views are linked while its mean is at "
        f"least {config.min_overlap:g}, then groups joined or dissolved by what they see. "
        f"{len(views)} views, {doors} of them from a doorway.",
    )
    fills = _fills(explanation.rooms)
    axes = axes_at(figure, (0.0, 0.0), (wide, side))
    sheet = draw_sheet(axes, bounds, explanation.unit, weight=WEIGHT)
    put(axes, sheet, "rooms", _room_fills(explanation, grouping.level, fills), 1)
    marks: list[Artist] = []
    for view in views:
        ink = _stronger(fills.get(view.room, CONTEXT_COLOUR))
        marks.append(lines_of([view.boundary], ink, 0.8 * sheet.weight, 0.75))
    marks += path_of([view for view in explanation.views if view.level == grouping.level], sheet)
    for view in views:
        ink = _stronger(fills.get(view.room, CONTEXT_COLOUR))
        face, edge = ("white", ink) if view.doorway else (ink, "white")
        marks.append(dots([view.camera], sheet, face, edge, 5.0))
    put(axes, sheet, "views", marks, 2)
    _draw_overlaps(figure, explanation, grouping, (wide + rim, 0.3), side - 0.6)
    legend(
        figure,
        [
            stroke("boundary of a view", QUIET_COLOUR),
            dot("view", QUIET_COLOUR, "white"),
            dot("view from a doorway", "white", QUIET_COLOUR),
            *(
                swatch(f"common area {share:g}", colour_map(INK)(0.8 * share))
                for share in (0, 0.5, 1)
            ),
        ],
    )
    return figure


def _several(explanation: Explanation) -> bool:
    return len(explanation.groupings) > 1


def _draw_overlaps(
    figure: Figure,
    explanation: Explanation,
    grouping: Grouping,
    corner: tuple[float, float],
    side: float,
) -> None:
    """The matrix of common areas with a line between rooms, their names where they fit."""
    count = len(grouping.views)
    axes = axes_at(figure, corner, (side, side))
    axes.imshow(
        grouping.overlaps,
        cmap=colour_map(INK),
        vmin=0.0,
        vmax=1.25,
        interpolation="nearest",
        extent=(0, count, count, 0),
    )
    names = {room.id: room.name for room in explanation.rooms}
    ids = [explanation.views[k].room for k in grouping.views]
    start, ticks = 0, []
    for room, members in groupby(ids):
        stop = start + len(list(members))
        for line in (axes.axhline, axes.axvline):
            line(stop, color=FRAME_COLOUR, linewidth=0.8)
        block = [start, stop, stop, start, start], [start, start, stop, stop, start]
        axes.plot(*block, color=WALL_COLOUR, linewidth=0.9)
        if (stop - start) * side * 72 / count > 7.5:
            ticks.append(((start + stop) / 2, names[room]))
        start = stop
    doors = [k + 0.5 for k, view in enumerate(grouping.views) if explanation.views[view].doorway]
    size = float(np.clip(0.5 * side * 72 / count, 1.5, 5.0))
    axes.plot(
        doors,
        doors,
        linestyle="none",
        marker="o",
        markersize=size,
        markerfacecolor="white",
        markeredgecolor=QUIET_COLOUR,
    )
    axes.set_xlim(0, count)
    axes.set_ylim(count, 0)
    axes.set_xticks([])
    axes.set_yticks([at for at, _ in ticks], [name for _, name in ticks])
    axes.tick_params(length=0, labelsize=7, labelfontfamily=FONT, labelcolor=WALL_COLOUR)
    for spine in axes.spines.values():
        spine.set_color(FRAME_COLOUR)


def _stronger(colour: str) -> Any:
    """The same hue as a fill, for lines."""
    from matplotlib.colors import hsv_to_rgb, rgb_to_hsv, to_rgb

    hue, saturation, _ = rgb_to_hsv(to_rgb(colour))
    return tuple(hsv_to_rgb((hue, min(1.0, 0.25 + 2.0 * saturation), 0.62)).tolist())


def _fills(rooms: Sequence[ExplainedRoom]) -> dict[str, str]:
    """The colours that the plan's rooms have."""
    return room_colours([Room(room.id, room.name, room.polygon, None, ()) for room in rooms])


def _room_fills(explanation: Explanation, level: int, fills: Mapping[str, str]) -> list[Artist]:
    from matplotlib.patches import Polygon

    there = {view.room for view in explanation.views if view.level == level}
    return [
        Polygon(room.polygon, facecolor=fills[room.id], edgecolor="none", alpha=0.45)
        for room in explanation.rooms
        if room.polygon is not None and room.id in there
    ]
