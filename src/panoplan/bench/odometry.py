"""Accuracy and speed of odometry on walks whose true poses are known."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from panoplan.bench.estimate import estimate, predicted
from panoplan.cache import Cache
from panoplan.config import Config
from panoplan.datasets.detect import image_files
from panoplan.datasets.folder import read_truth
from panoplan.errors import InputError
from panoplan.estimator.state import Walk
from panoplan.formats.sequence import DESCRIPTION, TRUE_LAYOUTS, TRUE_TRAJECTORY, read_sequence
from panoplan.formats.tum import read_tum
from panoplan.geometry.similarity import fit_similarity
from panoplan.intake.level_images import LevelImages
from panoplan.intake.live import LivePlan
from panoplan.intake.panoramas import Panoramas
from panoplan.intake.scene_folder import IMAGES
from panoplan.intake.walk import looker
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.layouts.onnx import OnnxLayouts
from panoplan.metrics.presentation import as_dict
from panoplan.metrics.report import evaluate
from panoplan.metrics.rooms import THRESHOLDS
from panoplan.pipeline import Progress
from panoplan.poses.associate import Panorama, associate
from panoplan.poses.level import level, upright
from panoplan.poses.walk.carried import carried
from panoplan.poses.walk.features import Extractor, sharpness
from panoplan.poses.walk.follow import (
    HEIGHT,
    WIDTH,
    Seen,
    WalkSettings,
    follow,
    trajectory_of_map,
    working_grey,
)
from panoplan.poses.walk.keyframes import EVERY_IMAGE, KeyframeChooser
from panoplan.poses.walk.odometry import Odometry
from panoplan.simulate.render.filmed import TROUBLES, film_badly, film_walk, filmed_home
from panoplan.simulate.scene import SimulatedScene
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.plan import FloorPlan
from panoplan.types.pose import Pose, Trajectory
from panoplan.types.truth import GroundTruth

_ENDS = 50
_GROSS_M, _GROSS_DEG = 0.10, 2.0
RENDERED_SEEDS = range(25, 28)
"""Buildings of the walks that figures are reported of."""
_LOOKS = 2


def rendered(folder: Path, progress: Progress) -> list[Path]:
    """Walks of 300 frames through made-up homes, rendered where they are not there yet.

    Args:
        folder: gets a sequence folder a walk: three buildings with two looks each, and the first
            of them furnished anew but for a bare white corridor, and with each of the troubles that
            pictures can have.
        progress: is told how far the work has come.

    Returns:
        The folders.

    Raises:
        InputError: a place that cannot be written.
        MissingExtraError: the `render` extra is not installed.
    """

    def filmed(walk: SimulatedScene, look: int, name: str, *, bare_corridor: bool = False) -> Path:
        place = folder / name
        if not (place / DESCRIPTION).exists():
            told = partial(_rendering, progress, name)
            film_walk(place, walk, look, told, bare_corridor=bare_corridor)
        return place

    walks = {seed: filmed_home(seed) for seed in RENDERED_SEEDS}
    folders = [
        filmed(walk, len(RENDERED_SEEDS) * look + seed, f"walk_{seed}_look_{look}")
        for seed, walk in walks.items()
        for look in range(_LOOKS)
    ]
    first = RENDERED_SEEDS[0]
    bare = f"{folders[0].name}_bare_corridor"
    folders.append(filmed(walks[first], first, bare, bare_corridor=True))
    for trouble in TROUBLES:
        place = folder / f"{folders[0].name}_{trouble}"
        if not place.exists():
            film_badly(folders[0], place, trouble, 0)
        folders.append(place)
    return folders


def _rendering(progress: Progress, name: str, done: int, total: int) -> None:
    progress(done, total, f"rendering {name}")


def measure(
    folders: Sequence[Path],
    config: Config,
    report: Progress,
    *,
    live: OnnxLayouts | None = None,
    plans: OnnxLayouts | None = None,
) -> list[dict[str, Any]]:
    """Follows walks and compares with the truth.

    Args:
        folders: each with images and trajectory_gt.tum.
        config: settings of the plans.
        report: is told how far the work has come.
        live: network with which each walk is followed once more, its plan growing meanwhile; None
            for no live plan.
        plans: network whose plan of each walk is compared with the truth, as is that of the true
            layouts with the poses found and with the true ones; None for no plans.

    Returns:
        A walk's figures each: keyframes with a pose in the largest map, error of their positions
        after a similarity, in cm and in percent of the way, for the poses at the time they were
        given and for the final ones; seconds of processor time a keyframe; where asked for, how
        long after its image was read a keyframe stood in the live plan, seconds of the clock, and
        the figures of three plans.

    Raises:
        InputError: images, true poses or what plans are compared with are missing.
        MissingExtraError: pycolmap is not installed.
    """
    walks = []
    for folder in folders:
        known = None if plans is None else _known(folder)
        told, found = _walk(folder, report)
        if plans is not None and known is not None:
            told["plans"] = _plans(folder, known, found, config, plans, report)
        if live is not None:
            told["plan_lag_s"] = _lags(folder, config, live, report)
        walks.append(told)
    return walks


def _lags(folder: Path, config: Config, network: OnnxLayouts, report: Progress) -> dict[str, float]:
    """How long keyframes of the first map took from being read to standing in a plan, seconds."""
    panoramas = Panoramas.of_images(folder, image_files(folder))
    mask = carried(panoramas.sample(), WIDTH, HEIGHT)
    read: dict[str, float] = {}
    lags: dict[str, float] = {}

    def reading() -> Iterator[Seen]:
        for seen in panoramas:
            read[seen.name] = time.perf_counter()
            yield seen

    def shown(plan: FloorPlan) -> None:
        now = time.perf_counter()
        for pose in plan.trajectory:
            lags.setdefault(pose.id, now - read[pose.id])
        report(len(read), len(panoramas.images), f"{folder.name}, live")

    with TemporaryDirectory() as work:
        place = Path(work)
        look = looker(None, network, LevelImages(place / IMAGES), place, Cache(place / "cache"))
        plan = LivePlan(config, Walk(), shown, look)
        follow(reading(), WalkSettings(keyframes=EVERY_IMAGE), mask, plan)
    values = list(lags.values())
    return {**_spread(values), "longest": max(values, default=0.0)}


@dataclass(frozen=True, eq=False)
class _Known:
    """What is true of a rendered walk, by the names of its images."""

    truth: GroundTruth
    poses: Mapping[str, Pose]
    layouts: Mapping[str, Path]
    height_m: float


def _known(folder: Path) -> _Known:
    sequence, truth = read_sequence(folder), read_truth(folder)
    true, height = truth.trajectory, sequence.camera_height_m
    if true is None or height is None:
        raise InputError(folder, "no true poses or no camera height", "a rendered walk")
    files = list_layouts(folder / TRUE_LAYOUTS)
    poses = {label: true[k] for k, label in enumerate(true.labels)}
    for path in image_files(folder):
        if path.stem not in files or path.stem not in poses:
            raise InputError(path, "no true layout or no true pose", "a rendered walk")
    return _Known(truth, poses, files, height)


def _plans(
    folder: Path,
    known: _Known,
    found: Trajectory | None,
    config: Config,
    network: OnnxLayouts,
    report: Progress,
) -> dict[str, Any]:
    """Figures of the plans of a walk's largest map, in metres by the camera height."""
    if found is None:
        return dict.fromkeys(PLANS, _nothing_found(len(known.truth.plan.rooms)))
    layouts = {name: read_layout(known.layouts[name]) for name in found.labels}
    poses, _ = level(found)
    stand = Trajectory(poses.labels, upright(poses.rotations), poses.translations)
    with TemporaryDirectory() as work:
        place = Path(work)
        panoramas = Panoramas.of_images(folder, image_files(folder))
        LevelImages(place).complete(panoramas, poses, report)
        pictures = {name: place / f"{name}.jpg" for name in poses.labels}
        asked = predicted(pictures, network, report)

    def compared(at: Sequence[Pose], told: Mapping[str, Layout]) -> dict[str, Any]:
        if not told:
            return _nothing_found(len(known.truth.plan.rooms))
        keyframes = [
            Keyframe(name, pose, told.get(name), "" if name in told else "no layout")
            for name, pose in zip(found.labels, at, strict=True)
        ]
        plan = estimate(keyframes, config, Walk("unknown", known.height_m, len(keyframes)))
        return as_dict(evaluate(plan, known.truth, align="rigid"))

    made = (
        compared([known.poses[name] for name in found.labels], layouts),
        compared([poses[k] for k in range(len(poses))], layouts),
        compared([stand[k] for k in range(len(stand))], asked),
    )
    return {"network": network.spec.name, **dict(zip(PLANS, made, strict=True))}


