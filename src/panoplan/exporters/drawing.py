"""How a plan is drawn."""

from __future__ import annotations

import colorsys
from typing import TYPE_CHECKING

import numpy as np

from panoplan.geometry.polygons import signed_area
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import FloorPlan

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WALL = "#22272e"
PATH = "#64748b"
CORNER = "#c026d3"
_STEPS = (1.0, 2.0, 5.0)


def room_colour(index: int) -> tuple[float, float, float]:
    """A light colour; neighbouring indices lie far apart on the colour circle."""
    return colorsys.hls_to_rgb((0.58 + index * 0.381966) % 1.0, 0.80, 0.55)


def plan_figure(plan: FloorPlan, *, long_side_inch: float = 11.0) -> Figure:
    """A figure of the plan alone, as large as its extent asks for."""
    from matplotlib.figure import Figure

    low, high = extent(plan)
    width, height = np.maximum(high - low, 1e-6)
    scale = long_side_inch / max(width, height)
    figure = Figure(
        figsize=(max(width * scale, 5.0), max(height * scale, 4.0) + 0.6), layout="constrained"
    )
    draw_plan(figure.add_subplot(), plan)
    return figure


def extent(plan: FloorPlan) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest (x, y) of rooms and cameras, with a margin of 6 %."""
    points = [room.polygon for room in plan.rooms if room.polygon is not None]
    points += [pose.position[None] for pose in plan.trajectory]
    everything = np.concatenate(points) if points else np.array([[0.0, 0.0], [1.0, 1.0]])
    low, high = everything.min(axis=0), everything.max(axis=0)
    margin = 0.06 * max(float((high - low).max()), 0.5)
    return low - margin, high + margin


def draw_plan(axes: Axes, plan: FloorPlan, *, labels: bool = True) -> None:
    """Draws rooms, walls, corners, the camera's path, names, areas and a scale bar.

    Args:
        axes: where to; its limits and aspect are set.
        plan: the plan; rooms without a polygon are named below.
        labels: whether rooms are named.
    """
    for index, room in enumerate(plan.rooms):
        if room.polygon is None:
            continue
        ring = np.vstack([room.polygon, room.polygon[:1]])
        (area,) = axes.fill(*ring.T, color=room_colour(index), zorder=1, linewidth=0)
        area.set_gid(f"room-{room.id}")
        (outline,) = axes.plot(
            *ring.T, color=WALL, linewidth=2.0, solid_joinstyle="miter", zorder=3
        )
        outline.set_gid(f"walls-{room.id}")
        (dots,) = axes.plot(*room.polygon.T, "o", color=CORNER, markersize=3.5, zorder=4)
        dots.set_gid(f"corners-{room.id}")
    if plan.trajectory:
        path = np.array([pose.position for pose in plan.trajectory])
        (line,) = axes.plot(
            *path.T, "-o", color=PATH, linewidth=0.7, markersize=2.0, alpha=0.8, zorder=2
        )
        line.set_gid("path")
    if labels:
        _label_rooms(axes, plan)
    low, high = extent(plan)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.set_axis_off()
    _scale_bar(axes, plan, low, high)
    shapeless = [f"{room.name}: {room.failure}" for room in plan.rooms if room.polygon is None]
    if shapeless:
        text = "without a shape: " + "; ".join(shapeless)
        axes.text(
            0.0, -0.01, text, transform=axes.transAxes, va="top", fontsize=7, parse_math=False,
            wrap=True,
        )  # fmt: skip


def _label_rooms(axes: Axes, plan: FloorPlan) -> None:
    from shapely import Polygon, maximum_inscribed_circle

    low, high = extent(plan)
    span = float(max(high - low))
    unit = "m²" if plan.unit == "m" else "ch²"
    for room in plan.rooms:
        if room.polygon is None:
            continue
        circle = maximum_inscribed_circle(Polygon(room.polygon), tolerance=0.02 * span)
        (x, y), radius = circle.coords[0], circle.length
        text = f"{room.name}\n{signed_area(room.polygon):.1f} {unit}"
        axes.text(
            x, y, text, ha="center", va="center", zorder=5, color=WALL, parse_math=False,
            fontsize=float(np.clip(330 * radius / span, 4.5, 10.0)),
        ).set_gid(f"label-{room.id}")  # fmt: skip


def _scale_bar(axes: Axes, plan: FloorPlan, low: FloatArray, high: FloatArray) -> None:
    wanted = float(high[0] - low[0]) / 6
    power = 10.0 ** np.floor(np.log10(wanted))
    length = power * max(step for step in _STEPS if step * power <= wanted)
    x, y = low[0] + 0.01 * (high[0] - low[0]), low[1] + 0.012 * (high[1] - low[1])
    (bar,) = axes.plot([x, x + length], [y, y], color="black", linewidth=3, solid_capstyle="butt")
    bar.set_gid("scale-bar")
    unit = "m" if plan.unit == "m" else "camera heights"
    axes.text(
        x + length / 2, y, f"{length:g} {unit}\n", ha="center", va="center", fontsize=8,
        parse_math=False, linespacing=1.6,
    )  # fmt: skip
