"""Odometry of a walk: the true poses with drift, in a unit of its own."""

from __future__ import annotations

import numpy as np

from panoplan.simulate.walks import about_y
from panoplan.types.arrays import FloatArray
from panoplan.types.pose import Trajectory


def drifted(
    trajectory: Trajectory, drift_m: float, drift_deg: float, rng: np.random.Generator
) -> Trajectory:
    """The trajectory as odometry would have it: right at first, then gradually off.

    Heading and position err by smooth random walks over the way gone; the heading's error bends
    the way that follows.

    Args:
        trajectory: true poses, metres.
        drift_m: largest error of a position over the walk, ≥ 0; reached exactly unless the
            camera hardly moves.
        drift_deg: standard deviation of the heading's error at the end of the walk; lessened
            where it alone would cause a larger drift.
        rng: of the drift.

    Returns:
        Poses that agree with the true ones at the first keyframe, metres. Heights are true.
    """
    plan = trajectory.translations[:, [0, 2]]
    if len(plan) < 2 or drift_m == 0:
        return trajectory
    steps = np.diff(plan, axis=0)
    gone = np.concatenate([[0.0], np.cumsum(np.hypot(*steps.T))])
    if gone[-1] == 0:
        return trajectory
    turn = np.deg2rad(drift_deg) * _random_walk(gone, rng)
    slip = np.stack([_random_walk(gone, rng) for _ in range(2)], axis=1)
    bent = _offset(steps, turn)
    largest = float(np.hypot(*bent.T).max())
    if largest > 0.6 * drift_m:
        turn = turn * (0.6 * drift_m / largest)
        bent = _offset(steps, turn)
    offset = bent + _slip_to_reach(bent, slip, drift_m) * slip
    translations = trajectory.translations.copy()
    translations[:, [0, 2]] += offset
    return Trajectory(trajectory.labels, about_y(turn) @ trajectory.rotations, translations)


def in_units(trajectory: Trajectory, metres_per_su: float) -> Trajectory:
    """The trajectory with its translations in units of `metres_per_su` metres."""
    return Trajectory(
        trajectory.labels, trajectory.rotations, trajectory.translations / metres_per_su
    )


def _offset(steps: FloatArray, turn: FloatArray) -> FloatArray:
    """(N, 2) how far a way is off whose steps are turned by the heading's error before them."""
    c, s = np.cos(turn[:-1]), np.sin(turn[:-1])
    turned = np.stack([c * steps[:, 0] + s * steps[:, 1], c * steps[:, 1] - s * steps[:, 0]], 1)
    return np.vstack([np.zeros(2), np.cumsum(turned - steps, axis=0)])


def _random_walk(gone: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Brownian motion over the way, 0 at its start, made smooth, of unit variance at its end."""
    knots = 24
    walked = np.concatenate([[0.0], np.cumsum(rng.standard_normal(knots))]) / np.sqrt(knots)
    smooth = np.convolve(np.pad(walked, 2, mode="edge"), np.array([1, 4, 6, 4, 1]) / 16, "valid")
    smooth -= smooth[0]
    return np.asarray(np.interp(gone / gone[-1], np.linspace(0, 1, knots + 1), smooth))


def _slip_to_reach(bent: FloatArray, slip: FloatArray, drift_m: float) -> float:
    """The factor on `slip` with which the largest offset is `drift_m`."""
    low, high = 0.0, 1.0
    if np.hypot(*slip.T).max() == 0:
        return 0.0
    while np.hypot(*(bent + high * slip).T).max() < drift_m:
        high *= 2
    for _ in range(60):
        middle = (low + high) / 2
        if np.hypot(*(bent + middle * slip).T).max() < drift_m:
            low = middle
        else:
            high = middle
    return low
