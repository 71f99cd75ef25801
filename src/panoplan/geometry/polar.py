"""Star-shaped regions: a range for each heading around a camera."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from panoplan.geometry.sphere import column_heading

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]


PROFILE_BINS = 1024
"""Headings of a profile, as many as a layout usually has columns."""
_MAX_GAP_RAD = float(np.deg2rad(2.0))
_MAX_GAP_COLUMNS = 1.5
"""Between known columns farther apart than both, a boundary is unknown. A layout of few columns
has neighbours farther apart than the first, and a tilt spreads some of them."""


def profile_headings(bins: int) -> FloatArray:
    """(B,) headings of a profile's bins in rad, from the second axis towards the first.

    Bin b looks along 2π(b + ½)/B − π.
    """
    return column_heading(np.arange(bins, dtype=np.float64), bins)


def profile_rays(bins: int) -> FloatArray:
    """(B, 2) unit directions of a profile's bins."""
    headings = profile_headings(bins)
    return np.stack([np.sin(headings), np.cos(headings)], axis=-1)


def range_profile(offsets: FloatArray) -> FloatArray:
    """Ranges at evenly spaced headings.

    Args:
        offsets: (W, 2) boundary points relative to the camera, of all columns of a layout, NaN
            where unknown.

    Returns:
        (`PROFILE_BINS`,) ranges along `profile_headings`, NaN where unknown.
    """
    known = offsets[np.isfinite(offsets[:, 0])]
    out = np.full(PROFILE_BINS, np.nan)
    if len(known) < 2:
        return out
    heading = np.arctan2(known[:, 0], known[:, 1])
    order = np.argsort(heading, kind="stable")
    heading, distance = heading[order], np.hypot(known[order, 0], known[order, 1])
    at = profile_headings(PROFILE_BINS)
    after = np.searchsorted(heading, at)
    before, after = (after - 1) % len(heading), after % len(heading)
    gap = np.mod(heading[after] - heading[before], 2 * np.pi)
    share = np.mod(at - heading[before], 2 * np.pi) / np.where(gap > 0, gap, 1.0)
    filled = distance[before] + np.clip(share, 0, 1) * (distance[after] - distance[before])
    close = gap <= max(_MAX_GAP_RAD, _MAX_GAP_COLUMNS * 2 * np.pi / len(offsets))
    out[close] = filled[close]
    return out


def intruding_shares(
    offsets: FloatArray,
    profiles: FloatArray,
    positions: FloatArray,
    rises: FloatArray,
    scales: FloatArray,
    margin: float,
    share: float,
) -> FloatArray:
    """How many points of some views lie well inside the region of another, for each scale.

    The point of column u of view i at scale s is (1 + s·rise_i)·offset_iu + s·position_i.

    Args:
        offsets: (N, C, 2) boundary points relative to their camera for a camera height of 1; NaN
            where unknown.
        profiles: (N, B) ranges of the views as `range_profile` gives them.
        positions: (N, 2) cameras in trajectory units.
        rises: (N,) how much higher than the first camera each one is, in trajectory units.
        scales: (S,) candidates s, camera heights a trajectory unit.
        margin: a point lies inside where it is nearer than the boundary by this, camera heights,
        share: and by this share of the boundary's range.

    Returns:
        (S,) shares of the points known, 0 where none is.
    """
    return np.asarray(
        _intruding_shares(offsets, profiles, positions, rises, scales, margin, 1.0 - share)
    )


@njit(cache=True)
def _heading(x, y):
    """arctan2(x, y) within 1e-5 rad, several times faster.

    Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.47.
    """
    across, along = abs(x), abs(y)
    most = max(across, along)
    if most == 0.0:
        return 0.0
    z = min(across, along) / most
    q = z * z
    angle = z * (0.9998660 + q * (-0.3302995 + q * (0.1801410 + q * (-0.0851330 + q * 0.0208351))))
    if across > along:
        angle = 0.5 * np.pi - angle
    if y < 0:
        angle = np.pi - angle
    return -angle if x < 0 else angle


