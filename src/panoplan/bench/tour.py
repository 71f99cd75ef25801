"""Joining the photos of tours, against their true poses."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.config import Config, TourConfig
from panoplan.datasets.folder import read_truth
from panoplan.errors import InputError
from panoplan.formats.image import read_panorama
from panoplan.formats.sequence import LAYOUTS, read_sequence
from panoplan.geometry.rigid import heading_of
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.metrics.tour import tour_error
from panoplan.pipeline import Progress
from panoplan.poses.tour.features import Features
from panoplan.poses.tour.tour import TourGroup, found_features, join_tour
from panoplan.types.arrays import FloatArray
from panoplan.types.pose import Trajectory

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


def measure(
    folders: Sequence[Path], config: Config, draws: int, progress: Progress
) -> list[dict[str, Any]]:
    """Joins the photos of sequence folders with the layouts in them.

    Args:
        folders: each with images, layouts_pred/ and trajectory_gt.tum.
        config: settings.
        draws: so often three quarters of a tour's photos are drawn and joined, too.
        progress: is told how far the work has come.

    Returns:
        A tour each: the number of photos; each group's photos, those misplaced, errors in metres
        and degrees; why photos are apart; wall and CPU seconds; the same of its draws.

    Raises:
        InputError: a folder is not complete.
    """
    return [_tour(folder, config, draws, progress) for folder in folders]


def _tour(folder: Path, config: Config, draws: int, progress: Progress) -> dict[str, Any]:
    sequence = read_sequence(folder)
    truth = read_truth(folder)
    true, height = truth.trajectory, sequence.camera_height_m or truth.plan.camera_height_m
    if true is None or height is None:
        raise InputError(folder, "no true poses or no camera height", "a scene with known truth")
    files = {k.id: folder / k.image for k in sequence.keyframes if k.image}
    layouts = {name: read_layout(path) for name, path in list_layouts(folder / LAYOUTS).items()}
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
            "seconds": seconds[0],
            "cpu_seconds": seconds[1],
        }

    names = list(files)
    whole = {"scene": folder.name, **joined(names)}
    count = round(_DRAWN * len(names))
    drawn = [np.random.default_rng(seed).permutation(len(names))[:count] for seed in range(draws)]
    return {**whole, "draws": [joined([names[k] for k in np.sort(some)]) for some in drawn]}


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
