"""The sequence folder, and any trajectory with a folder of layouts."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.formats.layout_npz import read_layout_npz
from panoplan.formats.sequence import Sequence, read_sequence, read_true_plan
from panoplan.formats.tum import read_tum
from panoplan.poses.associate import Panorama, associate
from panoplan.poses.level import level
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth

_READERS = {".npz": read_layout_npz}
_STILL = 1e-9


def open_folder(
    folder: Path, *, trajectory: Path | None = None, layouts: Path | None = None
) -> Scene:
    """Reads a sequence folder. Truth is never read.

    Args:
        folder: holds trajectory.tum and layouts_pred/, and may hold sequence.json.
        trajectory: TUM file used instead of the folder's.
        layouts: folder used instead of layouts_pred/.

    Returns:
        The scene.

    Raises:
        InputError: a file that cannot be used; no layout that matches a pose, or none of those
            readable; several cameras all at one spot.
    """
    described = folder / "sequence.json"
    sequence = read_sequence(folder) if described.exists() else None
    trajectory = trajectory or folder / "trajectory.tum"
    layouts = layouts or folder / "layouts_pred"
    poses, turn = level(read_tum(trajectory))
    _check_moving(poses, trajectory)
    files = _layout_files(layouts)
    association = associate(poses.labels, _panoramas(sequence, files), str(trajectory))
    keyframes = []
    for k, panorama in enumerate(association.panoramas):
        if panorama is None:
            keyframes.append(Keyframe(f"pose_{poses.labels[k]}", poses[k], None))
            continue
        layout, problem = _read_layout(files.get(panorama.id))
        keyframes.append(Keyframe(panorama.id, poses[k], layout, problem))
    if all(keyframe.layout is None for keyframe in keyframes):
        problems = sorted({keyframe.missing for keyframe in keyframes})
        raise InputError(layouts, f"no usable layout ({problems[0]})", "at least one")
    return Scene(
        name=sequence.name if sequence else folder.name,
        kind="sequence folder",
        keyframes=tuple(keyframes),
        level_rotation=turn,
        camera_height_m=sequence.camera_height_m if sequence else None,
        association=association.rule,
    )


def read_truth(folder: Path) -> GroundTruth:
    """Reads the truth of a sequence folder: floorplan_gt.json and trajectory_gt.tum."""
    path = folder / "trajectory_gt.tum"
    return GroundTruth(
        read_true_plan(folder / "floorplan_gt.json"), read_tum(path) if path.exists() else None
    )


def _check_moving(poses: Trajectory, source: Path) -> None:
    spread = np.ptp(poses.translations, axis=0)
    if len(poses) > 1 and np.all(spread <= _STILL * (1 + np.abs(poses.translations).max())):
        raise InputError(source, f"{len(poses)} cameras at one spot", "a camera that moves")


def _layout_files(folder: Path) -> dict[str, Path]:
    if not folder.is_dir():
        raise InputError(folder, "no folder", "a folder of layouts")
    files: dict[str, Path] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix not in _READERS or path.name.startswith("."):
            continue
        if path.stem in files:
            raise InputError(folder, f"two layouts named {path.stem}", "one layout an id")
        files[path.stem] = path
    if not files:
        raise InputError(folder, "no layout", "files ending in " + ", ".join(_READERS))
    return files


def _panoramas(sequence: Sequence | None, files: dict[str, Path]) -> list[Panorama]:
    if sequence is None or not sequence.keyframes:
        return [Panorama(stem) for stem in files]
    return [Panorama(entry.id, entry.image, entry.order) for entry in sequence.keyframes]


def _read_layout(path: Path | None) -> tuple[Layout | None, str]:
    if path is None:
        return None, "no layout"
    try:
        return _READERS[path.suffix](path), ""
    except InputError as error:
        return None, f"unreadable layout: found {error.found}; expected {error.expected}"