@njit(cache=True)
def _intruding_shares(offsets, profiles, positions, rises, scales, margin, kept):
    n_views, width = offsets.shape[:2]
    bins = profiles.shape[1]
    out = np.zeros(scales.size)
    for k in range(scales.size):
        s = scales[k]
        known, inside = 0, 0
        for i in range(n_views):
            height = 1.0 + s * rises[i]
            for u in range(width):
                if np.isnan(offsets[i, u, 0]):
                    continue
                known += 1
                x = height * offsets[i, u, 0] + s * positions[i, 0]
                y = height * offsets[i, u, 1] + s * positions[i, 1]
                for j in range(n_views):
                    if j == i:
                        continue
                    dx, dy = x - s * positions[j, 0], y - s * positions[j, 1]
                    b = int((_heading(dx, dy) + np.pi) * bins / (2 * np.pi)) % bins
                    limit = (1.0 + s * rises[j]) * profiles[j, b]
                    # Nothing is nearer than what is unknown.
                    if np.hypot(dx, dy) < min(limit - margin, kept * limit):
                        inside += 1
                        break
        out[k] = inside / max(known, 1)
    return out


def star_evidence(
    camera: FloatArray,
    profile: FloatArray,
    radius: float,
    band: float,
    beyond_weight: float,
    cell: float,
    first_cell: tuple[int, int],
    shape: tuple[int, int],
) -> tuple[Float32Array, Float32Array]:
    """What one view says of each cell of a lattice.

    Cell (i, j) of the lattice has its centre at ((i + ½)·cell, (j + ½)·cell).

    Args:
        camera: (2,) position.
        profile: (B,) ranges as `range_profile` gives them.
        radius: beyond it nothing is said.
        band: up to so far beyond the boundary a view speaks against a cell with weight 1.
        beyond_weight: the weight farther beyond.
        cell: cell size.
        first_cell: index of the first cell of the answer.
        shape: cells along both axes.

    Returns:
        free: 1 where the cell lies inside the boundary, else 0.
        against: weight with which the view speaks against the cell.
    """
    free = np.zeros(shape, dtype=np.float32)
    against = np.zeros(shape, dtype=np.float32)
    _star_evidence(
        float(camera[0]),
        float(camera[1]),
        profile,
        radius,
        band,
        beyond_weight,
        cell,
        first_cell[0],
        first_cell[1],
        free,
        against,
    )
    return free, against


@njit(cache=True)
def _star_evidence(cx, cy, profile, radius, band, beyond_weight, cell, i0, j0, free, against):
    bins = profile.size
    for i in range(free.shape[0]):
        x = (i0 + i + 0.5) * cell - cx
        if abs(x) > radius:
            continue
        for j in range(free.shape[1]):
            y = (j0 + j + 0.5) * cell - cy
            distance = np.sqrt(x * x + y * y)
            if distance > radius:
                continue
            b = int((np.arctan2(x, y) + np.pi) * bins / (2 * np.pi)) % bins
            limit = profile[b]
            if np.isnan(limit):
                continue
            if distance < limit:
                free[i, j] = 1.0
            elif distance < limit + band:
                against[i, j] = 1.0
            else:
                against[i, j] = beyond_weight


def signed_distance_sums(
    cameras: FloatArray,
    profiles: FloatArray,
    sigmas: FloatArray,
    truncation: float,
    blur: float,
    beyond_weight: float,
    radius: float,
    cell: float,
    first_cell: tuple[int, int],
    shape: tuple[int, int],
) -> tuple[FloatArray, FloatArray]:
    """Weighted sums of the views' truncated signed distances along their rays.

    A view's distance at a cell is its range in the cell's direction less that of the cell,
    truncated; its weight is 1 / (sigma² + blur²) with the sigma of that range.

    Args:
        cameras: (V, 2) positions.
        profiles: (V, B) ranges as `range_profile` gives them, NaN where unknown.
        sigmas: (V, B) standard deviations of the ranges.
        truncation: largest distance that counts.
        blur: standard deviation that every range has at least.
        beyond_weight: factor of the weight where a cell lies farther behind the boundary than the
            truncation, 0-1.
        radius: a view says nothing of cells farther away.
        cell: cell size; cell (i, j) has its centre at ((i + ½)·cell, (j + ½)·cell).
        first_cell: index of the first cell of the answer.
        shape: cells along both axes.

    Returns:
        (n, m) sum of weight × distance, positive where free, and (n, m) sum of weights.
    """
    total = np.zeros(shape)
    weight = np.zeros(shape)
    _signed_distance_sums(
        cameras,
        profiles,
        1.0 / (sigmas**2 + blur * blur),
        truncation,
        beyond_weight,
        radius,
        cell,
        first_cell[0],
        first_cell[1],
        total,
        weight,
    )
    return total, weight


