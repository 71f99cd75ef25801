"""A room's walls: the outline of its floor cut into lines, each fitted to the raw columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import shapely
from contourpy import contour_generator
from numba import njit
from scipy import ndimage

from panoplan.config import FusionConfig, OutlineConfig
from panoplan.geometry.polygons import signed_area, untangled
from panoplan.geometry.polyline import resampled, straight_pieces
from panoplan.stages.plan.fusion import Floor
from panoplan.stages.plan.sight import Sights
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.room import RoomShape


@dataclass(frozen=True, eq=False)
class WallLine:
    """A straight wall: points middle + t·along for t in [start, end], the room on its left.

    Attributes:
        middle: (2,) a point of the line.
        along: (2,) unit direction.
        start: where the wall begins.
        end: where it ends.
        columns: how many raw columns it was fitted to, 0 where none lies near.
        sigma: standard deviation across the wall in camera heights, NaN where not fitted.
    """

    middle: FloatArray
    along: FloatArray
    start: float
    end: float
    columns: int = 0
    sigma: float = np.nan

    @property
    def outward(self) -> FloatArray:
        """(2,) unit normal away from the room."""
        return np.array([self.along[1], -self.along[0]])

    @property
    def ends(self) -> FloatArray:
        """(2, 2) first and last point."""
        return self.middle + np.outer([self.start, self.end], self.along)


@dataclass(frozen=True, eq=False)
class _Columns:
    """Known boundary columns of all views of a room.

    Attributes:
        points: (N, 2) walk frame.
        rays: (N, 2) unit directions from the camera.
        sigmas: (N,) standard deviations of the ranges.
        view: (N,) index of the view.
        worth: (N,) how many columns of a layout of 1024 each is as wide as.
    """

    points: FloatArray
    rays: FloatArray
    sigmas: FloatArray
    view: IntArray
    worth: FloatArray

    def near(self, wall: WallLine, reach: float) -> _Columns:
        """Those within a distance of a wall's line."""
        off = (self.points - wall.middle) @ wall.outward
        chosen = np.flatnonzero(np.abs(off) < reach)
        return _Columns(
            self.points[chosen],
            self.rays[chosen],
            self.sigmas[chosen],
            self.view[chosen],
            self.worth[chosen],
        )


def outline(floor: Floor, views: Sights, config: OutlineConfig, fusion: FusionConfig) -> RoomShape:
    """The straight walls around a floor.

    The zero line of the field is cut into straight pieces; each is fitted to the raw boundary
    columns near it; corners are where neighbouring lines meet.

    Args:
        floor: of the room.
        views: the room's.
        config: settings.
        fusion: settings of the field.

    Returns:
        The polygon, its holes and the standard deviation of each wall; or why there is none.
    """
    if floor.mask.sum() * fusion.cell_ch**2 < fusion.min_area_ch2:
        return RoomShape(None, "its floor is smaller than a room's")
    columns = _columns(views)
    pieces = cut(floor, config, fusion)
    walls = _walls(pieces, columns, config)
    ring, sigmas = _corners(walls)
    if not _is_simple(ring):
        # Walls of a narrow notch may cross: it ends there.
        ring, sigmas = _untangled(ring, sigmas)
        if signed_area(ring) < _ENCLOSED * floor.mask.sum() * fusion.cell_ch**2:
            return RoomShape(None, "its walls do not close")
    inner = []
    labels, count = ndimage.label(floor.holes)
    for number in range(1, count + 1):
        piece = np.asarray(labels == number)
        if piece.sum() * fusion.cell_ch**2 < fusion.min_hole_ch2:
            continue
        around = _pieces(piece, -floor.field, floor.first_cell, config, fusion)
        inwards = [part[::-1] for part in reversed(around)]
        inner.append(_corners(_walls(inwards, columns, config))[0])
    return RoomShape(ring, None, sigmas=sigmas, holes=holes_within(ring, inner))


