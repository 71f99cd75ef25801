"""Point clouds in PLY, as MP3D-FPE has them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from panoplan.errors import InputError, MissingExtraError
from panoplan.types.arrays import FloatArray, frozen_array

_LIMIT = 8 * 2**30


def read_ply_points(path: Path) -> FloatArray:
    """Reads the vertices of a PLY file.

    Args:
        path: with an element `vertex` that has x, y and z; other properties are not looked at.

    Returns:
        (N, 3) in the file's unit.

    Raises:
        InputError: missing, larger than 8 GiB, no PLY, no vertices, or a coordinate that is not
            finite.
        MissingExtraError: plyfile is not installed.
    """
    try:
        from plyfile import PlyData, PlyParseError
    except ImportError:
        raise MissingExtraError("a point cloud", "plyfile", "points") from None
    if not path.is_file():
        raise InputError(path, "nothing", "a point cloud in PLY")
    if path.stat().st_size > _LIMIT:
        raise InputError(path, f"{path.stat().st_size} bytes", f"at most {_LIMIT}")
    try:
        vertices = PlyData.read(path, mmap="c")["vertex"]
        points = np.stack([np.asarray(vertices[axis]) for axis in "xyz"], axis=1)
    except (PlyParseError, KeyError, ValueError, OSError, UnicodeDecodeError) as error:
        raise InputError(path, f"no point cloud ({error})", "PLY with x, y, z") from None
    return frozen_array(str(path), points, (None, 3))
