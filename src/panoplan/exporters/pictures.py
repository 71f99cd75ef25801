"""plan.png and plan.svg."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.exporters.drawing import plan_figure
from panoplan.formats.atomic import write_bytes
from panoplan.types.plan import FloorPlan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DPI = 160


def write_picture(path: Path, figure: Figure) -> None:
    """Writes a figure as PNG or SVG, by the path's suffix; the same figure gives the same bytes.

    Raises:
        InputError: the place cannot be written.
    """
    import matplotlib

    buffer = io.BytesIO()
    kind = path.suffix.lstrip(".")
    metadata = {"Date": None, "Creator": "panoplan"} if kind == "svg" else {"Software": "panoplan"}
    with matplotlib.rc_context({"svg.hashsalt": "panoplan", "svg.fonttype": "none"}):
        figure.savefig(buffer, format=kind, dpi=_DPI, metadata=metadata, facecolor="white")
    write_bytes(path, buffer.getvalue())


def write_plan_pictures(folder: Path, plan: FloorPlan) -> None:
    """Writes plan.svg and plan.png into a folder."""
    figure = plan_figure(plan)
    write_picture(folder / "plan.svg", figure)
    write_picture(folder / "plan.png", figure)
