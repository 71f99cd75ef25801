"""Layouts as .npz: floor_boundary, and optionally ceiling_boundary, corners, floor_sigma."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes, write_bytes
from panoplan.types.layout import Layout

_FILE_LIMIT = 64 * 2**20
_MEMBER_LIMIT = 16 * 2**20
_FIELDS = ("floor_boundary", "ceiling_boundary", "corners", "floor_sigma")


def read_layout_npz(path: Path) -> Layout:
    """Reads a layout; members it does not know are not even unpacked.

    Raises:
        InputError: missing, empty or truncated; a member pickled, oversized, or of wrong shape or
            type; no floor boundary.
    """
    data = read_bytes(path, _FILE_LIMIT)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            sizes = {item.filename: item.file_size for item in archive.infolist()}
        for name in _FIELDS:
            if sizes.get(f"{name}.npy", 0) > _MEMBER_LIMIT:
                found = f"{sizes[f'{name}.npy']} bytes of {name}"
                raise InputError(path, found, f"at most {_MEMBER_LIMIT}")
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays: dict[str, NDArray[np.float64]] = {
                name: archive[name] for name in _FIELDS if name in archive
            }
    except (zipfile.BadZipFile, EOFError, OSError, KeyError, ValueError) as error:
        raise InputError(
            path, f"no readable archive ({error})", "an .npz of plain arrays"
        ) from None
    if "floor_boundary" not in arrays:
        raise InputError(path, "no floor_boundary", "floor_boundary (W,) in rad")
    try:
        return Layout(**arrays)
    except InputError as error:
        raise InputError(f"{path}, {error.source}", error.found, error.expected) from None


def write_layout_npz(path: Path, layout: Layout) -> None:
    """Writes a layout as 32-bit floats."""
    arrays = {
        name: np.asarray(value, dtype=np.float32)
        for name in _FIELDS
        if (value := getattr(layout, name)) is not None
    }
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    write_bytes(path, buffer.getvalue())
