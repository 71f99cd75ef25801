"""Plans and figures as SVG: a group a layer, text as text, a metric plan in true scale."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.exporters.drawing import content_bounds, plan_figure, scaled_figure
from panoplan.exporters.storeys import spread
from panoplan.formats.atomic import write_bytes
from panoplan.types.plan import FloorPlan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCALES = (50, 100, 200, 500, 1000)
"""Denominators of the scales a drawing may have."""

LONG_SIDE_M = 0.40
"""Longest side of a drawing, that of an A3 sheet."""


@contextmanager
def quiet_fonts() -> Iterator[None]:
    """Draws names with letters that the font lacks as boxes, without a warning for each."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        warnings.filterwarnings("ignore", message=r"Matplotlib currently does not support")
        yield


def figure_svg(figure: Figure) -> bytes:
    """A figure as SVG bytes, the same for the same figure: no date, no random ids."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    buffer = io.BytesIO()
    with matplotlib.rc_context(), quiet_fonts():
        matplotlib.rcParams["svg.hashsalt"] = "panoplan"
        matplotlib.rcParams["svg.fonttype"] = "none"
        FigureCanvasSVG(figure).print_figure(
            buffer, format="svg", dpi=72, metadata={"Date": None, "Creator": None}
        )
    return buffer.getvalue()


def drawing_scale(plan: FloorPlan) -> int | None:
    """Denominator of the scale a plan is drawn at: the largest drawing that fits a sheet.

    Returns:
        50 for 1:50 and so on, None for a plan in camera heights or one too large for 1:1000.
    """
    if plan.unit != "m":
        return None
    low, high = content_bounds(plan)
    extent = float((high - low).max())
    return next((scale for scale in SCALES if extent / scale <= LONG_SIDE_M), None)


def write_svg(path: Path, plan: FloorPlan) -> None:
    """Writes a drawing of a plan, storeys side by side, in true scale where it is metric.

    Its groups have the ids rooms, walls, openings, path, corners, labels and scale.

    Args:
        path: the file.
        plan: the plan.

    Raises:
        InputError: the file cannot be written.
    """
    plan = spread(plan)
    scale = drawing_scale(plan)
    figure = plan_figure(plan) if scale is None else scaled_figure(plan, scale)
    write_bytes(path, figure_svg(figure))
