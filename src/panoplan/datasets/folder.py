"""The sequence folder, and any trajectory with a folder of layouts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from panoplan.datasets.scene import Scene, build_scene
from panoplan.errors import InputError
from panoplan.formats.sequence import (
    DESCRIPTION,
    LAYOUTS,
    TRAJECTORY,
    TRUE_PLAN,
    TRUE_TRAJECTORY,
    Sequence,
    read_sequence,
    read_true_plan,
)
from panoplan.formats.tum import read_tum
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.poses.associate import Panorama, associate
from panoplan.poses.files import find_trajectory, read_trajectory
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth


def open_folder(
    folder: Path, *, trajectory: Path | None = None, layouts: Path | None = None
) -> Scene:
    """Reads a sequence folder. Truth and images are never read.

    Args:
        folder: holds a trajectory by one of its usual names (trajectory.tum, COLMAP's images.txt
            or images.bin, ...) and layouts_pred/, and may hold sequence.json.
        trajectory: file of any program used instead of the folder's.
        layouts: folder used instead of layouts_pred/; .npz, .npy or .json.

    Returns:
        The scene.

    Raises:
        InputError: a file that cannot be used; no trajectory; no layout that matches a pose, or
            none of those readable; several cameras all at one spot.
    """
    sequence = read_sequence(folder) if (folder / DESCRIPTION).exists() else None
    source = trajectory or find_trajectory(folder)
    if source is None:
        raise InputError(
            folder, "no trajectory", f"{TRAJECTORY} in it, or a file given by --trajectory"
        )
    poses = read_trajectory(source)
    place = layouts or folder / LAYOUTS
    files = list_layouts(place)
    scene = build_scene(
        name=sequence.name if sequence else folder.resolve().name or "scene",
        kind="sequence folder" if sequence else "trajectory and layouts",
        trajectory=poses.trajectory,
        trajectory_source=poses.path,
        panoramas=_panoramas(sequence, files),
        layouts=files,
        layouts_source=place,
        reader=read_layout,
        camera_height_m=sequence.camera_height_m if sequence else None,
    )
    if poses.kind == "TUM":
        return scene
    told = f"{scene.association}, which come from {poses.path.name} ({poses.kind})"
    return replace(scene, association=told)


def read_truth(folder: Path) -> GroundTruth:
    """Reads the truth of a sequence folder: floorplan_gt.json and trajectory_gt.tum.

    Args:
        folder: a sequence folder.

    Returns:
        The truth; its trajectory is labelled with the keyframes' ids and in their order, and None
        where there is no trajectory_gt.tum.

    Raises:
        InputError: a file that cannot be used, or true poses that match no keyframe.
    """
    plan = read_true_plan(folder / TRUE_PLAN)
    path = folder / TRUE_TRAJECTORY
    if not path.exists():
        return GroundTruth(plan)
    trajectory = read_tum(path)
    if not (folder / DESCRIPTION).exists():
        return GroundTruth(plan, trajectory)
    return GroundTruth(plan, _named(trajectory, read_sequence(folder), path))


def _named(trajectory: Trajectory, sequence: Sequence, source: Path) -> Trajectory:
    """The poses of the keyframes, labelled with their ids, in their order."""
    matches = associate(trajectory.labels, _panoramas(sequence, {}), source).panoramas
    place = {p.id: k for k, p in enumerate(matches) if p is not None}
    ids = [entry.id for entry in sequence.keyframes if entry.id in place]
    rows = [place[name] for name in ids]
    return Trajectory(tuple(ids), trajectory.rotations[rows], trajectory.translations[rows])


def _panoramas(sequence: Sequence | None, files: Mapping[str, Path]) -> list[Panorama]:
    if sequence is None or not sequence.keyframes:
        return [Panorama(stem) for stem in files]
    return [Panorama(entry.id, entry.image, entry.order) for entry in sequence.keyframes]
