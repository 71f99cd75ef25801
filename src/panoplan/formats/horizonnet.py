"""Layouts as HorizonNet and its kin write them: dense boundaries (.npy) and corners (.json).

Both have elevations with the v axis down (floor positive); they are turned to this package's
positive-up elevations here.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.ndimage import maximum_filter1d

from panoplan.errors import InputError
from panoplan.formats.npy import read_npy
from panoplan.formats.schema import read_json
from panoplan.geometry.sphere import column_heading
from panoplan.types.arrays import FloatArray, frozen_array
from panoplan.types.layout import Layout

WIDTH = 1024
_PEAK = 0.5
_PEAK_REACH_DEG = 5.0
_MAX_CORNERS = 4096


def read_boundaries_npy(path: Path, *, pixel_centre: float = 0.5) -> Layout:
    """Reads dense boundaries.

    Args:
        path: (2, W) or (3, W) numbers: rows ceiling boundary, floor boundary (rad, v axis down,
            so that the floor is positive), and optionally the probability of a corner (0..1).
            NaN is unknown.
        pixel_centre: column u of the file looks along 2π(u + pixel_centre)/W − π: ½ as most
            write it, 0 as MP3D-FPE does. Other than ½, the boundaries are interpolated linearly
            around the circle to this package's columns; a column is unknown where one of the two
            it lies between is.

    Returns:
        The layout; corners are those of `corner_peaks`, None where the file has no third row or
        one without a number.

    Raises:
        InputError: missing, empty, truncated, pickled; wrong shape or type; values that are no
            radians; a floor above the horizon; probabilities outside 0..1.
    """
    rows = read_npy(path)
    if rows.ndim != 2 or rows.shape[0] not in (2, 3):
        raise InputError(path, f"shape {rows.shape}", "shape (2, W) or (3, W)")
    floor, ceiling = -rows[1], -rows[0]
    if np.isfinite(floor).any() and np.nanmedian(floor) > 0:
        raise InputError(
            path, "a floor boundary above the horizon", "row 1 in rad, positive downwards"
        )
    shift = 0.5 - pixel_centre
    width = rows.shape[1]
    wanted = np.arange(width, dtype=np.float64) + shift
    corners = None
    if len(rows) == 3 and not np.isnan(rows[2]).all():
        if np.nanmin(rows[2]) < 0 or np.nanmax(rows[2]) > 1:
            raise InputError(f"{path}, row 2", "a corner probability outside 0..1", "0..1")
        corners = np.sort((corner_peaks(rows[2]) - shift) % width)
    try:
        return Layout(
            at_columns(floor, wanted),
            None if np.isnan(ceiling).all() else at_columns(ceiling, wanted),
            corners,
        )
    except InputError as error:
        raise InputError(f"{path}, {error.source}", error.found, error.expected) from None


def read_corners_json(path: Path, *, width: int = WIDTH) -> Layout:
    """Reads corners and draws the dense boundary between them as straight walls.

    The corners are joined in the order of the file by straight walls in the plan, whatever their
    angles; each column sees the nearest wall. z0 and z1 say nothing that uv does not and are not
    read. HorizonNet divides the index of a pixel's column by the width where LGT-Net has its
    centre; the file does not tell which, half a pixel (0.18°) is left.

    Args:
        path: object with `uv`, a list of [u, v] pairs in 0..1, ceiling and floor corners in
            turns; u → heading 2πu − π, v → elevation π/2 − πv.
        width: columns of the answer.

    Returns:
        The layout: both boundaries (the ceiling at the median of the corners' heights), corners.

    Raises:
        InputError: missing, empty or broken; not at least three pairs of numbers in 0..1; a floor
            corner at or above the horizon, or a ceiling corner below it.
    """
    data = read_json(path)
    if not isinstance(data, dict) or not isinstance(data.get("uv"), list):
        raise InputError(path, "no list uv", "corners as uv pairs, ceiling and floor in turns")
    if len(data["uv"]) > 2 * _MAX_CORNERS:
        raise InputError(f"{path}, uv", f"{len(data['uv'])} points", f"at most {2 * _MAX_CORNERS}")
    uv = frozen_array(f"{path}, uv", data["uv"], (None, 2))
    if len(uv) < 6 or len(uv) % 2:
        raise InputError(
            f"{path}, uv", f"{len(uv)} points", "an even number, at least 6: ceiling, floor, ..."
        )
    if np.any((uv < 0) | (uv > 1)):
        raise InputError(f"{path}, uv", f"{uv.max():.4g} at most", "u and v within 0..1")
    heading = 2 * np.pi * uv[1::2, 0] - np.pi
    floor, ceiling = np.pi / 2 - np.pi * uv[1::2, 1], np.pi / 2 - np.pi * uv[::2, 1]
    if np.any(floor >= 0) or np.any(ceiling <= 0):
        raise InputError(
            f"{path}, uv",
            "a floor corner above or a ceiling corner below the horizon",
            "ceiling and floor corners in turns",
        )
    reach = 1 / np.tan(-floor)
    polygon = reach[:, None] * np.stack([np.sin(heading), np.cos(heading)], axis=1)
    distance = wall_ranges(polygon, width)
    ceiling_height = float(np.median(reach * np.tan(ceiling)))
    return Layout(
        -np.arctan2(1.0, distance),
        np.arctan2(ceiling_height, distance),
        np.unique(uv[1::2, 0] * width - 0.5),
    )


def corner_peaks(probability: FloatArray) -> FloatArray:
    """Columns at which a corner is likely.

    A corner is a column of probability ½ or more that no column within 5° to either side, around
    the circle, exceeds. Equal columns so close to one another are one corner, in their middle; a
    plateau wider than 10° is none.

    Args:
        probability: (W,) 0..1; NaN counts as 0.

    Returns:
        (K,) columns in [0, W), sorted.
    """
    p = np.nan_to_num(probability, nan=0.0)
    width = len(p)
    reach = max(1, round(width * _PEAK_REACH_DEG / 360))
    highest = maximum_filter1d(p, 2 * reach + 1, mode="wrap")
    columns = np.flatnonzero((p >= _PEAK) & (p == highest))
    if len(columns) == 0:
        return np.zeros(0)
    gaps = np.diff(columns, append=columns[0] + width)
    if np.all(gaps <= reach):
        return np.zeros(0)
    # Begin after a gap, so that no plateau is cut in two where the image wraps.
    start = int(np.flatnonzero(gaps > reach)[0]) + 1
    unrolled = np.concatenate([columns[start:], columns[:start] + width])
    plateaus = np.split(unrolled, np.flatnonzero(np.diff(unrolled) > reach) + 1)
    peaks = [(q[0] + q[-1]) / 2 % width for q in plateaus if q[-1] - q[0] <= 2 * reach]
    return np.sort(np.array(peaks, dtype=np.float64))


def wall_ranges(polygon: FloatArray, width: int) -> FloatArray:
    """Distance from the origin to the nearest wall along each column's heading.

    Args:
        polygon: (N, 2) corners in order, plan axes (right, forward) of the camera.
        width: number of columns.

    Returns:
        (width,) distances, NaN where no wall is met.
    """
    heading = column_heading(np.arange(width, dtype=np.float64), width)
    dx, dz = np.sin(heading)[:, None], np.cos(heading)[:, None]
    ax, az = polygon.T
    ex, ez = (np.roll(polygon, -1, axis=0) - polygon).T
    cross = dx * ez - dz * ex
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (ax * ez - az * ex) / cross
        along = (ax * dz - az * dx) / cross
    met = (along >= -1e-9) & (along <= 1 + 1e-9) & (distance > 0)
    nearest = np.where(met, distance, np.inf).min(axis=1)
    return np.where(np.isfinite(nearest), nearest, np.nan)


def at_columns(values: FloatArray, columns: FloatArray) -> FloatArray:
    """Values at fractional columns, linear around the circle.

    Args:
        values: (W,), NaN where unknown.
        columns: (M,) any numbers; W is column 0 again.

    Returns:
        (M,) values, NaN where one of the two columns in between is unknown; at a whole column
        that column's own value.
    """
    before = np.floor(columns).astype(np.int64)
    share = columns - before
    left, right = values[before % len(values)], values[(before + 1) % len(values)]
    return np.where(share == 0, left, (1 - share) * left + share * right)
