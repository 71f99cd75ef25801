"""Whether simulated layouts are as hard as real ones: the same cameras in the same rooms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import shapely.ops

from panoplan.bench.estimate import estimate, true_poses
from panoplan.bench.parallel import mapped, processes
from panoplan.config import Config
from panoplan.datasets.detect import read_truth
from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.estimator.state import Walk as Known
from panoplan.formats.schema import read_json
from panoplan.formats.sequence import DESCRIPTION
from panoplan.geometry.rigid import heading_of
from panoplan.metrics.report import evaluate
from panoplan.simulate.annotated import annotated_building
from panoplan.simulate.buildings import Building
from panoplan.simulate.errors import error_table
from panoplan.simulate.families import family_of
from panoplan.simulate.houses import make_house
from panoplan.simulate.noise import REAL, NoiseModel
from panoplan.simulate.scene import noisy_view
from panoplan.simulate.views import View, ViewCaster
from panoplan.simulate.walks import Walk, stills
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TruePlan

SEEDS = range(20)
JUDGED = ("mean_iou", "corner_cm")
"""The figures that must lie within what the seeds give."""
_WITHIN = (0.05, 0.95)
_HOMES = range(100, 160)
_AT_ROOM_M = 0.15
_INSIDE_M = 0.01


@dataclass(frozen=True, eq=False)
class Twin:
    """A real tour and all that is needed to simulate it.

    Attributes:
        keyframes: true poses, the real network's layouts.
        truth: rooms split at openings.
        camera_height_m: above the floor.
        way: the true poses, on the floor, and the room that each camera looks at.
        caster: of the true rooms, doors and openings.
    """

    keyframes: tuple[Keyframe, ...]
    truth: GroundTruth
    camera_height_m: float
    way: Walk
    caster: ViewCaster

    def views(self) -> list[View]:
        """What the cameras truly see, all doors and openings closed."""
        poses = self.way.trajectory
        return [
            self.caster.view(
                poses.translations[k, [0, 2]],
                heading_of(poses.rotations[k]),
                self.camera_height_m - float(poses.translations[k, 1]),
                room=int(room),
            )
            for k, room in enumerate(self.way.rooms)
        ]

    def simulated(self, seed: int) -> list[Layout]:
        """Layouts of the grade `measured`, without what the real ones lack."""
        layouts = []
        for k, real in enumerate(keyframe.layout for keyframe in self.keyframes):
            rng = np.random.default_rng([seed, k])
            layout = noisy_view(self.caster, self.way, k, REAL, rng)[1]
            layouts.append(_alike(layout, real))
        return layouts


def measure(
    folder: Path,
    config: Config,
    progress: Callable[[int, int], None],
    *,
    seeds: range = SEEDS,
    jobs: int = 1,
) -> dict[str, Any]:
    """Compares the method's figures on a real tour with those on simulated layouts of it.

    Args:
        folder: sequence folder with trajectory_gt.tum, predicted layouts, and a true plan with
            doors.
        config: settings.
        progress: called with (runs done, runs in all).
        seeds: one simulation each.
        jobs: processes.

    Returns:
        Figures of the real layouts and of each seed, at true poses, metric, unaligned; the seeds'
        5-95 % and whether the real figures lie within; the same without the uncertainty that
        layouts state; the errors of both kinds of layouts, and of photos in made-up open homes.

    Raises:
        InputError: the folder is not complete.
    """
    twin = read_twin(folder)
    work = [(seed, stated) for stated in (True, False) for seed in seeds]
    rows = mapped(partial(_run, folder=folder, config=config), work, processes(jobs), progress)
    views = twin.views()
    real = [layout for layout in _layouts(twin, None, True) if layout is not None]
    repeated = [layout for seed in seeds for layout in twin.simulated(seed)]
    return {
        "scene": folder.name,
        "grade": REAL.name,
        "cameras": len(twin.keyframes),
        "stated": _compared(_run((None, True), folder, config), rows[: len(seeds)]),
        "unstated": _compared(_run((None, False), folder, config), rows[len(seeds) :]),
        "errors_real": asdict(error_table(views, real)),
        "errors_simulated": asdict(error_table(views * len(seeds), repeated)),
        "errors_homes": asdict(error_table(*open_home_views(REAL, _HOMES))),
    }


def open_home_views(model: NoiseModel, seeds: range) -> tuple[list[View], list[Layout]]:
    """Photos in made-up flats as open as the two homes that were measured, and their layouts.

    Args:
        model: the grade.
        seeds: one flat each, of the usual sizes, all its shared rooms joined by openings.
    """
    flat = family_of("flat")
    style = replace(flat.style, doors=replace(flat.style.doors, openings=1.0, rounds=1.0))
    seen, told = [], []
    for seed in seeds:
        home = make_house("home", style, *flat.size(seed), np.random.default_rng([1, seed]))
        tour = stills(home, np.random.default_rng(seed))
        caster = ViewCaster(home)
        for k in range(len(tour.trajectory)):
            view, layout = noisy_view(caster, tour, k, model, np.random.default_rng([seed, k]))
            seen.append(view)
            told.append(layout)
    return seen, told


def read_twin(folder: Path) -> Twin:
    """Reads a real tour and its truth.

    Raises:
        InputError: the folder is not complete.
    """
    scene = true_poses(folder)
    truth = read_truth(folder)
    if scene.camera_height_m is None:
        raise InputError(folder / DESCRIPTION, "no camera_height", "metres")
    building = annotated_building(folder.name, truth.plan)
    poses = Trajectory(
        tuple(k.id for k in scene.keyframes),
        np.array([k.pose.rotation for k in scene.keyframes]),
        np.array([k.pose.translation for k in scene.keyframes]),
    )
    positions = poses.translations[:, [0, 2]]
    rooms = _rooms(folder, scene, truth.plan, positions)
    seen_from = poses.translations.copy()
    seen_from[:, [0, 2]] = [
        _on_floor(building, int(room), place) for room, place in zip(rooms, positions, strict=True)
    ]
    way = Walk(
        replace(poses, translations=seen_from), rooms, scene.camera_height_m, seen_from[:, [0, 2]]
    )
    return Twin(scene.keyframes, truth, scene.camera_height_m, way, ViewCaster(building))


def figures(layouts: list[Layout | None], twin: Twin, config: Config) -> dict[str, float]:
    """Figures of the method at the true poses, metric, unaligned.

    Args:
        layouts: one a camera.
        twin: the tour.
        config: settings.

    Returns:
        The figures; what there was nothing to measure of is NaN.
    """
    known = Known("m", twin.camera_height_m, len(layouts))
    pairs = zip(twin.keyframes, layouts, strict=True)
    keyframes = [replace(keyframe, layout=layout) for keyframe, layout in pairs]
    plan = estimate(keyframes, config, known)
    report = evaluate(plan, twin.truth, rooms="rooms_partial", align="none")
    _, half, seven = report.rooms.scores
    corner_cm = report.corners.true_to_predicted.median_cm
    return {
        "mean_iou": _number(report.rooms.mean_iou),
        "corner_cm": _number(corner_cm),
        "wall_cm": _number(report.walls.median_cm),
        "floor_iou": float(report.rooms.floor_iou),
        "hits_50": half.hits,
        "hits_70": seven.hits,
        "predicted": report.rooms.predicted,
    }


def _run(work: tuple[int | None, bool], folder: Path, config: Config) -> dict[str, float]:
    """The method's figures on a seed's layouts, or the real ones where the seed is None."""
    twin = read_twin(folder)
    return figures(_layouts(twin, *work), twin, config)


def _layouts(twin: Twin, seed: int | None, stated: bool) -> list[Layout | None]:
    """A seed's layouts or the real ones, with or without the uncertainty that they state."""
    layouts: list[Layout | None] = [keyframe.layout for keyframe in twin.keyframes]
    if seed is not None:
        layouts = list(twin.simulated(seed))
    if stated:
        return layouts
    return [None if layout is None else replace(layout, floor_sigma=None) for layout in layouts]


