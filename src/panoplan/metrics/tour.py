"""Photo tours against true poses: how many are misplaced, and how far the others are off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.geometry.angles import wrapped
from panoplan.geometry.rigid import turn
from panoplan.metrics.alignment import fit
from panoplan.types.arrays import BoolArray, FloatArray

MISPLACED_M = 0.5
MISPLACED_RAD = float(np.deg2rad(6.0))


@dataclass(frozen=True)
class TourError:
    """Errors of one group of photos.

    Attributes:
        photos: how many were compared.
        misplaced: numbers of those more than 0.5 m or 6° off, the scale fixed.
        median_m: median position error after a similarity fitted to those not misplaced.
        p90_m: 90th percentile of it.
        heading_deg: median heading error after it.
        scale: of that similarity, 1 for a true camera height.
    """

    photos: int
    misplaced: tuple[int, ...]
    median_m: float
    p90_m: float
    heading_deg: float
    scale: float


def tour_error(poses_m: FloatArray, true_m: FloatArray) -> TourError:
    """Compares a group's poses with the true ones.

    Args:
        poses_m: (N, 3) x, z in metres by the true camera height, heading in rad; any frame.
        true_m: (N, 3) the true ones.

    Returns:
        The errors; the frame in which fewest photos are misplaced is that of some photo's pose.
    """
    wrong = _misplaced(poses_m, true_m)
    right = ~wrong
    if np.sum(right) < 2:
        return TourError(len(true_m), tuple(np.flatnonzero(wrong)), np.nan, np.nan, np.nan, np.nan)
    similarity = fit(poses_m[right, :2], true_m[right, :2], "similarity")
    off = np.hypot(*(similarity.apply(poses_m[:, :2]) - true_m[:, :2]).T)
    turned = wrapped(poses_m[:, 2] - true_m[:, 2])
    common = np.angle(np.exp(1j * turned[right]).mean())
    heading = np.rad2deg(np.abs(wrapped(turned - common)))
    return TourError(
        len(true_m),
        tuple(int(k) for k in np.flatnonzero(wrong)),
        float(np.median(off)),
        float(np.percentile(off, 90)),
        float(np.median(heading)),
        similarity.scale,
    )


def _misplaced(poses_m: FloatArray, true_m: FloatArray) -> BoolArray:
    """(N,) which photos are misplaced in the frame that leaves fewest so."""
    best, found = (np.inf, np.inf), np.ones(len(true_m), dtype=bool)
    for k in range(len(true_m)):
        yaw = true_m[k, 2] - poses_m[k, 2]
        moved = poses_m[:, :2] @ turn(yaw).T
        moved = moved + np.median(true_m[:, :2] - moved, axis=0)
        off = np.hypot(*(moved - true_m[:, :2]).T)
        turned = np.abs(wrapped(poses_m[:, 2] + yaw - true_m[:, 2]))
        wrong = (off > MISPLACED_M) | (turned > MISPLACED_RAD)
        score = (float(wrong.sum()), float(np.median(off)))
        if score < best:
            best, found = score, wrong
    return found
