"""Corner metrics: the paper's on a grid, and distances as a surveyor asks for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from panoplan.errors import InputError
from panoplan.metrics.rooms import Match, Score
from panoplan.types.arrays import FloatArray

GRID_PX = 256
"""Side of the grid. Source: Sec. V of the paper."""

HIT_PX = 10.0
"""Distance up to which a corner is found. Source: Sec. V of the paper."""

MARGIN = 0.05
"""Margin a side, relative to the scene's longer side. Source: released code of the paper."""

MERGE_M = 0.5
"""Corners closer than this are one corner. Source: released code; not in the paper's text."""

WITHIN_CM = (5.0, 10.0, 25.0, 50.0)
"""Distances at which the share of corners is told."""


@dataclass(frozen=True, eq=False)
class CornerGrid:
    """The square grid over a scene that the paper counts corners on.

    Attributes:
        first_m: (2,) the grid's corner of least coordinates, after turning.
        metres_per_px: side of a cell.
        turn: (2, 2) matrix applied to points first.
    """

    first_m: FloatArray
    metres_per_px: float
    turn: FloatArray

    def pixels(self, points_m: FloatArray) -> FloatArray:
        """Grid coordinates, not rounded, of (N, 2) points."""
        return np.asarray((points_m @ self.turn.T - self.first_m) / self.metres_per_px)


@dataclass(frozen=True)
class CornerDistances:
    """Distances from corners to the nearest corner of the room they are matched with.

    Attributes:
        count: how many corners.
        median_cm: median distance, None where no room is matched.
        within: pairs of a distance in cm and the share of corners nearer than or at it.
    """

    count: int
    median_cm: float | None
    within: tuple[tuple[float, float], ...]


def corner_grid(true_corners_m: FloatArray, axis: FloatArray | None = None) -> CornerGrid:
    """The grid over a scene: square, as long as the scene's longer side and 5 % more at each end.

    Args:
        true_corners_m: (N, 2) all true corners, N at least 1; they span the scene.
        axis: (2,) direction that is turned onto the first axis, or None.

    Returns:
        The grid, centred on the scene.

    Raises:
        InputError: no corner, corners at one place, or an axis without direction.
    """
    turn = np.eye(2)
    if axis is not None:
        length = float(np.hypot(axis[0], axis[1]))
        if length == 0:
            raise InputError("axis", "a direction of no length", "a direction")
        c, s = np.asarray(axis) / length
        turn = np.array([[c, s], [-s, c]])
    if not len(true_corners_m):
        raise InputError("true corners", "none", "at least one room")
    turned = true_corners_m @ turn.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    side = float((high - low).max()) * (1 + 2 * MARGIN)
    if side <= 0:
        raise InputError("true corners", "all at one place", "a scene with an extent")
    return CornerGrid((low + high) / 2 - side / 2, side / GRID_PX, turn)


def paper_score(true_m: FloatArray, predicted_m: FloatArray, grid: CornerGrid) -> Score:
    """The paper's corner metric.

    A predicted corner is right if a true one is within 10 px (Euclidean, not rounded). Of several
    predictions around one true corner the closest counts, the rest are wrong; pairs are taken in
    the order of their distance, each corner once.

    Args:
        true_m: (T, 2) corners of all true rooms, those that rooms share counted for each.
        predicted_m: (P, 2) corners of all predicted rooms.
        grid: over the scene.

    Source: Sec. V-B "Corner" of the paper.
    """
    true, predicted = grid.pixels(true_m), grid.pixels(predicted_m)
    distance = np.linalg.norm(true[:, None] - predicted[None], axis=2)
    rows, columns = np.nonzero(distance <= HIT_PX)
    free_true, free_predicted = np.ones(len(true), bool), np.ones(len(predicted), bool)
    hits = 0
    for k in np.argsort(distance[rows, columns], kind="stable"):
        i, j = rows[k], columns[k]
        if free_true[i] and free_predicted[j]:
            free_true[i] = free_predicted[j] = False
            hits += 1
    return Score(hits, len(true), len(predicted))


