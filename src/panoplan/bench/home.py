"""Accuracy on a scene with known truth, the trajectory metric or in an unknown unit."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from panoplan.bench.estimate import estimate, images_of, predicted, true_poses
from panoplan.config import Config
from panoplan.datasets.detect import read_truth
from panoplan.estimator.state import Walk
from panoplan.layouts.onnx import OnnxLayouts
from panoplan.metrics.presentation import as_dict
from panoplan.metrics.report import evaluate
from panoplan.pipeline import Progress
from panoplan.types.keyframe import Keyframe
from panoplan.types.pose import Pose

_UNIT_M = 3.7
"""Metres a trajectory unit where the unit is to be unknown: any number will do."""


def measure(
    folder: Path, config: Config, network: OnnxLayouts | None, progress: Progress
) -> dict[str, Any]:
    """Runs the method on a sequence folder with its true poses.

    Args:
        folder: with trajectory_gt.tum, the true plan, and images or predicted layouts.
        config: settings.
        network: is asked for the layouts; None for those in the folder.
        progress: is told how far that has come.

    Returns:
        Figures over the rooms split at openings, unaligned, with the trajectory known to be metric
        and with its scale recovered; seconds for the whole walk with warm compiled loops.

    Raises:
        InputError: the folder is not complete.
    """
    scene = true_poses(folder)
    truth = read_truth(folder)
    told = scene.keyframes
    if network is not None:
        layouts = predicted(images_of(folder), network, progress)
        told = tuple(replace(k, layout=layouts.get(k.id)) for k in told)
    asked = "files" if network is None else network.spec.name
    result: dict[str, Any] = {"scene": folder.name, "layouts": asked}
    for name in ("metric", "recovered"):
        metric = name == "metric"
        keyframes = told if metric else [_in_units(k) for k in told]
        walk = Walk("m" if metric else "unknown", scene.camera_height_m, len(keyframes))
        for _ in range(2):
            started = time.perf_counter()
            plan = estimate(keyframes, config, walk)
            seconds = time.perf_counter() - started
        report = as_dict(evaluate(plan, truth, rooms="rooms_partial", align="none"))
        result[name] = {"seconds": seconds, **report}
    return result


def _in_units(keyframe: Keyframe) -> Keyframe:
    pose = Pose(keyframe.pose.rotation, keyframe.pose.translation / _UNIT_M)
    return replace(keyframe, pose=pose)
