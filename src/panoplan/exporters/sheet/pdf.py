"""Sheets as PDF: a page each, in true scale, with text that can be searched."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

from panoplan.exporters.drawing import FONT
from panoplan.exporters.sheet.marks import Mark, Shape, Sheet
from panoplan.exporters.svg import quiet_fonts

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

_PT_PER_MM = 72 / 25.4


def sheets_pdf(sheets: Sequence[Sheet]) -> bytes:
    """Sheets as the pages of a PDF; the same sheets give the same bytes."""
    import matplotlib
    from matplotlib.backends.backend_pdf import FigureCanvasPdf, PdfPages

    buffer = io.BytesIO()
    metadata = {"Title": sheets[0].title, "Creator": "panoplan", "CreationDate": None}
    with matplotlib.rc_context(), quiet_fonts():
        # Type 42 keeps letters as letters.
        matplotlib.rcParams["pdf.fonttype"] = 42
        with PdfPages(buffer, metadata=metadata) as pages:
            for sheet in sheets:
                figure = _page(sheet)
                FigureCanvasPdf(figure)
                pages.savefig(figure)
    return buffer.getvalue()


def _page(sheet: Sheet) -> Figure:
    from matplotlib.figure import Figure

    width, height = sheet.paper.width, sheet.paper.height
    figure = Figure(figsize=(width / 25.4, height / 25.4), facecolor="white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0.0, width)
    axes.set_ylim(height, 0.0)
    for marks in sheet.layers.values():
        for mark in marks:
            axes.add_artist(_artist(mark))
    for order, artist in enumerate(axes.get_children()):
        artist.set_zorder(order)
    return figure


def _artist(mark: Mark) -> Artist:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path
    from matplotlib.text import Text

    if isinstance(mark, Shape):
        paths = [
            Path([*ring, ring[0]] if mark.closed else ring, closed=mark.closed)
            for ring in mark.rings
        ]
        width = mark.width * _PT_PER_MM
        dash = [length * _PT_PER_MM / width for length in mark.dash]
        return PathPatch(
            Path.make_compound_path(*paths),
            facecolor=mark.fill or "none",
            edgecolor=mark.stroke or "none",
            linewidth=width if mark.stroke else 0.0,
            linestyle=(0, dash) if dash else "solid",
            joinstyle="miter",
            capstyle="butt",
        )
    return Text(
        *mark.at,
        mark.text,
        color=mark.colour,
        fontsize=mark.size * _PT_PER_MM,
        fontfamily=FONT,
        fontweight="bold" if mark.bold else "normal",
        ha={"start": "left", "middle": "center", "end": "right"}[mark.anchor],
        va="center_baseline",
        rotation=mark.angle_deg,
        rotation_mode="anchor",
        parse_math=False,
    )
