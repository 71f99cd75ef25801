"""Two level cameras of one height: their relative heading and the direction from one to the other.

A point at elevation φ lies cot|φ| times its height off the horizon away. Seen from two level
cameras of one height it tells, for each yaw, in which direction the second camera stands, and how
far in units of the point's own height. What one match says of the direction is as sharp as its
elevations and headings allow, and by the symmetry of headings a match by chance says any direction
alike: so each match has a likelihood ratio of its own, near 1 at the horizon, where anything fits.

Yaw: what is added to a heading in the second camera to have it in the first one's frame.
Direction: heading of the second camera from the first one, in the first one's frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SHARE_STEPS = 6
"""Steps in which the share of inliers is found; more change a sum of 450 by less than .1 nats."""
_VAGUE_RAD = 1.0
"""A direction less certain than this says nothing."""


class UprightFit(NamedTuple):
    """A yaw and a direction that matches agree upon.

    Attributes:
        yaw: rad.
        direction: rad.
        evidence: log likelihood ratio against chance, capped a cell, nats.
        share: of the matches that are inliers.
        information: (2, 2) inverse covariance of yaw and direction.
    """

    yaw: float
    direction: float
    evidence: float
    share: float
    information: FloatArray


class Caps(NamedTuple):
    """How much evidence matches that are not independent give at most, in either image.

    Attributes:
        cell: side of a cell of directions, rad.
        a_cell: of the matches of one cell, nats: a poster must not decide.
        a_surface: of the matches of one level surface, nats: floors and ceilings repeat themselves.
    """

    cell: float
    a_cell: float
    a_surface: float


WALL, FLOOR, CEILING = 0, 1, 2
"""What a match lies on; on walls, or where it is not known, only cells are capped."""


def vote(
    matches: FloatArray,
    prior: FloatArray,
    yaw_prior: FloatArray,
    weights: FloatArray,
    directions: int,
    sigma: float,
    share: float,
) -> FloatArray:
    """What all matches say of every yaw and direction on a grid.

    Args:
        matches: (M, 4) heading and elevation in the first camera, then in the second one; rad;
            both elevations of a match of one sign, none 0.
        prior: (M,) likelihood ratio of each match being one at all.
        yaw_prior: (Y,) log prior of the yaws 2π·k/Y.
        weights: (M,) how much of what each match says counts, 0-1.
        directions: number of directions D, 2π·k/D.
        sigma: standard deviation of an angle, rad, of the matches; half a cell is added.
        share: of the matches that are inliers.

    Returns:
        (Y, D) log likelihood ratio.
    """
    grid = np.repeat(np.asarray(yaw_prior, dtype=np.float64)[:, None], directions, axis=1)
    _vote(_prepared(matches), prior, weights, sigma, share, grid)
    return grid


def refine(
    matches: FloatArray,
    prior: FloatArray,
    surfaces: IntArray,
    yaw: float,
    direction: float,
    sigma: float,
    caps: Caps,
    widths: tuple[float, ...] = (3.0, 2.0, 1.4, 1.0, 1.0, 1.0),
) -> UprightFit:
    """The best yaw and direction near a start.

    Args:
        matches: as `vote`.
        prior: as `vote`.
        surfaces: (M,) WALL, FLOOR or CEILING.
        yaw: start, rad.
        direction: start, rad.
        sigma: standard deviation of an angle, rad.
        caps: on the evidence.
        widths: factors on sigma, one a step.

    Returns:
        The fit.
    """
    found = _refine(
        _prepared(matches), prior, surfaces, yaw, direction, sigma, *caps, np.array(widths)
    )
    information = np.array([[found[4], found[5]], [found[5], found[6]]])
    return UprightFit(found[0], found[1], found[2], found[3], information)


def evidence(
    matches: FloatArray,
    prior: FloatArray,
    surfaces: IntArray,
    yaw: float,
    direction: float,
    sigma: float,
    caps: Caps,
) -> tuple[float, float, FloatArray]:
    """How much more likely matches are at a yaw and direction than by chance.

    Args:
        matches: as `vote`.
        prior: as `vote`.
        surfaces: (M,) WALL, FLOOR or CEILING.
        yaw: rad.
        direction: rad.
        sigma: standard deviation of an angle, rad.
        caps: on the evidence.

    Returns:
        Log likelihood ratio in nats, the smaller of both images' sums, never below 0 (no match
        need be an inlier); the share of inliers; (M,) probability of each match to be one.
    """
    inlier = np.zeros(len(matches))
    total, share = _evidence(
        _prepared(matches), prior, surfaces, yaw, direction, sigma, *caps, inlier
    )
    return total, share, inlier


def pull(
    matches: FloatArray, prior: FloatArray, yaw: float, direction: float, sigma: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where matches pull a yaw and a direction, as least squares has it.

    Args:
        matches: as `vote`.
        prior: as `vote`.
        yaw: rad.
        direction: rad.
        sigma: standard deviation of an angle, rad.

    Returns:
        (2, 2) information of yaw and direction, (2,) information times the step to the optimum,
        and (M,) probability of each match to be an inlier.
    """
    inlier = np.empty(len(matches))
    a, b, d, gy, gd = _pull(_prepared(matches), prior, yaw, direction, sigma, inlier)
    return np.array([[a, b], [b, d]]), np.array([gy, gd]), inlier


