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
    return np.asarray(
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
        )
    )


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
):
    n_views, width = sectors.shape
    out = np.empty(scales.size)
    histogram = np.zeros(1)
    for k in range(scales.size):
        s = scales[k]
        low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
        for i in range(n_views):
            height = 1.0 + s * drops[i]
            for u in range(width):
                if sectors[i, u] < 0:
                    continue
                x = height * offsets[i, u, 0] + s * positions[i, 0]
                y = height * offsets[i, u, 1] + s * positions[i, 1]
                low_x, high_x = min(low_x, x), max(high_x, x)
                low_y, high_y = min(low_y, y), max(high_y, y)
        if low_x > high_x:
            out[k] = 0.0
            continue
        # Cells are counted from the world's origin, so that the curve is one function of s.
        ix0, iy0 = np.floor(low_x / cell) - 1, np.floor(low_y / cell) - 1
        nx = int(np.floor(high_x / cell) - ix0) + 3
        ny = int(np.floor(high_y / cell) - iy0) + 3
        size = nx * ny * n_sectors
        if histogram.size < size:
            histogram = np.zeros(size)
        touched = np.empty(n_views * width * (8 if smooth else 2), dtype=np.int64)
        n_touched = 0
        total = 0.0
        for i in range(n_views):
            height = 1.0 + s * drops[i]
            for u in range(width):
                first = sectors[i, u]
                if first < 0:
                    continue
                x = (height * offsets[i, u, 0] + s * positions[i, 0]) / cell - ix0
                y = (height * offsets[i, u, 1] + s * positions[i, 1]) / cell - iy0
                ix, iy = int(x), int(y)
                for sector in range(2):
                    facing = (first + sector) % n_sectors
                    share = sector_weights[i, u] if sector == 0 else 1.0 - sector_weights[i, u]
                    if share <= 0.0:
                        continue
                    if smooth:
                        fx, fy = x - ix, y - iy
                        for a in range(2):
                            for b in range(2):
                                w = share * (fx if a else 1.0 - fx) * (fy if b else 1.0 - fy)
                                if w > 0.0:
                                    at = ((ix + a) * ny + iy + b) * n_sectors + facing
                                    if histogram[at] == 0.0:
                                        touched[n_touched] = at
                                        n_touched += 1
                                    histogram[at] += w
                                    total += w
                    else:
                        at = (ix * ny + iy) * n_sectors + facing
                        if histogram[at] == 0.0:
                            touched[n_touched] = at
                            n_touched += 1
                        histogram[at] += share
                        total += share
        entropy = 0.0
        for t in range(n_touched):
            p = histogram[touched[t]] / total
            if saturation > 0.0:
                p = min(histogram[touched[t]], saturation) / saturation
            entropy -= p * np.log(p)
            histogram[touched[t]] = 0.0
        out[k] = entropy
    return out