def holes_within(ring: FloatArray, inner: Sequence[FloatArray]) -> tuple[FloatArray, ...]:
    """The inner outlines that are holes of an outline.

    Args:
        ring: (N, 2) simple outline.
        inner: (M, 2) outlines, clockwise.

    Returns:
        The simple ones inside, without one that meets a larger one or the outline.
    """
    holes: list[FloatArray] = []
    for hole in sorted(inner, key=signed_area):
        left = shapely.Polygon(ring, holes)
        if _is_simple(hole[::-1]) and left.contains_properly(shapely.Polygon(hole)):
            holes.append(hole)
    return tuple(holes)


_ENCLOSED = 0.8
"""Walls that enclose less than this share of the floor are not around it."""


def _untangled(ring: FloatArray, sigmas: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A ring without the loops where it crosses itself; walls from there on are not fitted."""
    sigma_at = dict(zip(map(tuple, ring.tolist()), sigmas.tolist(), strict=True))
    simple = untangled(ring)
    return simple, np.array([sigma_at.get(tuple(at), np.nan) for at in simple.tolist()])


def cut(floor: Floor, config: OutlineConfig, fusion: FusionConfig) -> list[FloatArray]:
    """The zero line of a floor's field cut into straight pieces, before walls are fitted.

    Args:
        floor: of the room.
        config: settings.
        fusion: settings of the field.

    Returns:
        (N, 2) points of each piece, walk frame, counter-clockwise.
    """
    return _pieces(floor.mask, floor.field, floor.first_cell, config, fusion)


def _columns(views: Sights) -> _Columns:
    layouts = list(views.views)
    points = np.concatenate([view.boundary for view in layouts])
    sigmas = np.concatenate([view.sigmas for view in layouts])
    view = np.repeat(np.arange(len(layouts)), [len(view.boundary) for view in layouts])
    worth = np.array([view.column_worth for view in layouts])
    known = np.isfinite(points[:, 0])
    points, sigmas, view = points[known], sigmas[known], view[known]
    rays = points - views.cameras[view]
    ranges = np.hypot(*rays.T)
    return _Columns(points, rays / ranges[:, None], sigmas, view, worth[view])


def _is_simple(ring: FloatArray) -> bool:
    return signed_area(ring) > 0 and shapely.Polygon(ring).is_valid


def _pieces(
    mask: BoolArray,
    field: FloatArray,
    first_cell: tuple[int, int],
    config: OutlineConfig,
    fusion: FusionConfig,
) -> list[FloatArray]:
    """The straight pieces of a mask's outline, counter-clockwise."""
    ring = (_zero_line(mask, field) + first_cell) * fusion.cell_ch
    ring = resampled(ring, config.step_ch)
    return straight_pieces(ring, config.point_sigma_ch, config.corner_cost)


def _walls(
    pieces: Sequence[FloatArray], columns: _Columns, config: OutlineConfig
) -> list[WallLine]:
    walls = [_fitted(_through(piece), columns, config) for piece in pieces]
    merged = _straightened(walls, config)
    if len(merged) == len(walls):
        return walls
    return [_fitted(wall, columns, config) for wall in merged]


def _zero_line(mask: BoolArray, field: FloatArray) -> FloatArray:
    """(N, 2) outer outline of a mask, counter-clockwise, in cells, where the field is zero.

    The field places the line within the cells on the mask's rim; elsewhere the mask rules.
    """
    inside = np.maximum(field, _TINY)
    outside = np.where(
        ndimage.binary_dilation(mask), np.minimum(field, -_TINY), -np.abs(field) - _TINY
    )
    values = np.pad(np.where(mask, inside, outside), 1, constant_values=-1.0)
    lines = cast(list[FloatArray], contour_generator(z=values.T).lines(0.0))
    ring = max(lines, key=lambda line: abs(signed_area(line[:-1])))
    ring = ring[:-1] - 0.5
    return ring if signed_area(ring) > 0 else ring[::-1]


_TINY = 1e-4


def _through(piece: FloatArray) -> WallLine:
    """The line through a piece of outline."""
    middle = piece.mean(axis=0)
    _, axes = np.linalg.eigh((piece - middle).T @ (piece - middle))
    along = axes[:, 1]
    if along @ (piece[-1] - piece[0]) < 0:
        along = -along
    reach = (piece - middle) @ along
    return WallLine(middle, along, float(reach.min()), float(reach.max()))


_CORNER_MARGIN_CH, _CORNER_MARGIN_SHARE = 0.07, 0.15
"""Columns this near to a wall's ends may be of its neighbours."""
_FEWEST_COLUMNS = 8
"""Of 1024, of all views together."""
_TRUST = 4.0
_FINEST_CH = 0.004


def _fitted(wall: WallLine, columns: _Columns, config: OutlineConfig) -> WallLine:
    """The wall moved and turned to the raw columns near it, robustly."""
    columns = columns.near(wall, 2 * config.fit_reach_ch)
    for number in range(config.fit_rounds):
        step = _fit(wall, columns, config.fit_reach_ch / (1 + number), config)
        if step is None:
            break
        wall = step
    return wall


def _fit(wall: WallLine, columns: _Columns, reach: float, config: OutlineConfig) -> WallLine | None:
    """One weighted least-squares fit; None where too few columns lie near."""
    margin = min(_CORNER_MARGIN_CH, _CORNER_MARGIN_SHARE * (wall.end - wall.start))
    count, off, turn, sigma = _least_squares(
        columns.points,
        columns.rays,
        columns.sigmas,
        columns.view,
        columns.worth,
        wall.middle,
        wall.along,
        (wall.start + margin, wall.end - margin),
        reach,
        np.sin(np.deg2rad(config.grazing_deg)),
        np.deg2rad(config.turn_sigma_deg),
        config.correlation_columns,
    )
    if count == 0:
        return None
    along = wall.along + turn * wall.outward
    return replace(
        wall,
        middle=wall.middle + off * wall.outward,
        along=along / np.hypot(*along),
        columns=count,
        sigma=sigma,
    )


@njit(cache=True)
def _least_squares(  # type: ignore[no-untyped-def]
    points, rays, sigmas, view, worth, middle, along, within, reach, facing, turn_sigma, correlation
):
    """(columns, offset at the middle, turn, sigma) of a line through columns; no columns if few."""
    views = view.max() + 1 if len(view) else 0
    chosen = np.empty(len(points), np.int64)
    at, off, across = np.empty(len(points)), np.empty(len(points)), np.empty(len(points))
    own, own_worth = np.zeros(views), np.zeros(views)
    n, widths = 0, 0.0
    for k in range(len(points)):
        x, y = points[k, 0] - middle[0], points[k, 1] - middle[1]
        a, o = x * along[0] + y * along[1], x * along[1] - y * along[0]
        sine = rays[k, 0] * along[1] - rays[k, 1] * along[0]
        if abs(o) < reach and within[0] < a < within[1] and sine > facing:
            chosen[n], at[n], off[n] = view[k], a, o
            across[n] = max(sigmas[k] * sine, _FINEST_CH)
            own[view[k]] += 1.0
            own_worth[view[k]] += worth[k]
            widths += worth[k]
            n += 1
    if widths < _FEWEST_COLUMNS:
        return 0, 0.0, 0.0, np.nan
    chosen, at, off, across = chosen[:n], at[:n], off[:n], across[:n]
    # Columns of one view err together: a view counts once, however many columns it has.
    weight = 1.0 / (across**2 * own[chosen] * (1.0 + (off / (2.0 * across)) ** 2))
    total = weight.sum()
    mean_at, mean_off = (weight * at).sum() / total, (weight * off).sum() / total
    spread = (weight * (at - mean_at) ** 2).sum()
    turn = (weight * (at - mean_at) * (off - mean_off)).sum() / (spread + 1.0 / turn_sigma**2)
    left = weight * (off - mean_off - turn * (at - mean_at))
    weights, lefts = np.zeros(views), np.zeros(views)
    for k in range(n):
        weights[chosen[k]] += weight[k]
        lefts[chosen[k]] += left[k]
    # Where views differ by more than their sigmas, the wall is known less well, and better where
    # by less: Birge's ratio, with a few views' worth of trust in the sigmas.
    ratio, information, telling = _TRUST, 0.0, 0
    for v in range(views):
        if own[v] > 0.0:
            telling += 1
            known = weights[v] * max(1.0, own_worth[v] / correlation)
            information += known
            ratio += known * (lefts[v] / weights[v]) ** 2
    ratio /= _TRUST + telling - 1
    return n, mean_off - turn * mean_at, turn, np.sqrt(ratio / information)


def _straightened(walls: Sequence[WallLine], config: OutlineConfig) -> list[WallLine]:
    """Joins neighbours that lie on one line."""
    left = list(walls)
    index = 0
    while len(left) > 3 and index < len(left):
        one, other = left[index], left[(index + 1) % len(left)]
        if not _one_line(one, other, config):
            index += 1
            continue
        longer = max(one, other, key=lambda w: (w.end - w.start) * max(1, w.columns))
        reach = (np.concatenate([one.ends, other.ends]) - longer.middle) @ longer.along
        joined = replace(longer, start=float(reach.min()), end=float(reach.max()))
        if index + 1 < len(left):
            left[index : index + 2] = [joined]
        else:
            left = [joined, *left[1:-1]]
            index = 0
    return left


def _one_line(one: WallLine, other: WallLine, config: OutlineConfig) -> bool:
    if one.along @ other.along < np.cos(np.deg2rad(config.straight_deg)):
        return False
    step = (other.ends[0] - one.ends[1]) @ one.outward
    return bool(
        abs(step) < config.fit_reach_ch / 2
        and abs((other.ends[0] - one.middle) @ one.outward) < config.fit_reach_ch / 2
    )


def _corners(walls: Sequence[WallLine]) -> tuple[FloatArray, FloatArray]:
    """Where neighbouring walls meet, and the sigma of the wall that begins at each corner."""
    corners: list[FloatArray] = []
    sigmas: list[float] = []
    for index, wall in enumerate(walls):
        before = walls[index - 1]
        ends = np.stack([before.ends[1], wall.ends[0]])
        normals = np.stack([before.outward, wall.outward])
        if abs(before.along @ wall.outward) > _MEETING_SINE:
            offsets = np.array([before.outward @ before.middle, wall.outward @ wall.middle])
            meeting: FloatArray = np.linalg.solve(normals, offsets)
            if np.hypot(*(ends - meeting).T).min() < _MEETING_CH:
                corners.append(meeting)
                sigmas.append(wall.sigma)
                continue
        if np.hypot(*(ends[1] - ends[0])) < _STEP_CH:
            corners.append(ends.mean(axis=0))
            sigmas.append(wall.sigma)
        else:
            # A step between two nearly parallel walls is a wall itself.
            corners += [ends[0], ends[1]]
            sigmas += [np.nan, wall.sigma]
    return _without_spikes(np.array(corners).reshape(-1, 2), np.array(sigmas))


def _without_spikes(ring: FloatArray, sigmas: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Drops corners where the outline turns back on itself: no wall is a blade."""
    while len(ring) > 4:
        before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
        length = np.maximum(np.hypot(*before.T) * np.hypot(*after.T), 1e-12)
        folded = (before * after).sum(axis=1) / length
        sharpest = int(np.argmin(folded))
        if folded[sharpest] > -_SPIKE_COSINE:
            break
        # The wall that began at the corner before now ends at the one after: it is not fitted.
        sigmas = sigmas.copy()
        sigmas[sharpest - 1] = np.nan
        ring, sigmas = np.delete(ring, sharpest, axis=0), np.delete(sigmas, sharpest)
    return ring, sigmas


_SPIKE_COSINE = float(np.cos(np.deg2rad(20.0)))
_MEETING_SINE = 0.2
_MEETING_CH = 0.25
_STEP_CH = 0.07