def _prepared(matches: FloatArray) -> FloatArray:
    """(M, 8) sine and cosine of the heading and cot|φ| of both cameras, then both elevations."""
    m = np.asarray(matches, dtype=np.float64).reshape(-1, 4)
    out = np.empty((len(m), 8))
    for k in (0, 1):
        heading, elevation = m[:, 2 * k], m[:, 2 * k + 1]
        out[:, 3 * k] = np.sin(heading)
        out[:, 3 * k + 1] = np.cos(heading)
        out[:, 3 * k + 2] = 1.0 / np.tan(np.abs(elevation))
        out[:, 6 + k] = elevation
    return np.hstack([out, m[:, [0, 2]]])


@njit(cache=True)
def _told(row, sy, cy, sigma, slack_b):
    """Sine and cosine of the direction that a match tells at a yaw, variance, d direction/d yaw.

    The vector from the first camera to the second one, in units of the point's height, is the
    difference of the point's places seen from both.
    """
    ra, rb = row[2], row[5]
    sb, cb = row[3] * cy + row[4] * sy, row[4] * cy - row[3] * sy
    x, z = row[0] * ra - sb * rb, row[1] * ra - cb * rb
    length = np.sqrt(x * x + z * z) + 1e-12
    s, c = x / length, z / length
    # Along and across the ray: an error of the elevation changes the range, one of the heading
    # moves the point aside; both matter as far as they lie across the direction.
    sin_a, cos_a = row[0] * c - row[1] * s, row[0] * s + row[1] * c
    sin_b, cos_b = sb * c - cb * s, sb * s + cb * c
    qa, qb = 1.0 + ra * ra, 1.0 + rb * rb
    across = qa * cos_a * cos_a + qa * qa * sin_a * sin_a
    across += qb * cos_b * cos_b + qb * qb * sin_b * sin_b
    turned = rb * cos_b / length
    variance = sigma * sigma * across / (length * length) + (slack_b * turned) ** 2
    return s, c, variance, -turned


@njit(cache=True)
def _ratio(off_sin, off_cos, variance):
    """Likelihood ratio of a direction so far off against one by chance."""
    if off_cos <= 0.0:
        return 0.0
    return np.sqrt(2.0 * np.pi / variance) * np.exp(-0.5 * off_sin * off_sin / variance)


@njit(cache=True)
def _vote(rows, prior, weights, sigma, share, grid):
    yaws, directions = grid.shape
    half_yaw, half_direction = np.pi / yaws, np.pi / directions
    per_rad = directions / (2.0 * np.pi)
    # The slack of a uniform error within a cell.
    slack_yaw, slack = half_yaw / np.sqrt(3.0), half_direction / np.sqrt(3.0)
    for y in range(yaws):
        yaw = 2.0 * np.pi * y / yaws
        sy, cy = np.sin(yaw), np.cos(yaw)
        for k in range(rows.shape[0]):
            s, c, variance, _ = _told(rows[k], sy, cy, sigma, slack_yaw)
            variance += slack * slack
            if variance > _VAGUE_RAD * _VAGUE_RAD:
                continue
            at = np.arctan2(s, c) * per_rad
            reach = 2.5 * np.sqrt(variance) * per_rad
            peak = share / (1.0 - share) * prior[k] * np.sqrt(2.0 * np.pi / variance)
            for d in range(int(np.ceil(at - reach)), int(np.floor(at + reach)) + 1):
                off = (d - at) / per_rad
                told = np.log1p(peak * np.exp(-0.5 * off * off / variance))
                grid[y, d % directions] += weights[k] * told


