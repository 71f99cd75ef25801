"""Figures of an explanation: head, panels, legend."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from panoplan.exporters.drawing import (
    FONT,
    QUIET_COLOUR,
    WALL_COLOUR,
    Sheet,
    draw_sheet,
    plan_text,
    unit_name,
)
from panoplan.exporters.explain.marks import CONTEXT_COLOUR, FRAME_COLOUR, Bounds
from panoplan.exporters.labels import width_em
from panoplan.types.explain import ExplainedRoom, Explanation
from panoplan.types.plan import Unit

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WEIGHT = 0.85
"""Of the panels' fonts and lines."""

_HEAD_IN, _FOOT_IN = 0.95, 0.55
_EDGE_IN = 0.35
_LEAST_IN = 8.5
"""A narrower page has no room for note and legend."""
_LEGEND_PT = 8.0


def camera_height(explanation: Explanation) -> float:
    """Plan units a camera height."""
    room = next(iter(explanation.rooms), None)
    return 1.0 if room is None else room.density.cell / explanation.config.rooms.cell_ch


def length_text(value: float, unit: Unit) -> str:
    """A length in plan units, in centimetres where the plan is metric."""
    if unit == "m":
        return f"{100 * value:.0f} cm"
    return f"{value:.2g} {unit_name(unit, value)}"


def blank_page(width_in: float, height_in: float) -> Figure:
    """An empty figure of this size between head and foot."""
    from matplotlib.figure import Figure

    size = (max(width_in, _LEAST_IN) + 2 * _EDGE_IN, height_in + _HEAD_IN + _FOOT_IN)
    return Figure(figsize=size, facecolor="white")


def centred(figure: Figure, width_in: float) -> float:
    """Where something of this width begins that stands in the middle of the figure, in inches."""
    return (float(figure.get_size_inches()[0]) - width_in) / 2 - _EDGE_IN


def axes_at(figure: Figure, corner: tuple[float, float], size: tuple[float, float]) -> Axes:
    """Axes by their lower left corner and size in inches, above the foot."""
    width, height = figure.get_size_inches()
    left, bottom = corner[0] + _EDGE_IN, corner[1] + _FOOT_IN
    return figure.add_axes((left / width, bottom / height, size[0] / width, size[1] / height))


def write(figure: Figure, left: float, up: float, text: str, size: float, colour: str) -> None:
    """Text by the place of its upper left corner in inches, above the foot."""
    width, height = figure.get_size_inches()
    x, y = (left + _EDGE_IN) / width, (up + _FOOT_IN) / height
    made = plan_text(x, y, text, size, colour, ha="left", va="top", linespacing=1.3)
    made.set_transform(figure.transFigure)
    figure.add_artist(made)


def panel_height(bounds: Bounds, width_in: float) -> float:
    """Height of axes of this width that hold bounds with title and scale bar, in inches."""
    width, height = bounds[1] - bounds[0]
    return width_in * float(np.clip(height / width, 0.25, 1.3)) + 0.55


def heading(figure: Figure, title: str, note: str) -> None:
    """The title of a figure and a note below it."""
    from textwrap import fill

    width, height = figure.get_size_inches()
    top = height - _FOOT_IN - 0.2
    write(figure, 0.0, top, title, 14.0, WALL_COLOUR)
    characters = int((width - 2 * _EDGE_IN) * 72 / (8.5 * 0.53))
    write(figure, 0.0, top - 0.32, fill(note, characters), 8.5, QUIET_COLOUR)


def room_page(
    rooms: Sequence[ExplainedRoom], columns: int, panel: float, title: str, note: str
) -> tuple[Figure, Iterator[tuple[Axes, ExplainedRoom]]]:
    """A figure with square axes a room."""
    columns = min(columns, max(1, len(rooms)))
    rows = -(-len(rooms) // columns)
    figure = blank_page(columns * panel, rows * panel)
    heading(figure, title, note)
    left = centred(figure, columns * panel)
    places = (
        (left + k % columns * panel, (rows - 1 - k // columns) * panel) for k in range(len(rooms))
    )
    axes = (axes_at(figure, place, (panel, panel)) for place in places)
    return figure, zip(axes, rooms, strict=True)


def room_sheet(axes: Axes, bounds: Bounds, unit: Unit, room: ExplainedRoom, told: str) -> Sheet:
    """Lays out a room's axes: its name above, scale bar and some words below."""
    return draw_sheet(axes, bounds, unit, title=room.name, told=told, weight=WEIGHT)


def legend(figure: Figure, handles: Sequence[Artist]) -> None:
    """The legend at the foot of a figure, in one row or two."""
    labels = [str(handle.get_label()) for handle in handles]
    # A handle with its gaps is as wide as four letters M.
    needed = sum(width_em(label) + 4.0 for label in labels) * _LEGEND_PT / 72
    rows = 1 if needed < figure.get_size_inches()[0] else 2
    figure.legend(
        handles=list(handles),
        loc="lower center",
        bbox_to_anchor=(0.5, 0.12 / float(figure.get_size_inches()[1])),
        ncols=-(-len(handles) // rows),
        frameon=False,
        handletextpad=0.5,
        columnspacing=1.4,
        prop={"family": FONT, "size": _LEGEND_PT},
        labelcolor=WALL_COLOUR,
    )


def stroke(label: str, colour: str, style: Any = "solid") -> Artist:
    """A line for the legend."""
    from matplotlib.lines import Line2D

    return Line2D([], [], color=colour, linewidth=1.6, linestyle=style, label=label)


def dot(label: str, face: str, edge: str, size: float = 5.0) -> Artist:
    """A dot for the legend."""
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


def swatch(label: str, colour: Any) -> Artist:
    """A field of colour for the legend."""
    from matplotlib.patches import Patch

    return Patch(facecolor=colour, edgecolor=CONTEXT_COLOUR, linewidth=0.6, label=label)


def dress(axes: Axes, title: str) -> None:
    """Quiet axes for a curve."""
    axes.set_title(title, fontsize=9, fontfamily=FONT, color=WALL_COLOUR, loc="left")
    axes.tick_params(
        labelsize=7.5, labelfontfamily=FONT, labelcolor=WALL_COLOUR, color=QUIET_COLOUR
    )
    axes.grid(color=FRAME_COLOUR, linewidth=0.6)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(QUIET_COLOUR)
