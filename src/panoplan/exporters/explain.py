"""A picture a stage: why a plan is as it is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from panoplan.exporters.drawing import (
    CORNER_COLOUR,
    FONT,
    PATH_COLOUR,
    QUIET_COLOUR,
    WALL_COLOUR,
)
from panoplan.exporters.png import figure_png
from panoplan.formats.atomic import write_bytes
from panoplan.types.arrays import FloatArray
from panoplan.types.explain import ExplainedRoom, Explanation, Raster

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FOLDER = "explain"

_REASON_COLOURS = {
    "too few columns": "#8D99A6",
    "no plane fits": "#D9480F",
    "seen edge-on": "#7048A8",
    "too far": "#B08900",
}
_CLOUD_CELLS = 420
_PANEL_IN = 3.4
_MOST_PANELS = 30
_TITLE_IN, _LEGEND_IN = 0.55, 0.4


def write_explanation(folder: Path, explanation: Explanation) -> tuple[Path, ...]:
    """Writes scale.png, rooms.png, walls.png and shapes.png.

    Args:
        folder: made where it does not exist.
        explanation: what is drawn.

    Returns:
        The files written: without rooms only scale.png.

    Raises:
        InputError: the place cannot be written.
    """
    figures = {"scale.png": scale_figure(explanation)}
    if explanation.rooms:
        figures["rooms.png"] = rooms_figure(explanation)
        figures["walls.png"] = walls_figure(explanation)
        figures["shapes.png"] = shapes_figure(explanation)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, figure in figures.items():
        path = folder / name
        write_bytes(path, figure_png(figure))
        written.append(path)
    return tuple(written)


def scale_figure(explanation: Explanation) -> Figure:
    """The cloud of all boundary points at three scales, and the entropy over the scale."""
    clouds = explanation.clouds
    figure, grid = _figure(_PANEL_IN * max(3, len(clouds)), 2 * _PANEL_IN, 2, len(clouds))
    chosen = next(points for factor, points in clouds if factor == 1.0)
    low, high = _extent([chosen, explanation.path])
    scale = explanation.scale
    found = None if scale is None else scale.ch_per_su
    for k, (factor, points) in enumerate(clouds):
        axes = figure.add_subplot(grid[0, k])
        _draw_cloud(axes, points, low, high)
        told = "" if found is None else f"s = {factor * found:.4g}"
        mark = " (found)" if factor == 1.0 and found is not None else ""
        _plan_axes(axes, low, high, f"{told}{mark}" or "camera heights")
    axes = figure.add_subplot(grid[1, :])
    if scale is None or scale.curve is None or found is None:
        axes.set_axis_off()
        why = "not known" if found is None else "given, not searched"
        axes.text(0.5, 0.5, f"The scale is {why}.", ha="center", va="center", fontsize=11)
        return figure
    s, objective = scale.curve.T
    axes.plot(s, objective, ".-", color=PATH_COLOUR, markersize=3, linewidth=1, label="objective")
    axes.axvline(found, color=CORNER_COLOUR, linewidth=1.2, label=f"found: {found:.5g}")
    if scale.sigma:
        reach = scale.sigma * found
        axes.axvspan(
            found - reach,
            found + reach,
            color=CORNER_COLOUR,
            alpha=0.18,
            linewidth=0,
            label=f"± {100 * scale.sigma:.2g} %",
        )
    if scale.search_range is not None:
        axes.set_xlim(*scale.search_range)
    axes.set_xlabel("camera heights a trajectory unit")
    axes.set_ylabel("entropy, control subtracted where set")
    axes.grid(alpha=0.25)
    axes.legend(frameon=False, fontsize=9)
    axes.set_title("Entropy over the scale (Eq. 3-4)", fontsize=11)
    return figure


def rooms_figure(explanation: Explanation) -> Figure:
    """The density of each room with its cameras, and the path."""
    figure, panels = _panels(explanation.rooms, "Room densities and the path")
    for axes, room in panels:
        low, high = _extent([_box(room.density), room.cameras])
        _image(axes, room.density, "Blues", 0.0, 1.0)
        inside = _within(explanation.path, low, high)
        axes.plot(*inside.T, "-", color=QUIET_COLOUR, linewidth=0.7, alpha=0.7)
        axes.plot(*room.cameras.T, "o", color=CORNER_COLOUR, markersize=3)
        if np.nanmax(room.density.values) > 0.5:
            _contour(axes, room.density, 0.5, WALL_COLOUR)
        _plan_axes(axes, low, high, f"{room.id}, keyframes: {len(room.cameras)}")
    return figure


def walls_figure(explanation: Explanation) -> Figure:
    """What became walls: planes kept and rejected, or the columns that walls were fitted to."""
    fitted = any(room.columns is not None for room in explanation.rooms)
    title = "Raw columns and the walls fitted to them" if fitted else "Planes kept and rejected"
    figure, panels = _panels(explanation.rooms, title)
    for axes, room in panels:
        around = [*room.kept, *([] if room.outline is None else [room.outline])]
        low, high = _extent([*around, room.cameras])
        if room.columns is not None:
            inside = _within(room.columns, low - 0.3, high + 0.3)
            axes.plot(*inside.T, ".", color=PATH_COLOUR, markersize=0.8, alpha=0.35)
        for reason, points in room.rejected:
            inside = _within(points, low - 0.3, high + 0.3)
            axes.plot(*inside.T, ".", color=_REASON_COLOURS[reason], markersize=1.2, alpha=0.6)
        for ends in room.kept:
            axes.plot(*ends.T, "-", color=PATH_COLOUR, linewidth=0.9, alpha=0.6)
        if room.outline is not None and fitted:
            _ring(axes, room.outline, WALL_COLOUR, 1.2)
        axes.plot(*room.cameras.T, "o", color=CORNER_COLOUR, markersize=2)
        told = f"{len(room.kept)} kept, {len(room.rejected)} rejected"
        if fitted:
            told = _sigma_text(room)
        _plan_axes(axes, low, high, f"{room.id}: {told}")
    if not fitted:
        handles = [_handle(colour, reason) for reason, colour in _REASON_COLOURS.items()] + [
            _handle(PATH_COLOUR, "kept")
        ]
        figure.legend(handles=handles, loc="lower center", ncols=5, frameon=False, fontsize=9)
    return figure


def shapes_figure(explanation: Explanation) -> Figure:
    """How outlines came about: rounds of iSPA, or the fused signed distance and its zero line."""
    fused = any(room.distance is not None for room in explanation.rooms)
    title = "Fused signed distance, fitted outline, outline in the plan" if fused else "iSPA rounds"
    figure, panels = _panels(explanation.rooms, title)
    for axes, room in panels:
        parts = [p for p in (room.outline, room.polygon, *room.rounds) if p is not None]
        low, high = _extent([*(parts or [_box(room.density)]), room.cameras])
        if room.distance is not None:
            reach = float(np.nanmax(np.abs(room.distance.values)))
            _image(axes, room.distance, "RdBu", -reach, reach)
            _contour(axes, room.distance, 0.0, QUIET_COLOUR)
        else:
            _image(axes, room.density, "Greys", 0.0, 2.0)
        for number, ring in enumerate(room.rounds):
            colour = ROOM_STRONG[number % len(ROOM_STRONG)]
            _ring(axes, ring, colour, 0.9 + 0.5 * number)
        if room.outline is not None and not room.rounds:
            _ring(axes, room.outline, CORNER_COLOUR, 1.0)
        if room.polygon is not None and fused:
            _ring(axes, room.polygon, WALL_COLOUR, 1.6)
        told = room.failure or (f"{len(room.rounds)} rounds" if room.rounds else "")
        corners = "" if room.polygon is None else f"{len(room.polygon)} corners"
        text = ", ".join(part for part in (corners, told) if part)
        _plan_axes(axes, low, high, f"{room.id}: {text}")
    if fused:
        handles = [
            _handle(QUIET_COLOUR, "zero of the field"),
            _handle(CORNER_COLOUR, "fitted outline"),
            _handle(WALL_COLOUR, "in the plan"),
        ]
    else:
        most = max(len(room.rounds) for room in explanation.rooms)
        handles = [
            _handle(ROOM_STRONG[k % len(ROOM_STRONG)], f"round {k + 1}") for k in range(most)
        ]
    figure.legend(handles=handles, loc="lower center", ncols=5, frameon=False, fontsize=9)
    return figure


ROOM_STRONG = ("#2B8A3E", "#E67700", "#C2255C", "#1864AB", "#5F3DC4")


def _figure(width: float, height: float, rows: int, columns: int) -> tuple[Figure, Any]:
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context({"font.family": FONT}):
        figure = Figure(figsize=(width, height), facecolor="white", layout="constrained")
        return figure, figure.add_gridspec(rows, columns)


def _panels(
    rooms: Sequence[ExplainedRoom], title: str
) -> tuple[Figure, list[tuple[Axes, ExplainedRoom]]]:
    """A figure with a panel a room."""
    shown = rooms[:_MOST_PANELS]
    columns = min(len(shown), max(2, int(np.ceil(np.sqrt(1.4 * len(shown))))))
    rows = -(-len(shown) // columns)
    height = _PANEL_IN * rows + _TITLE_IN + _LEGEND_IN
    figure, grid = _figure(_PANEL_IN * columns, height, rows, columns)
    more = f" (first {len(shown)} of {len(rooms)} rooms)" if len(shown) < len(rooms) else ""
    figure.text(0.5, 1 - 0.5 * _TITLE_IN / height, title + more, fontsize=13, ha="center")
    low, high = _LEGEND_IN / height, 1 - (_TITLE_IN + _LEGEND_IN) / height
    cast(Any, figure.get_layout_engine()).set(rect=(0, low, 1, high))
    panels = [
        (figure.add_subplot(grid[k // columns, k % columns]), room) for k, room in enumerate(shown)
    ]
    return figure, panels


def _plan_axes(axes: Axes, low: FloatArray, high: FloatArray, title: str) -> None:
    """Equal scales, a scale bar of one camera height, no frame."""
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_axis_off()
    axes.set_title(title, fontsize=10)
    start = low + 0.03 * (high - low)
    axes.plot([start[0], start[0] + 1], [start[1]] * 2, "-", color=WALL_COLOUR, linewidth=2)
    axes.annotate(
        "1 camera height",
        (start[0], start[1]),
        xytext=(0, 3),
        textcoords="offset points",
        fontsize=7,
        color=WALL_COLOUR,
    )


def _extent(parts: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """The box around nearly all points, with a margin."""
    points = np.concatenate([np.empty((0, 2)), *(part.reshape(-1, 2) for part in parts)])
    if len(points) == 0:
        return np.zeros(2), np.ones(2)
    low, high = np.quantile(points, [0.002, 0.998], axis=0)
    margin = 0.3 + 0.04 * float((high - low).max())
    return low - margin, high + margin


def _box(raster: Raster) -> FloatArray:
    """Corners of the cells that have something to say."""
    rows, columns = np.nonzero(np.nan_to_num(raster.values) > 0.05)
    if len(rows) == 0:
        return raster.low[None]
    cells = np.stack([rows, columns], axis=1)
    ends = np.stack([cells.min(axis=0), cells.max(axis=0) + 1])
    return np.asarray(raster.low + raster.cell * ends)


def _within(points: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    return points[((points >= low) & (points <= high)).all(axis=1)]


def _draw_cloud(axes: Axes, points: FloatArray, low: FloatArray, high: FloatArray) -> None:
    cell = float((high - low).max()) / _CLOUD_CELLS
    edges = [np.arange(low[k], high[k] + cell, cell) for k in (0, 1)]
    counts, _, _ = np.histogram2d(points[:, 0], points[:, 1], bins=edges)
    axes.imshow(
        counts.T,
        origin="lower",
        extent=(edges[0][0], edges[0][-1], edges[1][0], edges[1][-1]),
        cmap="Greys",
        vmin=0.0,
        vmax=max(1.0, float(np.quantile(counts[counts > 0], 0.6))) if counts.any() else 1.0,
        interpolation="nearest",
    )


def _image(axes: Axes, raster: Raster, colours: str, least: float, most: float) -> None:
    n, m = raster.values.shape
    x, y = raster.low
    axes.imshow(
        raster.values.T,
        origin="lower",
        extent=(x, x + n * raster.cell, y, y + m * raster.cell),
        cmap=colours,
        vmin=least,
        vmax=most,
        interpolation="nearest",
    )


def _contour(axes: Axes, raster: Raster, level: float, colour: str) -> None:
    n, m = raster.values.shape
    x = raster.low[0] + (np.arange(n) + 0.5) * raster.cell
    y = raster.low[1] + (np.arange(m) + 0.5) * raster.cell
    axes.contour(x, y, raster.values.T, levels=[level], colors=[colour], linewidths=0.8)


def _ring(axes: Axes, ring: FloatArray, colour: str, width: float) -> None:
    closed = np.vstack([ring, ring[:1]])
    axes.plot(*closed.T, "-", color=colour, linewidth=width)


def _sigma_text(room: ExplainedRoom) -> str:
    if room.outline is None:
        return room.failure or "no shape"
    known = room.sigmas[np.isfinite(room.sigmas)] if room.sigmas is not None else np.empty(0)
    told = f", ± {100 * float(np.median(known)):.1f} % of a camera height" if len(known) else ""
    return f"{len(room.outline)} walls{told}"


def _handle(colour: str, label: str) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], color=colour, linewidth=2, label=label)
