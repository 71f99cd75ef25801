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


# Cells farther from the origin than this are all one, so that no pose asks for endless memory.
_FARTHEST_CELL = 2**27
# Odd and without pattern: neighbouring cells go to slots far apart.
_SCATTER = 0x1E3779B97F4A7C15


@njit(cache=True)
def _slot(keys, key):
    """Where a cell is in the hash table, or the free place that it gets."""
    mask = keys.size - 1
    slot = ((key * _SCATTER) >> 32) & mask
    while keys[slot] != key and keys[slot] >= 0:
        slot = (slot + 1) & mask
    return slot


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
    corners = 4 if smooth else 1
    out = np.empty(scales.size)
    # Occupied cells only: a walk may be long, and one lost pose may lie anywhere.
    size = 64
    while size < 2 * n_views * width * corners:
        size *= 2
    keys = np.full(size, -1, dtype=np.int64)
    histogram = np.zeros((size, n_sectors))
    taken = np.empty(size, dtype=np.int64)
    touched = np.empty(2 * n_views * width * corners, dtype=np.int64)
    shares = np.ones(4)
    slots = np.empty(4, dtype=np.int64)
    for k in range(scales.size):
        s = scales[k]
        n_taken, n_touched = 0, 0
        total = 0.0
        last_x, last_y = np.inf, np.inf
        for i in range(n_views):
            height = 1.0 + s * drops[i]
            for u in range(width):
                first = sectors[i, u]
                if first < 0:
                    continue
                # Cells are counted from the world's origin, so the curve is one function of s.
                x = (height * offsets[i, u, 0] + s * positions[i, 0]) / cell
                y = (height * offsets[i, u, 1] + s * positions[i, 1]) / cell
                x = min(max(x, -_FARTHEST_CELL), _FARTHEST_CELL)
                y = min(max(y, -_FARTHEST_CELL), _FARTHEST_CELL)
                ix, iy = np.floor(x), np.floor(y)
                if ix != last_x or iy != last_y:
                    last_x, last_y = ix, iy
                    for c in range(corners):
                        column, row = int(ix) + c // 2, int(iy) + c % 2
                        key = ((column + _FARTHEST_CELL) << 29) | (row + _FARTHEST_CELL)
                        slots[c] = _slot(keys, key)
                        if keys[slots[c]] < 0:
                            keys[slots[c]] = key
                            taken[n_taken] = slots[c]
                            n_taken += 1
                if smooth:
                    fx, fy = x - ix, y - iy
                    for c in range(4):
                        shares[c] = (fx if c // 2 else 1.0 - fx) * (fy if c % 2 else 1.0 - fy)
                for sector in range(2):
                    facing = (first + sector) % n_sectors
                    share = sector_weights[i, u] if sector == 0 else 1.0 - sector_weights[i, u]
                    for c in range(corners):
                        w = share * shares[c]
                        if w <= 0.0:
                            continue
                        if histogram[slots[c], facing] == 0.0:
                            touched[n_touched] = slots[c] * n_sectors + facing
                            n_touched += 1
                        histogram[slots[c], facing] += w
                        total += w
        entropy = 0.0
        counts = histogram.reshape(-1)
        for t in range(n_touched):
            p = counts[touched[t]] / total
            if saturation > 0.0:
                p = min(counts[touched[t]], saturation) / saturation
            entropy -= p * np.log(p)
            counts[touched[t]] = 0.0
        for t in range(n_taken):
            keys[taken[t]] = -1
        out[k] = entropy
    return out
