"""Which features of two panoramas show the same."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panoplan.config import TourConfig
from panoplan.geometry.nearest import mutual_nearest
from panoplan.poses.tour.features import Features
from panoplan.poses.tour.room import RoomSeen, at_aperture
from panoplan.types.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Matches:
    """Features that two panoramas seem to have in common.

    Attributes:
        angles: (M, 4) heading and elevation in the first panorama, then in the second one; rad.
        prior: (M,) likelihood ratio of each match being one, from what it looks like.
    """

    angles: FloatArray
    prior: FloatArray

    def __len__(self) -> int:
        """Number of matches."""
        return len(self.angles)


def match(a: Features, b: Features, config: TourConfig) -> Matches:
    """Matches the features of two level panoramas taken from one height.

    What is above the horizon in one is so in the other, so both halves are matched apart. At most
    one match a cell of `config.match_cell_deg` in either panorama is kept, that of the smallest
    distance ratio.

    Args:
        a: features of the first panorama.
        b: features of the second one.
        config: settings.

    Returns:
        The matches, the clearest first.
    """
    pairs, ratios = [], []
    for sign in (-1, 1):
        rows = [np.flatnonzero(sign * side.elevations > 0) for side in (a, b)]
        found, ratio = mutual_nearest(_unit(a.descriptors[rows[0]]), _unit(b.descriptors[rows[1]]))
        pairs.append(np.column_stack([rows[0][found[:, 0]], rows[1][found[:, 1]]]))
        ratios.append(ratio)
    pair, ratio = np.vstack(pairs), np.concatenate(ratios)
    order = np.argsort(ratio, kind="stable")
    order = order[ratio[order] < config.max_ratio]
    for side, column in ((a, 0), (b, 1)):
        order = order[_first_of_cells(side, pair[order, column], config)]
    order = order[: config.max_matches]
    i, j = pair[order].T
    angles = np.column_stack([a.headings[i], a.elevations[i], b.headings[j], b.elevations[j]])
    sizes = np.log(a.sizes[i] / b.sizes[j])
    return Matches(angles, _distinct(ratio[order]) * _sized(sizes, angles))


def without_distant(
    matches: Matches, a: RoomSeen | None, b: RoomSeen | None, config: TourConfig
) -> Matches:
    """The matches without what lies so far away that it tells no place.

    What is far outside has one elevation from everywhere, and a heading that tells the yaw alone:
    two rooms with windows to one side would be taken for one. What is seen at one elevation through
    a window, door or opening in both panoramas is left out, though some of it may be near.

    Args:
        matches: of two panoramas.
        a: the room that the first one stands in, None where unknown.
        b: that of the second one.
        config: settings.
    """
    if a is None or b is None:
        return matches
    angles = matches.angles
    same = np.abs(angles[:, 1] - angles[:, 3]) < _FAR_SIGMAS * np.deg2rad(config.match_sigma_deg)
    far = same & at_aperture(a, angles[:, 0]) & at_aperture(b, angles[:, 2])
    return Matches(angles[~far], matches.prior[~far])


_FAR_SIGMAS = 3.0


def _distinct(ratio: FloatArray) -> FloatArray:
    """Likelihood ratio of a match by how much nearer its neighbour is than the second one.

    Fitted to rendered tours: of matches at .9 as many are right as wrong ones would be, at .65
    nine times as many.
    """
    return np.exp(np.minimum(_MOST_DISTINCT, _DISTINCT_SLOPE * (_NEUTRAL_RATIO - ratio)))


_DISTINCT_SLOPE, _NEUTRAL_RATIO, _MOST_DISTINCT = 10.0, 0.87, 3.5


def _sized(log_sizes: FloatArray, angles: FloatArray) -> FloatArray:
    """Likelihood ratio of a match by the sizes of its features.

    A thing at elevation φ is its height over sin|φ| away, whatever the height; seen from two
    cameras of one height its sizes are as these sines.
    """
    sines = np.sin(np.abs(angles[:, [1, 3]]))
    off = log_sizes - np.log(sines[:, 0] / sines[:, 1])
    true, chance = (np.exp(-0.5 * (off / s) ** 2) / s for s in (_SIZE_SIGMA, _SIZE_SPREAD))
    return _SIZED * true / np.maximum(chance, 1e-12) + 1.0 - _SIZED


_SIZED, _SIZE_SIGMA, _SIZE_SPREAD = 0.8, 0.3, 0.8
"""Share of matches whose sizes tell; standard deviation of the logarithms, and by chance."""


def _unit(descriptors: NDArray[np.uint8]) -> NDArray[np.float32]:
    values = descriptors.astype(np.float32)
    values /= np.maximum(np.linalg.norm(values, axis=1, keepdims=True), 1e-6)
    return values


def _first_of_cells(side: Features, rows: IntArray, config: TourConfig) -> IntArray:
    """Places in `rows` of the first feature in each cell, in their order."""
    cell = np.deg2rad(max(config.match_cell_deg, 1e-3))
    at = np.column_stack([side.headings[rows], side.elevations[rows]]) // cell
    return np.sort(np.unique(at, axis=0, return_index=True)[1])
