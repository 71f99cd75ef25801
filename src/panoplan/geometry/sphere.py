"""Image columns, headings and rays of an equirectangular camera (x right, y down, z forward)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def column_heading(column: FloatArray | float, width: int) -> FloatArray:
    """Heading θ of an image column.

    Args:
        column: columns, fractional ones welcome, the centre of the first being 0.
        width: number of columns W.

    Returns:
        2π(u + ½)/W − π in rad, clockwise seen from above, 0 along z.
    """
    return np.asarray(2 * np.pi * (np.asarray(column) + 0.5) / width - np.pi, dtype=np.float64)


def heading_column(heading: FloatArray | float, width: int) -> FloatArray:
    """Image column of a heading: the inverse of `column_heading`, in [-½, W - ½)."""
    turn = np.mod(np.asarray(heading) + np.pi, 2 * np.pi)
    return np.asarray(turn * width / (2 * np.pi) - 0.5, dtype=np.float64)


def rays(elevation: FloatArray, heading: FloatArray) -> FloatArray:
    """Unit rays in the camera frame.

    Args:
        elevation: (N,) φ in rad, positive upwards.
        heading: (N,) θ in rad.

    Returns:
        (N, 3) unit vectors (cos φ sin θ, −sin φ, cos φ cos θ).
    """
    cos = np.cos(elevation)
    return np.stack([cos * np.sin(heading), -np.sin(elevation), cos * np.cos(heading)], axis=-1)