PLANS = ("true_poses_true_layouts", "true_layouts", "images_alone")
"""The plans of a walk: of true poses and layouts, of poses found and true layouts, of images."""


def _nothing_found(rooms: int) -> dict[str, Any]:
    none = {"hits": 0, "predicted": 0, "true": rooms}
    scores = [{"iou": iou, **none} for iou in THRESHOLDS]
    return {"rooms": {"scores": scores, "mean_iou": None}}


def _walk(folder: Path, report: Progress) -> tuple[dict[str, Any], Trajectory | None]:
    """A walk's figures, and the poses of its largest map."""
    images = image_files(folder)
    if not images:
        raise InputError(folder, "no image", "a rendered walk")
    truth = _truth(folder, [path.stem for path in images])
    panoramas = Panoramas.of_images(folder, images)
    mask = carried(panoramas.sample(), WIDTH, HEIGHT)
    extract = Extractor(mask=None if mask is None else ~mask)
    choose = KeyframeChooser(WIDTH, HEIGHT, EVERY_IMAGE)
    odometry = Odometry(WIDTH, HEIGHT)
    names: list[str] = []
    given: dict[int, dict[int, Pose]] = {}
    seconds = []
    for seen in panoramas:
        started = time.process_time()
        grey = working_grey(seen.pixels)
        features = extract(grey)
        if not choose(features, sharpness(grey)):
            continue
        names.append(seen.name)
        for told in odometry.add(features):
            given.setdefault(told.map, {})[told.number] = told.pose
        seconds.append(time.process_time() - started)
        report(len(names), len(images), folder.name)
    started = time.process_time()
    odometry.finish()
    finishing = time.process_time() - started
    final = odometry.poses()
    largest = max(given.values(), key=len, default={})
    figures = {
        "scene": folder.name,
        "frames": len(images),
        "keyframes": len(names),
        "maps": [len(poses) for poses in final],
        "lost": len(odometry.lost),
        "masked_share": 0.0 if mask is None else float(mask.mean()),
        "final": _errors(final[0], names, truth) if final else None,
        "as_given": _errors(largest, names, truth) if largest else None,
        "cpu_s_a_keyframe": _spread(seconds),
        "cpu_s_first": _spread(seconds[:_ENDS]),
        "cpu_s_last": _spread(seconds[-_ENDS:]),
        "cpu_s_finishing": finishing,
        "keyframes_a_cpu_second": len(seconds) / max(sum(seconds), 1e-9),
    }
    return figures, trajectory_of_map(names, final[0]) if final else None


