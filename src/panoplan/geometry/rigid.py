"""Rotations about the vertical and the plane's rigid motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def heading_of(rotation: FloatArray) -> float:
    """Heading of a camera's z axis in a level world (y down).

    Where the z axis is closer to the vertical than 30°, the x axis serves instead.

    Args:
        rotation: (3, 3) world_from_cam.

    Returns:
        Angle in rad from the world's z axis towards its x axis (clockwise seen from above).
    """
    forward, right = rotation[:, 2], rotation[:, 0]
    if np.hypot(forward[0], forward[2]) > 0.5:
        return float(np.arctan2(forward[0], forward[2]))
    return float(np.arctan2(-right[2], right[0]))


def turn(heading: float) -> FloatArray:
    """(2, 2) matrix that turns plan vectors (x, z) by `heading` rad from z towards x."""
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, s], [-s, c]])
