"""Straight pieces of views' boundaries that lie on the walls of their rooms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from panoplan.config import AdjustConfig
from panoplan.geometry.hits import edge_directions, first_hits
from panoplan.geometry.rigid import turn
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.view import Correction, RegisteredLayout


@dataclass(frozen=True, eq=False)
class Pieces:
    """Straight pieces of views' boundaries that lie on walls, two points each.

    Attributes:
        view: (P,) index of the view.
        wall: (P,) index of the wall, counted through room by room.
        points: (P, 2, 2) relative to the camera, in the view's own frame, before it was moved;
            their errors across the wall are independent.
        sigma: (P,) standard deviation of each across the wall.
    """

    view: IntArray
    wall: IntArray
    points: FloatArray
    sigma: FloatArray


def pieces_on_walls(
    views: Sequence[RegisteredLayout],
    rooms: Sequence[tuple[Sequence[int], FloatArray]],
    moved_by: Sequence[Correction],
    reach_ch: float,
    config: AdjustConfig,
) -> Pieces:
    """What of each view lies on which wall of its room.

    Args:
        views: any number.
        rooms: indices of the views of each room, and its outline (N, 2).
        moved_by: how each view moves to where the outlines are.
        reach_ch: columns this near to a wall are on it.
        config: settings.

    Returns:
        Lines fitted robustly to each view's columns on each wall.
    """
    view_of: list[IntArray] = []
    wall_of: list[IntArray] = []
    points: list[FloatArray] = []
    sigmas: list[FloatArray] = []
    first = 0
    for members, ring in rooms:
        for index in members:
            correction = moved_by[index]
            wall, ends, sigma = _of_view(correction.apply(views[index]), ring, reach_ch, config)
            view_of.append(np.full(len(wall), index))
            wall_of.append(first + wall)
            points.append(ends @ (turn(-correction.turn) / correction.factor))
            sigmas.append(sigma)
        first += len(ring)
    if not view_of:
        none = np.empty(0, dtype=np.int64)
        return Pieces(none, none, np.empty((0, 2, 2)), np.empty(0))
    return Pieces(
        np.concatenate(view_of),
        np.concatenate(wall_of),
        np.concatenate(points),
        np.concatenate(sigmas),
    )


def _of_view(
    view: RegisteredLayout, ring: FloatArray, reach_ch: float, config: AdjustConfig
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Walls (P,), ends (P, 2, 2) relative to the camera and sigmas (P,)."""
    offsets = view.boundary - view.camera
    stride = max(1, round(config.stride / view.column_worth))
    width = stride * view.column_worth
    known = np.flatnonzero(np.isfinite(offsets[:, 0]))[::stride]
    offsets, sigmas = offsets[known], view.sigmas[known]
    ranges = np.hypot(*offsets.T)
    hits = first_hits(view.camera, offsets / ranges[:, None], ring)
    with np.errstate(invalid="ignore"):
        near = np.abs(ranges - hits.range) * hits.sine < reach_ch
    near &= hits.sine > np.sin(np.deg2rad(config.grazing_deg))
    # What all columns of a panorama have in common is its factor, not their noise.
    own = np.maximum(sigmas**2 - (config.common_share * ranges) ** 2, (_OWN * sigmas) ** 2)
    fewest = math.ceil(config.min_columns / width)
    independent = width / config.correlation_columns
    across = np.sqrt(own) * hits.sine
    wall = np.where(near, hits.edge, -1)
    along, _ = edge_directions(ring)
    found: tuple[IntArray, FloatArray, FloatArray] = _fitted(
        offsets, across, wall, along, fewest, independent
    )
    return found


_OWN = 0.3
"""At least this share of a column's sigma is its own."""


@njit(cache=True)
def _fitted(points, sigma, wall, along, fewest, independent):  # type: ignore[no-untyped-def]
    """Lines through the columns on each wall: two points of each with independent errors."""
    walls, count = np.zeros(len(along), np.int64), 0
    ends, sigmas = np.empty((len(along), 2, 2)), np.empty(len(along))
    for w in range(len(along)):
        chosen = np.flatnonzero(wall == w)
        if len(chosen) < fewest:
            continue
        ax, ay = along[w]
        at = points[chosen, 0] * ax + points[chosen, 1] * ay
        off = points[chosen, 0] * ay - points[chosen, 1] * ax
        variance = sigma[chosen] ** 2
        weight = 1.0 / variance
        turned, mean_at, mean_off, spread = 0.0, 0.0, 0.0, 0.0
        for _ in range(3):
            total = weight.sum()
            mean_at, mean_off = (weight * at).sum() / total, (weight * off).sum() / total
            squares = (weight * (at - mean_at) ** 2).sum()
            spread = np.sqrt(squares / total)
            turned = (weight * (at - mean_at) * (off - mean_off)).sum() / max(squares, 1e-12)
            left = off - mean_off - turned * (at - mean_at)
            weight = 1.0 / (variance * (1.0 + left**2 / (4.0 * variance)))
        for end in range(2):
            reach = spread if end else -spread
            place, away = mean_at + reach, mean_off + turned * reach
            ends[count, end, 0] = place * ax + away * ay
            ends[count, end, 1] = place * ay - away * ax
        sigmas[count] = np.sqrt(2.0 * variance.mean() / max(1.0, len(chosen) * independent))
        walls[count] = w
        count += 1
    return walls[:count], ends[:count], sigmas[:count]
