"""Joining the photos of tours, against their true poses, and the plan that comes of them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.bench.estimate import estimate, images_of, predicted
from panoplan.config import Config, TourConfig
from panoplan.datasets.folder import read_truth
from panoplan.errors import InputError
from panoplan.estimator.state import Walk
from panoplan.formats.image import read_panorama
from panoplan.formats.sequence import DESCRIPTION, LAYOUTS, read_sequence
from panoplan.geometry.rigid import heading_of
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.layouts.onnx import OnnxLayouts
from panoplan.metrics.presentation import as_dict
from panoplan.metrics.report import RoomsKind, evaluate
from panoplan.metrics.tour import tour_error
from panoplan.pipeline import Progress
from panoplan.poses.tour.features import Features
from panoplan.poses.tour.tour import TourGroup, found_features, join_tour
from panoplan.simulate.render.tour import photograph_tour, tour_home
from panoplan.types.arrays import FloatArray
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth

RENDERED_SEEDS = range(25, 35)
"""Rendered tours that figures are reported of; settings are chosen by seeds 0 to 24."""
_DRAWN = 0.75


class Photos(Mapping[str, NDArray[np.uint8]]):
    """Grey levels of image files, each read when it is asked for.

    Args:
        files: by name.
    """

    def __init__(self, files: Mapping[str, Path]) -> None:
        self._files = files

    def __getitem__(self, name: str) -> NDArray[np.uint8]:
        """(H, W) grey levels of a photo."""
        return np.asarray(read_panorama(self._files[name]).mean(axis=2), dtype=np.uint8)

    def __iter__(self) -> Iterator[str]:
        """The names."""
        return iter(self._files)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._files)


def rendered(folder: Path, seeds: Sequence[int], progress: Progress) -> list[Path]:
    """Tours of made-up furnished homes, photographed where they are not there yet.

    Args:
        folder: gets a sequence folder a home.
        seeds: of the homes.
        progress: is told how far the work has come.

    Returns:
        The folders.

    Raises:
        InputError: a place that cannot be written.
        MissingExtraError: the `render` extra is not installed.
    """
    folders = []
    for seed in seeds:
        home = tour_home(seed)
        place = folder / home.name
        folders.append(place)
        if not (place / DESCRIPTION).exists():
            photograph_tour(place, home, seed, partial(_photographed, progress, home.name))
    return folders


def _photographed(progress: Progress, name: str, done: int, total: int) -> None:
    progress(done, total, f"photographs of {name}")


def measure(
    folders: Sequence[Path],
    config: Config,
    draws: int,
    network: OnnxLayouts | None,
    progress: Progress,
) -> list[dict[str, Any]]:
    """Joins the photos of sequence folders and makes the plan of the largest group.

    Args:
        folders: each with images, trajectory_gt.tum, and layouts_pred/ where no network is asked.
        config: settings.
        draws: so often three quarters of a tour's photos are drawn and joined, too.
        network: is asked for the layouts; None for those in the folders.
        progress: is told how far the work has come.

    Returns:
        A tour each: the number of photos; each group's photos, those misplaced, errors in metres
        and degrees; why photos are apart; the plan's figures; wall and CPU seconds; the same of
        its draws.

    Raises:
        InputError: a folder is not complete.
    """
    return [_tour(folder, config, draws, network, progress) for folder in folders]


def _tour(
    folder: Path, config: Config, draws: int, network: OnnxLayouts | None, progress: Progress
) -> dict[str, Any]:
    sequence, truth = read_sequence(folder), read_truth(folder)
    true, height = truth.trajectory, sequence.camera_height_m or truth.plan.camera_height_m
    if true is None or height is None:
        raise InputError(folder, "no true poses or no camera height", "a scene with known truth")
    files = images_of(folder)
    if network is None:
        told = list_layouts(folder / LAYOUTS)
        layouts = {name: read_layout(path) for name, path in told.items()}
    else:
        layouts = predicted(files, network, progress)
    known: dict[str, Features] = {}

    def features(name: str, image: NDArray[np.uint8], settings: TourConfig) -> Features:
        if name not in known:
            known[name] = found_features(name, image, settings)
        return known[name]

    def joined(names: Sequence[str]) -> dict[str, Any]:
        photos = Photos({name: files[name] for name in names})
        started = time.perf_counter(), time.process_time()
        result = join_tour(photos, layouts, config, progress, features)
        seconds = time.perf_counter() - started[0], time.process_time() - started[1]
        groups = [_compared(group, true, height) for group in result.groups]
        return {
            "photos": len(photos),
            "groups": groups,
            "reasons": dict(result.reasons),
            "plan": _plan(result.groups[0], layouts, truth, height, config),
            "seconds": seconds[0],
            "cpu_seconds": seconds[1],
        }

    names = list(files)
    asked = "files" if network is None else network.spec.name
    whole = {"scene": folder.name, "layouts": asked, **joined(names)}
    count = round(_DRAWN * len(names))
    drawn = [np.random.default_rng(seed).permutation(len(names))[:count] for seed in range(draws)]
    return {**whole, "draws": [joined([names[k] for k in np.sort(some)]) for some in drawn]}


def _plan(
    group: TourGroup,
    layouts: Mapping[str, Layout],
    truth: GroundTruth,
    height_m: float,
    config: Config,
) -> dict[str, Any] | None:
    """Figures of the plan of a group's photos, metric by the camera height, rigidly aligned.

    None where too few photos are together to be aligned.
    """
    if len(group.photos) < 2:
        return None
    poses = _in_metres_3d(group.trajectory(), height_m)
    keyframes = [
        Keyframe(name, poses[k], layouts.get(name), "" if name in layouts else "no layout")
        for k, name in enumerate(poses.labels)
    ]
    plan = estimate(keyframes, config, Walk("m", height_m, len(keyframes)))
    kind: RoomsKind = "rooms_partial" if truth.plan.rooms_partial else "rooms"
    return as_dict(evaluate(plan, truth, rooms=kind, align="rigid"))


def _compared(group: TourGroup, truth: Trajectory, height_m: float) -> dict[str, Any]:
    """A group's photos, which are misplaced, and how far the others are off."""
    at = {label: k for k, label in enumerate(truth.labels)}
    rows = [at[name] for name in group.photos]
    true = np.array(
        [[*truth.translations[k][[0, 2]], heading_of(truth.rotations[k])] for k in rows]
    )
    error = tour_error(_in_metres(group.poses, height_m), true)
    told = {k: None if v != v else v for k, v in asdict(error).items()}
    told["misplaced"] = [group.photos[k] for k in error.misplaced]
    return {"names": list(group.photos), **told}


def _in_metres(poses_ch: FloatArray, height_m: float) -> FloatArray:
    return np.asarray(poses_ch * np.array([height_m, height_m, 1.0]))


def _in_metres_3d(poses_ch: Trajectory, height_m: float) -> Trajectory:
    return Trajectory(poses_ch.labels, poses_ch.rotations, poses_ch.translations * height_m)
