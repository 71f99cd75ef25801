"""Scores of kept predictions, scene by scene, and their means."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from panoplan.bench.v1.predict import Prediction
from panoplan.bench.v1.store import KeptScene
from panoplan.errors import InputError
from panoplan.geometry.polygons import signed_area
from panoplan.metrics.alignment import Freedom
from panoplan.metrics.apertures import merged_faces
from panoplan.metrics.report import Report, evaluate
from panoplan.metrics.rooms import Score, region, visited_rooms
from panoplan.types.plan import FloorPlan

ALIGNMENTS: dict[str, Freedom] = {"aligned": "scale", "unaligned": "none"}
"""The scale fitted to the true poses, as in the paper; and nothing fitted."""

FIGURES = ("rooms_30", "rooms_50", "rooms_70", "corners", "doors")
"""What is told as recall and precision."""

Counts = dict[str, Any]


def score(scene: KeptScene, made: Prediction) -> dict[str, Any]:
    """Scores one prediction.

    Args:
        scene: the truth.
        made: the prediction; one that failed, or that cannot be aligned, has found nothing.

    Returns:
        What the scene is, what the prediction cost, the error of its scale, and for each alignment
        hits, true and predicted of each of `FIGURES` over the rooms that a camera entered; None
        for the unaligned figures where nobody knows metres.

    Source: Sec. V of the paper; docs/benchmarks.md.
    """
    rooms = scene.truth.plan.rooms
    row: dict[str, Any] = {
        "keyframes": scene.keyframes,
        "rooms": len(rooms),
        "area_m2": sum(abs(signed_area(room.polygon)) for room in rooms),
        "cpu_seconds": made.cpu_seconds,
        "failure": made.failure,
        "scale_error_percent": None,
    }
    for name, freedom in ALIGNMENTS.items():
        if freedom == "none" and scene.camera_height_m is None:
            row[name] = None
            continue
        row[name] = _nothing_found(scene)
        if made.plan is None:
            continue
        try:
            report = _report(made.plan, scene, freedom)
        except InputError as error:
            row["failure"] = str(error)
            continue
        row[name] = _counts(report)
        row["scale_error_percent"] = report.scale_error_percent
    return row


def _report(plan: FloorPlan, scene: KeptScene, freedom: Freedom) -> Report:
    return evaluate(plan, scene.truth, align=freedom, true_ch_per_su=scene.true_ch_per_su)


def _counts(report: Report) -> Counts:
    rooms, corners = report.rooms, report.corners
    scores: tuple[Score, ...] = (
        *(rooms.scores_visited or rooms.scores),
        corners.paper_visited or corners.paper,
        report.doors,
    )
    return {
        **{name: _triple(found) for name, found in zip(FIGURES, scores, strict=True)},
        "mean_iou": rooms.mean_iou,
        "floor_iou": rooms.floor_iou,
        "overlap_m2": rooms.overlap_m2,
        "corner_cm": corners.true_to_predicted.median_cm,
        "ate_cm": None if report.trajectory is None else report.trajectory.rmse_cm,
    }


def _triple(found: Score) -> list[int]:
    return [found.hits, found.true, found.predicted]


def _nothing_found(scene: KeptScene) -> Counts:
    plan, trajectory = scene.truth.plan, scene.truth.trajectory
    entered = np.ones(len(plan.rooms), dtype=np.bool_)
    if trajectory is not None:
        regions = [region(room.polygon, room.holes) for room in plan.rooms]
        entered = visited_rooms(regions, trajectory.translations[:, [0, 2]])
    true = {name: int(entered.sum()) for name in FIGURES[:3]}
    true["corners"] = sum(
        len(room.polygon) for room, seen in zip(plan.rooms, entered, strict=True) if seen
    )
    true["doors"] = len(merged_faces(plan.doors))
    return {
        **{name: [0, count, 0] for name, count in true.items()},
        **dict.fromkeys(("mean_iou", "overlap_m2", "corner_cm", "ate_cm")),
        "floor_iou": 0.0,
    }


def recall(counts: Sequence[int]) -> float | None:
    """Share of what is true that was found; None where there was nothing to find."""
    hits, true, _ = counts
    return hits / true if true else None


def precision(counts: Sequence[int]) -> float | None:
    """Share of what was predicted that is true; None where nothing was to be found or was told."""
    hits, true, predicted = counts
    if not predicted:
        return 0.0 if true else None
    return hits / predicted


MEASURES = {"recall": recall, "precision": precision}


def column(scenes: Sequence[dict[str, Any]], alignment: str, figure: str) -> list[float | None]:
    """One figure of every scene.

    Args:
        scenes: rows of `score`.
        alignment: of `ALIGNMENTS`.
        figure: of a row's alignment; one of `FIGURES` is followed by " recall" or " precision".
    """
    name, _, measure = figure.partition(" ")
    values = [None if row[alignment] is None else row[alignment][name] for row in scenes]
    if not measure:
        return values
    return [None if counts is None else MEASURES[measure](counts) for counts in values]


def mean(values: Sequence[float | None]) -> float | None:
    """The mean over the scenes that have the figure, None where none has."""
    told = [value for value in values if value is not None]
    return float(np.mean(told)) if told else None


def summary(scenes: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Means over scenes.

    Args:
        scenes: rows of `score`.

    Returns:
        For each alignment the mean over scenes of each figure, recall and precision apart, and
        over all: scenes, failures, CPU seconds, and the median of the scale's absolute error.
    """
    errors = [abs(e) for row in scenes if (e := row["scale_error_percent"]) is not None]
    figures = [f"{name} {measure}" for name in FIGURES for measure in MEASURES]
    figures += ["mean_iou", "floor_iou", "overlap_m2", "corner_cm", "ate_cm"]
    return {
        "scenes": len(scenes),
        "failures": sum(row["failure"] is not None for row in scenes),
        "cpu_seconds": sum(row["cpu_seconds"] for row in scenes),
        "scale_error_percent_median": float(np.median(errors)) if errors else None,
        **{
            alignment: {name: mean(column(scenes, alignment, name)) for name in figures}
            for alignment in ALIGNMENTS
        },
    }
