"""Point clouds in PLY, as MP3D-FPE has them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import InputError, MissingExtraError
from panoplan.formats.atomic import write_bytes
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


def write_ply_points(path: Path, points: FloatArray, colours: NDArray[np.uint8]) -> None:
    """Writes points as a binary PLY with x, y, z, red, green, blue.

    Args:
        path: to write to.
        points: (N, 3) any unit; written as 32-bit floats.
        colours: (N, 3).

    Raises:
        InputError: the place cannot be written.
    """
    axes = [(axis, "<f4") for axis in "xyz"]
    channels = [(channel, "u1") for channel in ("red", "green", "blue")]
    vertices = np.empty(len(points), dtype=axes + channels)
    for k, (axis, _) in enumerate(axes):
        vertices[axis] = points[:, k]
    for k, (channel, _) in enumerate(channels):
        vertices[channel] = colours[:, k]
    kinds = [f"property float {axis}" for axis, _ in axes]
    kinds += [f"property uchar {channel}" for channel, _ in channels]
    count = f"element vertex {len(points)}"
    lines = ["ply", "format binary_little_endian 1.0", count, *kinds, "end_header", ""]
    write_bytes(path, "\n".join(lines).encode("ascii") + vertices.tobytes())
