"""Simple polygons: (N, 2) open rings."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def signed_area(polygon: FloatArray) -> float:
    """Area of a polygon, positive where it runs counter-clockwise, by the shoelace formula.

    Fewer than three corners enclose 0.
    """
    if len(polygon) < 3:
        return 0.0
    x, y = (polygon - polygon[0]).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def counter_clockwise(polygon: FloatArray) -> FloatArray:
    """The polygon, reversed if it runs clockwise."""
    return polygon if signed_area(polygon) >= 0 else polygon[::-1]


def untangled(polygon: FloatArray) -> FloatArray:
    """The largest part of what a polygon that crosses itself encloses.

    Args:
        polygon: (N, 2) corners.

    Returns:
        (M, 2) simple, counter-clockwise; corners that stay are as they were, the others are where
        edges crossed. Empty where nothing is enclosed.
    """
    if len(polygon) < 3:
        return np.empty((0, 2))
    area = shapely.make_valid(shapely.Polygon(polygon), method="structure", keep_collapsed=False)
    largest = max(shapely.get_parts(area), key=shapely.area, default=None)
    if largest is None or largest.is_empty:
        return np.empty((0, 2))
    return counter_clockwise(shapely.get_coordinates(largest.exterior)[:-1])
