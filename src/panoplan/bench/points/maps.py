"""A scan seen from above: where walls are, and where floor is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from panoplan.errors import InputError
from panoplan.types.arrays import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class Maps:
    """Maps of a scene, cell (i, j) the square at `first_m` + (i, j) cells.

    Attributes:
        first_m: (2,) corner of the first cell, (x, z).
        cell_m: side of a cell.
        walls: (n, m) share of the height from floor to ceiling at which there are points, 0-1.
        floor: (n, m) whether there are points of the floor.
    """

    first_m: FloatArray
    cell_m: float
    walls: FloatArray
    floor: BoolArray

    def metres(self, cells: FloatArray) -> FloatArray:
        """(N, 2) points in cells, in metres."""
        return np.asarray(self.first_m + self.cell_m * cells)


_LARGEST_CELLS = 4096
_LAYER_M = 0.1
_FLOOR_M = 0.15
_GAP_M = 0.2
"""Floor between points nearer than twice this is floor."""
_RIM_CELLS = 8


def maps(points_m: FloatArray, cell_m: float) -> Maps:
    """Maps of a scan.

    Args:
        points_m: (N, 3) x right, y down, z forward; of one storey.
        cell_m: side of a cell.

    Returns:
        The maps. The floor is where the lowest 2 % of the points begin, the ceiling where the
        highest do.

    Raises:
        InputError: no points, or a scene of more than 4096 cells a side.
    """
    if not len(points_m):
        raise InputError("scan", "no points", "some")
    plan = points_m[:, [0, 2]]
    low, high = plan.min(axis=0), plan.max(axis=0)
    shape = np.ceil((high - low) / cell_m).astype(int) + 1 + 2 * _RIM_CELLS
    if shape.max() > _LARGEST_CELLS:
        size = f"{(high - low).max():.0f} m at {100 * cell_m:.0f} cm a cell"
        raise InputError("scan", size, f"at most {_LARGEST_CELLS} cells a side")
    first = low - _RIM_CELLS * cell_m
    cells = np.floor((plan - first) / cell_m).astype(int)
    ceiling, floor = np.percentile(points_m[:, 1], [2, 98])
    height = floor - points_m[:, 1]
    layers = max(1, int((floor - ceiling - 2 * _FLOOR_M) / _LAYER_M))
    layer = np.floor((height - _FLOOR_M) / _LAYER_M).astype(int)
    between = (layer >= 0) & (layer < layers)
    place = np.ravel_multi_index(cells.T, tuple(shape))
    filled = np.unique(place[between] * layers + layer[between])
    walls = np.bincount(filled // layers, minlength=int(shape.prod())).reshape(shape) / layers
    lowest = np.bincount(place[np.abs(height) <= _FLOOR_M], minlength=int(shape.prod()))
    reach = int(np.ceil(_GAP_M / cell_m))
    seen = ndimage.binary_closing(lowest.reshape(shape) > 0, _disc(reach))
    return Maps(first, cell_m, walls, np.asarray(seen))


def _disc(radius: int) -> BoolArray:
    steps = np.arange(-radius, radius + 1)
    return np.asarray(np.hypot(*np.meshgrid(steps, steps)) <= radius)
