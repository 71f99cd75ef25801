"""Rooms by iSPA: wall planes, and the rounds of the shortest path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from panoplan.exporters.drawing import CORNER_COLOUR, PATH_COLOUR, QUIET_COLOUR, Sheet, draw_sheet
from panoplan.exporters.explain.marks import (
    CONTEXT_COLOUR,
    FRAME_COLOUR,
    bounds_of,
    box_of,
    colour_map,
    dots,
    image_of,
    lines_of,
    put,
    ring_of,
)
from panoplan.exporters.explain.page import (
    WEIGHT,
    axes_at,
    blank_page,
    camera_height,
    centred,
    dot,
    heading,
    legend,
    length_text,
    panel_height,
    room_page,
    room_sheet,
    stroke,
    swatch,
)
from panoplan.types.explain import ExplainedRoom, ExplainedRound, Explanation, Raster
from panoplan.types.plan import Unit

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

REASON_COLOURS = {
    "too few columns": "#8D99A6",
    "no plane fits": "#D9480F",
    "seen edge-on": "#7048A8",
    "too far": "#B08900",
}
ROUND_COLOURS = ("#B08900", "#2B8A3E", "#C2255C")


def walls_figure(explanation: Explanation, rooms: Sequence[ExplainedRoom]) -> Figure:
    """Pieces of boundary kept as wall planes, and those rejected, with the reason."""
    config = explanation.config.planes
    cm = explanation.unit == "m"
    residual = config.max_residual_ch * camera_height(explanation)
    told = f"{100 * residual:.0f} cm" if cm else f"{residual:g} camera heights"
    figure, panels = room_page(
        rooms,
        3,
        4.3,
        "Wall planes kept and rejected",
        "Each layout's boundary is split at corners and jumps; a piece is kept where "
        f"{100 * config.min_inlier_ratio:.0f} % of its columns lie within {told} of one line.",
    )
    for axes, room in panels:
        assert room.walls is not None
        kept, rejected = room.walls.kept, room.walls.rejected
        views = explanation.views_of(room)
        bounds = bounds_of([box_of(room.density), *kept], share=0.01)
        count = f"{len(kept)} kept, {len(rejected)} rejected"
        sheet = room_sheet(axes, bounds, explanation.unit, room, count)
        boundaries = [view.boundary for view in views]
        marks: list[Artist] = [lines_of(boundaries, CONTEXT_COLOUR, 0.6 * sheet.weight)]
        for reason, colour in REASON_COLOURS.items():
            pieces = [points for why, points in rejected if why == reason]
            if pieces:
                marks.append(dots(np.concatenate(pieces), sheet, colour, "none", 2.4, alpha=0.6))
        marks.append(lines_of(kept, PATH_COLOUR, 1.3 * sheet.weight, 0.8))
        marks.append(dots([view.camera for view in views], sheet, CORNER_COLOUR, "white", 4.6))
        put(axes, sheet, "walls", marks, 1)
    counts = {
        reason: sum(why == reason for room in rooms if room.walls for why, _ in room.walls.rejected)
        for reason in REASON_COLOURS
    }
    total = sum(len(room.walls.kept) for room in rooms if room.walls)
    legend(
        figure,
        [
            stroke(f"kept ({total})", PATH_COLOUR),
            *(
                dot(f"rejected, {reason} ({counts[reason]})", colour, "none")
                for reason, colour in REASON_COLOURS.items()
            ),
            stroke("boundary", CONTEXT_COLOUR),
            dot("keyframe", CORNER_COLOUR, "white"),
        ],
    )
    return figure


def rounds_figure(explanation: Explanation, room: ExplainedRoom) -> Figure:
    """Grid, mask, wall density, candidates and shortest path of each round."""
    assert room.walls is not None
    rounds = room.walls.rounds
    bounds = bounds_of(
        [rounds[0].candidates, *(r.corners for r in rounds if r.corners is not None)]
    )
    panel = 4.5
    tall = panel_height(bounds, panel)
    figure = blank_page(panel * len(rounds), tall)
    heading(
        figure,
        f"{room.name}: iterative shortest path",
        "The cheapest closed path through corner candidates around the room: along walls, in their "
        "directions, around the mask, with few corners (Eq. 8-11)."
        + (f" No shape: {room.failure}." if room.failure else ""),
    )
    colours = colour_map(("#FFFFFF", "#C9D1DA", "#5B636E", "#2B3038"))
    left = centred(figure, panel * len(rounds))
    for number, made in enumerate(rounds):
        axes = axes_at(figure, (left + number * panel, 0.0), (panel, tall))
        sheet = draw_sheet(
            axes,
            bounds,
            explanation.unit,
            title=f"Round {number + 1}",
            told=_round_text(made, explanation.unit),
            weight=WEIGHT,
        )
        put(axes, sheet, "round", _round_marks(axes, sheet, rounds, number), 1)
    legend(
        figure,
        [
            swatch("wall density", colours(0.6)),
            swatch("mask", _MASK_COLOUR),
            stroke("grid", FRAME_COLOUR),
            dot("candidate", _CANDIDATE_COLOUR, "none"),
            stroke("path of the round before", QUIET_COLOUR, (0, (3, 2))),
            *(
                stroke(f"path of round {k + 1}", ROUND_COLOURS[k % len(ROUND_COLOURS)])
                for k in range(len(rounds))
            ),
        ],
    )
    return figure


_MASK_COLOUR = "#E3EEF7"
_CANDIDATE_COLOUR = "#4AA3DF"


def _round_text(made: ExplainedRound, unit: Unit) -> str:
    n, m = made.wall.values.shape
    corners = "no path" if made.corners is None else f"{len(made.corners)} corners"
    cell = length_text(made.wall.cell, unit)
    return f"{n} × {m} cells of {cell}, {len(made.candidates)} candidates, {corners}"


def _round_marks(
    axes: Axes, sheet: Sheet, rounds: Sequence[ExplainedRound], number: int
) -> list[Artist]:
    made = rounds[number]
    n, m = made.wall.values.shape
    wall = colour_map(("#FFFFFF00", "#5B636E", "#2B3038"))
    mask = colour_map(("#FFFFFF00", _MASK_COLOUR))
    lines = [np.array([[i, 0], [i, m]], dtype=float) for i in range(n + 1)]
    lines += [np.array([[0, j], [n, j]], dtype=float) for j in range(m + 1)]
    marks: list[Artist] = [
        image_of(
            axes, Raster(made.wall.origin, made.wall.axes, made.mask.astype(float)), mask, 0, 1
        ),
        lines_of([made.wall.at(line) for line in lines], FRAME_COLOUR, 0.3 * sheet.weight),
        image_of(axes, made.wall, wall, 0.0, 1.2),
        dots(made.candidates, sheet, _CANDIDATE_COLOUR, "none", 1.7),
    ]
    before = rounds[number - 1].corners if number else None
    if before is not None:
        marks.append(ring_of(before, QUIET_COLOUR, 0.9 * sheet.weight, (0, (3, 2))))
    if made.corners is not None:
        colour = ROUND_COLOURS[number % len(ROUND_COLOURS)]
        marks.append(ring_of(made.corners, colour, 1.7 * sheet.weight))
        marks.append(dots(made.corners, sheet, colour, "white", 5.0))
    return marks
