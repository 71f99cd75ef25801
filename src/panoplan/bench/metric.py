"""Whether the ± of a plan's metres holds on simulated flats, source by source."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Literal

import numpy as np

from panoplan.bench.accuracy import GRADES
from panoplan.bench.estimate import estimate
from panoplan.bench.parallel import mapped, processes
from panoplan.config import Config
from panoplan.editing.apply import apply
from panoplan.editing.change import changed
from panoplan.editing.scale import DOOR_SIGMA_M, TAPE_SIGMA_M
from panoplan.estimator.state import Walk
from panoplan.metrics.walls import true_wall
from panoplan.simulate.scene import Grade, SimulatedScene, simulate_flat
from panoplan.types.arrays import FloatArray
from panoplan.types.edits import Edits
from panoplan.types.plan import Aperture, FloorPlan, PlanPose

SOURCES = ("camera height", "trajectory", "length", "door height")

_HEIGHT_SIGMA_M = 0.01
_IMAGE_ROWS = 1024
_ROW_SIGMA = 1.5
_DOOR_M = 2.0
_NEAR_M, _FAR_M = 1.2, 4.0
_SHORT_M = 1.0


def measure(
    seeds: range,
    config: Config,
    progress: Callable[[int, int], None],
    *,
    jobs: int = 1,
    grades: Sequence[Grade] = GRADES,
) -> dict[str, Any]:
    """Runs the method on flats of both grades and makes each plan metric in four ways.

    The camera's height is told with an error of 1 cm. The length is that of the longest wall that
    the plan has, taped within 5 mm; the height that of a door that a camera sees from 1.2 m to 4 m,
    told within 1 cm, its upper edge marked within 1.5 rows of 1,024.

    Args:
        seeds: one flat each.
        config: settings.
        progress: called with (flats done, flats in all).
        jobs: processes; the figures do not depend on it.
        grades: of noise.

    Returns:
        For each grade and source the summary over the flats, and the flats.
    """
    work = [(grade, seed) for grade in grades for seed in seeds]
    rows = mapped(partial(_scene, config=config), work, processes(jobs), progress)
    result: dict[str, Any] = {}
    for grade in grades:
        scenes = [row for (of, _), row in zip(work, rows, strict=True) if of == grade]
        summary = {name: _summary([s[name] for s in scenes if name in s]) for name in SOURCES}
        result[grade] = {"summary": summary, "scenes": scenes}
    return result


def _scene(work: tuple[Grade, int], config: Config) -> dict[str, Any]:
    grade, seed = work
    scene = simulate_flat(seed, grade)
    rng = np.random.default_rng(seed)
    told = scene.camera_height_m + rng.normal(0.0, _HEIGHT_SIGMA_M)
    plan = _plan(scene, config, "unknown", told)
    found: dict[str, Any] = {"seed": seed, "camera height": _row(plan, scene, ())}
    # The same walk with its unit known: metres are in both, the drift is the same.
    metric = simulate_flat(seed, grade, metres_per_su=1.0)
    found["trajectory"] = _row(_plan(metric, config, "m", None), metric, ())
    taped = _longest(plan, scene)
    if taped is not None:
        wall, metres = taped
        taped_m = metres + rng.normal(0.0, TAPE_SIGMA_M)
        edits = changed(Edits(), plan, lengths=[f"{wall}={taped_m:.4f}"])
        found["length"] = _row(apply(plan, edits).plan, scene, (wall,))
    seen = _seen_door(plan, scene, rng)
    if seen is not None:
        edits = changed(Edits(), plan, door_heights=[seen])
        found["door height"] = _row(apply(plan, edits).plan, scene, ())
    return found


def _plan(
    scene: SimulatedScene, config: Config, unit: Literal["unknown", "m"], height: float | None
) -> FloorPlan:
    return estimate(scene.keyframes, config, Walk(unit, height, len(scene.keyframes)))


def _lengths(plan: FloorPlan, scene: SimulatedScene) -> dict[str, tuple[float, float]]:
    """Predicted and true length of the walls that have a true one, by id."""
    outlines = [room.polygon for room in scene.truth.plan.rooms]
    found = {}
    for room in plan.rooms:
        for wall in room.walls:
            true = true_wall(wall, outlines)
            if true is not None:
                found[wall.id] = (_length(wall.a, wall.b), _length(*true))
    return found


def _length(a: FloatArray, b: FloatArray) -> float:
    return float(np.hypot(*(b - a)))


def _longest(plan: FloorPlan, scene: SimulatedScene) -> tuple[str, float] | None:
    lengths = _lengths(plan, scene)
    if not lengths:
        return None
    name = max(lengths, key=lambda key: lengths[key][1])
    return name, lengths[name][1]


def _seen_door(plan: FloorPlan, scene: SimulatedScene, rng: np.random.Generator) -> str | None:
    """The edit that tells the height of the first door that a camera sees well, or None."""
    assert scene.truth.trajectory is not None
    true = dict(
        zip(scene.truth.trajectory.labels, scene.truth.trajectory.translations, strict=True)
    )
    for door in plan.doors:
        middle = _true_middle(door, scene)
        camera = _witness(door, plan)
        if middle is None or camera is None:
            continue
        x, y, z = true[camera.id]
        distance = float(np.hypot(*(middle - (x, z))))
        elevation = np.arctan2(_DOOR_M - (scene.camera_height_m - y), distance)
        row = (np.pi / 2 - elevation) / np.pi * _IMAGE_ROWS - 0.5 + rng.normal(0.0, _ROW_SIGMA)
        told = _DOOR_M + rng.normal(0.0, DOOR_SIGMA_M)
        return f"{door.id}={told}@{camera.id},{row}/{_IMAGE_ROWS}"
    return None


def _true_middle(door: Aperture, scene: SimulatedScene) -> FloatArray | None:
    middles = [segment.mean(axis=0) for segment in scene.truth.plan.doors]
    own = door.segment.mean(axis=0)
    near = min(middles, key=lambda m: _length(m, own), default=None)
    return near if near is not None and _length(near, own) < 0.3 else None


def _witness(door: Aperture, plan: FloorPlan) -> PlanPose | None:
    own = door.segment.mean(axis=0)
    return next(
        (
            pose
            for pose in plan.trajectory
            if pose.room in door.rooms and _NEAR_M <= _length(pose.position, own) <= _FAR_M
        ),
        None,
    )


def _row(plan: FloorPlan, scene: SimulatedScene, known: Sequence[str]) -> dict[str, Any]:
    """Errors of a metric plan; walls whose length was given count not."""
    assert plan.metric is not None
    lengths = {n: pair for n, pair in _lengths(plan, scene).items() if n not in known}
    pairs = np.array(list(lengths.values())).reshape(-1, 2)
    predicted, true = pairs.T
    errors = predicted / true - 1
    size = float(predicted @ true / (true @ true) - 1) if len(pairs) else None
    own = {
        wall.id: wall.length_sigma
        for room in plan.rooms
        for wall in room.walls
        if wall.length_sigma is not None
    }
    stated = [
        abs(told - true) / np.hypot(own[name], plan.metric.sigma * true)
        for name, (told, true) in lengths.items()
        if name in own
    ]
    return {
        "walls": len(pairs),
        "size_error_percent": None if size is None else 100 * size,
        "size_sigma_percent": 100 * plan.metric.sigma,
        "length_errors_sigmas": np.round(stated, 3).tolist(),
        "length_errors_percent": np.round(100 * errors, 3).tolist(),
        "long": [bool(value) for value in true >= _SHORT_M],
    }


def _summary(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    told = [row for row in rows if row["size_error_percent"] is not None]
    sizes = np.array([row["size_error_percent"] for row in told])
    sigmas = np.array([row["size_sigma_percent"] for row in told])
    errors = np.abs([e for row in told for e in row["length_errors_percent"]])
    stated = np.array([value for row in told for value in row["length_errors_sigmas"]])
    long = np.array([flag for row in told for flag in row["long"]], dtype=bool)
    if not len(sizes):
        return {"flats": 0}
    return {
        "flats": len(sizes),
        "size_error_percent_median": float(np.median(np.abs(sizes))),
        "size_sigma_percent_median": float(np.median(sigmas)),
        "size_within_1_sigma": float(np.mean(np.abs(sizes) <= sigmas)),
        "size_within_2_sigma": float(np.mean(np.abs(sizes) <= 2 * sigmas)),
        "lengths_within_1_sigma": float(np.mean(stated <= 1)) if len(stated) else None,
        "lengths_within_2_sigma": float(np.mean(stated <= 2)) if len(stated) else None,
        "length_error_percent_median": float(np.median(errors)),
        "length_error_percent_median_from_1_m": (
            float(np.median(errors[long])) if long.any() else None
        ),
    }