def released_score(true_m: FloatArray, predicted_m: FloatArray, grid: CornerGrid) -> Score:
    """The corner metric as the paper's released code computes it, under its right names.

    It differs from the paper's text: corners closer than 0.5 m are first merged into their mean,
    positions are rounded to whole pixels, distances are Chebyshev, and each true corner looks
    only at its closest prediction, which counts once. (That code prints recall and precision
    swapped; here they are not. Its grid spans the point cloud, here the true corners.)

    Args:
        true_m: (T, 2) corners of all true rooms.
        predicted_m: (P, 2) corners of all predicted rooms.
        grid: over the scene.

    Source: docs/deviations.md, corner metric.
    """
    true = np.rint(grid.pixels(merged(true_m, MERGE_M)))
    predicted = np.rint(grid.pixels(merged(predicted_m, MERGE_M)))
    if not len(predicted) or not len(true):
        return Score(0, len(true), len(predicted))
    distance = np.abs(true[:, None] - predicted[None]).max(axis=2)
    closest = distance.argmin(axis=1)
    found = distance[np.arange(len(true)), closest] <= HIT_PX
    return Score(len(np.unique(closest[found])), len(true), len(predicted))


def merged(corners: FloatArray, distance: float) -> FloatArray:
    """Corners with every chain of neighbours closer than `distance` replaced by its mean.

    Args:
        corners: (N, 2).
        distance: in their unit.

    Returns:
        (M, 2), in the order of each chain's first corner.
    """
    if not len(corners):
        return corners
    near = np.linalg.norm(corners[:, None] - corners[None], axis=2) < distance
    count, label = connected_components(csr_array(near), directed=False)
    return np.array([corners[label == k].mean(axis=0) for k in range(count)])


def score_within(true_m: FloatArray, predicted_m: FloatArray, radius_m: float) -> Score:
    """Corners found within a distance, by the one-to-one matching with the most hits.

    Args:
        true_m: (T, 2) corners of all true rooms.
        predicted_m: (P, 2) corners of all predicted rooms.
        radius_m: largest distance of a hit.
    """
    if not len(true_m) or not len(predicted_m):
        return Score(0, len(true_m), len(predicted_m))
    distance = np.linalg.norm(true_m[:, None] - predicted_m[None], axis=2)
    hit = distance <= radius_m
    rows, columns = linear_sum_assignment(hit, maximize=True)
    return Score(int(hit[rows, columns].sum()), len(true_m), len(predicted_m))


def corner_distances(
    from_rooms: Sequence[FloatArray], to_rooms: Sequence[FloatArray]
) -> CornerDistances:
    """Distances from every corner of each room to the nearest corner of its partner.

    Args:
        from_rooms: (N, 2) polygons in metres.
        to_rooms: as many polygons, the partner of each.
    """
    if not from_rooms:
        return CornerDistances(0, None, ())
    pairs = zip(from_rooms, to_rooms, strict=True)
    distance = 100.0 * np.concatenate([cKDTree(to).query(of)[0] for of, to in pairs])
    within = tuple((limit, float(np.mean(distance <= limit))) for limit in WITHIN_CM)
    return CornerDistances(len(distance), float(np.median(distance)), within)


def both_ways(
    true: Sequence[FloatArray], predicted: Sequence[FloatArray], matches: Sequence[Match]
) -> tuple[CornerDistances, CornerDistances]:
    """Corner distances of matched rooms, true to predicted and predicted to true."""
    ours = [true[match.true] for match in matches]
    theirs = [predicted[match.predicted] for match in matches]
    return corner_distances(ours, theirs), corner_distances(theirs, ours)


def all_corners(rooms: Sequence[FloatArray]) -> FloatArray:
    """(N, 2) corners of all rooms, one after the other; holes are not part of `rooms`."""
    return np.concatenate(rooms) if len(rooms) else np.empty((0, 2))
