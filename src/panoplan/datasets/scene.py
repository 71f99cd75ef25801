"""A scene: what a run starts from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np

from panoplan.errors import InputError
from panoplan.layouts.files import LayoutReader
from panoplan.poses.associate import Panorama, associate
from panoplan.poses.level import level
from panoplan.poses.motion import check_moving
from panoplan.types.arrays import FloatArray
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory


@dataclass(frozen=True, eq=False)
class Scene:
    """Keyframes of one walk, ready for the estimator. It holds no truth.

    Attributes:
        name: of the scene.
        kind: what the input was recognised as.
        keyframes: in the order of the walk; poses in the level world. Those without a layout
            are among them, with the reason.
        level_rotation: (3, 3) level_from_world that was applied.
        camera_height_m: metres, None where the input does not say.
        association: how layouts were matched with poses, in words.
        skipped: (id, reason) of what the input lists and `keyframes` does not hold: panoramas
            without a pose.
    """

    name: str
    kind: str
    keyframes: tuple[Keyframe, ...]
    level_rotation: FloatArray
    camera_height_m: float | None
    association: str
    skipped: tuple[tuple[str, str], ...] = ()


def build_scene(
    *,
    name: str,
    kind: str,
    trajectory: Trajectory,
    trajectory_source: object,
    panoramas: Sequence[Panorama],
    layouts: Mapping[str, Path],
    layouts_source: object,
    reader: LayoutReader,
    camera_height_m: float | None = None,
    skipped: Sequence[tuple[str, str]] = (),
) -> Scene:
    """Joins poses and layouts.

    The walk's order is that of the panoramas where they list one, else that of the trajectory.

    Args:
        name: of the scene.
        kind: what the input was recognised as.
        trajectory: poses as read.
        trajectory_source: the file it came from, for messages.
        panoramas: what can be matched with a pose.
        layouts: file by name without ending: the id of a panorama or the stem of its image.
        layouts_source: the folder they are in, for messages.
        reader: reads one of them.
        camera_height_m: metres, or None.
        skipped: (id, reason) of what is known to take no part.

    Returns:
        The scene.

    Raises:
        InputError: several cameras at one spot; poses and panoramas that cannot be matched in one
            way; or no usable layout at all. One unreadable layout among many is a keyframe
            without a layout.
    """
    check_moving(trajectory, trajectory_source)
    association = associate(trajectory.labels, panoramas, trajectory_source)
    poses, turn = level(trajectory)
    taken = {panorama.id for panorama in panoramas}
    keyframes = []
    for k in _walk_order(association.panoramas):
        panorama = association.panoramas[k]
        if panorama is None:
            own = poses.labels[k]
            while own in taken:
                own = f"pose_{own}"
            taken.add(own)
            keyframes.append(Keyframe(own, poses[k], None, "no layout for this pose"))
            continue
        layout, problem = _read_layout(_layout_of(panorama, layouts), reader)
        keyframes.append(Keyframe(panorama.id, poses[k], layout, problem))
    if all(keyframe.layout is None for keyframe in keyframes):
        problems = [keyframe.missing for keyframe in keyframes]
        worst = next((p for p in problems if p.startswith("unreadable")), problems[0])
        raise InputError(
            layouts_source, f"no usable layout of {len(keyframes)} ({worst})", "at least one"
        )
    matched = {panorama.id for panorama in association.panoramas if panorama is not None}
    unmatched = tuple((p.id, "no pose") for p in panoramas if p.id not in matched)
    unlisted = _unlisted(panoramas, layouts)
    return Scene(
        name=name,
        kind=kind,
        keyframes=tuple(keyframes),
        level_rotation=turn,
        camera_height_m=camera_height_m,
        association=association.rule,
        skipped=(*skipped, *unmatched, *unlisted),
    )


def _walk_order(matches: Sequence[Panorama | None]) -> list[int]:
    """Indices of the poses in the order that their panoramas list.

    A pose without a panorama stays behind the pose before it.
    """
    if any(p is not None and p.order is None for p in matches):
        return list(range(len(matches)))
    keys, last = [], -np.inf
    for panorama in matches:
        last = last if panorama is None or panorama.order is None else float(panorama.order)
        keys.append(last)
    return sorted(range(len(matches)), key=lambda k: keys[k])


def _names(panorama: Panorama) -> tuple[str, ...]:
    return (panorama.id, PurePosixPath(panorama.image).stem)


def _layout_of(panorama: Panorama, layouts: Mapping[str, Path]) -> Path | None:
    return next((layouts[name] for name in _names(panorama) if name in layouts), None)


def _unlisted(
    panoramas: Sequence[Panorama], layouts: Mapping[str, Path]
) -> tuple[tuple[str, str], ...]:
    known = {name for panorama in panoramas for name in _names(panorama)}
    return tuple((name, "layout of no keyframe") for name in layouts if name not in known)


def _read_layout(path: Path | None, reader: LayoutReader) -> tuple[Layout | None, str]:
    if path is None:
        return None, "no layout"
    try:
        return reader(path), ""
    except InputError as error:
        return None, f"unreadable layout: found {error.found}; expected {error.expected}"
