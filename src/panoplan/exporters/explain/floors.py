"""Rooms by fusion: signed distance, cut outline, walls fitted and placed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from panoplan.exporters.drawing import CORNER_COLOUR, WALL_COLOUR
from panoplan.exporters.explain.marks import bounds_of, colour_map, dots, image_of, put, ring_of
from panoplan.exporters.explain.page import (
    camera_height,
    dot,
    legend,
    length_text,
    room_page,
    room_sheet,
    stroke,
    swatch,
)
from panoplan.types.explain import ExplainedRoom, Explanation

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

FITTED_COLOUR = CORNER_COLOUR
_SIGNED = ("#E0935F", "#F6DCC6", "#FFFFFF", "#CFE2F1", "#8FBBDF")


def floors_figure(explanation: Explanation, rooms: Sequence[ExplainedRoom]) -> Figure:
    """The fused signed distance of each room, its cut zero line, the walls fitted and placed."""
    reach = explanation.config.fusion.truncation_ch * camera_height(explanation)
    figure, panels = room_page(
        rooms,
        3,
        4.3,
        "Fused floors and their walls",
        "Signed distance to the boundary, fused over the room's views and truncated at "
        f"{length_text(reach, explanation.unit)}, less the strongest other room's. Its zero line "
        "is cut into straight pieces, walls are fitted to the raw columns near each, and the rooms "
        "made one plan.",
    )
    colours = colour_map(_SIGNED)
    for axes, room in panels:
        assert room.floor is not None
        floor = room.floor
        views = explanation.views_of(room)
        rings = [ring for ring in (floor.fitted, room.polygon) if ring is not None]
        bounds = bounds_of([*floor.pieces, *rings], margin=1.2 * reach)
        sheet = room_sheet(axes, bounds, explanation.unit, room, _sigma_text(room, explanation))
        columns = np.concatenate([view.boundary for view in views] or [np.empty((0, 2))])
        cuts = [piece[0] for piece in floor.pieces]
        marks: list[Artist] = [
            image_of(axes, floor.distance, colours, -reach, reach),
            dots(columns, sheet, WALL_COLOUR, "none", 0.7, alpha=0.35),
            ring_of(np.concatenate(floor.pieces), WALL_COLOUR, 0.8 * sheet.weight),
            dots(cuts, sheet, "white", WALL_COLOUR, 3.6),
        ]
        if floor.fitted is not None:
            marks.append(ring_of(floor.fitted, FITTED_COLOUR, 1.5 * sheet.weight))
        if room.polygon is not None:
            marks.append(ring_of(room.polygon, _PLACED_COLOUR, 1.5 * sheet.weight, (0, (3, 3))))
        put(axes, sheet, "floor", marks, 1)
    away = length_text(reach, explanation.unit)
    legend(
        figure,
        [
            swatch(f"{away} outside", colours(0.0)),
            swatch(f"{away} inside", colours(1.0)),
            dot("raw column", WALL_COLOUR, "none", 2.0),
            stroke("zero line", WALL_COLOUR),
            dot("where it is cut", "white", WALL_COLOUR),
            stroke("walls fitted", FITTED_COLOUR),
            stroke("in the plan", _PLACED_COLOUR, (0, (3, 2))),
        ],
    )
    return figure


_PLACED_COLOUR = "#1D4E89"


def _sigma_text(room: ExplainedRoom, explanation: Explanation) -> str:
    assert room.floor is not None
    if room.floor.fitted is None:
        return room.failure or "no shape"
    told = f"{len(room.floor.fitted)} walls"
    sigmas = room.floor.sigmas
    known = np.empty(0) if sigmas is None else sigmas[np.isfinite(sigmas)]
    if not len(known):
        return told
    middle = float(np.median(known))
    figure = f"{100 * middle:.1f} cm" if explanation.unit == "m" else f"{middle:.3f} camera heights"
    return f"{told}, fitted to ± {figure}"
