"""Maps that a room's shape is found on: mask M_H and wall density M_P."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from panoplan.config import ShapeConfig
from panoplan.geometry.segments import splat_segments
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.room import WallPiece

# A wall between two rows of candidates is up to half a cell off both: it must still count.
_LEAST_CELLS = 0.8


@dataclass(frozen=True, eq=False)
class Grid:
    """A grid laid over one room, turned so that its axes follow the room's main walls.

    Grid coordinates are cells: cell (i, j) is the square [i, i + 1] × [j, j + 1].

    Attributes:
        axes: (2, 2) rows are the grid's axes in the walk frame.
        origin: (2,) of the grid in turned coordinates, camera heights.
        cell: size in camera heights.
        shape: number of cells along both axes.
    """

    axes: FloatArray
    origin: FloatArray
    cell: float
    shape: tuple[int, int]

    def to_grid(self, points: FloatArray) -> FloatArray:
        """(N, 2) points of the walk frame, in cells."""
        return np.asarray((points @ self.axes.T - self.origin) / self.cell)

    def to_walk(self, points: FloatArray) -> FloatArray:
        """(N, 2) points of the grid, in camera heights of the walk frame."""
        return np.asarray((points * self.cell + self.origin) @ self.axes)


def lay_grid(
    cells: FloatArray, lattice_cell: float, direction: float, count: int, config: ShapeConfig
) -> Grid:
    """A grid over a room's mask.

    Args:
        cells: (N, 2) centres of the mask's cells, walk frame.
        lattice_cell: their size.
        direction: of the grid's first axis in rad.
        count: cells along the longer side.
        config: settings; a `fixed_cell_ch` above zero overrides `count`.

    Returns:
        The grid, with room for the band of candidates around the mask.
    """
    c, s = np.cos(direction), np.sin(direction)
    axes = np.array([[c, s], [-s, c]])
    turned = cells @ axes.T
    low, high = turned.min(axis=0) - lattice_cell / 2, turned.max(axis=0) + lattice_cell / 2
    rim = config.band_out_cells + 3.0
    cell = config.fixed_cell_ch or float((high - low).max() / max(count - 2 * rim, 8.0))
    n, m = np.ceil((high - low) / cell + 2 * rim).astype(int)
    middle = (low + high) / 2
    origin = middle - np.array([n, m]) * cell / 2
    return Grid(axes, origin, cell, (int(n), int(m)))


def mask_on(
    grid: Grid, density: FloatArray, first_cell: tuple[int, int], lattice_cell: float, level: float
) -> BoolArray:
    """M_H on a grid: the room's density, interpolated, against the threshold.

    Args:
        grid: where to.
        density: (n, m) room density on the lattice.
        first_cell: lattice index of its first cell.
        lattice_cell: lattice cell size.
        level: threshold.

    Returns:
        Mask of the grid's shape: the largest part, its holes filled, its rim empty.
    """
    i, j = np.meshgrid(*(np.arange(k) + 0.5 for k in grid.shape), indexing="ij")
    centres = grid.to_walk(np.stack([i.ravel(), j.ravel()], axis=1))
    at = (centres / lattice_cell - 0.5 - np.asarray(first_cell)).T
    sampled = ndimage.map_coordinates(density, at, order=1, cval=0.0).reshape(grid.shape)
    return largest_part(sampled >= level)


def largest_part(mask: BoolArray) -> BoolArray:
    """The largest 4-connected part of a mask with its holes filled and a rim of one cell empty."""
    inner = np.zeros_like(mask)
    inner[1:-1, 1:-1] = mask[1:-1, 1:-1]
    labels, count = ndimage.label(inner)
    if count == 0:
        return inner
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    filled: BoolArray = ndimage.binary_fill_holes(labels == int(np.argmax(sizes)))
    return filled


def wall_density(grid: Grid, walls: Sequence[WallPiece], config: ShapeConfig) -> FloatArray:
    """M_P: how much wall there is in each cell, 0-1.

    Each wall piece is drawn along its plane with a profile as wide as the noise at its distance;
    the sum is divided by its largest value nearby, so that the ridge of many views counts as one
    wall, not as a broad band.

    Args:
        grid: where to.
        walls: the room's accepted pieces.
        config: settings.

    Returns:
        (n, m) density at the cells' centres.

    Source: Section III-F; profile and normalisation in docs/deviations.md.
    """
    total = np.zeros(grid.shape)
    if not walls:
        return total
    ends = np.array([grid.to_grid(wall.ends) for wall in walls])
    distance = np.array([wall.distance for wall in walls])
    sigma = config.wall_sigma_ch * np.maximum(1.0, (distance / config.wall_near_ch) ** 2)
    splat_segments(
        total, ends, np.maximum(sigma / grid.cell, _LEAST_CELLS), config.wall_sigma_ch / sigma
    )
    reach = 2 * int(np.ceil(config.wall_merge_ch / grid.cell)) + 1
    nearby = ndimage.maximum_filter(total, size=reach)
    floor = config.wall_floor
    return np.asarray(total / np.maximum(nearby, floor))
