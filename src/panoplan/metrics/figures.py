"""Figures of rooms and of corners over a whole plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from panoplan.metrics import corners, rooms
from panoplan.metrics.compared import Compared
from panoplan.metrics.corners import CornerDistances
from panoplan.metrics.rooms import RoomScore, Score
from panoplan.types.arrays import FloatArray

RECALL_CM = (10.0, 25.0)
"""Distances at which corner recall and precision are told."""


@dataclass(frozen=True)
class RoomPair:
    """A predicted room and the true one it is matched with at IoU 0.5 or more.

    Attributes:
        true: id of the true room.
        predicted: id of the predicted room.
        iou: of the two.
        area_error_percent: (predicted - true) / true.
        area_sigma_percent: standard deviation that the plan states, of the true area; or None.
        outline_cm: mean distance between the outlines, both ways averaged.
    """

    true: str
    predicted: str
    iou: float
    area_error_percent: float
    area_sigma_percent: float | None
    outline_cm: float


@dataclass(frozen=True)
class RoomFigures:
    """How well rooms were found.

    Attributes:
        true: number of true rooms.
        visited: number of true rooms a camera stands in, None where no camera is known.
        predicted: predicted rooms that have a polygon.
        without_polygon: predicted rooms that have none: they count as not predicted.
        matching_none: predictions without a partner at the lowest threshold.
        scores: recall and precision at IoU 0.3, 0.5, 0.7 over all true rooms.
        scores_visited: the same over visited rooms; predictions of unvisited rooms left out.
        pairs: rooms matched at 0.5.
        mean_iou: over `pairs`.
        floor_iou: of all rooms together.
        area_error_median_percent: signed, over `pairs`.
        area_error_mean_abs_percent: over `pairs`.
        outline_cm: mean over `pairs` of the mean distance between outlines, both ways averaged.
        outline_true_to_predicted_cm: the one way.
        outline_predicted_to_true_cm: the other way.
        overlap_m2: area claimed by more than one predicted room of a storey.
    """

    true: int
    visited: int | None
    predicted: int
    without_polygon: int
    matching_none: int
    scores: tuple[RoomScore, ...]
    scores_visited: tuple[RoomScore, ...] | None
    pairs: tuple[RoomPair, ...]
    mean_iou: float | None
    floor_iou: float
    area_error_median_percent: float | None
    area_error_mean_abs_percent: float | None
    outline_cm: float | None
    outline_true_to_predicted_cm: float | None
    outline_predicted_to_true_cm: float | None
    overlap_m2: float


@dataclass(frozen=True)
class CornerFigures:
    """How well corners were found.

    Attributes:
        metres_per_px: of the paper's grid.
        paper: the paper's metric over all rooms.
        paper_visited: the same over visited rooms, predictions of unvisited rooms left out.
        released: the variant of the paper's released code, over all rooms.
        released_visited: the same over visited rooms.
        within: pairs of a distance in cm and the score of the best one-to-one matching within it.
        true_to_predicted: distances of the true corners of matched rooms.
        predicted_to_true: distances of the predicted corners of matched rooms.
    """

    metres_per_px: float
    paper: Score
    paper_visited: Score | None
    released: Score
    released_visited: Score | None
    within: tuple[tuple[float, Score], ...]
    true_to_predicted: CornerDistances
    predicted_to_true: CornerDistances


def room_figures(of: Compared, without_polygon: int) -> RoomFigures:
    """How well rooms were found.

    Args:
        of: rooms.
        without_polygon: number of predicted rooms that are not among them, having none.
    """
    scores = tuple(rooms.room_score(of.overlap, t) for t in rooms.THRESHOLDS)
    visited_scores = None
    if of.visited is not None:
        visited_scores = tuple(
            rooms.room_score(of.overlap, t, of.visited) for t in rooms.THRESHOLDS
        )
    area = 100.0 * rooms.area_errors(of.true_regions, of.predicted_regions, of.matches)
    there, back = _outline_distances(of)
    outline = (there + back) / 2
    return RoomFigures(
        true=len(of.true),
        visited=None if of.visited is None else int(of.visited.sum()),
        predicted=len(of.predicted),
        without_polygon=without_polygon,
        matching_none=len(of.predicted) - scores[0].hits,
        scores=scores,
        scores_visited=visited_scores,
        pairs=tuple(
            RoomPair(
                of.true[m.true].id,
                of.predicted[m.predicted].id,
                m.iou,
                float(a),
                _percent(of.predicted[m.predicted].area_sigma, of.true_regions[m.true].area),
                float(d),
            )
            for m, a, d in zip(of.matches, area, outline, strict=True)
        ),
        mean_iou=_mean(np.array([match.iou for match in of.matches])),
        floor_iou=rooms.floor_iou(
            [
                ([of.true_regions[k] for k in true], [of.predicted_regions[k] for k in ours])
                for true, ours in of.storeys
            ]
        ),
        area_error_median_percent=float(np.median(area)) if len(area) else None,
        area_error_mean_abs_percent=_mean(np.abs(area)),
        outline_cm=_mean(outline),
        outline_true_to_predicted_cm=_mean(there),
        outline_predicted_to_true_cm=_mean(back),
        overlap_m2=_overlap(of),
    )


def _percent(value: float | None, of: float) -> float | None:
    return None if value is None else 100.0 * value / of


def _outline_distances(of: Compared) -> tuple[FloatArray, FloatArray]:
    pairs = [(of.true_regions[m.true], of.predicted_regions[m.predicted]) for m in of.matches]
    there = np.array([rooms.outline_distance(true, ours) for true, ours in pairs], dtype=float)
    back = np.array([rooms.outline_distance(ours, true) for true, ours in pairs], dtype=float)
    return 100.0 * there, 100.0 * back


def _overlap(of: Compared) -> float:
    levels = sorted({room.level for room in of.predicted})
    together = list(zip(of.predicted, of.predicted_regions, strict=True))
    return sum(
        rooms.overlap_area([area for room, area in together if room.level == level])
        for level in levels
    )


def corner_figures(of: Compared, axis: FloatArray | None) -> CornerFigures:
    """How well corners were found.

    Args:
        of: rooms.
        axis: (2,) direction along which the grid of the paper lies, or None.
    """
    true = [room.polygon for room in of.true]
    predicted = [room.polygon for room in of.predicted if room.polygon is not None]
    grid = corners.corner_grid(corners.all_corners(true), axis)
    there, back = corners.both_ways(true, predicted, of.matches)

    def score(how: Callable[[FloatArray, FloatArray], Score], *, visited: bool = False) -> Score:
        """Over all storeys; of visited rooms and the predictions that show no other."""
        entered = np.ones(len(true), dtype=np.bool_)
        left_out: tuple[int, ...] = ()
        if visited and of.visited is not None:
            entered, left_out = of.visited, rooms.of_unvisited(of.overlap, of.visited)
        found = Score(0, 0, 0)
        for ours, theirs in of.storeys:
            counted = [k for k in theirs if k not in left_out]
            found += how(_where(true, ours[entered[ours]]), _where(predicted, counted))
        return found

    def paper(ours: FloatArray, theirs: FloatArray) -> Score:
        return corners.paper_score(ours, theirs, grid)

    def released(ours: FloatArray, theirs: FloatArray) -> Score:
        return corners.released_score(ours, theirs, grid)

    known = of.visited is not None
    return CornerFigures(
        metres_per_px=grid.metres_per_px,
        paper=score(paper),
        paper_visited=score(paper, visited=True) if known else None,
        released=score(released),
        released_visited=score(released, visited=True) if known else None,
        within=tuple(
            (cm, score(partial(corners.score_within, radius_m=cm / 100.0))) for cm in RECALL_CM
        ),
        true_to_predicted=there,
        predicted_to_true=back,
    )


def _where(polygons: Sequence[FloatArray], chosen: Sequence[int] | Any) -> FloatArray:
    return corners.all_corners([polygons[k] for k in chosen])


def _mean(values: FloatArray) -> float | None:
    return float(values.mean()) if len(values) else None
