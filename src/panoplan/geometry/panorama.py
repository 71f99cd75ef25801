"""Colours of an equirectangular image along rays, and the image turned."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from panoplan.geometry.sphere import FloatArray, column_heading, rays


def sampled(image: NDArray[np.uint8], directions: FloatArray) -> FloatArray:
    """What a panorama shows along rays, interpolated linearly, around the circle.

    Args:
        image: (H, W, C), H ≥ 2.
        directions: (N, 3) of any length, camera frame (x right, y down, z forward).

    Returns:
        (N, C), 0-255.
    """
    return np.asarray(_sampled(image, np.ascontiguousarray(directions)))


@njit(cache=True, nogil=True)
def _sampled(image, directions):
    height, width, channels = image.shape
    out = np.empty((len(directions), channels))
    for n in range(len(directions)):
        x, y, z = directions[n]
        column = (np.arctan2(x, z) / (2 * np.pi) + 0.5) * width - 0.5
        row = (0.5 + np.arctan2(y, np.hypot(x, z)) / np.pi) * height - 0.5
        row = min(max(row, 0.0), height - 1.0)
        left, upper = np.floor(column), min(np.floor(row), height - 2.0)
        u, v = column - left, row - upper
        i, j = int(upper), int(left) % width
        k = (j + 1) % width
        for c in range(channels):
            top = image[i, j, c] * (1 - u) + image[i, k, c] * u
            bottom = image[i + 1, j, c] * (1 - u) + image[i + 1, k, c] * u
            out[n, c] = top * (1 - v) + bottom * v
    return out


def turned(image: NDArray[Any], cam_from_new: FloatArray) -> NDArray[Any]:
    """The panorama that a camera turned about its centre would have taken.

    Args:
        image: (H, W, C) of 8 bits a channel.
        cam_from_new: (3, 3) rotation from the turned camera to the one that took the image.

    Returns:
        (H, W, C), interpolated linearly, around the circle.
    """
    height, width = image.shape[:2]
    heading = column_heading(np.arange(width, dtype=np.float64), width)
    elevation = np.pi / 2 - np.pi * (np.arange(height) + 0.5) / height
    grid = np.meshgrid(elevation, heading, indexing="ij")
    x, y, z = cam_from_new @ rays(grid[0].ravel(), grid[1].ravel()).T
    columns = (np.arctan2(x, z) + np.pi) * width / (2 * np.pi) - 0.5
    rows = np.clip((np.arcsin(np.clip(y, -1, 1)) / np.pi + 0.5) * height - 0.5, 0, height - 1)
    # One column more at either edge, so that interpolation goes around.
    padded = np.concatenate([image[:, -1:], image, image[:, :1]], axis=1)
    places = np.stack([rows, columns + 1])
    channels = [
        map_coordinates(padded[..., c], places, order=1, mode="nearest")
        for c in range(image.shape[2])
    ]
    return np.stack(channels, axis=-1).reshape(image.shape)