@njit(cache=True, fastmath=True)
def _row(x, y0, cell, bins, place, away):
    """Heading, in profile bins, and distance of cells in a row, without a branch."""
    for j in range(place.size):
        y = y0 + j * cell
        across, along = abs(x), abs(y)
        z = min(across, along) / max(across, along, 1e-12)
        q = z * z
        # As in `_heading`.
        angle = z * (
            0.9998660 + q * (-0.3302995 + q * (0.1801410 + q * (-0.0851330 + q * 0.0208351)))
        )
        angle = 0.5 * np.pi - angle if across > along else angle
        angle = np.pi - angle if y < 0 else angle
        angle = -angle if x < 0 else angle
        place[j] = (angle + np.pi) * bins / (2 * np.pi)
        away[j] = np.sqrt(x * x + y * y)


@njit(cache=True)
def _signed_distance_sums(
    cameras, profiles, weights, truncation, beyond_weight, radius, cell, i0, j0, total, weight
):
    bins = profiles.shape[1]
    place, away = np.empty(total.shape[1]), np.empty(total.shape[1])
    for v in range(cameras.shape[0]):
        low_i = max(0, int(np.floor((cameras[v, 0] - radius) / cell)) - i0)
        high_i = min(total.shape[0], int(np.floor((cameras[v, 0] + radius) / cell)) - i0 + 1)
        for i in range(low_i, high_i):
            x = (i0 + i + 0.5) * cell - cameras[v, 0]
            if abs(x) > radius:
                continue
            half = np.sqrt(radius * radius - x * x)
            low = max(0, int(np.ceil((cameras[v, 1] - half) / cell - 0.5)) - j0)
            high = min(total.shape[1], int(np.floor((cameras[v, 1] + half) / cell - 0.5)) - j0 + 1)
            count = max(0, high - low)
            _row(x, (j0 + low + 0.5) * cell - cameras[v, 1], cell, bins, place[:count], away)
            for j in range(count):
                at = place[j] + 0.5
                right = int(at)
                share = at - right
                left = right - 1 if right > 0 else bins - 1
                right = right if right < bins else 0
                near = left if share < 0.5 else right
                reach = profiles[v, near]
                if np.isnan(reach):
                    near = right if near == left else left
                    reach = profiles[v, near]
                    if np.isnan(reach):
                        continue
                elif abs(profiles[v, left] - profiles[v, right]) < truncation:
                    # Interpolated only along one wall, not over a step from one to another.
                    reach = profiles[v, left] * (1 - share) + profiles[v, right] * share
                distance = reach - away[j]
                w = weights[v, near]
                if distance < -truncation:
                    w *= beyond_weight
                    distance = -truncation
                elif distance > truncation:
                    distance = truncation
                total[i, low + j] += w * distance
                weight[i, low + j] += w


def passing_votes(
    cameras: FloatArray, profiles: FloatArray, points: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray]:
    """How many views look through each point and how many end there.

    Args:
        cameras: (V, 2) positions.
        profiles: (V, B) ranges as `range_profile` gives them.
        points: (N, 2).
        tolerance: a view ends at a point where its range differs by less than this.

    Returns:
        (N,) views whose range goes beyond the point, and (N,) those that end there; views that
        end before it take no part.
    """
    through = np.zeros(len(points))
    ending = np.zeros(len(points))
    _passing_votes(cameras, profiles, points, tolerance, through, ending)
    return through, ending


