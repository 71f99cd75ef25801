"""Plans and figures as PNG."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.exporters.drawing import plan_figure
from panoplan.exporters.storeys import spread
from panoplan.exporters.svg import quiet_fonts
from panoplan.formats.atomic import write_bytes
from panoplan.types.plan import FloorPlan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONG_SIDE_PX = 2400


def figure_png(figure: Figure, long_side_px: int = LONG_SIDE_PX) -> bytes:
    """A figure as PNG bytes, the same for the same figure.

    Args:
        figure: a matplotlib figure.
        long_side_px: its longer side in pixels.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    buffer = io.BytesIO()
    dpi = long_side_px / float(max(figure.get_size_inches()))
    with quiet_fonts():
        FigureCanvasAgg(figure).print_figure(
            buffer, format="png", dpi=dpi, facecolor="white", metadata={"Software": None}
        )
    return buffer.getvalue()


def write_png(path: Path, plan: FloorPlan, long_side_px: int = LONG_SIDE_PX) -> None:
    """Writes a drawing of a plan, storeys side by side.

    Args:
        path: the file.
        plan: the plan.
        long_side_px: longer side of the image.

    Raises:
        InputError: the file cannot be written.
    """
    write_bytes(path, figure_png(plan_figure(spread(plan)), long_side_px))
