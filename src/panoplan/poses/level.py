"""Levelling: the world's y axis is turned onto gravity."""

from __future__ import annotations

import numpy as np

from panoplan.types.arrays import FloatArray
from panoplan.types.pose import Trajectory

_ITERATIONS = 50


def level(trajectory: Trajectory) -> tuple[Trajectory, FloatArray]:
    """Turns a trajectory so that gravity points along +y.

    Gravity is the geometric median of the cameras' down axes: people hold a 360° camera upright,
    and a few tilted ones do not move a median. The turn is the smallest one and is always made,
    so a tilted world gives the same level one, exactly.

    Args:
        trajectory: N ≥ 1 poses in any world.

    Returns:
        The level trajectory, and (3, 3) level_from_world.
    """
    down = _geometric_median(trajectory.rotations[:, :, 1])
    turn = _smallest_turn(down)
    return (
        Trajectory(
            trajectory.labels, turn @ trajectory.rotations, trajectory.translations @ turn.T
        ),
        turn,
    )


def _geometric_median(directions: FloatArray) -> FloatArray:
    median = np.median(directions, axis=0)
    for _ in range(_ITERATIONS):
        distance = np.maximum(np.linalg.norm(directions - median, axis=1), 1e-9)
        median = (directions / distance[:, None]).sum(axis=0) / (1 / distance).sum()
    return np.asarray(median / np.linalg.norm(median))


def _smallest_turn(down: FloatArray) -> FloatArray:
    """(3, 3) rotation about a horizontal axis that takes `down` to +y."""
    axis = np.cross(down, [0.0, 1.0, 0.0])
    cos = float(down[1])
    if cos < -1 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + skew + skew @ skew / (1 + cos))