@njit(cache=True)
def _passing_votes(cameras, profiles, points, tolerance, through, ending):
    bins = profiles.shape[1]
    for p in range(points.shape[0]):
        for v in range(cameras.shape[0]):
            x, y = points[p, 0] - cameras[v, 0], points[p, 1] - cameras[v, 1]
            reach = profiles[v, int((np.arctan2(x, y) + np.pi) * bins / (2 * np.pi)) % bins]
            beyond = reach - np.sqrt(x * x + y * y)
            if beyond > tolerance:
                through[p] += 1
            elif beyond > -tolerance:
                ending[p] += 1


def at_boundaries(
    cameras: FloatArray, profiles: FloatArray, reach: float, limit: float
) -> BoolArray:
    """Which cameras stand near the boundary of another view and deep inside none.

    Args:
        cameras: (V, 2) positions.
        profiles: (V, B) ranges as `range_profile` gives them.
        reach: pairs farther apart are not looked at.
        limit: nearer than this is near, deeper than this is deep.

    Returns:
        (V,) whether they do. Where a view's boundary is unknown in the direction of a camera it
        says nothing of it.
    """
    found = np.zeros(len(cameras), dtype=np.bool_)
    _at_boundaries(cameras, profiles, profile_rays(profiles.shape[1]), reach, limit, found)
    return found


@njit(cache=True)
def _at_boundaries(cameras, profiles, rays, reach, limit, found):
    views, bins = profiles.shape
    for i in range(views):
        for j in range(views):
            x, y = cameras[i, 0] - cameras[j, 0], cameras[i, 1] - cameras[j, 1]
            away = np.sqrt(x * x + y * y)
            if i == j or away > reach:
                continue
            straight = int((_heading(x, y) + np.pi) * bins / (2 * np.pi))
            ahead = profiles[j, straight % bins]
            # The boundary is at least as near as it is straight ahead.
            if np.isnan(ahead) or (ahead > away and ahead - away < limit and found[i]):
                continue
            nearest = np.inf
            # What is nearer than the limit lies within this angle of straight ahead.
            span = bins // 2
            if away > limit:
                span = min(span, int(np.arcsin(limit / away) * bins / (2 * np.pi)) + 2)
            for k in range(straight - span, straight + span + 1):
                b = k % bins
                r = profiles[j, b]
                dx, dy = r * rays[b, 0] - x, r * rays[b, 1] - y
                squared = dx * dx + dy * dy
                if squared < nearest:
                    nearest = squared
            if nearest < limit * limit:
                found[i] = True
            elif away < ahead:
                found[i] = False
                break


def intrusions(
    cameras: FloatArray,
    profiles: FloatArray,
    sigmas: FloatArray,
    into: FloatArray,
    into_profiles: FloatArray,
    into_sigmas: FloatArray,
    depth: float,
    reach: float,
) -> FloatArray:
    """How much of each view's boundary lies in the free space of each other one.

    Args:
        cameras: (V, 2) positions.
        profiles: (V, B) ranges as `range_profile` gives them, NaN where unknown.
        sigmas: (V, B) their standard deviations.
        into: (U, 2) positions of the other views.
        into_profiles: (U, B).
        into_sigmas: (U, B).
        depth: what lies less deep does not count, nor what lies within three standard deviations.
        reach: ranges beyond it say nothing.

    Returns:
        (V, U) share of the view's known directions, 0-1.
    """
    shares = np.zeros((len(cameras), len(into)))
    rays = profile_rays(profiles.shape[1])
    _intrusions(
        cameras, profiles, sigmas, into, into_profiles, into_sigmas, rays, depth, reach, shares
    )
    return shares