def _truth(folder: Path, names: list[str]) -> dict[str, Pose]:
    source = folder / TRUE_TRAJECTORY
    true: Trajectory = read_tum(source)
    panoramas = [Panorama(name, order=k) for k, name in enumerate(names)]
    matched = associate(true.labels, panoramas, source).panoramas
    return {p.id: true[k] for k, p in enumerate(matched) if p is not None}


def _errors(poses: dict[int, Pose], names: list[str], truth: dict[str, Pose]) -> dict[str, Any]:
    numbers = [n for n in sorted(poses) if names[n] in truth]
    true = [truth[names[n]] for n in numbers]
    positions = np.array([poses[n].translation for n in numbers])
    places = np.array([pose.translation for pose in true])
    fit = fit_similarity(positions, places)
    off_m = np.linalg.norm(fit(positions) - places, axis=1)
    turns = [fit.rotation @ poses[n].rotation for n in numbers]
    cosines = [
        (np.trace(pose.rotation.T @ turn) - 1) / 2 for pose, turn in zip(true, turns, strict=True)
    ]
    off_deg = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    length = float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
    rmse = float(np.sqrt(np.mean(off_m**2)))
    return {
        "poses": len(numbers),
        "length_m": length,
        "ate_cm": 100 * rmse,
        "ate_percent_of_length": 100 * rmse / max(length, 1e-9),
        "worst_cm": 100 * float(off_m.max()),
        "median_deg": float(np.median(off_deg)),
        "worst_deg": float(off_deg.max()),
        "gross": int(np.sum((off_m > _GROSS_M) | (off_deg > _GROSS_DEG))),
    }


def _spread(values: list[float]) -> dict[str, float]:
    median, high = np.percentile(values or [0.0], [50, 95])
    return {"median": float(median), "95 %": float(high)}
