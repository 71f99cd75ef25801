"""Bayesian filter of a room's wall directions (Section III-E, Eq. 7)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from panoplan.config import OrientationConfig
from panoplan.geometry.angles import line_angle, line_difference
from panoplan.types.room import Orientation, WallPiece


def observe(
    orientations: Sequence[Orientation], wall: WallPiece, config: OrientationConfig
) -> tuple[Orientation, ...]:
    """Updates the nearest direction with a wall, or starts a new one.

    The product of two normal distributions is normal: precisions add, means are averaged by
    precision. Angles of walls have period π.

    Args:
        orientations: the room's directions so far.
        wall: the observation; its noise is sigma_0 + lambda·d.
        config: settings.

    Returns:
        The directions after the observation.

    Source: Eq. 7.
    """
    sigma = np.deg2rad(config.sigma0_deg + config.sigma_per_ch_deg * wall.distance)
    length = float(np.linalg.norm(wall.ends[1] - wall.ends[0]))
    sigma *= max(1.0, config.full_length_ch / max(length, 1e-9))
    if orientations:
        gaps = [abs(float(line_difference(wall.direction, o.direction))) for o in orientations]
        nearest = int(np.argmin(gaps))
        if gaps[nearest] <= np.deg2rad(config.gate_deg):
            updated = list(orientations)
            updated[nearest] = _product(orientations[nearest], wall.direction, float(sigma))
            return tuple(updated)
    start = Orientation(wall.direction, float(np.deg2rad(config.initial_sigma_deg)), 1)
    return (*orientations, start)


def _product(prior: Orientation, direction: float, sigma: float) -> Orientation:
    precision_prior, precision = prior.sigma**-2, sigma**-2
    share = precision / (precision + precision_prior)
    moved = prior.direction + share * float(line_difference(direction, prior.direction))
    return Orientation(
        float(line_angle(moved)), (precision + precision_prior) ** -0.5, prior.support + 1
    )


def accepted(
    orientations: Sequence[Orientation], config: OrientationConfig
) -> tuple[tuple[Orientation, ...], bool]:
    """The directions that are certain enough, best supported first.

    Args:
        orientations: of one room.
        config: settings.

    Returns:
        Those below the final sigma, or the best-supported one where none is, and whether that
        was so. Empty where the room has no wall.

    Source: Section III-E, last sentence.
    """
    ranked = sorted(orientations, key=lambda o: (-o.support, o.sigma))
    certain = tuple(o for o in ranked if o.sigma < np.deg2rad(config.final_sigma_deg))
    if certain or not ranked:
        return certain, False
    return (ranked[0],), True
