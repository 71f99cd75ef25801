"""Where one panorama was taken, seen from another: several hypotheses of yaw and direction."""

from __future__ import annotations

import numpy as np

from panoplan.config import TourConfig
from panoplan.geometry.angles import wrapped
from panoplan.geometry.upright import Caps, UprightFit, refine, vote
from panoplan.poses.tour.matching import Matches
from panoplan.types.arrays import FloatArray, IntArray

_PEAKS = 24
"""Peaks of the vote that are refined; the vote weighs cells alike, so the best may not lead."""
_FEWEST = 4


def hypotheses(
    matches: Matches, surfaces: IntArray, yaw_prior: FloatArray, config: TourConfig
) -> tuple[UprightFit, ...]:
    """Yaws and directions that the matches of two panoramas agree upon.

    Args:
        matches: of the two.
        surfaces: (M,) WALL, FLOOR or CEILING, what each match lies on.
        yaw_prior: (Y,) log prior of the yaws 2π·k/Y.
        config: settings.

    Returns:
        At most `config.hypotheses`, no two of them one, the one of most evidence first, the
        prior's included.
    """
    if len(matches) < _FEWEST:
        return ()
    sigma = np.deg2rad(config.match_sigma_deg)
    directions = round(360.0 / config.direction_step_deg)
    weights = _shares_of_cells(matches.angles, config)
    grid = vote(
        matches.angles, matches.prior, yaw_prior, weights, directions, sigma, config.vote_share
    )
    fits = [
        refine(
            matches.angles,
            matches.prior,
            surfaces,
            2 * np.pi * y / len(yaw_prior),
            2 * np.pi * d / directions,
            sigma,
            caps(config),
        )
        for y, d in _peaks(grid, config)
    ]
    fits = [fit._replace(evidence=fit.evidence + _at(yaw_prior, fit.yaw)) for fit in fits]
    fits.sort(key=lambda fit: -fit.evidence)
    kept: list[UprightFit] = []
    for fit in fits:
        if fit.evidence > 0 and all(_apart(fit, other) > config.apart_deg for other in kept):
            kept.append(fit)
    return tuple(kept[: config.hypotheses])


def _shares_of_cells(angles: FloatArray, config: TourConfig) -> FloatArray:
    """(M,) weights with which all matches of a cell of either image count as one.

    What many matches of one bookcase say adds up along a curve of yaws and directions, on which
    no peak would be left for the matches of all other cells together.
    """
    most = np.ones(len(angles))
    for image in (angles[:, :2], angles[:, 2:]):
        cells = np.floor(image / np.deg2rad(config.evidence_cell_deg))
        _, own, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
        most = np.maximum(most, counts[own.reshape(-1)])
    return 1.0 / most


def caps(config: TourConfig) -> Caps:
    """The caps on evidence that the settings ask for."""
    return Caps(np.deg2rad(config.evidence_cell_deg), config.evidence_cap, config.surface_cap)


def _peaks(grid: FloatArray, config: TourConfig) -> list[tuple[int, int]]:
    """The highest cells of a grid that wraps both ways, none within `apart_deg` of another."""
    left = grid.copy()
    reach = [max(1, round(config.apart_deg / 360.0 * n)) for n in grid.shape]
    peaks = []
    for _ in range(_PEAKS):
        y, d = (int(k) for k in np.unravel_index(np.argmax(left), left.shape))
        if left[y, d] <= 0:
            break
        peaks.append((y, d))
        rows, columns = (
            np.arange(at - r, at + r + 1) % n
            for at, r, n in zip((y, d), reach, grid.shape, strict=True)
        )
        left[np.ix_(rows, columns)] = -np.inf
    return peaks


def _at(yaw_prior: FloatArray, yaw: float) -> float:
    return float(yaw_prior[round(yaw / (2 * np.pi) * len(yaw_prior)) % len(yaw_prior)])


def _apart(one: UprightFit, other: UprightFit) -> float:
    """The larger one of the differences in yaw and direction, degrees."""
    off = wrapped(np.array([one.yaw - other.yaw, one.direction - other.direction]))
    return float(np.rad2deg(np.abs(off)).max())
