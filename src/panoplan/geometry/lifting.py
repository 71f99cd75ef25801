"""How far two level cameras are apart, told by the room that each of them stands in.

Lengths are camera heights, which a layout knows. A point seen from both cameras lies at ranges that
are known but for the distance between them; the layout says how far the first surface along each
of its rays is. Most points lie on it; some lie beyond, seen through a door, and most do where the
layout tells one; some before, on furniture. And the walls that two layouts tell must fit one
another.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_ON, _BEFORE, _BEYOND, _ANY = 0.45, 0.2, 0.3, 0.05
"""Shares of points on the first surface, before and beyond it, and anywhere."""
_ON_OPEN, _BEFORE_OPEN, _BEYOND_OPEN = 0.12, 0.08, 0.75
"""The same where the layout tells a door, which may be shut, or an opening in the wall."""
_BEFORE_SCALE, _BEYOND_WIDTH, _ANY_WIDTH = 0.4, 3.0, 6.0
"""How far they are off then, as logarithms of the range."""
_TELLING = 0.6
"""Share of cells whose points tell anything: all that is seen through one door lies beyond."""
_LOG_WIDTH = 3.0
"""Logarithmic width of the lengths held possible: what a length is compared with."""


def triangulated(
    matches: FloatArray, yaw: float, direction: float, sigma: float
) -> tuple[FloatArray, FloatArray]:
    """Ranges of points seen from two level cameras that are a length of 1 apart.

    Args:
        matches: (M, 4) heading and elevation in the first camera, then in the second one; rad.
        yaw: what is added to a heading in the second camera to have it in the first one's frame.
        direction: heading of the second camera from the first one.
        sigma: standard deviation of an angle, rad.

    Returns:
        (M, 2) horizontal ranges from both cameras, NaN where a point lies behind one, and (M, 2)
        their relative standard deviations.
    """
    ranges = np.empty((len(matches), 2))
    sigmas = np.empty((len(matches), 2))
    _triangulate(np.ascontiguousarray(matches), yaw, direction, sigma, ranges, sigmas)
    return ranges, sigmas


def length_evidence(
    log_lengths: FloatArray,
    log_ranges: FloatArray,
    log_surfaces: FloatArray,
    sigmas: FloatArray,
    inlier: FloatArray,
    passages: NDArray[np.bool_],
    cells: NDArray[np.int64],
    level: NDArray[np.bool_],
    a_cell: float,
    a_level: float,
) -> FloatArray:
    """How well points lie in two rooms, for each of several lengths between the cameras.

    Args:
        log_lengths: (L,) logarithms of the lengths.
        log_ranges: (M, 2) logarithms of the points' ranges at length 1, NaN where unknown.
        log_surfaces: (M, 2) those of the first surface along the same rays, NaN where unknown.
        sigmas: (M, 2) standard deviations of their difference.
        inlier: (M,) probability of each match to be one.
        passages: (M, 2) whether that surface is a door or an opening.
        cells: (M,) cell of the image that each match lies in, from 0.
        level: (M,) whether a match lies on floor or ceiling.
        a_cell: most evidence of a cell, nats.
        a_level: most evidence of all that lies on floor and ceiling, nats.

    Returns:
        (L,) log likelihood ratio against any length.
    """
    out = np.empty(len(log_lengths))
    offs = log_ranges - log_surfaces
    _length_evidence(
        log_lengths, offs, sigmas, inlier, passages, cells, level, a_cell, a_level, out
    )
    return out


def length_pull(
    offs: FloatArray, sigmas: FloatArray, inlier: FloatArray, passages: NDArray[np.bool_]
) -> tuple[float, float]:
    """Where points pull the logarithm of a length, as least squares has it.

    Args:
        offs: (M, 2) logarithms of the points' ranges less those of the first surfaces, NaN where
            unknown.
        sigmas: (M, 2) their standard deviations.
        inlier: (M,) probability of each match to be one.
        passages: (M, 2) whether that surface is a door or an opening.

    Returns:
        Information, and information times the step to the optimum.
    """
    information, gradient = _length_pull(offs, sigmas, inlier, passages)
    return information, gradient


def coincidence(
    points: FloatArray,
    point_sigmas: FloatArray,
    yaw: float,
    places: FloatArray,
    log_profile: FloatArray,
    profile_sigmas: FloatArray,
) -> FloatArray:
    """How well the walls that one camera sees fit the room that another one sees.

    Args:
        points: (N, 2) wall points about the second camera, in its frame.
        point_sigmas: (N,) relative standard deviations of their ranges.
        yaw: of the second camera.
        places: (L, 2) of the second camera in the first one's frame.
        log_profile: (B,) logarithms of the first camera's ranges, bins as `polar.range_profile`
            has them, NaN where unknown.
        profile_sigmas: (B,) relative standard deviations of those.

    Returns:
        (L, 2) mean log likelihood ratio a point if both see one room, and if they do not.
    """
    out = np.empty((len(places), 2))
    _coincidence(points, point_sigmas, yaw, places, log_profile, profile_sigmas, out)
    return out


@njit(cache=True)
def _triangulate(matches, yaw, direction, sigma, ranges, sigmas):
    for k in range(matches.shape[0]):
        a, b = matches[k, 0] - direction, matches[k, 2] + yaw - direction
        sa, ca, sb, cb = np.sin(a), np.cos(a), np.sin(b), np.cos(b)
        ta, tb = np.tan(matches[k, 1]), np.tan(matches[k, 3])
        # First from the elevations: the cameras are the difference of the point's places apart.
        x, z = sa / abs(ta) - sb / abs(tb), ca / abs(ta) - cb / abs(tb)
        height = 1.0 / (np.sqrt(x * x + z * z) + 1e-12)
        ra, rb = height / abs(ta), height / abs(tb)
        variance_a = variance_b = np.inf
        for _ in range(3):
            # The point that all four angles fit best; an error of one moves it by about its
            # distance, and by that over the cosine along the vertical.
            da, db = ra * ra * (1.0 + ta * ta), rb * rb * (1.0 + tb * tb)
            wa, wb = 1.0 / da, 1.0 / db
            va, vb = ra * ra / (da * da), rb * rb / (db * db)
            xx = wa * ca * ca + wb * cb * cb + va * ta * ta * sa * sa + vb * tb * tb * sb * sb
            xz = -wa * ca * sa - wb * cb * sb + va * ta * ta * sa * ca + vb * tb * tb * sb * cb
            zz = wa * sa * sa + wb * sb * sb + va * ta * ta * ca * ca + vb * tb * tb * cb * cb
            xh = -va * ta * sa - vb * tb * sb
            zh = -va * ta * ca - vb * tb * cb
            hh = va + vb
            gx = -wb * cb * sb + vb * tb * tb * sb * cb
            gz = wb * sb * sb + vb * tb * tb * cb * cb
            gh = -vb * tb * cb
            # The height is eliminated.
            xx, xz, zz = xx - xh * xh / hh, xz - xh * zh / hh, zz - zh * zh / hh
            gx, gz = gx - xh * gh / hh, gz - zh * gh / hh
            determinant = xx * zz - xz * xz
            if not determinant > 1e-12 * xx * zz:
                ra = rb = np.nan
                break
            px, pz = (zz * gx - xz * gz) / determinant, (xx * gz - xz * gx) / determinant
            ra, rb = px * sa + pz * ca, px * sb + (pz - 1.0) * cb
            if not (ra > 1e-6 and rb > 1e-6):
                ra = rb = np.nan
                break
            variance_a = (zz * sa * sa - 2.0 * xz * sa * ca + xx * ca * ca) / determinant
            variance_b = (zz * sb * sb - 2.0 * xz * sb * cb + xx * cb * cb) / determinant
        ranges[k, 0], ranges[k, 1] = ra, rb
        sigmas[k, 0] = sigma * np.sqrt(variance_a) / ra
        sigmas[k, 1] = sigma * np.sqrt(variance_b) / rb


@njit(cache=True)
def _surface_ratio(off, sigma, passage):
    """Likelihood ratio of a point so far off (logarithm of range) the first surface."""
    on, before, beyond = _ON, _BEFORE, _BEYOND
    if passage:
        on, before, beyond = _ON_OPEN, _BEFORE_OPEN, _BEYOND_OPEN
    density = _ANY / _ANY_WIDTH
    if abs(off) < 6.0 * sigma:
        density += on * np.exp(-0.5 * (off / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi))
    if off < 0.0:
        density += before * np.exp(off / _BEFORE_SCALE) / _BEFORE_SCALE
    elif off < _BEYOND_WIDTH:
        density += beyond / _BEYOND_WIDTH
    return density * _LOG_WIDTH


@njit(cache=True)
def _length_pull(offs, sigmas, inlier, passages):
    information = gradient = 0.0
    for k in range(offs.shape[0]):
        for side in range(2):
            off, sigma = offs[k, side], sigmas[k, side]
            if np.isnan(off) or not abs(off) < 6.0 * sigma:
                continue
            on = _ON_OPEN if passages[k, side] else _ON
            on *= np.exp(-0.5 * (off / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi))
            share = inlier[k] * on * _LOG_WIDTH / _surface_ratio(off, sigma, passages[k, side])
            information += share / sigma**2
            gradient -= share * off / sigma**2
    return information, gradient


@njit(cache=True)
def _length_evidence(
    log_lengths, offs, sigmas, inlier, passages, cells, level, a_cell, a_level, out
):
    count = 0
    for cell in cells:
        count = max(count, cell + 1)
    sums = np.empty((2, count))
    for n in range(log_lengths.size):
        sums[:] = 0.0
        for k in range(offs.shape[0]):
            ratio = 1.0
            for side in range(2):
                off = offs[k, side] + log_lengths[n]
                if not np.isnan(off):
                    ratio *= _surface_ratio(off, sigmas[k, side], passages[k, side])
            sums[int(level[k]), cells[k]] += np.log(1.0 - inlier[k] + inlier[k] * ratio)
        totals = np.zeros(2)
        for surface in range(2):
            for value in sums[surface]:
                told = np.exp(min(a_cell, value))
                totals[surface] += np.log(1.0 - _TELLING + _TELLING * told)
        out[n] = totals[0] + min(a_level, totals[1])


_NEAR_BINS = 3
"""A step of the profile within about a degree is as good as one straight ahead."""
_LIMIT = 2.5
"""Most that one point says, nats."""


@njit(cache=True)
def _fit_terms(off, sigma):
    """Log likelihood ratios of a wall so far off another's (logarithm of range).

    The shares are those of simulated homes, against the same layouts laid over one another at
    random; what contradicts is held possible more often than there (leaks, furniture).
    """
    by_chance = 0.35
    on = np.exp(-0.5 * (off / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi))
    if off < 0.0:
        same = 0.62 * on + 0.2 * np.exp(off / 0.3) / 0.3 + 0.01
        other = 0.05 * on + 0.15 * np.exp(off / 0.15) / 0.15 + 0.02
    else:
        same = 0.62 * on + 0.16 * np.exp(-off / 0.8) / 0.8 + 0.01
        other = by_chance
    same = min(_LIMIT, max(-_LIMIT, np.log(same / by_chance)))
    other = min(_LIMIT, max(-_LIMIT, np.log(other / by_chance)))
    return same, min(0.0, other)


@njit(cache=True)
def _coincidence(points, point_sigmas, yaw, places, log_profile, profile_sigmas, out):
    s, c = np.sin(yaw), np.cos(yaw)
    bins = log_profile.size
    per_rad = bins / (2.0 * np.pi)
    for n in range(places.shape[0]):
        same = other = 0.0
        count = 0
        for k in range(points.shape[0]):
            x = points[k, 0] * c + points[k, 1] * s + places[n, 0]
            z = points[k, 1] * c - points[k, 0] * s + places[n, 1]
            log_range = 0.5 * np.log(x * x + z * z + 1e-12)
            at = int((np.arctan2(x, z) + np.pi) * per_rad)
            off, sigma = np.inf, 1.0
            for b in range(at - _NEAR_BINS, at + _NEAR_BINS + 1):
                here = log_range - log_profile[b % bins]
                if abs(here) < abs(off):
                    off, sigma = here, profile_sigmas[b % bins]
            if np.isinf(off):
                continue
            told = _fit_terms(off, np.hypot(sigma, point_sigmas[k]))
            same += told[0]
            other += told[1]
            count += 1
        out[n, 0] = same / max(1, count)
        out[n, 1] = other / max(1, count)
