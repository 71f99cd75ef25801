"""Joining the photos of a scene, against its true poses."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.config import Config
from panoplan.datasets.folder import read_truth
from panoplan.errors import InputError
from panoplan.formats.image import read_panorama
from panoplan.formats.sequence import LAYOUTS, read_sequence
from panoplan.geometry.rigid import heading_of
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.metrics.tour import tour_error
from panoplan.pipeline import Progress
from panoplan.poses.tour.tour import join_tour
from panoplan.types.arrays import FloatArray


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


def measure(folder: Path, config: Config, progress: Progress) -> dict[str, Any]:
    """Joins the photos of a sequence folder with the layouts in it.

    Args:
        folder: with images, layouts_pred/ and trajectory_gt.tum.
        config: settings.
        progress: is told how far the work has come.

    Returns:
        The number of photos; each group's photos, those misplaced, errors in metres and degrees;
        why photos are apart; wall and CPU seconds.

    Raises:
        InputError: the folder is not complete.
    """
    sequence = read_sequence(folder)
    truth = read_truth(folder)
    height = sequence.camera_height_m or truth.plan.camera_height_m
    if truth.trajectory is None or height is None:
        raise InputError(folder, "no true poses or no camera height", "a scene with known truth")
    files = {k.id: folder / k.image for k in sequence.keyframes if k.image}
    layouts = {name: read_layout(path) for name, path in list_layouts(folder / LAYOUTS).items()}
    started = time.perf_counter(), time.process_time()
    result = join_tour(Photos(files), layouts, config, progress)
    seconds = time.perf_counter() - started[0], time.process_time() - started[1]
    poses = {
        label: np.array([*position[[0, 2]], heading_of(rotation)])
        for label, position, rotation in zip(
            truth.trajectory.labels,
            truth.trajectory.translations,
            truth.trajectory.rotations,
            strict=True,
        )
    }
    groups = []
    for group in result.groups:
        true = np.array([poses[name] for name in group.photos])
        error = asdict(tour_error(_in_metres(group.poses, height), true))
        error["misplaced"] = [group.photos[k] for k in error["misplaced"]]
        groups.append({"names": list(group.photos), **error})
    return {
        "scene": folder.name,
        "photos": len(files),
        "groups": groups,
        "reasons": dict(result.reasons),
        "seconds": seconds[0],
        "cpu_seconds": seconds[1],
    }


def _in_metres(poses_ch: FloatArray, height_m: float) -> FloatArray:
    return np.asarray(poses_ch * np.array([height_m, height_m, 1.0]))
