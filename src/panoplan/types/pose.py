"""Camera poses and trajectories."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from panoplan.errors import InputError
from panoplan.types.arrays import FloatArray, frozen_array

_ORTHONORMAL_TOLERANCE = 1e-4


def _check_rotations(name: str, rotations: FloatArray) -> None:
    gram = rotations @ np.swapaxes(rotations, -1, -2)
    if np.abs(gram - np.eye(3)).max(initial=0.0) > _ORTHONORMAL_TOLERANCE or np.any(
        np.linalg.det(rotations) < 0
    ):
        raise InputError(name, "a matrix that is no rotation", "orthonormal, determinant +1")


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a camera is: world_from_cam.

    Camera axes: x right, y down, z forward. World: y down along gravity.

    Attributes:
        rotation: (3, 3) world_from_cam rotation.
        translation: (3,) camera centre in the world, in the trajectory's unit.
    """

    rotation: FloatArray
    translation: FloatArray

    def __post_init__(self) -> None:
        """Copies and checks the arrays."""
        object.__setattr__(self, "rotation", frozen_array("rotation", self.rotation, (3, 3)))
        object.__setattr__(self, "translation", frozen_array("translation", self.translation, (3,)))
        _check_rotations("rotation", self.rotation)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Camera poses in the order of the walk.

    Attributes:
        labels: N strings, what the file has in its first column (an id, an order or a time).
        rotations: (N, 3, 3) world_from_cam rotations.
        translations: (N, 3) camera centres, any unit, y down.
    """

    labels: tuple[str, ...]
    rotations: FloatArray
    translations: FloatArray

    def __post_init__(self) -> None:
        """Copies and checks the arrays."""
        n = len(self.labels)
        object.__setattr__(self, "rotations", frozen_array("rotations", self.rotations, (n, 3, 3)))
        object.__setattr__(
            self, "translations", frozen_array("translations", self.translations, (n, 3))
        )
        _check_rotations("rotations", self.rotations)

    def __len__(self) -> int:
        """Number of poses."""
        return len(self.labels)

    def __getitem__(self, index: int) -> Pose:
        """The pose at `index`."""
        return Pose(self.rotations[index], self.translations[index])

    @staticmethod
    def from_quaternions(
        labels: tuple[str, ...], translations: ArrayLike, quaternions: ArrayLike
    ) -> Trajectory:
        """Trajectory from unit quaternions.

        Args:
            labels: N strings.
            translations: (N, 3) camera centres.
            quaternions: (N, 4) world_from_cam, scalar last (x, y, z, w), of unit length.

        Returns:
            The trajectory.

        Raises:
            InputError: wrong shape, not finite, or a quaternion not of unit length (± 1e-2).
        """
        q = frozen_array("quaternions", quaternions, (len(labels), 4))
        norm = np.linalg.norm(q, axis=1)
        for label, length in zip(labels, norm, strict=True):
            if abs(length - 1.0) > 1e-2:
                raise InputError(
                    f"pose {label}", f"a quaternion of length {length:.4g}", "a unit quaternion"
                )
        x, y, z, w = (q / norm[:, None]).T
        rotations = np.empty((len(labels), 3, 3))
        rotations[:, 0] = np.stack(
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=1
        )
        rotations[:, 1] = np.stack(
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=1
        )
        rotations[:, 2] = np.stack(
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=1
        )
        return Trajectory(labels, rotations, np.asarray(translations, dtype=np.float64))
