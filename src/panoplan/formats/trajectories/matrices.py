"""From world-to-camera poses to a trajectory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from panoplan.errors import InputError
from panoplan.formats.names import natural_order
from panoplan.types.pose import Trajectory


def from_cam_from_world(
    labels: Sequence[str], quaternions: ArrayLike, translations: ArrayLike, source: object
) -> Trajectory:
    """A trajectory from the inverse of its poses, in the natural order of its labels.

    Args:
        labels: N names, each once.
        quaternions: (N, 4) cam_from_world, scalar last, of unit length.
        translations: (N, 3) cam_from_world.
        source: for messages.

    Returns:
        The trajectory of world_from_cam.

    Raises:
        InputError: a label twice, numbers that are not finite, or no unit quaternion.
    """
    if len(set(labels)) < len(labels):
        raise InputError(source, "two poses of one name", "one pose a name")
    try:
        inverse = Trajectory.from_quaternions(tuple(labels), translations, quaternions)
    except InputError as error:
        raise InputError(f"{source}, {error.source}", error.found, error.expected) from None
    rotations = inverse.rotations.transpose(0, 2, 1)
    centres = -np.einsum("nij,nj->ni", rotations, inverse.translations)
    order = sorted(range(len(labels)), key=lambda k: natural_order(labels[k]))
    return Trajectory(tuple(labels[k] for k in order), rotations[order], centres[order])
