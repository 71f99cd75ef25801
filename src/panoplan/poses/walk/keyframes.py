"""Which panoramas of a walk are worth a pose: moved on, overlapping, sharp."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from panoplan.geometry.sphere import rays
from panoplan.poses.walk.features import Features, matches
from panoplan.types.arrays import FloatArray

_SHARPNESSES_KEPT = 15
_FEWEST_MATCHES = 12


@dataclass(frozen=True)
class KeyframeSettings:
    """When a panorama becomes a keyframe.

    Attributes:
        least_parallax_deg: median angle by which points moved since the last keyframe, turning of
            the camera taken out, below which the camera stood still.
        most_parallax_deg: the same, above which even a blurred panorama is taken.
        least_overlap: share of the last keyframe's points still seen, below which even a blurred
            panorama is taken.
        least_sharpness: of the median of the panoramas before, below which one is blurred.
    """

    least_parallax_deg: float = 1.5
    most_parallax_deg: float = 4.0
    least_overlap: float = 0.15
    least_sharpness: float = 0.75


EVERY_IMAGE = KeyframeSettings(least_parallax_deg=0.1, least_sharpness=0.0)


class KeyframeChooser:
    """Chooses keyframes one by one.

    Args:
        width: of the panoramas in px.
        height: of the panoramas in px.
        settings: when one is chosen.
    """

    def __init__(self, width: int, height: int, settings: KeyframeSettings) -> None:
        self._width, self._height, self._settings = width, height, settings
        self._last: Features | None = None
        self._sharpnesses: deque[float] = deque(maxlen=_SHARPNESSES_KEPT)

    def __call__(self, features: Features, sharpness: float) -> bool:
        """Whether the next panorama is a keyframe.

        Args:
            features: its points.
            sharpness: as `features.sharpness` has it.
        """
        usual = float(np.median(self._sharpnesses)) if self._sharpnesses else 0.0
        self._sharpnesses.append(sharpness)
        if self._last is not None:
            pairs = matches(self._last, features)
            overlap = len(pairs) / max(len(self._last.points), 1)
            if len(pairs) >= _FEWEST_MATCHES:
                one = self._rays(self._last.points[pairs[:, 0]])
                moved = parallax_deg(one, self._rays(features.points[pairs[:, 1]]))
                if moved < self._settings.least_parallax_deg:
                    return False
                late = moved > self._settings.most_parallax_deg
                late = late or overlap < self._settings.least_overlap
                if not late and sharpness < self._settings.least_sharpness * usual:
                    return False
        self._last = features
        return True

    def _rays(self, points: FloatArray) -> FloatArray:
        heading = 2 * np.pi * points[:, 0] / self._width - np.pi
        elevation = np.pi / 2 - np.pi * points[:, 1] / self._height
        return rays(elevation, heading)


def parallax_deg(one: FloatArray, other: FloatArray) -> float:
    """Median angle between rays to the same points that no rotation explains.

    Args:
        one: (N, 3) unit rays.
        other: (N, 3) unit rays to the same points from elsewhere.

    Returns:
        Degrees; the rotation is the best one for the half of the rays that it fits best.
    """
    kept = np.ones(len(one), dtype=bool)
    angles = np.zeros(len(one))
    for _ in range(3):
        u, _, vt = np.linalg.svd(other[kept].T @ one[kept])
        flip = np.diag([1.0, 1.0, float(np.sign(np.linalg.det(u @ vt)))])
        turned = one @ (u @ flip @ vt).T
        angles = np.arccos(np.clip((turned * other).sum(axis=1), -1, 1))
        kept = angles <= np.median(angles)
    return float(np.degrees(np.median(angles)))
