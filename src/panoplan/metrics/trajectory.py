"""Trajectory metric: how far the cameras of a plan are from where they were."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.types.arrays import FloatArray


@dataclass(frozen=True)
class TrajectoryError:
    """Absolute trajectory error of camera positions in the plan.

    Attributes:
        cameras: how many were compared.
        rmse_cm: root mean square distance.
        median_cm: median distance.
        length_m: length of the true path through these cameras.
        rmse_percent_of_length: `rmse_cm` relative to `length_m`, None for a path of no length.
    """

    cameras: int
    rmse_cm: float
    median_cm: float
    length_m: float
    rmse_percent_of_length: float | None


def trajectory_error(estimated_m: FloatArray, true_m: FloatArray) -> TrajectoryError | None:
    """Error of positions that are already aligned.

    Args:
        estimated_m: (K, 2) in metres, true frame, in the order of the walk.
        true_m: (K, 2) true positions of the same cameras.

    Returns:
        The error, or None where there is no camera.
    """
    if not len(true_m):
        return None
    distance = np.hypot(*(estimated_m - true_m).T)
    length = float(np.hypot(*np.diff(true_m, axis=0).T).sum())
    rmse = float(np.sqrt(np.mean(distance**2)))
    return TrajectoryError(
        cameras=len(true_m),
        rmse_cm=100.0 * rmse,
        median_cm=100.0 * float(np.median(distance)),
        length_m=length,
        rmse_percent_of_length=100.0 * rmse / length if length > 0 else None,
    )
