"""Simple polygons: (N, 2) open rings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def signed_area(polygon: FloatArray) -> float:
    """Area of a polygon, positive where it runs counter-clockwise, by the shoelace formula."""
    x, y = (polygon - polygon[0]).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def counter_clockwise(polygon: FloatArray) -> FloatArray:
    """The polygon, reversed if it runs clockwise."""
    return polygon if signed_area(polygon) >= 0 else polygon[::-1]