@njit(cache=True)
def _intrusions(
    cameras, profiles, sigmas, into, into_profiles, into_sigmas, rays, depth, reach, shares
):
    bins = profiles.shape[1]
    for v in range(cameras.shape[0]):
        known = 0
        for b in range(bins):
            r = profiles[v, b]
            if not r < reach:
                continue
            known += 1
            px, py = cameras[v, 0] + r * rays[b, 0], cameras[v, 1] + r * rays[b, 1]
            for u in range(into.shape[0]):
                x, y = px - into[u, 0], py - into[u, 1]
                away = np.sqrt(x * x + y * y)
                if away > reach:
                    continue
                at = int((_heading(x, y) + np.pi) * bins / (2 * np.pi)) % bins
                inside = into_profiles[u, at] - away
                if not inside > depth:
                    continue
                if inside * inside > 9 * (sigmas[v, b] ** 2 + into_sigmas[u, at] ** 2):
                    shares[v, u] += 1
        for u in range(into.shape[0]):
            shares[v, u] /= max(1, known)


def mutual_overlaps(
    cameras: FloatArray, profiles: FloatArray, radius: float, cell: float
) -> FloatArray:
    """Common area of each two views' regions over that of the smaller one.

    Args:
        cameras: (V, 2) positions.
        profiles: (V, B) ranges as `range_profile` gives them, NaN where unknown.
        radius: regions are clipped at it.
        cell: cell size that areas are counted in.

    Returns:
        (V, V) symmetric, 0-1, 1 on the diagonal; 0 with views that know no range.
    """
    reach = np.minimum(np.fmax.reduce(profiles, axis=1, initial=0.0), radius)
    low = np.floor((cameras - reach[:, None]) / cell).astype(np.int64)
    high = np.floor((cameras + reach[:, None]) / cell).astype(np.int64) + 1
    # Rows of whole words on one lattice, so that two masks are compared 64 cells at a time.
    low[:, 1] //= _WORD
    high[:, 1] = -(-high[:, 1] // _WORD)
    sizes = (high - low).prod(axis=1)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    words = np.zeros(starts[-1], dtype=np.uint64)
    _fill_words(cameras, profiles, radius, cell, low, high, starts, words)
    areas = np.zeros(len(cameras))
    common = np.eye(len(cameras))
    _word_overlaps(low, high, starts, words, areas, common)
    return common


_WORD = 64


@njit(cache=True)
def _fill_words(cameras, profiles, radius, cell, low, high, starts, words):
    bins = profiles.shape[1]
    widest = 64 * (high[:, 1] - low[:, 1]).max()
    place, away = np.empty(widest), np.empty(widest)
    for v in range(cameras.shape[0]):
        width = high[v, 1] - low[v, 1]
        for i in range(low[v, 0], high[v, 0]):
            x = (i + 0.5) * cell - cameras[v, 0]
            y0 = (64 * low[v, 1] + 0.5) * cell - cameras[v, 1]
            _row(x, y0, cell, bins, place[: 64 * width], away)
            for j in range(64 * width):
                if away[j] < min(profiles[v, int(place[j]) % bins], radius):
                    at = starts[v] + (i - low[v, 0]) * width + j // 64
                    words[at] |= np.uint64(1) << np.uint64(j % 64)


@njit(cache=True)
def _bits(word):
    word = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    word = (word & np.uint64(0x3333333333333333)) + (
        (word >> np.uint64(2)) & np.uint64(0x3333333333333333)
    )
    word = (word + (word >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return (word * np.uint64(0x0101010101010101)) >> np.uint64(56)


@njit(cache=True)
def _word_overlaps(low, high, starts, words, area, out):
    views = low.shape[0]
    for v in range(views):
        for k in range(starts[v], starts[v + 1]):
            area[v] += _bits(words[k])
    for a in range(views):
        for b in range(a):
            i0, i1 = max(low[a, 0], low[b, 0]), min(high[a, 0], high[b, 0])
            j0, j1 = max(low[a, 1], low[b, 1]), min(high[a, 1], high[b, 1])
            if i0 >= i1 or j0 >= j1:
                continue
            common = 0.0
            for i in range(i0, i1):
                row_a = starts[a] + (i - low[a, 0]) * (high[a, 1] - low[a, 1]) - low[a, 1]
                row_b = starts[b] + (i - low[b, 0]) * (high[b, 1] - low[b, 1]) - low[b, 1]
                for j in range(j0, j1):
                    common += _bits(words[row_a + j] & words[row_b + j])
            out[a, b] = common / max(1.0, min(area[a], area[b]))
            out[b, a] = out[a, b]
