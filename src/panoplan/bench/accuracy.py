"""Accuracy on simulated flats, unaligned, scene by scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from panoplan.config import Config
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.metrics.report import Report, evaluate
from panoplan.simulate.scene import Grade, SimulatedScene, simulate_flat

GRADES: tuple[Grade, ...] = ("mild", "hard")


def measure(
    seeds: range, config: Config, progress: Callable[[int, int], None]
) -> dict[str, dict[str, Any]]:
    """Runs the method on flats of both grades.

    Args:
        seeds: one flat each.
        config: settings.
        progress: called with (flats done, flats in all).

    Returns:
        For each grade the mean figures over the flats, and those of each flat.
    """
    result: dict[str, dict[str, Any]] = {}
    for number, grade in enumerate(GRADES):
        scenes = []
        for done, seed in enumerate(seeds):
            scenes.append({"seed": seed, **_figures(simulate_flat(seed, grade), config)})
            progress(number * len(seeds) + done + 1, len(GRADES) * len(seeds))
        result[grade] = {"summary": _summary(scenes), "scenes": scenes}
    return result


def _figures(scene: SimulatedScene, config: Config) -> dict[str, Any]:
    walk = Walk(camera_height_m=scene.camera_height_m, expected_keyframes=len(scene.keyframes))
    estimator = FloorPlanEstimator(config, walk)
    for keyframe in scene.keyframes:
        estimator.update(keyframe)
    estimator.finish()
    plan = estimator.plan()
    assert scene.truth.trajectory is not None
    # The method's unit of length is the height of the first camera, bob included.
    first_m = scene.camera_height_m - float(scene.truth.trajectory.translations[0, 1])
    report = evaluate(plan, scene.truth, align="none", true_ch_per_su=scene.metres_per_su / first_m)
    return _row(report, len(scene.keyframes), plan.scale.keyframes_used)


def _row(report: Report, keyframes: int, warmup: int) -> dict[str, Any]:
    rooms, corners = report.rooms, report.corners
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
        "corner_true_to_predicted_cm": corners.true_to_predicted.median_cm,
        "corner_predicted_to_true_cm": corners.predicted_to_true.median_cm,
        "scale_error_percent": report.scale_error_percent,
    }


def _summary(scenes: list[dict[str, Any]]) -> dict[str, Any]:
    def column(name: str) -> list[float]:
        return [scene[name] for scene in scenes if scene[name] is not None]

    true, hits = sum(column("rooms")), sum(column("hits_50"))
    return {
        "flats": len(scenes),
        "rooms": true,
        "lost": true - hits,
        "invented": sum(column("predicted")) - hits,
        "mean_iou": float(np.mean(column("mean_iou"))),
        "floor_iou": float(np.mean(column("floor_iou"))),
        "corner_true_to_predicted_cm": float(np.mean(column("corner_true_to_predicted_cm"))),
        "corner_predicted_to_true_cm": float(np.mean(column("corner_predicted_to_true_cm"))),
        "scale_error_percent_median": float(np.median(np.abs(column("scale_error_percent")))),
    }