@njit(cache=True)
def _ratios(rows, prior, yaw, direction, sigma, ratio, off, variance, slope):
    """Fills in, a match: its likelihood ratio, how far off it is, variance, d direction/d yaw."""
    sy, cy = np.sin(yaw), np.cos(yaw)
    st, ct = np.sin(direction), np.cos(direction)
    for k in range(rows.shape[0]):
        s, c, v, g = _told(rows[k], sy, cy, sigma, 0.0)
        off[k] = s * ct - c * st
        variance[k] = v
        slope[k] = g
        if v > _VAGUE_RAD * _VAGUE_RAD:
            ratio[k] = 1.0
            slope[k] = 0.0
            variance[k] = np.inf
        else:
            ratio[k] = prior[k] * _ratio(off[k], s * st + c * ct, v)


@njit(cache=True)
def _share(ratio):
    """The share of inliers that makes a mixture most likely (expectation, maximisation)."""
    share = 0.3
    for _ in range(SHARE_STEPS):
        total = 0.0
        for k in range(ratio.size):
            lifted = share * ratio[k]
            total += lifted / (1.0 - share + lifted)
        share = min(0.98, max(1e-4, total / max(1, ratio.size)))
    return share


@njit(cache=True)
def _capped(rows, terms, surfaces, cell, a_cell, a_surface):
    """Sum of terms, capped a cell and a level surface; the smaller one of both images."""
    across, up = int(np.ceil(2.0 * np.pi / cell)), int(np.ceil(np.pi / cell))
    smaller = np.inf
    for image in range(2):
        sums = np.zeros((3, across * up))
        for k in range(rows.shape[0]):
            i = int((rows[k, 8 + image] + np.pi) / cell) % across
            j = min(up - 1, max(0, int((rows[k, 6 + image] + 0.5 * np.pi) / cell)))
            sums[surfaces[k], i * up + j] += terms[k]
        total = 0.0
        for surface in range(3):
            here = 0.0
            for value in sums[surface]:
                here += min(value, a_cell)
            total += here if surface == WALL else min(here, a_surface)
        smaller = min(smaller, total)
    return smaller


@njit(cache=True)
def _evidence(rows, prior, surfaces, yaw, direction, sigma, cell, a_cell, a_surface, inlier):
    count = rows.shape[0]
    ratio, off = np.empty(count), np.empty(count)
    variance, slope = np.empty(count), np.empty(count)
    _ratios(rows, prior, yaw, direction, sigma, ratio, off, variance, slope)
    share = _share(ratio)
    terms = np.empty(count)
    for k in range(count):
        mixed = 1.0 - share + share * ratio[k]
        terms[k] = np.log(mixed)
        inlier[k] = share * ratio[k] / mixed
    return max(0.0, _capped(rows, terms, surfaces, cell, a_cell, a_surface)), share


@njit(cache=True)
def _pull(rows, prior, yaw, direction, sigma, inlier):
    count = rows.shape[0]
    ratio, off = np.empty(count), np.empty(count)
    variance, slope = np.empty(count), np.empty(count)
    _ratios(rows, prior, yaw, direction, sigma, ratio, off, variance, slope)
    share = _share(ratio)
    a = d = 1e-9
    b = gy = gd = 0.0
    for k in range(count):
        lifted = share * ratio[k]
        inlier[k] = lifted / (1.0 - share + lifted)
        w = inlier[k] / variance[k]
        # The told direction less the direction: J = (slope, -1).
        a += w * slope[k] * slope[k]
        b -= w * slope[k]
        d += w
        gy -= w * slope[k] * off[k]
        gd += w * off[k]
    return a, b, d, gy, gd


@njit(cache=True)
def _refine(rows, prior, surfaces, yaw, direction, sigma, cell, a_cell, a_surface, widths):
    inlier = np.empty(rows.shape[0])
    a = b = d = 0.0
    for width in widths:
        a, b, d, gy, gd = _pull(rows, prior, yaw, direction, width * sigma, inlier)
        determinant = a * d - b * b
        if determinant > 1e-12 * a * d:
            step_yaw = (d * gy - b * gd) / determinant
            step_direction = (a * gd - b * gy) / determinant
            # A step from a cell of the vote is never longer than a few cells.
            most = max(abs(step_yaw), abs(step_direction) / 3.0)
            damp = min(1.0, 0.05 / most) if most > 0.0 else 1.0
            yaw += damp * step_yaw
            direction += damp * step_direction
    total, share = _evidence(
        rows, prior, surfaces, yaw, direction, sigma, cell, a_cell, a_surface, inlier
    )
    yaw = (yaw + np.pi) % (2.0 * np.pi) - np.pi
    direction = (direction + np.pi) % (2.0 * np.pi) - np.pi
    return yaw, direction, total, share, a, b, d
