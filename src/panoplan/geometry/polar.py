"""Star-shaped regions: a range for each heading around a camera."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]


def range_profile(offsets: FloatArray, bins: int, max_gap: float) -> FloatArray:
    """Ranges at evenly spaced headings.

    Args:
        offsets: (W, 2) boundary points relative to the camera, NaN where unknown.
        bins: number of headings; bin b looks along 2π(b + ½)/bins − π from the second axis
            towards the first.
        max_gap: headings farther apart than this (rad) leave unknown bins between them.

    Returns:
        (bins,) ranges, NaN where unknown.
    """
    known = offsets[np.isfinite(offsets[:, 0])]
    out = np.full(bins, np.nan)
    if len(known) < 2:
        return out
    heading = np.arctan2(known[:, 0], known[:, 1])
    order = np.argsort(heading, kind="stable")
    heading, distance = heading[order], np.hypot(known[order, 0], known[order, 1])
    at = 2 * np.pi * (np.arange(bins) + 0.5) / bins - np.pi
    after = np.searchsorted(heading, at)
    before, after = (after - 1) % len(heading), after % len(heading)
    gap = np.mod(heading[after] - heading[before], 2 * np.pi)
    share = np.mod(at - heading[before], 2 * np.pi) / np.where(gap > 0, gap, 1.0)
    filled = distance[before] + np.clip(share, 0, 1) * (distance[after] - distance[before])
    close = gap <= max_gap
    out[close] = filled[close]
    return out


def star_area(profile: FloatArray, radius: float) -> float:
    """Area of the star-shaped region, clipped at `radius`; unknown bins count as empty."""
    clipped = np.minimum(np.nan_to_num(profile, nan=0.0), radius)
    return float(0.5 * np.sum(clipped**2) * 2 * np.pi / len(profile))


def star_evidence(
    camera: FloatArray,
    profile: FloatArray,
    radius: float,
    band: float,
    beyond_weight: float,
    cell: float,
    first_cell: tuple[int, int],
    shape: tuple[int, int],
) -> tuple[Float32Array, Float32Array]:
    """What one view says of each cell of a lattice.

    Cell (i, j) of the lattice has its centre at ((i + ½)·cell, (j + ½)·cell).

    Args:
        camera: (2,) position.
        profile: (B,) ranges as `range_profile` gives them.
        radius: beyond it nothing is said.
        band: up to so far beyond the boundary a view speaks against a cell with weight 1.
        beyond_weight: the weight farther beyond.
        cell: cell size.
        first_cell: index of the first cell of the answer.
        shape: cells along both axes.

    Returns:
        free: 1 where the cell lies inside the boundary, else 0.
        against: weight with which the view speaks against the cell.
    """
    free = np.zeros(shape, dtype=np.float32)
    against = np.zeros(shape, dtype=np.float32)
    _star_evidence(
        float(camera[0]),
        float(camera[1]),
        profile,
        radius,
        band,
        beyond_weight,
        cell,
        first_cell[0],
        first_cell[1],
        free,
        against,
    )
    return free, against


@njit(cache=True)
def _star_evidence(cx, cy, profile, radius, band, beyond_weight, cell, i0, j0, free, against):
    bins = profile.size
    for i in range(free.shape[0]):
        x = (i0 + i + 0.5) * cell - cx
        if abs(x) > radius:
            continue
        for j in range(free.shape[1]):
            y = (j0 + j + 0.5) * cell - cy
            distance = np.sqrt(x * x + y * y)
            if distance > radius:
                continue
            b = int((np.arctan2(x, y) + np.pi) * bins / (2 * np.pi)) % bins
            limit = profile[b]
            if np.isnan(limit):
                continue
            if distance < limit:
                free[i, j] = 1.0
            elif distance < limit + band:
                against[i, j] = 1.0
            else:
                against[i, j] = beyond_weight
