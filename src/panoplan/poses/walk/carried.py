"""What a camera carries along: its tripod, its photographer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_dilation, label

from panoplan.formats.image import Pixels, resized

_SIZE = (128, 64)
_FEWEST = 8
_LEAST_CHANGE = 6.0
_STEADY = 0.3
_HORIZON_ROW = 34
_LARGEST_SHARE = 0.25


def carried(panoramas: Sequence[Pixels], width: int, height: int) -> NDArray[np.bool_] | None:
    """Where panoramas of a moving camera stay the same, upwards from straight below.

    Args:
        panoramas: at least 8 of one walk, far apart.
        width: of the answer in px.
        height: of the answer in px.

    Returns:
        (height, width), True where the camera sees what it carries; None where that cannot be
        told: too few panoramas, a camera that hardly moves, or more than a quarter of the image.
    """
    if len(panoramas) < _FEWEST:
        return None
    levels = np.array([resized(p, *_SIZE).astype(np.float64).mean(axis=2) for p in panoramas])
    # Exposure changes the whole image.
    levels -= levels.mean(axis=(1, 2), keepdims=True)
    change = levels.std(axis=0)
    usual = float(np.median(change))
    if usual < _LEAST_CHANGE:
        return None
    steady = change < _STEADY * usual
    steady[:_HORIZON_ROW] = False
    # Beyond both edges, so that something behind the camera is in one piece.
    steady = np.tile(steady, 3)
    steady |= binary_closing(steady)
    pieces, _ = label(steady)
    below = np.unique(pieces[-1])
    mask = np.isin(pieces, below[below > 0])[:, _SIZE[0] : 2 * _SIZE[0]]
    if mask.mean() > _LARGEST_SHARE or not mask.any():
        return None
    mask = binary_dilation(mask)
    rows = np.arange(height) * _SIZE[1] // height
    columns = np.arange(width) * _SIZE[0] // width
    return np.asarray(mask[np.ix_(rows, columns)])
