"""Figures as files, and the pictures that every run writes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.errors import InputError
from panoplan.exporters.png import LONG_SIDE_PX, figure_png, write_png
from panoplan.exporters.svg import figure_svg, write_svg
from panoplan.formats.atomic import write_bytes
from panoplan.types.plan import FloorPlan

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_picture(path: Path, figure: Figure, long_side_px: int = LONG_SIDE_PX) -> None:
    """Writes a figure as PNG or SVG, by the path's suffix; the same figure gives the same bytes.

    Args:
        path: the file, .png or .svg.
        figure: a matplotlib figure.
        long_side_px: longer side of a PNG.

    Raises:
        InputError: another suffix, or the place cannot be written.
    """
    kind = path.suffix.lower()
    if kind not in (".png", ".svg"):
        raise InputError(path, f"the suffix {kind!r}", ".png or .svg")
    write_bytes(path, figure_svg(figure) if kind == ".svg" else figure_png(figure, long_side_px))


def write_plan_pictures(folder: Path, plan: FloorPlan) -> None:
    """Writes plan.svg and plan.png into a folder.

    Raises:
        InputError: the place cannot be written.
    """
    write_svg(folder / "plan.svg", plan)
    write_png(folder / "plan.png", plan)
