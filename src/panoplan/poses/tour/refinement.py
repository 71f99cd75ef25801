"""All photos of a group at once: the poses that matches and layouts speak for most."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from panoplan.config import TourConfig
from panoplan.geometry.angles import wrapped
from panoplan.poses.tour.frames import relative
from panoplan.poses.tour.pair import Pair
from panoplan.types.arrays import FloatArray

_WIDTHS = (4.0, 3.0, 2.0, 1.4, 1.0, 1.0, 1.0)
_CHOOSING = (0, 2, 4)
"""Steps at which it is asked anew which pairs agree."""
_LONGEST_STEP = 0.3
"""Camera heights or radians that a photo moves at most in one step."""
_GAUGE = 1e9


def refined(
    poses: Mapping[int, FloatArray], pairs: Mapping[tuple[int, int], Pair], config: TourConfig
) -> tuple[dict[int, FloatArray], FloatArray]:
    """Least squares on the matches of all pairs, weighted by their probability to be inliers.

    Args:
        poses: (3,) x, z, heading of each photo by number, near the optimum.
        pairs: by the numbers of the photos, the lower first.
        config: settings.

    Returns:
        The poses, the first one unmoved; and (3 N, 3 N) their covariance, in the order of the
        photos, zero for the first one.
    """
    keys = list(poses)
    place = {key: k for k, key in enumerate(keys)}
    x = np.array([poses[key] for key in keys])
    chosen = [(i, j) for i in sorted(keys) for j in sorted(keys) if i < j]
    information = np.eye(x.size)
    for n, width in enumerate(_WIDTHS):
        if n in _CHOOSING:
            agreeing = [key for key in chosen if _agrees(pairs[key], x, place, key, config)]
        information, gradient = _normal_equations(x, agreeing, place, pairs, width, config)
        step = np.linalg.solve(information, gradient).reshape(-1, 3)
        longest = np.abs(step).max()
        x = x + step * min(1.0, _LONGEST_STEP / max(longest, 1e-12))
        x[:, 2] = wrapped(x[:, 2])
    covariance: FloatArray = np.linalg.inv(information).astype(np.float64)
    covariance[:3] = covariance[:, :3] = 0.0
    return {key: x[k] for key, k in place.items()}, covariance


def _normal_equations(
    x: FloatArray,
    chosen: list[tuple[int, int]],
    place: Mapping[int, int],
    pairs: Mapping[tuple[int, int], Pair],
    width: float,
    config: TourConfig,
) -> tuple[FloatArray, FloatArray]:
    information, gradient = 1e-6 * np.eye(x.size), np.zeros(x.size)
    information[:3, :3] += _GAUGE * np.eye(3)
    for i, j in chosen:
        a, b = place[i], place[j]
        b_in_a = relative(x[a], x[b])
        told, drawn = pairs[i, j].pull(b_in_a, width)
        slope = _slope(x[a], x[b])
        at = np.r_[3 * a : 3 * a + 3, 3 * b : 3 * b + 3]
        information[np.ix_(at, at)] += slope.T @ told @ slope
        gradient[at] += slope.T @ drawn
    return information, gradient


def _agrees(
    pair: Pair,
    x: FloatArray,
    place: Mapping[int, int],
    key: tuple[int, int],
    config: TourConfig,
) -> bool:
    """Whether the matches of a pair speak for its poses."""
    b_in_a = relative(x[place[key[0]]], x[place[key[1]]])
    length = float(np.hypot(*b_in_a[:2]))
    if not len(pair.matches) or not config.shortest_ch < length < config.longest_ch:
        return False
    return pair.features(b_in_a) >= config.edge_evidence


def _slope(a: FloatArray, b: FloatArray) -> FloatArray:
    """(3, 6) derivative of yaw, direction and log length by both poses."""
    x, z = b[:2] - a[:2]
    square = x * x + z * z
    out = np.zeros((3, 6))
    out[0, 2], out[0, 5] = -1.0, 1.0
    out[1, 3:5] = z / square, -x / square
    out[2, 3:5] = x / square, z / square
    out[1:, :2] = -out[1:, 3:5]
    out[1, 2] = -1.0
    return out
