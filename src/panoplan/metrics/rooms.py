"""Room metrics: recall and precision by overlap, and how well the outlines agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from panoplan.types.arrays import BoolArray, FloatArray

THRESHOLDS = (0.3, 0.5, 0.7)
"""IoU from which a room counts as found. Source: Table II of the paper."""

MATCH_IOU = 0.5
"""IoU from which the shapes of two rooms are compared."""

Region = Any
"""A shapely Polygon or MultiPolygon."""


@dataclass(frozen=True)
class Score:
    """Hits among what is true and what was predicted.

    Attributes:
        hits: found.
        true: how many there are to find.
        predicted: how many were predicted.
    """

    hits: int
    true: int
    predicted: int

    @property
    def recall(self) -> float | None:
        """Share of what is true that was found; None where there was nothing to find."""
        return self.hits / self.true if self.true else None

    @property
    def precision(self) -> float:
        """Share of what was predicted that is true; 0 where nothing was predicted."""
        return self.hits / self.predicted if self.predicted else 0.0

    def __add__(self, other: Score) -> Score:
        """The score of both together."""
        return Score(
            self.hits + other.hits, self.true + other.true, self.predicted + other.predicted
        )


@dataclass(frozen=True)
class RoomScore(Score):
    """Rooms found from one IoU on.

    Attributes:
        iou: the threshold.
    """

    iou: float


@dataclass(frozen=True)
class Match:
    """A true room and the predicted one that stands for it, by their place in the lists."""

    true: int
    predicted: int
    iou: float


def region(polygon: FloatArray, holes: Sequence[FloatArray] = ()) -> Region:
    """The area of a room.

    Args:
        polygon: (N, 2) open ring.
        holes: open rings inside it.

    Returns:
        A valid Polygon or MultiPolygon; of a ring that crosses itself, the parts it encloses.
    """
    # Coordinates of nearly nothing make unions wrong by whole per cents.
    rings = [np.round(ring, _DIGITS) + 0.0 for ring in (polygon, *holes)]
    shape = shapely.Polygon(rings[0], [hole for hole in rings[1:] if len(hole) >= 3])
    if shape.is_valid:
        return shape
    made = shapely.make_valid(shape)
    parts = [part for part in shapely.get_parts(made) if part.geom_type.endswith("Polygon")]
    return shapely.union_all(parts) if parts else shapely.Polygon()


_DIGITS = 9


def iou_matrix(true: Sequence[Region], predicted: Sequence[Region]) -> FloatArray:
    """Intersection over union of every true room with every predicted one.

    Returns:
        (T, P) values in [0, 1].
    """
    matrix = np.zeros((len(true), len(predicted)))
    for i, ours in enumerate(true):
        for j, theirs in enumerate(predicted):
            matrix[i, j] = iou(ours, theirs)
    return matrix


def iou(one: Region, other: Region) -> float:
    """Intersection over union of two areas; 0 where both are empty."""
    common = float(one.intersection(other).area)
    union = float(one.area) + float(other.area) - common
    return common / union if union > 0 else 0.0


def matching(overlap: FloatArray, threshold: float) -> tuple[Match, ...]:
    """The one-to-one matching with the most hits, and among those the largest sum of IoU.

    Args:
        overlap: (T, P) IoU.
        threshold: IoU from which a pair is a hit, above 0.

    Returns:
        The hits, by true room.
    """
    # It takes longer to import than most exports, which need only `region`, to write.
    from scipy.optimize import linear_sum_assignment

    if 0 in overlap.shape:
        return ()
    hit = overlap >= threshold
    # One hit more always outweighs any gain of IoU among the others.
    weight = np.where(hit, min(overlap.shape) + overlap, 0.0)
    rows, columns = linear_sum_assignment(weight, maximize=True)
    return tuple(
        Match(int(i), int(j), float(overlap[i, j]))
        for i, j in zip(rows, columns, strict=True)
        if hit[i, j]
    )


def room_score(
    overlap: FloatArray, threshold: float, visited: BoolArray | None = None
) -> RoomScore:
    """Rooms found from an IoU on.

    With `visited`, true rooms that no camera entered are left out, and so are the predictions
    that show one of them (`of_unvisited`): they count neither for nor against.

    Args:
        overlap: (T, P) IoU.
        threshold: IoU from which a pair is a hit.
        visited: (T,) whether a camera stands in the true room, None for all rooms.

    Source: Sec. V of the paper; leaving out unvisited rooms is the released code's reading.
    """
    if visited is not None:
        counted = np.ones(overlap.shape[1], dtype=np.bool_)
        counted[list(of_unvisited(overlap, visited))] = False
        overlap = overlap[np.ix_(visited, counted)]
    true, predicted = overlap.shape
    return RoomScore(len(matching(overlap, threshold)), true, predicted, threshold)


def of_unvisited(overlap: FloatArray, visited: BoolArray) -> tuple[int, ...]:
    """Predictions that show a true room no camera entered.

    They are those that overlap an unvisited room more than any visited one, matched one-to-one
    with unvisited rooms at the lowest threshold; a second one for the same room is not among them.

    Args:
        overlap: (T, P) IoU.
        visited: (T,) whether a camera stands in the true room.

    Returns:
        Their columns in `overlap`, ascending.
    """
    best_visited = overlap[visited].max(axis=0, initial=0.0)
    best_other = overlap[~visited].max(axis=0, initial=0.0)
    candidates = np.flatnonzero(best_other > best_visited)
    found = matching(overlap[np.ix_(~visited, best_other > best_visited)], THRESHOLDS[0])
    return tuple(sorted(int(candidates[match.predicted]) for match in found))


def visited_rooms(rooms: Sequence[Region], cameras: FloatArray) -> BoolArray:
    """Which rooms a camera stands in, its edge included.

    Args:
        rooms: T areas.
        cameras: (K, 2) positions in the same frame.

    Returns:
        (T,) flags.
    """
    points = shapely.points(cameras.reshape(-1, 2))
    return np.array([bool(shapely.covers(room, points).any()) for room in rooms], dtype=np.bool_)


def floor_iou(storeys: Sequence[tuple[Sequence[Region], Sequence[Region]]]) -> float:
    """IoU of all true rooms together with all predicted ones together.

    Args:
        storeys: true and predicted rooms of each; areas add up over them.
    """
    floors = [tuple(shapely.union_all(list(rooms)) for rooms in both) for both in storeys]
    common = sum(float(one.intersection(other).area) for one, other in floors)
    total = sum(float(one.area + other.area) for one, other in floors) - common
    return common / total if total > 0 else 0.0


def overlap_area(rooms: Sequence[Region]) -> float:
    """Area that is claimed more than once: the sum of the areas less that of their union."""
    total = sum(float(room.area) for room in rooms)
    return max(0.0, total - float(shapely.union_all(list(rooms)).area))


def area_errors(
    true: Sequence[Region], predicted: Sequence[Region], matches: Sequence[Match]
) -> FloatArray:
    """Relative area error of matched rooms, positive where the prediction is too large.

    Returns:
        (M,) (predicted - true) / true.
    """
    return np.array(
        [predicted[m.predicted].area / true[m.true].area - 1.0 for m in matches], dtype=float
    )


def outline_distance(from_region: Region, to_region: Region, step: float = 0.02) -> float:
    """Mean distance from one outline (holes included) to the nearest point of another.

    Args:
        from_region: area whose outline is walked along.
        to_region: area whose outline is measured to.
        step: largest spacing of the points that are measured, in the unit of the areas.

    Returns:
        The mean over the length of the outline; it is not symmetric.
    """
    points, weights = _outline_points(from_region, step)
    distance: NDArray[np.float64] = shapely.distance(points, to_region.boundary)
    return float(np.average(distance, weights=weights))


def _outline_points(area: Region, step: float) -> tuple[Any, FloatArray]:
    """Midpoints of equal pieces of every edge, and the length of the piece each stands for."""
    points, weights = [], []
    for line in shapely.get_parts(area.boundary):
        ring = shapely.get_coordinates(line)
        for a, b in pairwise(ring):
            length = float(np.hypot(*(b - a)))
            pieces = max(1, int(np.ceil(length / step)))
            along = (np.arange(pieces) + 0.5) / pieces
            points.append(a + along[:, None] * (b - a))
            weights.append(np.full(pieces, length / pieces))
    return shapely.points(np.concatenate(points)), np.concatenate(weights)
