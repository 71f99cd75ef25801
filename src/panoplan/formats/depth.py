"""Depth of panoramas as PNG: 16 bit, millimetres along the ray, 0 where nothing was met."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes, write_bytes

_MOST_MM = 65535
_LIMIT = 256 * 2**20


def write_depth(path: Path, distance_m: NDArray[np.floating]) -> None:
    """Writes distances; what is farther than 65.5 m counts as that.

    Args:
        path: to be written.
        distance_m: (H, W) along the ray, infinite where nothing is.

    Raises:
        InputError: the place cannot be written.
    """
    known = np.isfinite(distance_m)
    millimetres = np.rint(np.where(known, distance_m, 0) * 1000).clip(0, _MOST_MM)
    buffer = io.BytesIO()
    Image.fromarray(millimetres.astype(np.uint16)).save(buffer, format="PNG")
    write_bytes(path, buffer.getvalue())


def read_depth(path: Path) -> NDArray[np.float64]:
    """Reads what `write_depth` writes.

    Returns:
        (H, W) metres along the ray, infinite where nothing was met.

    Raises:
        InputError: missing, or no PNG of 16-bit grey levels.
    """
    data = read_bytes(path, _LIMIT)
    try:
        with Image.open(io.BytesIO(data), formats=("PNG",)) as image:
            mode, millimetres = image.mode, np.asarray(image, dtype=np.float64)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        raise InputError(path, "no readable PNG", "depth as 16-bit PNG") from None
    if not mode.startswith("I"):
        raise InputError(path, f"pixels of mode {mode}", "grey levels of 16 bits")
    return np.where(millimetres > 0, millimetres / 1000, np.inf)
