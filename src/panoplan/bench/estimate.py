"""The plan of a walk, as every benchmark makes it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from panoplan.config import Config
from panoplan.datasets.detect import open_scene
from panoplan.datasets.scene import Scene
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.formats.sequence import TRUE_TRAJECTORY
from panoplan.types.keyframe import Keyframe
from panoplan.types.plan import FloorPlan


def estimate(keyframes: Sequence[Keyframe], config: Config, walk: Walk) -> FloorPlan:
    """The plan at the end of a walk, as it is when all that can still change it is done."""
    estimator = FloorPlanEstimator(config, walk)
    for keyframe in keyframes:
        estimator.update(keyframe)
    estimator.finish()
    return estimator.plan()


def true_poses(folder: Path) -> Scene:
    """A scene with its true poses, which are metric, and its predicted layouts.

    Raises:
        InputError: the folder is not complete.
    """
    return open_scene(folder, trajectory=folder / TRUE_TRAJECTORY)


def metric_plan(scene: Scene, config: Config) -> FloorPlan:
    """The plan of a scene whose poses are known to be in metres."""
    walk = Walk("m", scene.camera_height_m, len(scene.keyframes))
    return estimate(scene.keyframes, config, walk)
