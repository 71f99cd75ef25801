"""A picture a stage: why a plan is as it is."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from panoplan.errors import InputError
from panoplan.exporters.drawing import (
    CORNER_COLOUR,
    FONT,
    PATH_COLOUR,
    QUIET_COLOUR,
    WALL_COLOUR,
    Sheet,
    draw_sheet,
    plan_text,
    room_colours,
    unit_name,
)
from panoplan.exporters.layers import add_layer
from panoplan.exporters.png import figure_png
from panoplan.formats.atomic import make_folder, write_bytes
from panoplan.types.arrays import FloatArray
from panoplan.types.explain import (
    Cloud,
    ExplainedRoom,
    ExplainedRound,
    ExplainedScale,
    ExplainedView,
    Explanation,
    Grouping,
    Raster,
)
from panoplan.types.plan import Room, Unit

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

FOLDER = "explain"

REASON_COLOURS = {
    "too few columns": "#8D99A6",
    "no plane fits": "#D9480F",
    "seen edge-on": "#7048A8",
    "too far": "#B08900",
}
ROUND_COLOURS = ("#B08900", "#2B8A3E", "#C2255C")
FITTED_COLOUR = CORNER_COLOUR
_CONTEXT_COLOUR = "#C3C9D0"
_FRAME_COLOUR = "#DDE1E6"
_INK = ("#FFFFFF", "#C9DDEF", "#7FAAD4", "#1D4E89", "#0B2545")
_BELOW = ("#FFFFFF", "#E6E9ED", "#CDD3DA")
_ABOVE = ("#D3E5F3", "#A6CBE7", "#6FA8D6")
_SIGNED = ("#E0935F", "#F6DCC6", "#FFFFFF", "#CFE2F1", "#8FBBDF")

_DOTS_PER_INCH = 160
_HEAD_IN, _FOOT_IN = 0.95, 0.55
_EDGE_IN = 0.35
_WEIGHT = 0.85
_OURS = re.compile(r"[1-4]_(scale|rooms|views|walls|floors|rounds)(_\w+)?\.png")

Bounds = tuple[FloatArray, FloatArray]


def write_explanation(
    folder: Path,
    explanation: Explanation,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Path, ...]:
    """Writes a picture a stage; those of an earlier explanation go.

    These are 1_scale.png and 2_rooms.png, then for fused rooms 3_views.png and 4_floors.png, for
    rooms by iSPA 3_walls.png and 4_rounds_ROOM.png; where the rooms or levels do not fit on one,
    numbered ones.

    Args:
        folder: made where it does not exist.
        explanation: what is drawn.
        progress: called with (pictures done, pictures in all).

    Returns:
        The files written.

    Raises:
        InputError: the place cannot be written.
    """
    forget_explanation(folder)
    make_folder(folder)
    drawn = _pictures(explanation)
    written = []
    for done, (name, draw) in enumerate(drawn):
        progress(done, len(drawn))
        figure = draw()
        long_side = _DOTS_PER_INCH * float(max(figure.get_size_inches()))
        write_bytes(folder / name, figure_png(figure, round(long_side)))
        written.append(folder / name)
    return tuple(written)


def forget_explanation(folder: Path) -> None:
    """Removes the pictures of an earlier explanation, and the folder if nothing else is in it.

    Raises:
        InputError: they cannot be removed.
    """
    if not folder.is_dir():
        return
    try:
        names = list(folder.iterdir())
        ours = [path for path in names if _OURS.fullmatch(path.name)]
        for path in ours:
            path.unlink()
        if ours == names:
            folder.rmdir()
    except OSError as error:
        raise InputError(
            folder, f"{error.strerror or error}", "a folder that can be written"
        ) from None


def _pictures(explanation: Explanation) -> list[tuple[str, Callable[[], Figure]]]:
    """Names and how to draw them, so that only one figure is held at a time."""
    rooms, groupings = explanation.rooms, explanation.groupings
    found: list[tuple[str, Callable[[], Figure]]] = [
        ("1_scale.png", partial(scale_figure, explanation)),
        *_paged("2_rooms", 20, partial(rooms_figure, explanation), rooms),
    ]
    for grouping in groupings:
        level = f"_level_{grouping.level}" if len(groupings) > 1 else ""
        found.append((f"3_views{level}.png", partial(views_figure, explanation, grouping)))
    by_ispa = [room for room in rooms if room.walls]
    found += _paged("3_walls", 12, partial(walls_figure, explanation), by_ispa)
    fused = [room for room in rooms if room.floor]
    found += _paged("4_floors", 12, partial(floors_figure, explanation), fused)
    found += [
        (f"4_rounds_{room.id}.png", partial(rounds_figure, explanation, room))
        for room in by_ispa
        if room.walls and room.walls.rounds
    ]
    return found


def _paged(
    stem: str,
    per_page: int,
    draw: Callable[[Sequence[ExplainedRoom]], Figure],
    rooms: Sequence[ExplainedRoom],
) -> list[tuple[str, Callable[[], Figure]]]:
    pages = [rooms[k : k + per_page] for k in range(0, len(rooms), per_page)]
    names = [f"{stem}_{k + 1}.png" if len(pages) > 1 else f"{stem}.png" for k in range(len(pages))]
    return [(name, partial(draw, page)) for name, page in zip(names, pages, strict=True)]


# Scale.


def scale_figure(explanation: Explanation) -> Figure:
    """All boundary points at some scales, and the entropy over the scale."""
    scale, unit = explanation.scale, explanation.unit
    clouds = scale.clouds
    cell = explanation.config.scale.cells_ch[0] * _camera_height(explanation)
    bounds = _bounds([cloud.points for cloud in clouds])
    columns = max(len(clouds), 3)
    panel = 4.2
    tall = _panel_height(bounds, panel)
    curve_in = 3.6
    figure = _figure(columns * panel, tall + curve_in)
    _heading(
        figure,
        "Scale of the trajectory",
        f"Above, all boundary points in cells of {_length(cell, unit)}, as the entropy sees them: "
        "at the right scale walls seen from several places lie on one another. Below, the "
        "objective that the search minimises (Eq. 3-4).",
    )
    counts = [_counted(cloud.points, bounds, cell) for cloud in clouds]
    most = max((float(raster.values.max()) for raster in counts), default=1.0)
    for k, (cloud, raster) in enumerate(zip(clouds, counts, strict=True)):
        axes = _axes(figure, (k * panel, curve_in), (panel, tall))
        sheet = draw_sheet(axes, bounds, unit, title=_cloud_title(cloud, scale), weight=_WEIGHT)
        image = _image(axes, raster, _colours(_INK), 0.0, 0.8 * most)
        _put(axes, sheet, "cloud", [image], 1)
    _draw_objective(figure, explanation, curve_in, columns * panel)
    return figure


def _cloud_title(cloud: Cloud, scale: ExplainedScale) -> str:
    used = None if scale.used is None else scale.used.ch_per_su
    if used is None:
        return "no scale: cameras on one spot"
    told = f"s = {cloud.ch_per_su:.4g}"
    if cloud.adjusted:
        return f"cameras adjusted, {told}"
    percent = 100 * (cloud.ch_per_su / used - 1)
    return f"{told}, the one used" if abs(percent) < 1e-6 else f"{told} ({_percent(percent, 0)})"


def _percent(value: float, digits: int) -> str:
    return f"{value:+.{digits}f} %".replace("-", "−")


def _counted(points: FloatArray, bounds: Bounds, cell: float) -> Raster:
    """Logarithm of the points in each cell, so that far walls are seen, too."""
    low, high = bounds
    size = np.ceil((high - low) / cell).astype(int)
    at = np.floor((points - low) / cell).astype(int)
    at = at[((at >= 0) & (at < size)).all(axis=1)]
    counts = np.zeros(tuple(size))
    np.add.at(counts, tuple(at.T), 1.0)
    return Raster(low, cell * np.eye(2), np.log1p(counts))


def _draw_objective(figure: Figure, explanation: Explanation, high: float, wide: float) -> None:
    """The objective over the whole range, near its bottom, and the figures in words."""
    scale = explanation.scale
    used = scale.used
    facts_in, gap = 3.1, 0.75
    each = (wide - facts_in - 2 * gap - 0.2) / 2
    y, tall = 0.25, high - 0.75
    facts = _facts(scale)
    for k, (text, colour) in enumerate(facts):
        _note(figure, wide - facts_in + 0.1, y + tall - 0.24 * k, text, 8.5, colour)
    searched = scale.searched
    if searched is None or searched.curve is None or used is None:
        return
    s, objective = searched.curve.T
    settings = explanation.config.scale
    label = "entropy" if settings.saturation == 0 else "entropy of saturated counts"
    label += " less that of the control" if settings.control else ""
    centre = searched.ch_per_su or used.ch_per_su or float(s[np.argmin(objective)])
    marks = [m for m in (used.ch_per_su, searched.ch_per_su, scale.adjusted_ch_per_su) if m]
    marks.append(float(s[np.argmin(objective)]))
    reach = max(0.12 * centre, *(1.5 * abs(mark - centre) for mark in marks))
    near = np.abs(s - centre) <= reach
    ranges = (
        (searched.search_range or (float(s[0]), float(s[-1])), np.ones(len(s), dtype=bool)),
        ((centre - reach, centre + reach), near if near.sum() > 1 else np.ones(len(s), bool)),
    )
    for k, ((low, top), shown) in enumerate(ranges):
        axes = _axes(figure, (gap + k * (each + gap), y), (each, tall))
        axes.plot(
            s[shown],
            objective[shown],
            "-o",
            color=PATH_COLOUR,
            markersize=(1.6, 3.0)[k],
            linewidth=(0.9, 1.1)[k],
        )
        _draw_scales(axes, scale)
        axes.set_xlim(low, top)
        spread = float(np.ptp(objective[shown])) or 1.0
        axes.set_ylim(
            objective[shown].min() - 0.08 * spread, objective[shown].max() + 0.08 * spread
        )
        _dress(axes, "whole range searched" if k == 0 else "near the one used")
        style: dict[str, Any] = {"fontsize": 8, "fontfamily": FONT, "color": WALL_COLOUR}
        axes.set_xlabel("s: camera heights a trajectory unit", **style)
        if k == 0:
            axes.set_ylabel(f"{label} (nats)", **style)


def _draw_scales(axes: Axes, scale: ExplainedScale) -> None:
    used, searched = scale.used, scale.searched
    if used is not None and used.ch_per_su is not None:
        if used.sigma:
            reach = used.sigma * used.ch_per_su
            ends = (used.ch_per_su - reach, used.ch_per_su + reach)
            axes.axvspan(*ends, color=CORNER_COLOUR, alpha=0.15, linewidth=0)
        axes.axvline(used.ch_per_su, color=CORNER_COLOUR, linewidth=1.2)
    if searched is not None and searched is not used and searched.ch_per_su is not None:
        axes.axvline(searched.ch_per_su, color=PATH_COLOUR, linewidth=1.2, linestyle=(0, (4, 2)))
    if scale.adjusted_ch_per_su is not None:
        axes.axvline(
            scale.adjusted_ch_per_su, color=_ADJUSTED_COLOUR, linewidth=1.2, linestyle=(0, (1, 1.5))
        )


_ADJUSTED_COLOUR = "#2B8A3E"


def _facts(scale: ExplainedScale) -> list[tuple[str, str]]:
    used, searched = scale.used, scale.searched
    if used is None or used.ch_per_su is None:
        return [("The scale is not known.", WALL_COLOUR)]
    told = f"used: s = {used.ch_per_su:.5g}"
    facts = [(told, CORNER_COLOUR)]
    if used.method == "entropy":
        sigma = "not known" if used.sigma is None else f"± {100 * used.sigma:.2g} % (band)"
        facts += [
            (f"sigma {sigma}", WALL_COLOUR),
            (f"from {used.keyframes_used} keyframes", WALL_COLOUR),
            ("settled" if used.converged else "not settled when it was frozen", WALL_COLOUR),
        ]
        if used.at_edge:
            facts.append(
                ("at the edge of the range: do not trust it", REASON_COLOURS["no plane fits"])
            )
    else:
        facts.append(("given: unit and camera height known", WALL_COLOUR))
    if searched is not None and searched is not used and searched.ch_per_su is not None:
        apart = 100 * (searched.ch_per_su / used.ch_per_su - 1)
        facts.append(
            (f"layouts alone say {searched.ch_per_su:.5g} ({_percent(apart, 2)})", PATH_COLOUR)
        )
    if searched is not None and searched.search_range is not None:
        low, high = searched.search_range
        facts.append((f"range searched {low:.3g} to {high:.3g}", WALL_COLOUR))
    if scale.adjusted_ch_per_su is not None:
        apart = 100 * (scale.adjusted_ch_per_su / used.ch_per_su - 1)
        facts.append(
            (
                f"cameras adjusted: {scale.adjusted_ch_per_su:.5g} ({_percent(apart, 2)})",
                _ADJUSTED_COLOUR,
            )
        )
    return facts


# Rooms.


def rooms_figure(explanation: Explanation, rooms: Sequence[ExplainedRoom]) -> Figure:
    """The density of each room with its cameras and the camera path."""
    threshold = explanation.config.rooms.threshold
    meaning = "how many views see a cell as free floor, over the most"
    if explanation.config.rooms.normalise == "coverage":
        meaning = "the share of the evidence that says a cell is free floor"
    figure, panels = _room_page(
        rooms,
        4,
        3.3,
        "Rooms and the camera path",
        f"Density of each room: {meaning}. Cells from {threshold:g} on, in blue, are its mask.",
    )
    below, above = _colours(_BELOW), _colours(_ABOVE)
    colours = _joined(below, above, threshold)
    for axes, room in panels:
        views = [view for view in explanation.views if view.room == room.id]
        bounds = _bounds([_box(room.density), *(view.camera[None] for view in views)])
        count = f"{len(views)} keyframe" + ("" if len(views) == 1 else "s")
        sheet = _room_sheet(axes, bounds, explanation.unit, room, count)
        own = [view.camera for view in views]
        other = [view.camera for view in explanation.views if view.room != room.id]
        marks: list[Artist] = [
            _image(axes, room.density, colours, 0.0, 1.0),
            *([] if room.polygon is None else [_ring(room.polygon, WALL_COLOUR, sheet.weight)]),
            *_path(explanation.views, sheet),
            _dots(other, sheet, "white", QUIET_COLOUR, 2.6),
            _dots(own, sheet, CORNER_COLOUR, "white", 4.6),
        ]
        _put(axes, sheet, "room", marks, 1)
    _legend(
        figure,
        [
            _swatch("density 0", below(0.0)),
            _swatch(f"below {threshold:g}", below(1.0)),
            _swatch(f"{threshold:g}: mask", above(0.0)),
            _swatch("1", above(1.0)),
            _stroke("outline in the plan", WALL_COLOUR),
            _stroke("camera path", QUIET_COLOUR),
            _dot("keyframe of the room", CORNER_COLOUR, "white"),
            _dot("of another room", "white", QUIET_COLOUR),
        ],
    )
    return figure


# Views.


def views_figure(explanation: Explanation, grouping: Grouping) -> Figure:
    """What each view sees, in its room's colour, and the common areas that they are grouped by."""
    config = explanation.config.grouping
    views = [explanation.views[k] for k in grouping.views]
    bounds = _bounds(
        [view.boundary[np.isfinite(view.boundary[:, 0])] for view in views], share=0.01
    )
    side, rim = 6.6, 1.1
    width, height = bounds[1] - bounds[0]
    wide = float(np.clip(side * width / height, 6.0, 9.5))
    figure = _figure(wide + side + rim, side)
    doors = sum(view.doorway for view in views)
    _heading(
        figure,
        "Views grouped into rooms" + (f", level {grouping.level}" if _several(explanation) else ""),
        "Left, the boundary that each keyframe sees, in the colour of its room. Right, common "
        "area of each two views over that of the smaller: views are linked while its mean is at "
        f"least {config.min_overlap:g}, then groups joined or dissolved by what they see. "
        f"{len(views)} views, {doors} of them from a doorway.",
    )
    fills = _fills(explanation.rooms)
    axes = _axes(figure, (0.0, 0.0), (wide, side))
    sheet = draw_sheet(axes, bounds, explanation.unit, weight=_WEIGHT)
    _put(axes, sheet, "rooms", _room_fills(explanation, grouping.level, fills), 1)
    marks: list[Artist] = []
    for view in views:
        ink = _stronger(fills.get(view.room, _CONTEXT_COLOUR))
        marks.append(_lines([view.boundary], ink, 0.8 * sheet.weight, 0.75))
    marks += _path([view for view in explanation.views if view.level == grouping.level], sheet)
    for view in views:
        ink = _stronger(fills.get(view.room, _CONTEXT_COLOUR))
        face, edge = ("white", ink) if view.doorway else (ink, "white")
        marks.append(_dots([view.camera], sheet, face, edge, 5.0))
    _put(axes, sheet, "views", marks, 2)
    _draw_overlaps(figure, explanation, grouping, (wide + rim, 0.3), side - 0.6)
    _legend(
        figure,
        [
            _stroke("boundary of a view", QUIET_COLOUR),
            _dot("view", QUIET_COLOUR, "white"),
            _dot("view from a doorway", "white", QUIET_COLOUR),
            *(
                _swatch(f"common area {share:g}", _colours(_INK)(0.8 * share))
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
    axes = _axes(figure, corner, (side, side))
    axes.imshow(
        grouping.overlaps,
        cmap=_colours(_INK),
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
            line(stop, color=_FRAME_COLOUR, linewidth=0.8)
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
        spine.set_color(_FRAME_COLOUR)


# Rooms by iSPA.


def walls_figure(explanation: Explanation, rooms: Sequence[ExplainedRoom]) -> Figure:
    """Pieces of boundary kept as wall planes, and those rejected, with the reason."""
    config = explanation.config.planes
    cm = explanation.unit == "m"
    residual = config.max_residual_ch * _camera_height(explanation)
    told = f"{100 * residual:.0f} cm" if cm else f"{residual:g} camera heights"
    figure, panels = _room_page(
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
        views = [view for view in explanation.views if view.room == room.id]
        bounds = _bounds([_box(room.density), *kept], share=0.01)
        count = f"{len(kept)} kept, {len(rejected)} rejected"
        sheet = _room_sheet(axes, bounds, explanation.unit, room, count)
        boundaries = [view.boundary for view in views]
        marks: list[Artist] = [_lines(boundaries, _CONTEXT_COLOUR, 0.6 * sheet.weight)]
        for reason, colour in REASON_COLOURS.items():
            pieces = [points for why, points in rejected if why == reason]
            if pieces:
                marks.append(_dots(np.concatenate(pieces), sheet, colour, "none", 2.4, alpha=0.6))
        marks.append(_lines(kept, PATH_COLOUR, 1.3 * sheet.weight, 0.8))
        marks.append(_dots([view.camera for view in views], sheet, CORNER_COLOUR, "white", 4.6))
        _put(axes, sheet, "walls", marks, 1)
    counts = {
        reason: sum(why == reason for room in rooms if room.walls for why, _ in room.walls.rejected)
        for reason in REASON_COLOURS
    }
    total = sum(len(room.walls.kept) for room in rooms if room.walls)
    _legend(
        figure,
        [
            _stroke(f"kept ({total})", PATH_COLOUR),
            *(
                _dot(f"rejected, {reason} ({counts[reason]})", colour, "none")
                for reason, colour in REASON_COLOURS.items()
            ),
            _stroke("boundary", _CONTEXT_COLOUR),
            _dot("keyframe", CORNER_COLOUR, "white"),
        ],
    )
    return figure


def rounds_figure(explanation: Explanation, room: ExplainedRoom) -> Figure:
    """Grid, mask, wall density, candidates and shortest path of each round."""
    assert room.walls is not None
    rounds = room.walls.rounds
    bounds = _bounds([rounds[0].candidates, *(r.corners for r in rounds if r.corners is not None)])
    panel = 4.5
    tall = _panel_height(bounds, panel)
    figure = _figure(panel * len(rounds), tall)
    _heading(
        figure,
        f"{room.name}: iterative shortest path",
        "The cheapest closed path through corner candidates around the room: along walls, in their "
        "directions, around the mask, with few corners (Eq. 8-11)."
        + (f" No shape: {room.failure}." if room.failure else ""),
    )
    colours = _colours(("#FFFFFF", "#C9D1DA", "#5B636E", "#2B3038"))
    for number, made in enumerate(rounds):
        axes = _axes(figure, (number * panel, 0.0), (panel, tall))
        sheet = draw_sheet(
            axes,
            bounds,
            explanation.unit,
            title=f"Round {number + 1}",
            told=_round_text(made, explanation.unit),
            weight=_WEIGHT,
        )
        _put(axes, sheet, "round", _round_marks(axes, sheet, rounds, number), 1)
    _legend(
        figure,
        [
            _swatch("wall density", colours(0.6)),
            _swatch("mask", _MASK_COLOUR),
            _stroke("grid", _FRAME_COLOUR),
            _dot("candidate", _CANDIDATE_COLOUR, "none"),
            _stroke("path of the round before", QUIET_COLOUR, (0, (3, 2))),
            *(
                _stroke(f"path of round {k + 1}", ROUND_COLOURS[k % len(ROUND_COLOURS)])
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
    cell = _length(made.wall.cell, unit)
    return f"{n} × {m} cells of {cell}, {len(made.candidates)} candidates, {corners}"


def _round_marks(
    axes: Axes, sheet: Sheet, rounds: Sequence[ExplainedRound], number: int
) -> list[Artist]:
    made = rounds[number]
    n, m = made.wall.values.shape
    wall = _colours(("#FFFFFF00", "#5B636E", "#2B3038"))
    mask = _colours(("#FFFFFF00", _MASK_COLOUR))
    lines = [np.array([[i, 0], [i, m]], dtype=float) for i in range(n + 1)]
    lines += [np.array([[0, j], [n, j]], dtype=float) for j in range(m + 1)]
    marks: list[Artist] = [
        _image(axes, Raster(made.wall.origin, made.wall.axes, made.mask.astype(float)), mask, 0, 1),
        _lines([made.wall.at(line) for line in lines], _FRAME_COLOUR, 0.3 * sheet.weight),
        _image(axes, made.wall, wall, 0.0, 1.2),
        _dots(made.candidates, sheet, _CANDIDATE_COLOUR, "none", 1.7),
    ]
    before = rounds[number - 1].corners if number else None
    if before is not None:
        marks.append(_ring(before, QUIET_COLOUR, 0.9 * sheet.weight, (0, (3, 2))))
    if made.corners is not None:
        colour = ROUND_COLOURS[number % len(ROUND_COLOURS)]
        marks.append(_ring(made.corners, colour, 1.7 * sheet.weight))
        marks.append(_dots(made.corners, sheet, colour, "white", 5.0))
    return marks


# Rooms by fusion.


def floors_figure(explanation: Explanation, rooms: Sequence[ExplainedRoom]) -> Figure:
    """The fused signed distance of each room, its cut zero line, the walls fitted and placed."""
    reach = explanation.config.fusion.truncation_ch * _camera_height(explanation)
    figure, panels = _room_page(
        rooms,
        3,
        4.3,
        "Fused floors and their walls",
        "Signed distance to the boundary, fused over the room's views and truncated at "
        f"{_length(reach, explanation.unit)}, less the strongest other room's. Its zero line is "
        "cut into straight pieces, walls are fitted to the raw columns near each, and the rooms "
        "made one plan.",
    )
    colours = _colours(_SIGNED)
    for axes, room in panels:
        assert room.floor is not None
        floor = room.floor
        views = [view for view in explanation.views if view.room == room.id]
        rings = [ring for ring in (floor.fitted, room.polygon) if ring is not None]
        bounds = _bounds([*floor.pieces, *rings], margin=1.2 * reach)
        sheet = _room_sheet(axes, bounds, explanation.unit, room, _sigma_text(room, explanation))
        columns = np.concatenate([view.boundary for view in views] or [np.empty((0, 2))])
        cuts = [piece[0] for piece in floor.pieces]
        marks: list[Artist] = [
            _image(axes, floor.distance, colours, -reach, reach),
            _dots(columns, sheet, WALL_COLOUR, "none", 0.7, alpha=0.35),
            _ring(np.concatenate(floor.pieces), WALL_COLOUR, 0.8 * sheet.weight),
            _dots(cuts, sheet, "white", WALL_COLOUR, 3.6),
        ]
        if floor.fitted is not None:
            marks.append(_ring(floor.fitted, FITTED_COLOUR, 1.5 * sheet.weight))
        if room.polygon is not None:
            marks.append(_ring(room.polygon, _PLACED_COLOUR, 1.5 * sheet.weight, (0, (3, 3))))
        _put(axes, sheet, "floor", marks, 1)
    away = _length(reach, explanation.unit)
    _legend(
        figure,
        [
            _swatch(f"{away} outside", colours(0.0)),
            _swatch(f"{away} inside", colours(1.0)),
            _dot("raw column", WALL_COLOUR, "none", 2.0),
            _stroke("zero line", WALL_COLOUR),
            _dot("where it is cut", "white", WALL_COLOUR),
            _stroke("walls fitted", FITTED_COLOUR),
            _stroke("in the plan", _PLACED_COLOUR, (0, (3, 2))),
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


# What all figures share.


def _camera_height(explanation: Explanation) -> float:
    """Plan units a camera height."""
    room = next(iter(explanation.rooms), None)
    return 1.0 if room is None else room.density.cell / explanation.config.rooms.cell_ch


def _length(value: float, unit: Unit) -> str:
    if unit == "m":
        return f"{100 * value:.0f} cm"
    return f"{value:.2g} {unit_name(unit, value)}"


def _figure(width_in: float, height_in: float) -> Figure:
    """An empty figure of this size between head and foot."""
    from matplotlib.figure import Figure

    size = (width_in + 2 * _EDGE_IN, height_in + _HEAD_IN + _FOOT_IN)
    return Figure(figsize=size, facecolor="white")


def _axes(figure: Figure, corner: tuple[float, float], size: tuple[float, float]) -> Axes:
    """Axes by their lower left corner and size in inches, above the foot."""
    width, height = figure.get_size_inches()
    left, bottom = corner[0] + _EDGE_IN, corner[1] + _FOOT_IN
    return figure.add_axes((left / width, bottom / height, size[0] / width, size[1] / height))


def _note(figure: Figure, left: float, up: float, text: str, size: float, colour: str) -> None:
    """Text by the place of its upper left corner in inches, above the foot."""
    width, height = figure.get_size_inches()
    x, y = (left + _EDGE_IN) / width, (up + _FOOT_IN) / height
    made = plan_text(x, y, text, size, colour, ha="left", va="top", linespacing=1.3)
    made.set_transform(figure.transFigure)
    figure.add_artist(made)


def _panel_height(bounds: Bounds, width_in: float) -> float:
    """Height of axes of this width that hold bounds with title and scale bar, in inches."""
    width, height = bounds[1] - bounds[0]
    return width_in * float(np.clip(height / width, 0.25, 1.3)) + 0.55


def _heading(figure: Figure, title: str, note: str) -> None:
    from textwrap import fill

    width, height = figure.get_size_inches()
    top = height - _FOOT_IN - 0.2
    _note(figure, 0.0, top, title, 14.0, WALL_COLOUR)
    characters = int((width - 2 * _EDGE_IN) * 72 / (8.5 * 0.53))
    _note(figure, 0.0, top - 0.32, fill(note, characters), 8.5, QUIET_COLOUR)


def _room_page(
    rooms: Sequence[ExplainedRoom], columns: int, panel: float, title: str, note: str
) -> tuple[Figure, Iterator[tuple[Axes, ExplainedRoom]]]:
    """A figure with square axes a room."""
    columns = min(columns, max(2, len(rooms)))
    rows = -(-len(rooms) // columns)
    figure = _figure(columns * panel, rows * panel)
    _heading(figure, title, note)
    places = ((k % columns * panel, (rows - 1 - k // columns) * panel) for k in range(len(rooms)))
    axes = (_axes(figure, place, (panel, panel)) for place in places)
    return figure, zip(axes, rooms, strict=True)


def _room_sheet(axes: Axes, bounds: Bounds, unit: Unit, room: ExplainedRoom, told: str) -> Sheet:
    return draw_sheet(axes, bounds, unit, title=room.name, told=told, weight=_WEIGHT)


def _legend(figure: Figure, handles: Sequence[Artist]) -> None:
    figure.legend(
        handles=list(handles),
        loc="lower center",
        bbox_to_anchor=(0.5, 0.12 / float(figure.get_size_inches()[1])),
        ncols=len(handles),
        frameon=False,
        handletextpad=0.5,
        columnspacing=1.4,
        prop={"family": FONT, "size": 8},
        labelcolor=WALL_COLOUR,
    )


def _stroke(label: str, colour: str, style: Any = "solid") -> Artist:
    from matplotlib.lines import Line2D

    return Line2D([], [], color=colour, linewidth=1.6, linestyle=style, label=label)


def _dot(label: str, face: str, edge: str, size: float = 5.0) -> Artist:
    from matplotlib.lines import Line2D

    return Line2D(
        [],
        [],
        linestyle="none",
        marker="o",
        markersize=size,
        markerfacecolor=face,
        markeredgecolor=edge,
        markeredgewidth=0.8,
        label=label,
    )


def _swatch(label: str, colour: Any) -> Artist:
    from matplotlib.patches import Patch

    return Patch(facecolor=colour, edgecolor=_CONTEXT_COLOUR, linewidth=0.6, label=label)


def _dress(axes: Axes, title: str) -> None:
    """Quiet axes for a curve."""
    axes.set_title(title, fontsize=9, fontfamily=FONT, color=WALL_COLOUR, loc="left")
    axes.tick_params(
        labelsize=7.5, labelfontfamily=FONT, labelcolor=WALL_COLOUR, color=QUIET_COLOUR
    )
    axes.grid(color=_FRAME_COLOUR, linewidth=0.6)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(QUIET_COLOUR)


def _colours(names: Sequence[str]) -> Colormap:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("panoplan", list(names))


def _joined(below: Colormap, above: Colormap, at: float) -> Colormap:
    """Two colour maps over 0-1 with a step between them."""
    from matplotlib.colors import ListedColormap

    shares = (np.arange(256) + 0.5) / 256
    low, high = below(shares / max(at, 1e-9)), above((shares - at) / max(1 - at, 1e-9))
    return ListedColormap(np.where((shares < at)[:, None], low, high))


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


def _bounds(
    parts: Sequence[FloatArray], *, share: float = 0.002, margin: float | None = None
) -> Bounds:
    """The box around nearly all points: a share of them lies beyond it on each side."""
    points = np.concatenate([np.empty((0, 2)), *parts])
    if len(points) == 0:
        return np.zeros(2), np.ones(2)
    low, high = np.quantile(points, [share, 1 - share], axis=0)
    extent = float((high - low).max())
    grow = margin or max(0.06 * extent, 1e-3 if extent else 0.5)
    return low - grow, high + grow


def _box(raster: Raster) -> FloatArray:
    """Corners of the cells that have something to say."""
    cells = np.argwhere(raster.values > 0.05).astype(float)
    if len(cells) == 0:
        return raster.origin[None]
    return np.concatenate([raster.at(cells), raster.at(cells + 1.0)])


def _put(axes: Axes, sheet: Sheet, name: str, marks: Sequence[Artist], order: float) -> None:
    """Marks as a layer, cut off at the edge of the sheet, and its frame."""
    from matplotlib.patches import Rectangle

    width, height = sheet.high - sheet.low
    corner = (float(sheet.low[0]), float(sheet.low[1]))
    frame = Rectangle(
        corner, width, height, facecolor="none", edgecolor=_FRAME_COLOUR, linewidth=0.8
    )
    frame.set_transform(axes.transData)
    add_layer(axes, name, [*marks, frame], order)
    for mark in marks:
        mark.set_clip_path(frame)


def _image(axes: Axes, raster: Raster, colours: Colormap, least: float, most: float) -> Artist:
    from matplotlib.colors import Normalize
    from matplotlib.image import AxesImage
    from matplotlib.transforms import Affine2D

    n, m = raster.values.shape
    image = AxesImage(
        axes,
        cmap=colours,
        norm=Normalize(least, most),
        interpolation="nearest",
        origin="lower",
        extent=(0, n, 0, m),
    )
    image.set_data(raster.values.T)
    (a, b), (c, d) = raster.axes
    cells = Affine2D(np.array([[a, c, raster.origin[0]], [b, d, raster.origin[1]], [0, 0, 1]]))
    image.set_transform(cells + axes.transData)
    return image


def _lines(lines: Sequence[FloatArray], colour: Any, width: float, alpha: float = 1.0) -> Artist:
    from matplotlib.collections import LineCollection

    return LineCollection(
        list(lines), colors=[colour], linewidths=width, alpha=alpha, capstyle="round"
    )


def _ring(ring: FloatArray, colour: str, width: float, style: Any = "solid") -> Artist:
    from matplotlib.lines import Line2D

    x, y = np.vstack([ring, ring[:1]]).T
    return Line2D(x, y, color=colour, linewidth=width, linestyle=style, solid_joinstyle="miter")


def _dots(
    points: FloatArray | Sequence[FloatArray],
    sheet: Sheet,
    face: Any,
    edge: Any,
    size: float,
    alpha: float = 1.0,
) -> Artist:
    from matplotlib.lines import Line2D

    x, y = np.asarray(points).reshape(-1, 2).T
    return Line2D(
        x,
        y,
        linestyle="none",
        marker="o",
        markersize=size * sheet.weight,
        markerfacecolor=face,
        markeredgecolor=edge,
        markeredgewidth=0.6 * sheet.weight,
        alpha=alpha,
    )


def _path(views: Sequence[ExplainedView], sheet: Sheet) -> list[Artist]:
    """The camera path, broken between levels."""
    runs = [list(run) for _, run in groupby(views, key=lambda view: view.level)]
    lines = [np.array([view.camera for view in run]) for run in runs]
    return [_lines(lines, QUIET_COLOUR, 0.7 * sheet.weight, 0.7)]
