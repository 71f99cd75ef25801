"""MP3D-FPE scenes."""

from __future__ import annotations

from pathlib import Path

from panoplan.datasets.scene import Scene, build_scene
from panoplan.errors import InputError
from panoplan.formats.mp3d_fpe import (
    odometry_folder,
    read_mp3d_fpe,
    read_mp3d_fpe_layout,
    read_mp3d_fpe_truth,
)
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.poses.associate import Panorama
from panoplan.poses.files import read_trajectory
from panoplan.types.truth import GroundTruth


def version_folder(path: Path, version: str | None = None) -> Path | None:
    """The `<root>/<scene>/<version>` folder that a path means.

    Args:
        path: the version's folder, or that of the scene.
        version: name of the version, needed where the scene has several.

    Returns:
        The folder, or None where the path is no MP3D-FPE scene.

    Raises:
        InputError: a version that is not there, or several and none named.
    """
    if odometry_folder(path) is not None:
        if version is not None and version != path.resolve().name:
            raise InputError(path, f"version {path.resolve().name}", f"version {version}")
        return path
    if not path.is_dir():
        return None
    versions = [p for p in sorted(path.iterdir()) if odometry_folder(p) is not None]
    if not versions:
        return None
    names = ", ".join(p.name for p in versions[:10])
    if version is None and len(versions) > 1:
        raise InputError(path, f"versions {names}", "one of them, by --version")
    chosen = [p for p in versions if version in (None, p.name)]
    if not chosen:
        raise InputError(path, f"versions {names}", f"version {version}")
    return chosen[0]


def open_mp3d_fpe(
    folder: Path, *, trajectory: Path | None = None, layouts: Path | None = None
) -> Scene:
    """Reads one version of an MP3D-FPE scene. Truth and images are never read.

    Args:
        folder: `<root>/<scene>/<version>`.
        trajectory: file of any program used instead of the odometry, labelled with frame ids.
        layouts: folder used instead of hn_mp3d/; the columns of its files have their centre at
            u + ½.

    Returns:
        The scene. Keyframes without a valid pose are in `skipped`.

    Raises:
        InputError: a file that cannot be used; no layout that matches a pose, or none of those
            readable; several cameras all at one spot.
    """
    data = read_mp3d_fpe(folder)
    known = (*data.trajectory.labels, *(name for name, _ in data.skipped))
    ids = sorted(known if trajectory is not None else data.trajectory.labels, key=int)
    files = list_layouts(layouts or data.layouts)
    by_frame = {_frame(name): path for name, path in files.items()}
    if len(by_frame) < len(files):
        raise InputError(layouts or data.layouts, "two layouts of one frame", "one a frame")
    if trajectory is None:
        for name, _ in data.skipped:
            by_frame.pop(name, None)
    return build_scene(
        name=data.name,
        kind="MP3D-FPE scene",
        trajectory=data.trajectory
        if trajectory is None
        else read_trajectory(trajectory).trajectory,
        trajectory_source=folder if trajectory is None else trajectory,
        panoramas=[Panorama(name) for name in ids],
        layouts=by_frame,
        layouts_source=layouts or data.layouts,
        reader=read_mp3d_fpe_layout if layouts is None else read_layout,
        skipped=data.skipped if trajectory is None else (),
    )


def read_truth(folder: Path) -> GroundTruth:
    """Reads the truth of one version of an MP3D-FPE scene; raises as its reader does."""
    return read_mp3d_fpe_truth(folder)


def _frame(name: str) -> str:
    """The frame number of a layout's name, without leading zeros."""
    return str(int(name)) if name.isascii() and name.isdigit() and len(name) < 20 else name
