"""Level poses (x, z, heading) in a common frame, and what they are to one another."""

from __future__ import annotations

import numpy as np

from panoplan.geometry.angles import wrapped
from panoplan.geometry.rigid import turn
from panoplan.types.arrays import FloatArray


def relative(pose_a: FloatArray, pose_b: FloatArray) -> FloatArray:
    """(3,) second camera in the frame of the first one, both given as x, z, heading."""
    x, z = turn(-pose_a[2]) @ (pose_b[:2] - pose_a[:2])
    return np.array([x, z, wrapped(pose_b[2] - pose_a[2])])


def composed(pose_a: FloatArray, b_in_a: FloatArray) -> FloatArray:
    """(3,) pose of the second camera: the inverse of `relative`."""
    x, z = pose_a[:2] + turn(pose_a[2]) @ b_in_a[:2]
    return np.array([x, z, wrapped(pose_a[2] + b_in_a[2])])


def inverted(b_in_a: FloatArray) -> FloatArray:
    """(3,) the first camera in the frame of the second one."""
    x, z = turn(-b_in_a[2]) @ -b_in_a[:2]
    return np.array([x, z, -b_in_a[2]])


def heading_vector(heading: float) -> FloatArray:
    """(2,) unit vector (x, z) along a heading."""
    return np.array([np.sin(heading), np.cos(heading)])
