"""Points of interest of a panorama, and which of two panoramas' points are the same."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import MissingExtraError
from panoplan.types.arrays import FloatArray

_LARGEST_SCALE_FIRST = 128
_RATIO = 0.85
_ALIKE = 0.8


def load_pycolmap() -> Any:
    """pycolmap, quiet.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        import pycolmap
    except ImportError:
        raise MissingExtraError("finding camera poses", "pycolmap", "images") from None
    # Its warnings tell of things that are counted here.
    pycolmap.logging.minloglevel = 3
    return pycolmap


@dataclass(frozen=True, eq=False)
class Features:
    """Points of interest of one panorama.

    Attributes:
        points: (N, 2) px, the centre of the first pixel being (½, ½).
        descriptors: (N, 128) of unit length.
        coarse: (M, 128) those of the M largest points, for looking up places.
    """

    points: FloatArray
    descriptors: NDArray[np.float32]
    coarse: NDArray[np.float32]


class Extractor:
    """SIFT on equirectangular images.

    Args:
        limit: number of points to keep.
        peak_threshold: least contrast of a point.
        mask: (H, W), False where the camera sees what it is carried by; or None.

    Raises:
        MissingExtraError: pycolmap is not installed.
    """

    def __init__(
        self,
        limit: int = 1000,
        peak_threshold: float = 0.0015,
        mask: NDArray[np.bool_] | None = None,
    ) -> None:
        pycolmap = load_pycolmap()
        options = pycolmap.FeatureExtractionOptions()
        options.use_gpu, options.num_threads = False, 1
        options.sift.first_octave = 0
        options.sift.max_num_features = limit
        options.sift.max_num_orientations = 1
        options.sift.peak_threshold = peak_threshold
        self._extractor = pycolmap.FeatureExtractor.create(options, pycolmap.Device.cpu)
        self._matrix = pycolmap.keypoints_to_matrix
        self._mask = mask

    def __call__(self, grey: NDArray[np.uint8]) -> Features:
        """The points of a panorama.

        Args:
            grey: (H, W).
        """
        keypoints, descriptors = self._extractor.extract_from_uint8_array(grey)
        rows = np.asarray(self._matrix(keypoints), dtype=np.float64).reshape(-1, 4)
        data = np.asarray(descriptors.data, dtype=np.float32).reshape(-1, 128)
        if self._mask is not None:
            column, row = rows[:, 0].astype(int), rows[:, 1].astype(int)
            seen = self._mask[row, column]
            rows, data = rows[seen], data[seen]
        data = data / np.maximum(np.linalg.norm(data, axis=1, keepdims=True), 1e-6)
        largest = np.argsort(-rows[:, 2], kind="stable")[:_LARGEST_SCALE_FIRST]
        return Features(rows[:, :2], data, data[largest])


def sharpness(grey: NDArray[np.uint8]) -> float:
    """How sharp a panorama is: mean step between neighbouring pixels over its contrast.

    Args:
        grey: (H, W).

    Returns:
        0 for one colour; about half as much for twice the blur.
    """
    levels = grey[::2, ::2].astype(np.float32)
    spread = float(levels.std())
    step = np.abs(np.diff(levels, axis=1)).mean() + np.abs(np.diff(levels, axis=0)).mean()
    return float(step) / spread if spread > 1 else 0.0


def matches(one: Features, other: Features) -> NDArray[np.uint32]:
    """Points of two panoramas that look alike.

    Returns:
        (K, 2) indices: each the other's nearest, and clearly nearer than the second nearest.
    """
    if len(one.points) < 2 or len(other.points) < 2:
        return np.zeros((0, 2), dtype=np.uint32)
    likeness = one.descriptors @ other.descriptors.T
    forward = likeness.argmax(axis=1)
    rows = np.arange(len(forward))
    best = likeness[rows, forward]
    mutual = likeness.argmax(axis=0)[forward] == rows
    likeness[rows, forward] = -1
    second = likeness.max(axis=1)
    # Distances of unit vectors: d² = 2 − 2 cos.
    clear = 1 - np.minimum(best, 1) <= _RATIO**2 * (1 - np.minimum(second, 1))
    chosen = np.flatnonzero(mutual & clear & (best >= _ALIKE))
    return np.stack([chosen, forward[chosen]], axis=1).astype(np.uint32)


class Places:
    """Which panoramas seen before look like a new one."""

    def __init__(self) -> None:
        self._coarse: list[NDArray[np.float32]] = []
        self._owner: list[NDArray[np.int64]] = []
        self._count = 0

    def add(self, features: Features) -> None:
        """Remembers a panorama; its number is how many there were before."""
        self._coarse.append(features.coarse)
        self._owner.append(np.full(len(features.coarse), self._count))
        self._count += 1

    def like(self, features: Features, among: int, count: int) -> list[int]:
        """Numbers of the panoramas most like one.

        Args:
            features: of the one.
            among: only the first that many panoramas are looked at.
            count: at most so many are given.

        Returns:
            The most alike first; none that has no point in common.
        """
        if among <= 0 or not len(features.coarse):
            return []
        coarse = np.concatenate(self._coarse[:among])
        owner = np.concatenate(self._owner[:among])
        likeness = features.coarse @ coarse.T
        nearest = likeness.argmax(axis=0)
        alike = likeness[nearest, np.arange(len(coarse))]
        # A point of the new panorama votes once for each place, by how alike its best one is.
        votes = np.zeros((among, len(features.coarse)))
        np.maximum.at(votes, (owner, nearest), np.maximum(alike - _ALIKE, 0))
        score = votes.sum(axis=1)
        order = np.argsort(-score, kind="stable")[:count]
        return [int(k) for k in order if score[k] > 0]
