"""All figures of one plan against the truth, as a value, as plain data and as a table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from panoplan.errors import InputError
from panoplan.metrics import alignment, corners, rooms
from panoplan.metrics.alignment import (
    Alignment,
    Freedom,
    common_cameras,
    fit,
    metres_per_unit,
    transformed,
)
from panoplan.metrics.apertures import aperture_score
from panoplan.metrics.corners import CornerDistances
from panoplan.metrics.levels import UNKNOWN, aperture_level, camera_levels, true_levels
from panoplan.metrics.rooms import Match, Region, RoomScore, Score
from panoplan.metrics.trajectory import TrajectoryError, trajectory_error
from panoplan.metrics.walls import WallFigures, wall_figures
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.plan import Aperture, FloorPlan, Room
from panoplan.types.truth import GroundTruth, TrueLevels, TruePlan, TrueRoom

RECALL_CM = (10.0, 25.0)
"""Distances at which corner recall and precision are told."""

RoomsKind = Literal["rooms", "rooms_partial"]
_Apertures = Literal["doors", "openings", "windows"]


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


@dataclass(frozen=True, eq=False)
class Report:
    """All figures of one plan.

    Attributes:
        truth: which true rooms were compared with.
        alignment: how the plan was brought onto them.
        rooms: room figures.
        corners: corner figures.
        walls: where walls lie, and whether their stated uncertainty holds.
        doors: which were found.
        openings: which were found.
        windows: which were found.
        storeys: which were found, None where the truth does not tell of several.
        trajectory: camera positions after the alignment, None without common cameras.
        scale_error_percent: estimated scale relative to the true one, less 1; None where it
            cannot be known.
    """

    truth: RoomsKind
    alignment: Alignment
    rooms: RoomFigures
    corners: CornerFigures
    walls: WallFigures
    doors: Score
    openings: Score
    windows: Score
    storeys: Score | None
    trajectory: TrajectoryError | None
    scale_error_percent: float | None


def evaluate(
    plan: FloorPlan,
    truth: GroundTruth,
    *,
    rooms: RoomsKind = "rooms",
    visited: FloatArray | None = None,
    align: Freedom = "scale",
    true_ch_per_su: float | None = None,
) -> Report:
    """Compares a plan with the truth.

    What is on different storeys is never the same: rooms, corners and apertures are matched within
    a storey only, where the truth tells of several.

    A plan without any room is a result: recall and precision are 0, and figures over matched
    rooms are None.

    Args:
        plan: in metres or camera heights.
        truth: what is true; cameras correspond by keyframe id.
        rooms: complete true rooms, or those split at openings.
        visited: (K, 3) true camera positions in metres that say which rooms were visited; None
            for all of the true trajectory.
        align: what may be fitted to bring the plan onto the truth; "scale" is the paper's
            protocol.
        true_ch_per_su: true scale of the trajectory, where known; else the error of the scale is
            taken from a similarity of the camera positions.

    Returns:
        The report.

    Raises:
        InputError: the truth has no such rooms, or the alignment is not possible.

    Source: Sec. V of the paper; what goes beyond it is told in each figure's own doc.
    """
    if rooms not in ("rooms", "rooms_partial"):
        raise InputError("rooms", repr(rooms), "'rooms' or 'rooms_partial'")
    true_rooms: tuple[TrueRoom, ...] = getattr(truth.plan, rooms)
    if not true_rooms:
        raise InputError(f"true {rooms}", "none", "at least one room")
    found = alignment.align(plan, truth, align)
    moved = transformed(plan, found.true_from_plan)
    predicted = tuple(room for room in moved.rooms if room.polygon is not None)
    storey = true_levels(plan, truth)
    compared = _Compared.of(true_rooms, predicted, storey, _visiting(truth, visited), truth)
    ate = None
    if truth.trajectory is not None:
        ate = trajectory_error(*common_cameras(moved, truth.trajectory))
    return Report(
        truth=rooms,
        alignment=found,
        rooms=_room_figures(compared, len(plan.rooms) - len(predicted)),
        corners=_corner_figures(compared, truth.plan.axis),
        walls=wall_figures(
            [
                (compared.true[m.true].polygon, predicted[m.predicted].walls)
                for m in compared.matches
            ]
        ),
        doors=_aperture_score(truth.plan, "doors", moved, storey),
        openings=_aperture_score(truth.plan, "openings", moved, storey),
        windows=_aperture_score(truth.plan, "windows", moved, storey),
        storeys=_storey_score(truth.plan.levels, storey),
        trajectory=ate,
        scale_error_percent=scale_error_percent(plan, truth, true_ch_per_su),
    )


def scale_error_percent(
    plan: FloorPlan, truth: GroundTruth, true_ch_per_su: float | None = None
) -> float | None:
    """Error of the estimated scale: estimated / true - 1, in percent.

    Args:
        plan: the plan.
        truth: the truth.
        true_ch_per_su: the true scale; if None, the metres a plan unit has by its own account are
            compared with those that fit the true camera positions best.

    Returns:
        The error, or None where it cannot be known.
    """
    if true_ch_per_su is not None:
        estimated = plan.scale.ch_per_su
        return None if estimated is None else 100.0 * (estimated / true_ch_per_su - 1.0)
    claimed = metres_per_unit(plan, truth.plan.camera_height_m)
    if claimed is None or truth.trajectory is None:
        return None
    try:
        fitted = fit(*common_cameras(plan, truth.trajectory), "similarity")
    except InputError:
        return None
    return 100.0 * (claimed / fitted.scale - 1.0)


def _visiting(truth: GroundTruth, visited: FloatArray | None) -> FloatArray | None:
    if visited is not None or truth.trajectory is None:
        return visited
    return truth.trajectory.translations


def _storey_score(levels: TrueLevels | None, storey: Mapping[int, int]) -> Score | None:
    if levels is None:
        return None
    hits = sum(level != UNKNOWN for level in storey.values())
    return Score(hits, len(levels.floors_m), len(storey))


def _aperture_score(
    truth: TruePlan, kind: _Apertures, moved: FloorPlan, storey: Mapping[int, int]
) -> Score:
    """The doors, openings or windows of all storeys."""
    true: tuple[FloatArray, ...] = getattr(truth, kind)
    items: tuple[Aperture, ...] = getattr(moved, kind)
    if truth.levels is None:
        return aperture_score(true, [item.segment for item in items])
    of_room = {room.id: room.level for room in moved.rooms}
    of_wall = {wall.id: room.level for room in moved.rooms for wall in room.walls}
    ours = [storey.get(aperture_level(item, of_room, of_wall), UNKNOWN) for item in items]
    theirs: tuple[int, ...] = getattr(truth.levels, kind)
    found = Score(0, 0, ours.count(UNKNOWN))
    for level in range(len(truth.levels.floors_m)):
        found += aperture_score(
            [segment for segment, on in zip(true, theirs, strict=True) if on == level],
            [item.segment for item, on in zip(items, ours, strict=True) if on == level],
        )
    return found


@dataclass(frozen=True, eq=False)
class _Compared:
    """True and predicted rooms in one frame, in metres."""

    true: tuple[TrueRoom, ...]
    predicted: tuple[Room, ...]
    true_regions: tuple[Region, ...]
    predicted_regions: tuple[Region, ...]
    true_level: IntArray
    predicted_level: IntArray
    overlap: FloatArray
    visited: BoolArray | None
    matches: tuple[Match, ...]

    @staticmethod
    def of(
        true: tuple[TrueRoom, ...],
        predicted: tuple[Room, ...],
        storey: Mapping[int, int],
        cameras: FloatArray | None,
        truth: GroundTruth,
    ) -> _Compared:
        true_regions = tuple(rooms.region(room.polygon, room.holes) for room in true)
        predicted_regions = tuple(
            rooms.region(room.polygon, room.holes) for room in predicted if room.polygon is not None
        )
        levels = truth.plan.levels
        true_level = np.array([0 if levels is None else room.level for room in true])
        predicted_level = np.array([storey[room.level] for room in predicted], dtype=np.int64)
        overlap = rooms.iou_matrix(true_regions, predicted_regions)
        overlap[true_level[:, None] != predicted_level] = 0.0
        visited = None
        if cameras is not None:
            on = np.zeros(len(cameras)) if levels is None else camera_levels(cameras, levels)
            visited = np.zeros(len(true), dtype=np.bool_)
            for level in np.unique(true_level):
                there = np.flatnonzero(true_level == level)
                regions = [true_regions[k] for k in there]
                visited[there] = rooms.visited_rooms(regions, cameras[on == level][:, [0, 2]])
        return _Compared(
            true,
            predicted,
            true_regions,
            predicted_regions,
            true_level,
            predicted_level,
            overlap,
            visited,
            rooms.matching(overlap, rooms.MATCH_IOU),
        )

    @property
    def storeys(self) -> list[tuple[IntArray, IntArray]]:
        """True and predicted rooms of each storey; those of no true one come last."""
        levels = [*np.unique(self.true_level), UNKNOWN]
        return [
            (np.flatnonzero(self.true_level == k), np.flatnonzero(self.predicted_level == k))
            for k in levels
        ]


def _room_figures(of: _Compared, without_polygon: int) -> RoomFigures:
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


def _outline_distances(of: _Compared) -> tuple[FloatArray, FloatArray]:
    pairs = [(of.true_regions[m.true], of.predicted_regions[m.predicted]) for m in of.matches]
    there = np.array([rooms.outline_distance(true, ours) for true, ours in pairs], dtype=float)
    back = np.array([rooms.outline_distance(ours, true) for true, ours in pairs], dtype=float)
    return 100.0 * there, 100.0 * back


def _overlap(of: _Compared) -> float:
    levels = sorted({room.level for room in of.predicted})
    together = list(zip(of.predicted, of.predicted_regions, strict=True))
    return sum(
        rooms.overlap_area([area for room, area in together if room.level == level])
        for level in levels
    )


def _corner_figures(of: _Compared, axis: FloatArray | None) -> CornerFigures:
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


def as_dict(report: Report) -> dict[str, Any]:
    """The report as plain data for JSON: dicts, lists, numbers, strings and None."""
    room, corner, moved = report.rooms, report.corners, report.alignment.true_from_plan
    return {
        "truth": report.truth,
        "alignment": {
            "freedom": report.alignment.freedom,
            "metres_per_plan_unit": moved.scale,
            "rotation_deg": float(np.rad2deg(moved.rotation_rad)),
            "translation_m": [float(value) for value in moved.translation_m],
            "cameras": report.alignment.cameras,
            "residual_rmse_m": report.alignment.residual_rmse_m,
        },
        "rooms": {
            **_plain(room),
            "scores": [_score(score) for score in room.scores],
            "scores_visited": (
                None
                if room.scores_visited is None
                else [_score(score) for score in room.scores_visited]
            ),
            "pairs": [_plain(pair) for pair in room.pairs],
        },
        "corners": {
            "metres_per_px": corner.metres_per_px,
            "paper": _score(corner.paper),
            "paper_visited": _score(corner.paper_visited),
            "released": _score(corner.released),
            "released_visited": _score(corner.released_visited),
            "within": [{"cm": cm, **(_score(score) or {})} for cm, score in corner.within],
            "true_to_predicted": _distances(corner.true_to_predicted),
            "predicted_to_true": _distances(corner.predicted_to_true),
        },
        "walls": _plain(report.walls),
        "doors": _score(report.doors),
        "openings": _score(report.openings),
        "windows": _score(report.windows),
        "storeys": _score(report.storeys),
        "trajectory": None if report.trajectory is None else _plain(report.trajectory),
        "scale_error_percent": report.scale_error_percent,
    }


def _plain(value: object) -> dict[str, Any]:
    return dict(vars(value))


def _score(score: Score | None) -> dict[str, Any] | None:
    if score is None:
        return None
    return {**_plain(score), "recall": score.recall, "precision": score.precision}


def _distances(distances: CornerDistances) -> dict[str, Any]:
    within = [{"cm": limit, "share": share} for limit, share in distances.within]
    return {"count": distances.count, "median_cm": distances.median_cm, "within": within}


def as_table(report: Report) -> str:
    """The report as a text table, one figure a line, without a line break at its end."""
    rows = [*_head_rows(report), *_score_rows(report), *_shape_rows(report)]
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def _head_rows(report: Report) -> list[tuple[str, str]]:
    room, moved = report.rooms, report.alignment.true_from_plan
    visited = "" if room.visited is None else f" ({room.visited} visited)"
    none = f", {room.without_polygon} without shape" if room.without_polygon else ""
    turned = f", turned {np.rad2deg(moved.rotation_rad):+.2f}°"
    shift = f", shifted {np.hypot(*moved.translation_m):.3f} m"
    free = report.alignment.freedom
    motion = turned + shift if free in ("rigid", "similarity") else ""
    rows = [
        ("true rooms", f"{room.true}{visited}, {report.truth}"),
        ("predicted rooms", f"{room.predicted}{none}, {room.matching_none} matching none"),
        ("alignment", f"{free}: {moved.scale:.4f} m a plan unit{motion}"),
    ]
    if report.storeys is not None:
        rows.insert(2, ("storeys", _recall_precision(report.storeys)))
    if report.trajectory is not None:
        ate = report.trajectory
        share = _number(ate.rmse_percent_of_length, ".2f", " % of the path")
        found = f"RMSE {ate.rmse_cm:.1f} cm ({share}), median {ate.median_cm:.1f} cm"
        rows.append(("camera positions", f"{found}, {ate.cameras} cameras"))
    if report.scale_error_percent is not None:
        rows.append(("scale error", f"{report.scale_error_percent:+.2f} %"))
    return rows


def _score_rows(report: Report) -> list[tuple[str, str]]:
    room, corner = report.rooms, report.corners
    rows = [(f"rooms, IoU {score.iou}", _recall_precision(score)) for score in room.scores]
    for score in room.scores_visited or ():
        rows.append((f"visited rooms, IoU {score.iou}", _recall_precision(score)))
    rows.append(("corners, paper", _recall_precision(corner.paper)))
    if corner.paper_visited is not None:
        rows.append(("corners, paper, visited", _recall_precision(corner.paper_visited)))
    rows.append(("corners, released", _recall_precision(corner.released)))
    if corner.released_visited is not None:
        rows.append(("corners, released, visited", _recall_precision(corner.released_visited)))
    rows += [(f"corners within {cm:.0f} cm", _recall_precision(s)) for cm, s in corner.within]
    return rows


def _shape_rows(report: Report) -> list[tuple[str, str]]:
    room, corner = report.rooms, report.corners
    there, back = corner.true_to_predicted.median_cm, corner.predicted_to_true.median_cm
    one, other = room.outline_true_to_predicted_cm, room.outline_predicted_to_true_cm
    median, mean = room.area_error_median_percent, room.area_error_mean_abs_percent
    outline = f"{_cm(room.outline_cm)} (from true {_cm(one)}, from predicted {_cm(other)})"
    return [
        ("floor IoU", f"{room.floor_iou:.3f}"),
        ("mean IoU of matched rooms", _number(room.mean_iou, ".3f")),
        ("corner distance, median", f"from true {_cm(there)}, from predicted {_cm(back)}"),
        ("outline distance, mean", outline),
        (
            "area error",
            f"median {_number(median, '+.1f', ' %')}, mean absolute {_number(mean, '.1f', ' %')}",
        ),
        ("overlap of predicted rooms", f"{room.overlap_m2:.3f} m²"),
        ("wall distance, median", _walls(report.walls)),
        ("doors", _recall_precision(report.doors)),
        ("openings", _recall_precision(report.openings)),
        ("windows", _recall_precision(report.windows)),
    ]


def _walls(walls: WallFigures) -> str:
    told = f"{_cm(walls.median_cm)} ({walls.compared} of {walls.predicted})"
    if walls.within_1_sigma is None:
        return told
    shares = f"{walls.within_1_sigma:.2f} within 1, {_number(walls.within_2_sigma, '.2f')} within 2"
    return f"{told}; {shares} of the stated ±"


def _recall_precision(score: Score) -> str:
    recall = _number(score.recall, ".3f")
    return (
        f"recall {recall}  precision {score.precision:.3f}"
        f"  ({score.hits} of {score.true} true, {score.predicted} predicted)"
    )


def _cm(value: float | None) -> str:
    return _number(value, ".1f", " cm")


def _number(value: float | None, form: str, unit: str = "") -> str:
    return "–" if value is None else f"{value:{form}}{unit}"
