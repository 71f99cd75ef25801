"""Which features of two panoramas show the same."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panoplan.config import TourConfig
from panoplan.geometry.nearest import mutual_nearest
from panoplan.poses.tour.features import Features
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
    pair = pair[order[: config.max_matches]]
    angles = np.column_stack(
        [a.headings[pair[:, 0]], a.elevations[pair[:, 0]],
         b.headings[pair[:, 1]], b.elevations[pair[:, 1]]]
    )  # fmt: skip
    return Matches(angles, np.ones(len(pair)))


def _unit(descriptors: NDArray[np.uint8]) -> NDArray[np.float32]:
    values = descriptors.astype(np.float32)
    values /= np.maximum(np.linalg.norm(values, axis=1, keepdims=True), 1e-6)
    return values


def _first_of_cells(side: Features, rows: IntArray, config: TourConfig) -> IntArray:
    """Places in `rows` of the first feature in each cell, in their order."""
    cell = np.deg2rad(max(config.match_cell_deg, 1e-3))
    at = np.column_stack([side.headings[rows], side.elevations[rows]]) // cell
    return np.sort(np.unique(at, axis=0, return_index=True)[1])
