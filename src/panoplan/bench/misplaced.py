"""Whether a room of a tour whose cameras were shifted is found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from panoplan.bench.estimate import true_poses
from panoplan.config import Config
from panoplan.datasets.detect import read_truth
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.pipeline import Progress
from panoplan.simulate.scene import simulate_flat
from panoplan.types.events import CamerasMisplaced
from panoplan.types.keyframe import Keyframe
from panoplan.types.pose import Pose

SHIFT_M = 2.6
"""As far as a real photo-tour aligner misplaced a bedroom."""
_BACK_M = 0.3
"""Cameras moved back to within this are where they belong."""


def measure_home(folder: Path, config: Config, trials: int, report: Progress) -> dict[str, Any]:
    """Shifts one room's cameras of a scene with true poses, trial by trial.

    Args:
        folder: with trajectory_gt.tum, predicted layouts, and the true plan with partial rooms.
        config: settings.
        trials: how many; room and direction of each are drawn.
        report: progress.

    Returns:
        Each trial, and of the scene as it is; how many trials found all shifted cameras, how many
        named more than one innocent, and how many moved the shifted ones back.

    Raises:
        InputError: the folder is not complete.
    """
    scene = true_poses(folder)
    truth = read_truth(folder)
    places = shapely.points(
        [k.pose.translation[[0, 2]] for k in scene.keyframes if k.pose is not None]
    )
    rooms = [
        tuple(np.flatnonzero(shapely.contains(shapely.Polygon(room.polygon), places)).tolist())
        for room in truth.plan.rooms_partial or truth.plan.rooms
    ]
    held = [room for room in rooms if room]
    rng = np.random.default_rng(0)
    outcome = [_trial(scene.keyframes, scene.camera_height_m, (), np.zeros(2), config)]
    for number in range(trials):
        room = held[int(rng.integers(len(held)))]
        outcome.append(_trial(scene.keyframes, scene.camera_height_m, room, _shift(rng), config))
        report(number + 1, trials)
    return _figures("real home", outcome)


def measure_flats(seeds: Sequence[int], config: Config, report: Progress) -> dict[str, Any]:
    """Shifts one room's cameras of simulated photo tours, one trial a flat.

    Args:
        seeds: of the flats.
        config: settings.
        report: progress.

    Returns:
        As `measure_home`.
    """
    outcome = []
    for number, seed in enumerate(seeds):
        scene = simulate_flat(seed, "mild", stills=True, metres_per_su=1.0)
        rng = np.random.default_rng(seed)
        rooms = np.array(scene.keyframe_rooms)
        shifted = tuple(np.flatnonzero(rooms == rng.choice(rooms)).tolist())
        for chosen in ((), shifted):
            outcome.append(
                _trial(scene.keyframes, scene.camera_height_m, chosen, _shift(rng), config)
            )
        report(number + 1, len(seeds))
    return _figures("simulated flats", outcome)


def _shift(rng: np.random.Generator) -> np.ndarray:
    angle = rng.uniform(0, 2 * np.pi)
    return SHIFT_M * np.array([np.cos(angle), np.sin(angle)])


def _trial(
    keyframes: Sequence[Keyframe],
    height_m: float | None,
    shifted: tuple[int, ...],
    shift: np.ndarray,
    config: Config,
) -> dict[str, Any]:
    moved = [
        replace(keyframe, pose=_shifted(keyframe.pose, shift)) if k in shifted else keyframe
        for k, keyframe in enumerate(keyframes)
    ]
    estimator = FloorPlanEstimator(config, Walk("m", height_m, len(moved)))
    for keyframe in moved:
        estimator.update(keyframe)
    events = [e for e in estimator.finish() if isinstance(e, CamerasMisplaced)]
    named = {name for event in events for name in event.keyframes}
    guilty = {keyframes[k].id for k in shifted}
    placed = {pose.id: pose.position for pose in estimator.plan().trajectory}
    back = all(
        np.hypot(*(placed[keyframes[k].id] - keyframes[k].pose.translation[[0, 2]])) < _BACK_M
        for k in shifted
    )
    return {
        "shifted": sorted(guilty),
        "shift_m": shift.tolist() if shifted else None,
        "named": sorted(named),
        "found": guilty <= named,
        "innocent": len(named - guilty),
        "moved_back": back,
    }


def _shifted(pose: Pose, shift: np.ndarray) -> Pose:
    return Pose(pose.rotation, pose.translation + [shift[0], 0.0, shift[1]])


def _figures(scene: str, outcome: Sequence[dict[str, Any]]) -> dict[str, Any]:
    trials = [trial for trial in outcome if trial["shifted"]]
    return {
        "scene": scene,
        "trials": len(trials),
        "found": sum(trial["found"] for trial in trials),
        "more_than_one_innocent": sum(trial["innocent"] > 1 for trial in trials),
        "moved_back": sum(trial["moved_back"] for trial in trials),
        "named_where_none_is_shifted": sum(
            trial["innocent"] for trial in outcome if not trial["shifted"]
        ),
        "outcome": list(outcome),
    }
