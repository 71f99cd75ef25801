"""Layouts as .npz: floor_boundary, and optionally the other arrays of a layout."""

from __future__ import annotations

import io
import zipfile
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes, write_bytes
from panoplan.formats.npy import parse_npy
from panoplan.types.layout import Layout, Spans

_FILE_LIMIT = 64 * 2**20
_MEMBER_LIMIT = 16 * 2**20
_FIELDS = ("floor_boundary", "ceiling_boundary", "corners", "floor_sigma")
_SPANS = {"door_cols": "doors", "opening_cols": "openings", "window_cols": "windows"}
_CEILING_CORNERS = ("ceil_corner_u", "ceil_corner_phi")
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError, ValueError)


def read_layout_npz(path: Path) -> Layout:
    """Reads a layout; members it does not know are not even unpacked.

    Args:
        path: `floor_boundary` (W,) elevation in rad, positive upwards, NaN where unknown, and
            optionally the other arrays of `Layout` in its conventions; `door_cols`,
            `opening_cols` and `window_cols` (K, 2) first and last column; instead of
            `ceiling_boundary` also `ceil_corner_u` (K,) columns and `ceil_corner_phi` (K,) their
            elevations. At most 64 MiB, a member at most 16 MiB unpacked.

    Returns:
        The layout.

    Raises:
        InputError: missing, empty or truncated; a member pickled, oversized, or of wrong shape or
            type; no floor boundary.
    """
    arrays = _members(path)
    if "floor_boundary" not in arrays:
        raise InputError(path, "no floor_boundary", "floor_boundary (W,) in rad")
    try:
        return _layout(arrays)
    except InputError as error:
        raise InputError(f"{path}, {error.source}", error.found, error.expected) from None


def _layout(arrays: dict[str, NDArray[np.float64]]) -> Layout:
    told = {name: arrays[name] for name in _FIELDS if name in arrays}
    spans = None
    if any(name in arrays for name in _SPANS):
        none = np.empty((0, 2))
        spans = Spans(**{field: arrays.get(name, none) for name, field in _SPANS.items()})
    if "ceiling_boundary" not in told and all(name in arrays for name in _CEILING_CORNERS):
        columns, elevations = (arrays[name].ravel() for name in _CEILING_CORNERS)
        if len(columns) != len(elevations) or not np.isfinite(columns).all():
            raise InputError("ceil_corner_u", f"{len(columns)} columns", f"{len(elevations)}")
        width = told["floor_boundary"].size
        told["ceiling_boundary"] = np.full(width, np.nan)
        told["ceiling_boundary"][np.round(columns).astype(int) % width] = elevations
    return Layout(**told, spans=spans)


def write_layout_npz(path: Path, layout: Layout) -> None:
    """Writes a layout as 32-bit floats.

    Raises:
        InputError: the place cannot be written.
    """
    write_bytes(path, layout_npz(layout))


def layout_npz(layout: Layout) -> bytes:
    """The bytes of a layout file; the same layout gives the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        values = {name: getattr(layout, name) for name in _FIELDS}
        values |= {name: getattr(layout.spans, field, None) for name, field in _SPANS.items()}
        for name, value in values.items():
            if value is None:
                continue
            # Without a date of its own.
            member = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            member.compress_type = zipfile.ZIP_DEFLATED
            with archive.open(member, "w") as stream:
                np.save(stream, np.asarray(value, dtype=np.float32), allow_pickle=False)
    return buffer.getvalue()


def _members(path: Path) -> dict[str, NDArray[np.float64]]:
    data = read_bytes(path, _FILE_LIMIT)
    arrays: dict[str, NDArray[np.float64]] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            sizes = {item.filename: item.file_size for item in archive.infolist()}
            for name in (*_FIELDS, *_SPANS, *_CEILING_CORNERS):
                size = sizes.get(f"{name}.npy")
                if size is None:
                    continue
                if size > _MEMBER_LIMIT:
                    raise InputError(f"{path}, {name}", f"{size} bytes", f"at most {_MEMBER_LIMIT}")
                with archive.open(f"{name}.npy") as stream:
                    # The limit holds whatever size the archive declares.
                    arrays[name] = parse_npy(stream.read(_MEMBER_LIMIT), f"{path}, {name}")
    except _BROKEN as error:
        found = f"no readable archive ({str(error)[:80]})"
        raise InputError(path, found, "an .npz of plain arrays") from None
    return arrays
