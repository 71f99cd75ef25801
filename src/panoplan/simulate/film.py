"""A walk filmed: how fast a person goes and turns, and which frames become keyframes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from panoplan.simulate.buildings import Building
from panoplan.simulate.walks import (
    PATH_SPACING_M,
    Walk,
    about_x,
    about_y,
    about_z,
    camera_height,
    first_room,
    headings_along,
    locate,
    path_through,
    smooth_noise,
)
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.pose import Trajectory

_SPEED_SMOOTHING_M = 0.3
_SLOWEST_M_S = 0.1


@dataclass(frozen=True)
class Pace:
    """How a person walks with a camera, and how a SLAM picks keyframes.

    Attributes:
        frames_per_s: of the video.
        speed_m_s: on straight stretches, within 15 % of it.
        turn_deg_s: fastest turn.
        steps_per_s: of the feet at that speed.
        bob_m: amplitude of the rise and fall with each step at full speed.
        sway_m: standard deviation of the slow change of the camera's height.
        wander_deg: standard deviation of the camera's heading about the way gone.
        tilt_deg: standard deviation of pitch and of roll.
        parallax: a keyframe is taken where the camera has moved by about this share of the side of
            a square as large as the room: the next one then sees things from a new place.
        keyframe_m: least and largest such way, metres.
        unevenness: single ways differ by up to this share, as tracking goes better or worse.
    """

    frames_per_s: float = 10.0
    speed_m_s: float = 0.9
    turn_deg_s: float = 75.0
    steps_per_s: float = 1.8
    bob_m: float = 0.015
    sway_m: float = 0.01
    wander_deg: float = 8.0
    tilt_deg: float = 1.0
    parallax: float = 0.1
    keyframe_m: tuple[float, float] = (0.25, 1.0)
    unevenness: float = 0.25


PACE = Pace()


def film(
    building: Building,
    rng: np.random.Generator,
    pace: Pace = PACE,
    *,
    start: int | None = None,
    camera_height_m: float | None = None,
) -> Walk:
    """A person walks every room, through the doors and back through some, and films.

    Args:
        building: connected.
        rng: of all choices.
        pace: of the walk and of the keyframes.
        start: index of the first room, of the first storey; drawn where None.
        camera_height_m: nominal height; drawn from 1.4-1.7 m where None.

    Returns:
        The walk, with its frames; labels are frame numbers from 1.

    Raises:
        InputError: a room cannot be reached or is too narrow to walk in.
    """
    height = camera_height(rng, camera_height_m)
    path = path_through(building, rng, first_room(building, rng, start))
    headings = headings_along(path)
    speed = _speed(headings, pace, rng)
    seconds = np.concatenate([[0.0], np.cumsum(PATH_SPACING_M / speed[1:])])
    at = np.arange(0.0, seconds[-1], 1 / pace.frames_per_s)
    positions = np.stack([np.interp(at, seconds, path[:, k]) for k in range(2)], axis=1)
    floors_m = np.interp(at, seconds, path[:, 2])
    wander = np.deg2rad(pace.wander_deg) * smooth_noise(rng, len(at), 3 * pace.frames_per_s)
    beta = np.interp(at, seconds, headings) + wander
    rise, tilt = _gait(np.interp(at, seconds, speed), pace, rng)
    rotations = about_y(beta) @ about_x(tilt[:, 0]) @ about_z(tilt[:, 1])
    translations = np.stack([positions[:, 0], rise - floors_m, positions[:, 1]], axis=1)
    labels = tuple(f"{k + 1:06d}" for k in range(len(at)))
    rooms = locate(building, positions, beta, height + floors_m)
    kept = _keyframes(building, positions, rooms, pace, rng)
    return Walk(
        Trajectory(tuple(labels[k] for k in kept), rotations[kept], translations[kept]),
        rooms[kept],
        height,
        path[:, :2],
        Trajectory(labels, rotations, translations),
    )


def _speed(headings: FloatArray, pace: Pace, rng: np.random.Generator) -> FloatArray:
    """(P,) m/s at each point of the path: slower the sharper it turns."""
    usual = pace.speed_m_s * rng.uniform(0.85, 1.15)
    turning = np.abs(np.gradient(headings)) / PATH_SPACING_M
    fastest = np.deg2rad(pace.turn_deg_s) / np.maximum(turning, 1e-9)
    speed = np.clip(fastest, _SLOWEST_M_S, usual)
    # A person slows down before the turn and speeds up after it.
    calm = gaussian_filter1d(speed, _SPEED_SMOOTHING_M / PATH_SPACING_M)
    return np.asarray(np.minimum(speed, calm))


def _gait(speed: FloatArray, pace: Pace, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """(N,) the camera's y, and (N, 2) pitch and roll in rad, of each frame."""
    share = speed / pace.speed_m_s
    phase = 2 * np.pi * np.cumsum(pace.steps_per_s * np.sqrt(share)) / pace.frames_per_s
    slow = pace.sway_m * smooth_noise(rng, len(speed), 4 * pace.frames_per_s)
    rise = slow + pace.bob_m * share * np.sin(phase + rng.uniform(0, 2 * np.pi))
    lean = [smooth_noise(rng, len(speed), 2 * pace.frames_per_s) for _ in range(2)]
    return rise, np.deg2rad(pace.tilt_deg) * np.stack(lean, axis=1)


def _keyframes(
    building: Building,
    positions: FloatArray,
    rooms: IntArray,
    pace: Pace,
    rng: np.random.Generator,
) -> IntArray:
    """Indices of the frames that become keyframes, the first one included."""
    sides = np.sqrt([room.area for room in building.rooms])
    ways = np.clip(pace.parallax * sides, *pace.keyframe_m)
    # Every room gets keyframes, however small: the shortest way is less than any room's round.
    gone = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(positions, axis=0).T))])
    kept, due = [0], 0.0
    for k, room in enumerate(rooms):
        if k == 0 or gone[k] >= due:
            if k:
                kept.append(k)
            due = gone[k] + ways[room] * (1 + pace.unevenness * rng.uniform(-1, 1))
    return np.array(kept)
