"""What a folder is, told by its content."""

from __future__ import annotations

from pathlib import Path

from panoplan.datasets import folder as sequence_folder
from panoplan.datasets import mp3d_fpe
from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.formats.image import list_images
from panoplan.formats.sequence import DESCRIPTION, LAYOUTS, TRAJECTORY, TRUE_PLAN
from panoplan.layouts.files import list_layouts
from panoplan.poses.files import PLACES, find_trajectory
from panoplan.types.truth import GroundTruth

_EXPECTED = (
    f"a sequence folder ({DESCRIPTION}, {TRAJECTORY}, {LAYOUTS}/), an MP3D-FPE scene "
    "(vo*/keyframe_list.txt), or a folder of layouts with --trajectory"
)


def open_scene(
    path: Path,
    *,
    trajectory: Path | None = None,
    layouts: Path | None = None,
    version: str | None = None,
) -> Scene:
    """Opens whatever scene a folder holds; `Scene.kind` says what it was taken for.

    Args:
        path: a sequence folder; an MP3D-FPE scene or one version of it; a folder of layouts, when
            a trajectory is given; or any folder, when both are.
        trajectory: file of any program used instead of the folder's own.
        layouts: folder used instead of the folder's own.
        version: of an MP3D-FPE scene that has several.

    Returns:
        The scene.

    Raises:
        InputError: no folder, none of these, a version where there are none, or as the readers.
    """
    if not path.is_dir():
        raise InputError(path, "a file" if path.exists() else "nothing", "a folder")
    if (path / DESCRIPTION).exists():
        scene_version = None
    else:
        scene_version = mp3d_fpe.version_folder(path, version)
    if scene_version is not None:
        return mp3d_fpe.open_mp3d_fpe(scene_version, trajectory=trajectory, layouts=layouts)
    if version is not None:
        raise InputError(path, "no MP3D-FPE scene", "one, as a version is asked for")
    if trajectory is not None and layouts is None and _holds_layouts(path):
        layouts = path
    own = [name for name in (DESCRIPTION, *PLACES, LAYOUTS) if (path / name).exists()]
    if not own and (trajectory is None or layouts is None):
        raise InputError(path, "none of the files of a scene", _EXPECTED)
    return sequence_folder.open_folder(path, trajectory=trajectory, layouts=layouts)


def image_files(path: Path) -> list[Path]:
    """The images of a folder: those in its images/ or rgb/, else its own; natural order."""
    for place in (path / "images", path / "rgb", path):
        images = list_images(place) if place.is_dir() else []
        if images:
            return images
    return []


def has_layouts(path: Path, version: str | None = None) -> bool:
    """Whether a folder brings layouts: those of a scene, or files that are layouts themselves."""
    if (path / LAYOUTS).exists() or _holds_layouts(path):
        return True
    if (path / DESCRIPTION).exists():
        return False
    return mp3d_fpe.version_folder(path, version) is not None


def own_layouts(path: Path) -> Path | None:
    """The folder of layouts that a folder of images brings, or None."""
    return path / LAYOUTS if (path / LAYOUTS).is_dir() else None


def has_trajectory(path: Path, version: str | None = None) -> bool:
    """Whether a folder brings camera poses."""
    if find_trajectory(path) is not None:
        return True
    if (path / DESCRIPTION).exists():
        return False
    return mp3d_fpe.version_folder(path, version) is not None


def read_truth(path: Path, *, version: str | None = None) -> GroundTruth:
    """Reads the truth beside a scene, for metrics only.

    Args:
        path: as for `open_scene`.
        version: as for `open_scene`.

    Returns:
        The truth.

    Raises:
        InputError: there is none, or a file of it cannot be used.
    """
    if (path / TRUE_PLAN).exists():
        return sequence_folder.read_truth(path)
    scene_version = mp3d_fpe.version_folder(path, version)
    if scene_version is None:
        raise InputError(path, "no truth", f"{TRUE_PLAN}, or an MP3D-FPE scene with label.json")
    return mp3d_fpe.read_truth(scene_version)


def _holds_layouts(path: Path) -> bool:
    """Whether the files of a folder themselves are layouts."""
    if any((path / name).exists() for name in (DESCRIPTION, TRAJECTORY, LAYOUTS)):
        return False
    try:
        return bool(list_layouts(path))
    except InputError:
        return False
