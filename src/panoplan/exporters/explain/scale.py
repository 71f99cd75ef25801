"""How the trajectory was scaled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from panoplan.exporters.drawing import CORNER_COLOUR, FONT, PATH_COLOUR, WALL_COLOUR, draw_sheet
from panoplan.exporters.explain.marks import INK, Bounds, bounds_of, colour_map, image_of, put
from panoplan.exporters.explain.page import (
    WEIGHT,
    axes_at,
    blank_page,
    camera_height,
    dress,
    heading,
    length_text,
    panel_height,
    write,
)
from panoplan.types.arrays import FloatArray
from panoplan.types.explain import Cloud, ExplainedScale, Explanation, Raster

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def scale_figure(explanation: Explanation) -> Figure:
    """All boundary points at some scales, and the entropy over the scale."""
    scale, unit = explanation.scale, explanation.unit
    clouds = scale.clouds
    cell = explanation.config.scale.cells_ch[0] * camera_height(explanation)
    bounds = bounds_of([cloud.points for cloud in clouds])
    columns = max(len(clouds), 3)
    panel = 4.2
    tall = panel_height(bounds, panel)
    curve_in = 3.6
    figure = blank_page(columns * panel, tall + curve_in)
    heading(
        figure,
        "Scale of the trajectory",
        f"Above, all boundary points in cells of {length_text(cell, unit)}, as the entropy sees "
        "them: at the right scale walls seen from several places lie on one another. Below, the "
        "objective that the search minimises (Eq. 3-4).",
    )
    counts = [_counted(cloud.points, bounds, cell) for cloud in clouds]
    most = max((float(raster.values.max()) for raster in counts), default=1.0)
    for k, (cloud, raster) in enumerate(zip(clouds, counts, strict=True)):
        axes = axes_at(figure, (k * panel, curve_in), (panel, tall))
        sheet = draw_sheet(axes, bounds, unit, title=_cloud_title(cloud, scale), weight=WEIGHT)
        image = image_of(axes, raster, colour_map(INK), 0.0, 0.8 * most)
        put(axes, sheet, "cloud", [image], 1)
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
        write(figure, wide - facts_in + 0.1, y + tall - 0.24 * k, text, 8.5, colour)
    searched = scale.searched
    if searched is None or searched.curve is None or used is None:
        return
    s, objective = searched.curve.T
    settings = explanation.config.scale
    label = "entropy" if settings.saturation == 0 else "entropy of saturated counts"
    label += " less that of the control" if settings.control else ""
    label += " and what others see through" if settings.intrusion else ""
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
        axes = axes_at(figure, (gap + k * (each + gap), y), (each, tall))
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
        dress(axes, "whole range searched" if k == 0 else "near the one used")
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
_WARNING_COLOUR = "#D9480F"


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
            facts.append(("at the edge of the range: do not trust it", _WARNING_COLOUR))
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