def _compared(real: dict[str, float], seeds: list[dict[str, float]]) -> dict[str, Any]:
    bands = {name: _band([row[name] for row in seeds]) for name in real}
    within = {name: bands[name][0] <= real[name] <= bands[name][1] for name in JUDGED}
    return {"real": real, "band": bands, "within": within, "seeds": seeds}


def _rooms(folder: Path, scene: Scene, plan: TruePlan, positions: FloatArray) -> IntArray:
    """The room each camera looks at: that of its annotation where it stands in it or at its door,
    else the one it stands in, or the nearest.
    """
    areas = [shapely.Polygon(room.polygon) for room in plan.rooms_partial or plan.rooms]
    names = [room.id for room in plan.rooms_partial or plan.rooms]
    told = {
        item.get("id"): item.get("room_partial")
        for item in read_json(folder / DESCRIPTION).get("keyframes", [])
        if isinstance(item, dict)
    }
    found = []
    for keyframe, position in zip(scene.keyframes, positions, strict=True):
        away = shapely.distance(areas, shapely.Point(position))
        label = told.get(keyframe.id)
        k = names.index(label) if label in names else int(np.argmin(away))
        found.append(k if away[k] < _AT_ROOM_M else int(np.argmin(away)))
    return np.array(found)


def _on_floor(building: Building, room: int, position: FloatArray) -> FloatArray:
    """A camera's place, or the nearest one in its room or the room's doorways where it stands a
    hand's breadth beyond them.
    """
    floors = [building.rooms[room].floor]
    floors += [shapely.Polygon(building.passages[k].area) for k, _ in building.neighbours(room)]
    floor = shapely.union_all([f.buffer(1e-6) for f in floors]).buffer(-_INSIDE_M)
    if floor.is_empty or floor.contains(shapely.Point(position)):
        return position
    return np.asarray(shapely.ops.nearest_points(floor, shapely.Point(position))[0].coords[0])


def _alike(layout: Layout, real: Layout | None) -> Layout:
    """The layout without what the real one of the same image lacks."""
    if real is None:
        return layout
    ceiling = layout.ceiling_boundary
    if ceiling is not None:
        known = None if real.ceiling_boundary is None else ~np.isnan(real.ceiling_boundary)
        ceiling = None if known is None else np.where(known, ceiling, np.nan)
    return replace(
        layout,
        ceiling_boundary=ceiling,
        floor_sigma=None if real.floor_sigma is None else layout.floor_sigma,
        corners=None if real.corners is None else layout.corners,
        spans=None if real.spans is None else layout.spans,
    )


def _band(values: list[float]) -> tuple[float, float, float]:
    """5 %, 95 % and the median."""
    low, high, middle = np.quantile(values, [*_WITHIN, 0.5])
    return float(low), float(high), float(middle)


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)
