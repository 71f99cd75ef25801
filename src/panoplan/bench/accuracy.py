"""Accuracy on simulated flats, unaligned, scene by scene."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Literal

import numpy as np

from panoplan.bench.estimate import estimate
from panoplan.bench.parallel import mapped, processes
from panoplan.config import Config
from panoplan.estimator.state import Walk
from panoplan.metrics.report import Report, evaluate
from panoplan.simulate.scene import Grade, simulate_flat

GRADES: tuple[Grade, ...] = ("mild", "hard")


def measure(
    seeds: range,
    config: Config,
    progress: Callable[[int, int], None],
    *,
    metric: bool = False,
    jobs: int = 1,
) -> dict[str, Any]:
    """Runs the method on flats of both grades.

    Args:
        seeds: one flat each.
        config: settings.
        progress: called with (flats done, flats in all).
        metric: whether the trajectory is known to be in metres; else its scale is recovered.
        jobs: processes; the figures do not depend on it.

    Returns:
        Whether the trajectory was metric, and for each grade the mean figures over the flats and
        those of each flat.
    """
    work = [(grade, seed) for grade in GRADES for seed in seeds]
    rows = mapped(partial(_scene, config=config, metric=metric), work, processes(jobs), progress)
    result: dict[str, Any] = {"metric": metric}
    for grade in GRADES:
        scenes = [row for (of, _), row in zip(work, rows, strict=True) if of == grade]
        result[grade] = {"summary": _summary(scenes), "scenes": scenes}
    return result


def _scene(work: tuple[Grade, int], config: Config, metric: bool) -> dict[str, Any]:
    grade, seed = work
    scene = simulate_flat(seed, grade, metres_per_su=1.0 if metric else None)
    unit: Literal["unknown", "m"] = "m" if metric else "unknown"
    walk = Walk(unit, scene.camera_height_m, len(scene.keyframes))
    plan = estimate(scene.keyframes, config, walk)
    assert scene.truth.trajectory is not None
    report = evaluate(plan, scene.truth, align="none", true_ch_per_su=scene.ch_per_su)
    odometry = scene.metres_per_su * scene.odometry.translations[:, [0, 2]]
    true = scene.truth.trajectory.translations[:, [0, 2]]
    drift_cm = 100 * float(np.sqrt(np.mean(np.sum((odometry - true) ** 2, axis=1))))
    row = _row(report, len(scene.keyframes), plan.scale.keyframes_used)
    return {"seed": seed, **row, "odometry_ate_cm": drift_cm}


def _row(report: Report, keyframes: int, warmup: int) -> dict[str, Any]:
    rooms, corners, walls = report.rooms, report.corners, report.walls
    _, half, seven = rooms.scores
    return {
        "keyframes": keyframes,
        "warmup": warmup,
        "rooms": rooms.true,
        "predicted": rooms.predicted,
        "hits_50": half.hits,
        "hits_70": seven.hits,
        "mean_iou": rooms.mean_iou,
        "floor_iou": rooms.floor_iou,
        "overlap_m2": rooms.overlap_m2,
        "corner_true_to_predicted_cm": corners.true_to_predicted.median_cm,
        "corner_predicted_to_true_cm": corners.predicted_to_true.median_cm,
        "wall_cm": walls.median_cm,
        "walls_stated": walls.stated,
        "walls_within_1_sigma": walls.within_1_sigma,
        "walls_within_2_sigma": walls.within_2_sigma,
        "areas": [
            [pair.area_error_percent, pair.area_sigma_percent]
            for pair in rooms.pairs
            if pair.area_sigma_percent is not None
        ],
        "doors": [report.doors.hits, report.doors.true, report.doors.predicted],
        "openings": [report.openings.hits, report.openings.true, report.openings.predicted],
        "ate_cm": None if report.trajectory is None else report.trajectory.rmse_cm,
        "scale_error_percent": report.scale_error_percent,
    }


def _summary(scenes: list[dict[str, Any]]) -> dict[str, Any]:
    def column(name: str) -> list[float]:
        return [scene[name] for scene in scenes if scene[name] is not None]

    def mean(name: str) -> float | None:
        values = column(name)
        return float(np.mean(values)) if values else None

    def share(name: str) -> float | None:
        told = [(s[name], s["walls_stated"]) for s in scenes if s[name] is not None]
        counted = sum(count for _, count in told)
        return sum(value * count for value, count in told) / counted if counted else None

    def areas(reach: int) -> float | None:
        told = [abs(error) <= reach * sigma for s in scenes for error, sigma in s["areas"]]
        return float(np.mean(told)) if told else None

    def found(name: str) -> dict[str, float | None]:
        hits, true, predicted = (sum(scene[name][k] for scene in scenes) for k in range(3))
        return {
            "recall": hits / true if true else None,
            "precision": hits / predicted if predicted else None,
        }

    true, hits = sum(column("rooms")), sum(column("hits_50"))
    return {
        "flats": len(scenes),
        "rooms": true,
        "lost": true - hits,
        "invented": sum(column("predicted")) - hits,
        "mean_iou": mean("mean_iou"),
        "floor_iou": mean("floor_iou"),
        "overlap_m2": mean("overlap_m2"),
        "corner_true_to_predicted_cm": mean("corner_true_to_predicted_cm"),
        "corner_predicted_to_true_cm": mean("corner_predicted_to_true_cm"),
        "wall_cm": mean("wall_cm"),
        "walls_within_1_sigma": share("walls_within_1_sigma"),
        "walls_within_2_sigma": share("walls_within_2_sigma"),
        "areas_within_1_sigma": areas(1),
        "areas_within_2_sigma": areas(2),
        "doors": found("doors"),
        "openings": found("openings"),
        "odometry_ate_cm": mean("odometry_ate_cm"),
        "ate_cm": mean("ate_cm"),
        "scale_error_percent_median": float(np.median(np.abs(column("scale_error_percent")))),
    }
