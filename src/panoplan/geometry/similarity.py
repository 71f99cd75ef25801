"""The similarity that moves one set of points onto another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Similarity3:
    """target = scale · rotation · source + translation.

    Attributes:
        scale: above 0.
        rotation: (3, 3).
        translation: (3,).
    """

    scale: float
    rotation: FloatArray
    translation: FloatArray

    def __call__(self, points: FloatArray) -> FloatArray:
        """Moves (N, 3) points."""
        return self.scale * points @ self.rotation.T + self.translation


def fit_similarity(source: FloatArray, target: FloatArray) -> Similarity3:
    """The similarity with the least squared distances.

    Args:
        source: (N, 3), not all in one place.
        target: (N, 3).

    Returns:
        It; points on a line leave the turn about that line open.

    Source: Umeyama, Least-squares estimation of transformation parameters, 1991, Eq. 40-43.
    """
    mean_source, mean_target = source.mean(axis=0), target.mean(axis=0)
    centred = source - mean_source
    u, singular, vt = np.linalg.svd((target - mean_target).T @ centred / len(source))
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    rotation = (u * signs) @ vt
    scale = float((singular * signs).sum() / (centred**2).sum() * len(source))
    return Similarity3(scale, rotation, mean_target - scale * rotation @ mean_source)
