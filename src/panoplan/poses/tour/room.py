"""The room that a panorama's layout tells: ranges around the camera, ceiling, heading of walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.config import RegistrationConfig
from panoplan.geometry.polar import PROFILE_BINS, range_profile
from panoplan.stages.registration import cast
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout, Spans
from panoplan.types.pose import Pose

_WALL_POINTS = 128
_NO_SPANS = Spans(*(np.empty((0, 2)) for _ in range(3)))


@dataclass(frozen=True, eq=False)
class RoomSeen:
    """A layout about its level camera; lengths in camera heights, camera frame.

    Attributes:
        points: (N, 2) points of the walls (x, z), evenly spaced by heading.
        point_sigmas: (N,) relative standard deviations of their ranges.
        log_profile: (B,) logarithms of the ranges, as `polar.range_profile` bins them, NaN where
            unknown.
        profile_sigmas: (B,) relative standard deviations of those.
        ceiling: height above the camera, NaN where unknown.
        passages: (B,) whether the layout tells a door or an opening there.
        windows: (B,) whether it tells a window.
    """

    points: FloatArray
    point_sigmas: FloatArray
    log_profile: FloatArray
    profile_sigmas: FloatArray
    ceiling: float
    passages: BoolArray
    windows: BoolArray


def room_seen(layout: Layout, config: RegistrationConfig) -> RoomSeen:
    """Casts the layout of a level panorama onto the floor.

    Args:
        layout: of the panorama.
        config: what columns are known and how far they err.

    Returns:
        The room.
    """
    level = Keyframe("", Pose(np.eye(3), np.zeros(3)), layout)
    view = cast(level, 0, np.zeros(3), np.eye(2), config)
    ranges = np.hypot(*view.offsets.T)
    known = np.flatnonzero(np.isfinite(ranges))
    rows = known[:: max(1, len(known) // _WALL_POINTS)]
    with np.errstate(divide="ignore"):
        log_profile = np.log(range_profile(view.offsets))
    relative = view.sigmas / ranges
    at = np.minimum(
        ((np.arange(PROFILE_BINS) + 0.5) * layout.width / PROFILE_BINS).astype(int),
        layout.width - 1,
    )
    sigmas = relative[at]
    spans = layout.spans or _NO_SPANS
    # A bin between two known columns has the worst of what is known.
    worst = float(np.nanmax(relative)) if len(known) else 1.0
    return RoomSeen(
        points=view.offsets[rows],
        point_sigmas=relative[rows],
        log_profile=log_profile,
        profile_sigmas=np.where(np.isfinite(sigmas), sigmas, worst),
        ceiling=view.ceiling - 1.0,
        passages=_columns(spans.doors, layout)[at] | _columns(spans.openings, layout)[at],
        windows=_columns(spans.windows, layout)[at],
    )


def _columns(spans: FloatArray, layout: Layout) -> BoolArray:
    """(W,) the columns of some spans of a layout."""
    inside = np.zeros(layout.width, dtype=bool)
    columns = np.arange(layout.width)
    for first, last in spans:
        within = (columns >= first, columns <= last)
        inside |= np.logical_and(*within) if first <= last else np.logical_or(*within)
    return inside


def at_aperture(room: RoomSeen, headings: FloatArray) -> BoolArray:
    """(M,) whether the layout tells a window or a passage along headings, camera frame."""
    at = _bins(headings, room)
    return np.asarray(room.windows[at] | room.passages[at])


def _bins(headings: FloatArray, room: RoomSeen) -> IntArray:
    bins = len(room.log_profile)
    return ((headings + np.pi) * bins / (2 * np.pi)).astype(int) % bins


def log_surface_ranges(
    room: RoomSeen, headings: FloatArray, elevations: FloatArray
) -> tuple[FloatArray, FloatArray, BoolArray, BoolArray]:
    """How far the first surface of a room is along rays: floor, wall or ceiling.

    Args:
        room: as seen from a camera.
        headings: (M,) of the rays, rad, camera frame.
        elevations: (M,) rad, positive upwards, none 0.

    Returns:
        (M,) logarithms of the horizontal ranges, NaN where the room is not known; (M,) their
        standard deviations; (M,) whether the surface is floor or ceiling; (M,) whether it is a
        wall with a door or an opening.
    """
    at = _bins(headings, room)
    wall, sigma = room.log_profile[at], room.profile_sigmas[at]
    height = np.where(elevations < 0, 1.0, room.ceiling)
    with np.errstate(invalid="ignore", divide="ignore"):
        level = np.log(height / np.tan(np.abs(elevations)))
    # Where no ceiling is known, walls go on upwards.
    meets = np.isfinite(level) & (level < wall)
    flat = np.where(elevations < 0, _FLOOR_SIGMA, _CEILING_SIGMA)
    passage = room.passages[at] & ~meets
    return np.where(meets, level, wall), np.where(meets, flat, sigma), meets, passage


_FLOOR_SIGMA, _CEILING_SIGMA = 0.02, 0.05
"""Relative: of a level floor below a camera of unit height; of a ceiling that a layout tells."""
