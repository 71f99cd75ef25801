"""Which way the walls of a layout run: the heading that most of them share, modulo 90°."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.config import TourConfig
from panoplan.poses.tour.room import RoomSeen
from panoplan.types.arrays import FloatArray

_QUARTER = np.pi / 2
_CHORD = 5
"""Wall points from one end of a chord to the other: 7°, longer than a boundary's ripples."""
_STEP_RAD = np.deg2rad(0.25)
_JUMP = 1.35
"""Ends of a chord whose ranges differ by more than this factor are on two walls."""


@dataclass(frozen=True)
class WallHeading:
    """Heading of a room's walls in the camera's frame.

    Attributes:
        heading: rad, in [0, π/2).
        share: of the length of the walls that runs along it or across, 0-1.
    """

    heading: float
    share: float


def wall_heading(room: RoomSeen, config: TourConfig) -> WallHeading | None:
    """The heading modulo 90° along which most of a room's walls run.

    Args:
        room: as seen from a camera.
        config: settings.

    Returns:
        The heading, or None where the room shows no wall.
    """
    start, end = room.points, np.roll(room.points, -_CHORD, axis=0)
    if len(start) <= 2 * _CHORD:
        return None
    chord = end - start
    length = np.hypot(*chord.T)
    ranges = [np.hypot(*p.T) for p in (start, end)]
    joined = np.maximum(ranges[0] / ranges[1], ranges[1] / ranges[0]) < _JUMP
    weight = np.where(joined, np.minimum(length, 1.0), 0.0)
    if not weight.sum() > 0:
        return None
    angle = np.arctan2(chord[:, 0], chord[:, 1])
    trial = np.arange(0.0, _QUARTER, _STEP_RAD)
    off = quarter_difference(angle, trial[:, None])
    width = np.deg2rad(config.wall_width_deg)
    best = trial[np.argmax((weight * np.exp(-0.5 * (off / width) ** 2)).sum(axis=1))]
    for _ in range(5):
        off = quarter_difference(angle, best)
        near = weight * np.exp(-0.5 * (off / width) ** 2)
        best = best + float((near * off).sum() / near.sum())
    share = float(weight[np.abs(off) < 2 * width].sum() / weight.sum())
    return WallHeading(float(best % _QUARTER), share)


def yaw_prior(
    a: WallHeading | None, b: WallHeading | None, steps: int, config: TourConfig
) -> FloatArray:
    """What the walls of two rooms say of the yaw from one camera to the other.

    Most homes have walls at right angles, not all: the prior prefers four yaws and forbids none.

    Args:
        a: of the first camera.
        b: of the second one.
        steps: number of yaws.
        config: settings.

    Returns:
        (steps,) log ratio of the probability of the yaws 2π·k/steps to that of any yaw.
    """
    if a is None or b is None:
        return np.zeros(steps)
    yaws = 2 * np.pi * np.arange(steps) / steps
    return log_yaw_ratio(quarter_difference(yaws, a.heading - b.heading), a, b, steps, config)


def log_yaw_ratio(
    off: FloatArray, a: WallHeading, b: WallHeading, steps: int, config: TourConfig
) -> FloatArray:
    """Log ratio for yaws that are `off` (rad) what the walls say, blurred by a step of 1/steps."""
    believed = config.right_angle_share * min(1.0, a.share * b.share / config.wall_share**2)
    sigma = np.hypot(
        np.sqrt(2) * np.deg2rad(config.wall_sigma_deg), 2 * np.pi / steps / np.sqrt(12)
    )
    density = np.exp(-0.5 * (off / sigma) ** 2) / (sigma * np.sqrt(2 * np.pi))
    return np.asarray(np.log(1 - believed + believed * _QUARTER * density))


def quarter_difference(a: FloatArray | float, b: FloatArray | float) -> FloatArray:
    """Signed difference a − b of two headings modulo 90°, in [−π/4, π/4)."""
    return np.asarray(np.mod(np.subtract(a, b) + _QUARTER / 2, _QUARTER) - _QUARTER / 2)
