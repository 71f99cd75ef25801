"""Marks of an explanation: rasters, lines and dots on a sheet, cut off at its edge."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from panoplan.exporters.drawing import QUIET_COLOUR, Sheet
from panoplan.exporters.layers import add_layer
from panoplan.types.arrays import FloatArray
from panoplan.types.explain import ExplainedView, Raster

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap

CONTEXT_COLOUR = "#C3C9D0"
FRAME_COLOUR = "#DDE1E6"
INK = ("#FFFFFF", "#C9DDEF", "#7FAAD4", "#1D4E89", "#0B2545")

Bounds = tuple[FloatArray, FloatArray]


def colour_map(names: Sequence[str]) -> Colormap:
    """A colour map through these colours, evenly spaced."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("panoplan", list(names))


def bounds_of(
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


def box_of(raster: Raster) -> FloatArray:
    """Corners of the cells that have something to say."""
    cells = np.argwhere(raster.values > 0.05).astype(float)
    if len(cells) == 0:
        return raster.origin[None]
    return np.concatenate([raster.at(cells), raster.at(cells + 1.0)])


def put(axes: Axes, sheet: Sheet, name: str, marks: Sequence[Artist], order: float) -> None:
    """Marks as a layer, cut off at the edge of the sheet, and its frame."""
    from matplotlib.patches import Rectangle

    width, height = sheet.high - sheet.low
    corner = (float(sheet.low[0]), float(sheet.low[1]))
    frame = Rectangle(
        corner, width, height, facecolor="none", edgecolor=FRAME_COLOUR, linewidth=0.8
    )
    frame.set_transform(axes.transData)
    add_layer(axes, name, [*marks, frame], order)
    for mark in marks:
        mark.set_clip_path(frame)


def image_of(axes: Axes, raster: Raster, colours: Colormap, least: float, most: float) -> Artist:
    """A raster in colours from `least` to `most`, turned as it lies in the plan."""
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


def lines_of(lines: Sequence[FloatArray], colour: Any, width: float, alpha: float = 1.0) -> Artist:
    """Open lines, each (N, 2)."""
    from matplotlib.collections import LineCollection

    return LineCollection(
        list(lines), colors=[colour], linewidths=width, alpha=alpha, capstyle="round"
    )


def ring_of(ring: FloatArray, colour: str, width: float, style: Any = "solid") -> Artist:
    """A closed line."""
    from matplotlib.lines import Line2D

    x, y = np.vstack([ring, ring[:1]]).T
    return Line2D(x, y, color=colour, linewidth=width, linestyle=style, solid_joinstyle="miter")


def dots(
    points: FloatArray | Sequence[FloatArray],
    sheet: Sheet,
    face: Any,
    edge: Any,
    size: float,
    alpha: float = 1.0,
) -> Artist:
    """Round dots, `size` printer's points wide on a sheet of weight 1."""
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


def path_of(views: Sequence[ExplainedView], sheet: Sheet) -> list[Artist]:
    """The camera path, broken between levels."""
    runs = [list(run) for _, run in groupby(views, key=lambda view: view.level)]
    lines = [np.array([view.camera for view in run]) for run in runs]
    return [lines_of(lines, QUIET_COLOUR, 0.7 * sheet.weight, 0.7)]
