"""Odometry of a walk: the true poses with drift, in a unit of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.simulate.walks import about_y
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.pose import Trajectory

_REFERENCE_M = 100.0
_MEDIAN_Z = 0.6744897501960817
"""Median of the size of a standard normal."""
_FIRST_CERTAIN = 0.1
"""Nothing is lost and nothing jumps in this first part of a walk: there is no map yet."""


@dataclass(frozen=True)
class OdometryErrors:
    """How a monocular SLAM errs on a walk.

    Position, heading and scale err by Brownian motions over the way gone: their standard
    deviations grow with its root, the errors of heading and scale bend and stretch what follows.

    Attributes:
        slip_m: standard deviation of each coordinate's own error after 100 m.
        heading_deg: of the heading's error after 100 m.
        scale: of the logarithm of the scale's error after 100 m.
        jump_share: probability that the walk has a jump, where the SLAM relocalises: all poses
            from there on are off by one motion more.
        jump_m: its typical length.
        jump_deg: standard deviation of its turn.
        lost_share: probability that a piece of the walk is lost: it has no keyframes.
        lost_m: least and largest way of that piece.
    """

    slip_m: float = 0.0
    heading_deg: float = 0.0
    scale: float = 0.0
    jump_share: float = 0.0
    jump_m: float = 0.0
    jump_deg: float = 0.0
    lost_share: float = 0.0
    lost_m: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class TourErrors:
    """How poses of still photos err, one by one.

    Attributes:
        position_m: root mean square error of a position.
        heading_deg: median error of a heading.
        misplaced_share: share of the rooms whose photos together are in a wrong place.
        misplaced_m: how far off they are.
    """

    position_m: float = 0.0
    heading_deg: float = 0.0
    misplaced_share: float = 0.0
    misplaced_m: float = 0.0


MEASURED_ODOMETRY = OdometryErrors(
    slip_m=0.06,
    heading_deg=0.5,
    scale=0.01,
    jump_share=0.3,
    jump_m=0.15,
    jump_deg=0.5,
    lost_share=0.25,
    lost_m=(2.0, 6.0),
)
"""Three times what a structure from motion errs by on rendered walks (0.03-0.07 % of 33 m), as
real video is blurred and rooms are emptier; jumps and lost pieces are assumed."""

MEASURED_TOUR = TourErrors(
    position_m=0.13, heading_deg=0.45, misplaced_share=1 / 20, misplaced_m=2.6
)
"""Of a photo-tour aligner's poses of 56 real panoramas: 0.13 m for 52 of them, one bedroom of three
off by 2.6 m, median heading error 0.45°."""


def wandered(
    trajectory: Trajectory, errors: OdometryErrors, rng: np.random.Generator
) -> tuple[Trajectory, BoolArray]:
    """The trajectory as a SLAM would have it.

    Args:
        trajectory: true poses of the keyframes of a walk, metres.
        errors: how it errs.
        rng: of the errors.

    Returns:
        Poses that agree with the true ones at the first keyframe, metres, heights as they are;
        and (N,) which keyframes there are: those of a lost piece are not.
    """
    steps = np.diff(trajectory.translations[:, [0, 2]], axis=0)
    ways = np.hypot(*steps.T)
    gone = np.concatenate([[0.0], np.cumsum(ways)])
    growth = np.sqrt(ways / _REFERENCE_M)

    def brownian(sigma: float) -> FloatArray:
        return np.concatenate([[0.0], np.cumsum(sigma * growth * rng.standard_normal(len(ways)))])

    turn = brownian(np.deg2rad(errors.heading_deg))
    stretch = np.exp(brownian(errors.scale))
    slip = np.stack([brownian(errors.slip_m) for _ in range(2)], axis=1)
    jumps, jump_at = rng.random() < errors.jump_share, _somewhere(gone, 0.0, rng)
    leap = errors.jump_m / np.sqrt(2) * rng.standard_normal(2)
    twist = np.deg2rad(errors.jump_deg) * rng.standard_normal()
    if jumps:
        turn = turn + twist * (gone > jump_at)
        slip = slip + np.where((gone > jump_at)[:, None], leap, 0.0)
    moved = np.cumsum(_turned(steps * stretch[:-1, None], turn[:-1]), axis=0)
    translations = trajectory.translations.copy()
    translations[1:, [0, 2]] = translations[0, [0, 2]] + moved
    translations[:, [0, 2]] += slip
    kept = np.ones(len(trajectory), dtype=np.bool_)
    loses, length = rng.random() < errors.lost_share, rng.uniform(*errors.lost_m)
    lost_at = _somewhere(gone, float(length), rng)
    if loses:
        kept = (gone <= lost_at) | (gone > lost_at + length)
    rotations = about_y(turn) @ trajectory.rotations
    return Trajectory(trajectory.labels, rotations, translations), kept


def toured(
    trajectory: Trajectory, rooms: IntArray, errors: TourErrors, rng: np.random.Generator
) -> Trajectory:
    """The poses of still photos as an aligner of photos would have them.

    Args:
        trajectory: true poses, metres.
        rooms: (N,) the room each photo is of.
        errors: how it errs.
        rng: of the errors.

    Returns:
        The poses, metres, heights as they are; the first one's room is never misplaced.
    """
    n = len(trajectory)
    translations = trajectory.translations.copy()
    off = errors.position_m / np.sqrt(2) * rng.standard_normal((n, 2))
    for room in np.unique(rooms):
        astray, towards = rng.random() < errors.misplaced_share, rng.uniform(0, 2 * np.pi)
        if astray and room != rooms[0]:
            off[rooms == room] += errors.misplaced_m * np.array([np.cos(towards), np.sin(towards)])
    translations[:, [0, 2]] += off
    turn = np.deg2rad(errors.heading_deg) / _MEDIAN_Z * rng.standard_normal(n)
    return Trajectory(trajectory.labels, about_y(turn) @ trajectory.rotations, translations)


def _somewhere(gone: FloatArray, length: float, rng: np.random.Generator) -> float:
    """A place of the way after its first part, a given length before its end."""
    first = _FIRST_CERTAIN * gone[-1]
    return float(first + max(gone[-1] - first - length, 0.0) * rng.random())


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
    return np.vstack([np.zeros(2), np.cumsum(_turned(steps, turn[:-1]) - steps, axis=0)])


def _turned(steps: FloatArray, turn: FloatArray) -> FloatArray:
    """(N, 2) plan vectors, each turned by its own angle from z towards x."""
    c, s = np.cos(turn), np.sin(turn)
    return np.stack([c * steps[:, 0] + s * steps[:, 1], c * steps[:, 1] - s * steps[:, 0]], axis=1)


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
