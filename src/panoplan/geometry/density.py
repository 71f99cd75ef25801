"""Entropy of registered boundary points as a function of the scale (Eq. 3-4)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def registered_entropy(
    offsets: FloatArray,
    sectors: IntArray,
    sector_weights: FloatArray,
    positions: FloatArray,
    drops: FloatArray,
    scales: FloatArray,
    cell: float,
    n_sectors: int,
    smooth: bool,
    saturation: float = 0.0,
) -> FloatArray:
    """Entropy of the normalised histogram of all points, for each scale.

    The point of column u of view i at scale s is (1 + s·drop_i)·offset_iu + s·position_i.

    Args:
        offsets: (N, W, 2) boundary points relative to their camera for a camera height of 1,
            in the world's axes; NaN where unknown.
        sectors: (N, W) first of the two facings a point is shared between, −1 where unknown.
        sector_weights: (N, W) share of the first facing, 0-1.
        positions: (N, 2) camera positions in trajectory units.
        drops: (N,) how much higher than the first camera each one is, in trajectory units.
        scales: (S,) candidates s, camera heights a trajectory unit.
        cell: cell size in camera heights.
        n_sectors: number of facings.
        smooth: whether a point is shared among the four nearest cells.
        saturation: where above zero, the histogram is not normalised: a cell counts as
            min(count, saturation) / saturation.

    Returns:
        (S,) entropies in nats.
    """
    # Occupied cells only: a walk may be long, and one lost pose may lie anywhere.
    most = sectors.size * (4 if smooth else 1)
    places = np.full(1 << (2 * most - 1).bit_length(), -1, dtype=np.int64)
    cells = np.empty((most, 2), dtype=np.int64)
    touched = np.empty(2 * most, dtype=np.int64)
    histogram = np.zeros(most * n_sectors)
    out = np.empty(len(scales))
    _entropy(
        offsets,
        sectors,
        sector_weights,
        positions,
        drops,
        scales,
        cell,
        n_sectors,
        smooth,
        saturation,
        places,
        cells,
        touched,
        histogram,
        out,
    )
    return out


# Cells farther from the origin than this are all one, so that no pose asks for endless memory.
_FARTHEST_CELL = float(2**27)
# Odd and without pattern: neighbouring cells go to places far apart.
_SCATTER = 0x1E3779B97F4A7C15


@njit(cache=True)
def _entropy(
    offsets,
    sectors,
    sector_weights,
    positions,
    drops,
    scales,
    cell,
    n_sectors,
    smooth,
    saturation,
    places,
    cells,
    touched,
    histogram,
    out,
):
    n_views, width = sectors.shape
    corners = 4 if smooth else 1
    mask = places.size - 1
    for k in range(scales.size):
        s = scales[k]
        low_x, low_y = np.inf, np.inf
        for i in range(n_views):
            height = 1.0 + s * drops[i]
            for u in range(width):
                if sectors[i, u] >= 0:
                    low_x = min(low_x, height * offsets[i, u, 0] + s * positions[i, 0])
                    low_y = min(low_y, height * offsets[i, u, 1] + s * positions[i, 1])
        # Cells are counted from the world's origin, so that the curve is one function of s.
        x_0 = np.floor(max(low_x / cell, -_FARTHEST_CELL)) - 1
        y_0 = np.floor(max(low_y / cell, -_FARTHEST_CELL)) - 1
        n_cells, n_touched = 0, 0
        total = 0.0
        last_x, last_y = -1, -1
        row_0, row_1, row_2, row_3 = 0, 0, 0, 0
        for i in range(n_views):
            height = 1.0 + s * drops[i]
            for u in range(width):
                first = sectors[i, u]
                if first < 0:
                    continue
                x = (height * offsets[i, u, 0] + s * positions[i, 0]) / cell - x_0
                y = (height * offsets[i, u, 1] + s * positions[i, 1]) / cell - y_0
                x = min(max(x, 0.0), 2 * _FARTHEST_CELL)
                y = min(max(y, 0.0), 2 * _FARTHEST_CELL)
                ix, iy = int(x), int(y)
                if ix != last_x or iy != last_y:
                    last_x, last_y = ix, iy
                    for c in range(corners):
                        key = ((ix + (c >> 1)) << 29) + iy + (c & 1)
                        place = ((key * _SCATTER) >> 32) & mask
                        # Open addressing: a place holds the number of a cell, or -1.
                        while places[place] >= 0 and cells[places[place], 0] != key:
                            place = (place + 1) & mask
                        if places[place] < 0:
                            places[place] = n_cells
                            cells[n_cells, 0] = key
                            cells[n_cells, 1] = place
                            n_cells += 1
                        row_0, row_1, row_2, row_3 = row_1, row_2, row_3, places[place]
                fx, fy = x - ix, y - iy
                for sector in range(2):
                    share = 1.0 - sector_weights[i, u] if sector else sector_weights[i, u]
                    facing = first + sector if first + sector < n_sectors else 0
                    for c in range(4 - corners, 4):
                        row = row_0 if c == 0 else row_1 if c == 1 else row_2 if c == 2 else row_3
                        w = share
                        if smooth:
                            w = share * (fx if c > 1 else 1.0 - fx) * (fy if c & 1 else 1.0 - fy)
                        if w <= 0.0:
                            continue
                        at = row * n_sectors + facing
                        if histogram[at] == 0.0:
                            touched[n_touched] = at
                            n_touched += 1
                        histogram[at] += w
                        total += w
        entropy = 0.0
        for t in range(n_touched):
            count = histogram[touched[t]]
            histogram[touched[t]] = 0.0
            p = count / total
            if saturation > 0.0:
                p = min(count, saturation) / saturation
            entropy -= p * np.log(p)
        for row in range(n_cells):
            places[cells[row, 1]] = -1
        out[k] = entropy
