"""Levelling: the world's y axis is turned onto gravity."""

from __future__ import annotations

import numpy as np

from panoplan.types.arrays import FloatArray
from panoplan.types.pose import Trajectory

_ITERATIONS = 50


def level(trajectory: Trajectory) -> tuple[Trajectory, FloatArray]:
    """Turns a trajectory so that gravity points along +y.

    Gravity is the geometric median of the cameras' down axes: people hold a 360° camera upright,
    and a few tilted ones do not move a median. It says which way is down too, so a world whose y
    axis points up is turned over. The turn is the smallest one and is always made: a level world
    that was tilted comes back as it was, and any tilted world gives the same level one up to a
    turn about the vertical.

    Args:
        trajectory: N ≥ 1 poses in any world.

    Returns:
        The level trajectory, and (3, 3) level_from_world.
    """
    turn = _smallest_turn(gravity(trajectory))
    return (
        Trajectory(
            trajectory.labels, turn @ trajectory.rotations, trajectory.translations @ turn.T
        ),
        turn,
    )


def gravity(trajectory: Trajectory) -> FloatArray:
    """(3,) unit vector of gravity in the world: the cameras' median down axis."""
    return median_direction(trajectory.rotations[:, :, 1])


def median_direction(directions: FloatArray) -> FloatArray:
    """(3,) geometric median of (N, 3) unit vectors, by Weiszfeld's iteration from their mean.

    Each iterate turns with the directions, so the answer does however far it has converged.
    """
    median = directions.mean(axis=0)
    for _ in range(_ITERATIONS):
        distance = np.maximum(np.linalg.norm(directions - median, axis=1), 1e-9)
        median = (directions / distance[:, None]).sum(axis=0) / (1 / distance).sum()
    length = float(np.linalg.norm(median))
    # As many cameras up as down: the first one decides.
    return np.asarray(median / length if length > 1e-6 else directions[0])


def _smallest_turn(down: FloatArray) -> FloatArray:
    """(3, 3) rotation about a horizontal axis that takes the unit vector `down` to +y."""
    x, y, z = (float(value) for value in down)
    sin = float(np.hypot(x, z))
    if sin == 0:
        return np.eye(3) if y > 0 else np.diag([1.0, -1.0, -1.0])
    # The axis is down × y; (sin, cos) need no division by 1 + cos, which vanishes for y up.
    ax, az = -z / sin, x / sin
    skew = np.array([[0, -az, 0], [az, 0, -ax], [0, ax, 0]])
    return np.asarray(np.eye(3) + sin * skew + (1 - y) * (skew @ skew))


def level_turn(rotation: FloatArray, gravity: FloatArray) -> FloatArray:
    """The turn that sets a camera upright, its heading kept.

    Args:
        rotation: (3, 3) world_from_cam.
        gravity: (3,) unit vector in that world.

    Returns:
        (3, 3) cam_from_level.
    """
    stands = _smallest_turn(gravity) @ rotation
    return np.asarray(stands.T @ upright(stands[None])[0])


def upright(rotations: FloatArray) -> FloatArray:
    """The rotations of cameras that look the same way and stand upright.

    Args:
        rotations: (N, 3, 3) of cameras in a level world.

    Returns:
        (N, 3, 3) turns about the vertical with the same heading of the cameras' z axes.
    """
    heading = np.arctan2(rotations[:, 0, 2], rotations[:, 2, 2])
    turns = np.zeros_like(rotations)
    turns[:, 0, 0] = turns[:, 2, 2] = np.cos(heading)
    turns[:, 0, 2], turns[:, 2, 0] = np.sin(heading), -np.sin(heading)
    turns[:, 1, 1] = 1
    return turns


def tilts_deg(rotations: FloatArray) -> FloatArray:
    """(N,) angles in degrees between cameras' down axes and gravity of a level world."""
    return np.degrees(np.arccos(np.clip(rotations[:, 1, 1], -1, 1)))
