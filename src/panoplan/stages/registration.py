"""360-layout registration (Section III-B, Eq. 1-2)."""

from __future__ import annotations

import math

import numpy as np

from panoplan.config import RegistrationConfig
from panoplan.geometry.sphere import column_heading, rays
from panoplan.types.arrays import FloatArray
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.view import CastLayout, RegisteredLayout


def cast(
    keyframe: Keyframe,
    index: int,
    origin_su: FloatArray,
    walk_from_world: FloatArray,
    config: RegistrationConfig,
) -> CastLayout:
    """Casts a keyframe's floor boundary onto the floor, one camera height down.

    The ray of each column is turned by the keyframe's full rotation and met with the level floor,
    so a tilted camera is no error. A ray at, above or near the horizon says nothing about range:
    its column is unknown, not far.

    Args:
        keyframe: has a layout; its pose's world is level, y down.
        index: place of the keyframe in the walk.
        origin_su: (3,) camera of the walk's first keyframe.
        walk_from_world: (2, 2) turns (x, z) of the world into the walk frame.
        config: settings.

    Returns:
        The layout for a camera height of 1.

    Source: Eq. 1; sign and horizon in docs/deviations.md.
    """
    layout = keyframe.layout
    if layout is None:
        raise ValueError("the keyframe has no layout")
    width = layout.width
    headings = column_heading(np.arange(width, dtype=float), width)
    directions = rays(layout.floor_boundary, headings) @ keyframe.pose.rotation.T
    down = directions[:, 1]
    with np.errstate(invalid="ignore"):
        seen = (layout.floor_boundary < 0) & (down > np.sin(np.deg2rad(config.min_depression_deg)))
    offsets = np.full((width, 2), np.nan)
    offsets[seen] = directions[seen][:, [0, 2]] / down[seen, None] @ walk_from_world.T
    moved = keyframe.pose.translation - origin_su
    return CastLayout(
        keyframe=keyframe.id,
        index=index,
        position_su=walk_from_world @ moved[[0, 2]],
        rise_su=float(-moved[1]) if config.height_from_pose else 0.0,
        offsets=offsets,
        sigmas=_range_sigmas(np.hypot(*offsets.T), layout.floor_sigma, config),
        corners=layout.corners,
        ceiling=_ceiling(keyframe, layout, headings, np.hypot(*offsets.T)),
        spans=layout.spans,
    )


def register(view: CastLayout, ch_per_su: float) -> RegisteredLayout:
    """Places a cast layout in the walk frame.

    Args:
        view: the layout for a camera height of 1.
        ch_per_su: scale s, camera heights a trajectory unit.

    Returns:
        The boundary h_i·x + s·t_i with h_i = 1 + s·rise_i.

    Source: Eq. 2.
    """
    height = 1.0 + ch_per_su * view.rise_su
    camera = ch_per_su * view.position_su
    return RegisteredLayout(
        keyframe=view.keyframe,
        index=view.index,
        camera=camera,
        height=height,
        boundary=height * view.offsets + camera,
        sigmas=height * view.sigmas,
        corners=view.corners,
        ceiling=height * view.ceiling,
        spans=view.spans,
    )


def _ceiling(keyframe: Keyframe, layout: Layout, headings: FloatArray, ranges: FloatArray) -> float:
    """Height of the ceiling above the floor for a camera height of 1; the median column's.

    A wall's ceiling is above its floor: where a small tilt moves one to a neighbouring column, the
    ranges of the two differ by little.
    """
    if layout.ceiling_boundary is None:
        return math.nan
    directions = rays(layout.ceiling_boundary, headings) @ keyframe.pose.rotation.T
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = -directions[:, 1] / np.hypot(directions[:, 0], directions[:, 2]) * ranges
        rise = rise[(rise > 0) & (rise < _HIGHEST_CH)]
    return 1.0 + float(np.median(rise)) if len(rise) else math.nan


_HIGHEST_CH = 20.0


def _range_sigmas(
    ranges: FloatArray, stated: FloatArray | None, config: RegistrationConfig
) -> FloatArray:
    """Standard deviations of ranges for a camera height of 1, from those of the elevations."""
    angular = np.deg2rad(np.interp(ranges, config.sigma_ranges_ch, config.sigma_deg))
    if stated is not None:
        angular = np.fmax(angular, stated)
    return np.asarray(np.hypot((1 + ranges**2) * angular, config.scale_bias * ranges))
