"""The density of each room with the camera path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from panoplan.exporters.drawing import CORNER_COLOUR, QUIET_COLOUR, WALL_COLOUR
from panoplan.exporters.explain.marks import (
    bounds_of,
    box_of,
    colour_map,
    dots,
    image_of,
    path_of,
    put,
    ring_of,
)
from panoplan.exporters.explain.page import dot, legend, room_page, room_sheet, stroke, swatch
from panoplan.types.explain import ExplainedRoom, Explanation

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

_BELOW = ("#FFFFFF", "#E6E9ED", "#CDD3DA")
_ABOVE = ("#D3E5F3", "#A6CBE7", "#6FA8D6")


def rooms_figure(explanation: Explanation, rooms: Sequence[ExplainedRoom]) -> Figure:
    """The density of each room with its cameras and the camera path."""
    threshold = explanation.config.rooms.threshold
    meaning = "how many views see a cell as free floor, over the most"
    if explanation.config.rooms.normalise == "coverage":
        meaning = "the share of the evidence that says a cell is free floor"
    figure, panels = room_page(
        rooms,
        4,
        3.3,
        "Rooms and the camera path",
        f"Density of each room: {meaning}. Cells from {threshold:g} on, in blue, are its mask.",
    )
    below, above = colour_map(_BELOW), colour_map(_ABOVE)
    colours = _joined(below, above, threshold)
    for axes, room in panels:
        views = explanation.views_of(room)
        bounds = bounds_of([box_of(room.density), *(view.camera[None] for view in views)])
        count = f"{len(views)} keyframe" + ("" if len(views) == 1 else "s")
        sheet = room_sheet(axes, bounds, explanation.unit, room, count)
        own = [view.camera for view in views]
        other = [view.camera for view in explanation.views if view.room != room.id]
        marks: list[Artist] = [
            image_of(axes, room.density, colours, 0.0, 1.0),
            *([] if room.polygon is None else [ring_of(room.polygon, WALL_COLOUR, sheet.weight)]),
            *path_of(explanation.views, sheet),
            dots(other, sheet, "white", QUIET_COLOUR, 2.6),
            dots(own, sheet, CORNER_COLOUR, "white", 4.6),
        ]
        put(axes, sheet, "room", marks, 1)
    legend(
        figure,
        [
            swatch("density 0", below(0.0)),
            swatch(f"below {threshold:g}", below(1.0)),
            swatch(f"{threshold:g}: mask", above(0.0)),
            swatch("1", above(1.0)),
            stroke("outline in the plan", WALL_COLOUR),
            stroke("camera path", QUIET_COLOUR),
            dot("keyframe of the room", CORNER_COLOUR, "white"),
            dot("of another room", "white", QUIET_COLOUR),
        ],
    )
    return figure


def _joined(below: Colormap, above: Colormap, at: float) -> Colormap:
    """Two colour maps over 0-1 with a step between them."""
    from matplotlib.colors import ListedColormap

    shares = (np.arange(256) + 0.5) / 256
    low, high = below(shares / max(at, 1e-9)), above((shares - at) / max(1 - at, 1e-9))
    return ListedColormap(np.where((shares < at)[:, None], low, high))
