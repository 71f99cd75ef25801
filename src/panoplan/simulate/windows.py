"""Windows in the outer walls of made-up buildings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from panoplan.simulate.buildings import InteriorRoom, Window


def outer_windows(rooms: Sequence[InteriorRoom], rng: np.random.Generator) -> tuple[Window, ...]:
    """A window in most of the longer walls that face no other room.

    Args:
        rooms: of one storey.
        rng: of all choices.
    """
    areas = [shapely.Polygon(r.polygon) for r in rooms]
    windows = []
    for k, room in enumerate(rooms):
        for a, b in zip(room.polygon, np.roll(room.polygon, -1, axis=0), strict=True):
            length = float(np.hypot(*(b - a)))
            along = (b - a) / length
            outward = np.array([along[1], -along[0]])
            outside = shapely.LineString([a + 0.4 * outward, b + 0.4 * outward])
            if length < 1.5 or rng.random() < 0.3 or shapely.intersects(outside, areas).any():
                continue
            width = min(length - 0.5, float(rng.uniform(0.9, 1.9)))
            start = float(rng.uniform(0.25, length - 0.25 - width))
            segment = a + np.array([[start], [start + width]]) * along
            windows.append(Window(k, segment))
    return tuple(windows)
