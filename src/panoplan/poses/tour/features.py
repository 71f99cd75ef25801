"""Upright features of a level panorama (SIFT of pycolmap)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.config import TourConfig
from panoplan.errors import MissingExtraError
from panoplan.geometry.sphere import column_heading
from panoplan.types.arrays import FloatArray

_SEAM_PX = 48
"""Columns repeated at either side, so that features on the seam are whole."""
_FEWEST_PX = 16


@dataclass(frozen=True, eq=False)
class Features:
    """What stands out in a panorama.

    Attributes:
        headings: (N,) rad, camera frame.
        elevations: (N,) rad, positive upwards.
        sizes: (N,) scale of each feature as an angle, rad.
        descriptors: (N, 128) vectors of one length.
    """

    headings: FloatArray
    elevations: FloatArray
    sizes: FloatArray
    descriptors: NDArray[np.uint8]

    def __len__(self) -> int:
        """Number of features."""
        return len(self.headings)


def upright_features(image: NDArray[np.uint8], config: TourConfig) -> Features:
    """Finds the features of a level panorama.

    Every feature has its orientation along the vertical. Rows that `config` excludes (the tripod,
    the zenith, where an equirectangular image is smeared) and those at the horizon, which tell
    nothing of where a level camera stands, have none.

    Args:
        image: (H, W) grey levels, equirectangular, W = 2 H.
        config: settings.

    Returns:
        The features.

    Raises:
        MissingExtraError: pycolmap is not installed.
    """
    height, width = image.shape
    first = round(height * (0.5 - config.highest_elevation_deg / 180.0))
    last = round(height * (0.5 - config.lowest_elevation_deg / 180.0))
    if last - first < _FEWEST_PX:
        return _none()
    strip = np.pad(image[first:last], ((0, 0), (_SEAM_PX, _SEAM_PX)), mode="wrap")
    found, descriptors = _extractor(config).extract_from_uint8_array(np.ascontiguousarray(strip))
    keypoints = np.array([(k.x, k.y, k.compute_scale()) for k in found]).reshape(-1, 3)
    # COLMAP's pixel centres lie at ½.
    column = keypoints[:, 0] - 0.5 - _SEAM_PX
    row = keypoints[:, 1] - 0.5 + first
    elevation = np.pi / 2 - np.pi * (row + 0.5) / height
    kept = (column >= -0.5) & (column < width - 0.5)
    kept &= np.abs(elevation) >= np.deg2rad(config.horizon_deg)
    return Features(
        column_heading(column[kept], width),
        elevation[kept],
        keypoints[kept, 2] * np.pi / height,
        np.asarray(descriptors.data, dtype=np.uint8).reshape(-1, 128)[kept],
    )


def _extractor(config: TourConfig) -> Any:
    try:
        import pycolmap
    except ImportError:
        raise MissingExtraError("joining a photo tour", "pycolmap", "images") from None
    pycolmap.logging.minloglevel = pycolmap.logging.Level.WARNING.value
    options = pycolmap.FeatureExtractionOptions()
    options.num_threads = 1
    options.use_gpu = False
    sift = options.sift
    sift.upright = True
    sift.max_num_orientations = 1
    sift.first_octave = config.first_octave
    sift.peak_threshold = config.peak_threshold
    sift.max_num_features = config.max_features
    return pycolmap.FeatureExtractor.create(options, pycolmap.Device.cpu)


def _none() -> Features:
    return Features(np.empty(0), np.empty(0), np.empty(0), np.empty((0, 128), dtype=np.uint8))
