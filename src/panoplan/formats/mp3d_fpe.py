"""MP3D-FPE: one version of one scene, `<root>/<scene>/<version>/`.

The dataset's own habits are met here: poses in the order of the sorted frame ids, image columns
without the half pixel, numbers as strings in label.json, frame k in row k − 1 of frm_ref.txt.
"""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder, read_text, write_bytes, write_text
from panoplan.formats.horizonnet import WIDTH, at_columns, read_boundaries_npy
from panoplan.formats.schema import read_json
from panoplan.formats.sequence import level_of
from panoplan.formats.tum import read_rows
from panoplan.geometry.polygons import counter_clockwise
from panoplan.types.arrays import FloatArray, frozen_array
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TrueLevels, TruePlan, TrueRoom

_KEYFRAMES = "keyframe_list.txt"
_POSES = "cam_pose_estimated.csv"
_TRUE_POSES = "frm_ref.txt"
_LABEL = "label.json"
# Ours, in label.json of several storeys: the dataset has one a scene.
_FLOORS, _ROOM_LEVELS = "level_floors", "room_levels"
_LAYOUTS = "hn_mp3d"
_LIMIT = 64 * 2**20
_MAX_FRAME = 10_000_000
# How fast HorizonNet's corner probability falls with the distance in columns.
_CORNER_FALL = 0.96


@dataclass(frozen=True, eq=False)
class Mp3dFpe:
    """What a run may know of one version of one scene.

    Attributes:
        name: "<scene>_<version>".
        trajectory: odometry of the keyframes that have a pose, labelled with their frame id, in
            the order of the sorted ids; any unit.
        skipped: (id, reason) of the keyframes without a pose.
        layouts: the folder of the layouts `<id>.npy`.
    """

    name: str
    trajectory: Trajectory
    skipped: tuple[tuple[str, str], ...]
    layouts: Path


def odometry_folder(folder: Path) -> Path | None:
    """The first folder, by name, that matches vo* and lists keyframes; None where none does."""
    if not folder.is_dir():
        return None
    found = (path for path in sorted(folder.glob("vo*")) if (path / _KEYFRAMES).is_file())
    return next(found, None)


def read_mp3d_fpe(folder: Path) -> Mp3dFpe:
    """Reads keyframes and odometry; no truth.

    Args:
        folder: `<root>/<scene>/<version>`.

    Returns:
        The keyframes. A row of cam_pose_estimated.csv with NaN or an all-zero quaternion is a
        keyframe without a pose and shifts no other.

    Raises:
        InputError: no vo* folder; a file missing, empty, or truncated; ids that are no numbers or
            stand twice; not one pose an id; a quaternion neither unit nor zero; no valid pose.
    """
    odometry = odometry_folder(folder)
    if odometry is None:
        raise InputError(folder, "no keyframe list", f"a folder vo*/ with {_KEYFRAMES}")
    ids = _keyframe_ids(odometry / _KEYFRAMES)
    _, rows = read_rows(odometry / _POSES)
    if len(rows) != len(ids):
        raise InputError(
            odometry / _POSES, f"{len(rows)} poses", f"{len(ids)}, one a line of {_KEYFRAMES}"
        )
    trajectory, skipped = _valid_poses(ids, rows, odometry / _POSES)
    if trajectory is None:
        raise InputError(odometry / _POSES, "no valid pose", "at least one")
    place = folder.resolve()
    return Mp3dFpe(f"{place.parent.name}_{place.name}", trajectory, skipped, odometry / _LAYOUTS)


def read_mp3d_fpe_layout(path: Path) -> Layout:
    """Reads a layout of hn_mp3d/, whose column u looks along 2πu/W − π.

    Raises:
        InputError: as `read_boundaries_npy`.
    """
    return read_boundaries_npy(path, pixel_centre=0.0)


def read_mp3d_fpe_truth(folder: Path) -> GroundTruth:
    """Reads the truth: label.json, and frm_ref.txt at the keyframes.

    Args:
        folder: `<root>/<scene>/<version>`.

    Returns:
        The truth; its trajectory is labelled with the frame ids and leaves out frames whose true
        pose is invalid; None where there is no frm_ref.txt.

    Raises:
        InputError: a file that cannot be used, or a keyframe beyond the last frame.
    """
    plan = _true_plan(folder / _LABEL)
    path = folder / _TRUE_POSES
    odometry = odometry_folder(folder)
    if odometry is None or not path.exists():
        return GroundTruth(plan)
    ids = _keyframe_ids(odometry / _KEYFRAMES)
    _, rows = read_rows(path)
    if ids[-1] > len(rows):
        raise InputError(path, f"{len(rows)} frames", f"at least {ids[-1]}, the last keyframe")
    trajectory, _ = _valid_poses(ids, rows[np.array(ids) - 1], path)
    return GroundTruth(plan, trajectory)


def write_mp3d_fpe(
    folder: Path,
    keyframes: Sequence[Keyframe],
    truth: GroundTruth | None = None,
    frames: Trajectory | None = None,
) -> None:
    """Writes one version of one scene, without images, depth and cloud.

    Layouts are resampled to 1024 columns without the half pixel, so a sharp boundary is read
    back a little rounded; corners become peaks of the probability row.

    Args:
        folder: `<root>/<scene>/<version>`, made where it does not exist.
        keyframes: at least one; ids are frame numbers from 1 up, written as "1", "2", ...
        truth: for label.json and frm_ref.txt; its trajectory has one pose a keyframe, in the same
            order, or is None.
        frames: true poses of all frames of the video, labelled with their numbers; without them
            frames that are no keyframes get an invalid pose.

    Raises:
        InputError: no keyframe; ids that are no frame numbers or stand twice; a true trajectory
            of another length; or a place that cannot be written.
    """
    numbers = _frame_numbers(keyframes, folder)
    odometry = folder / "vo_final"
    make_folder(odometry / _LAYOUTS)
    order = np.argsort(numbers)
    poses = {
        numbers[k]: _pose_fields(keyframes[k].pose.rotation, keyframes[k].pose.translation)
        for k in order
    }
    for k in order:
        layout = keyframes[k].layout
        if layout is not None:
            buffer = io.BytesIO()
            np.save(buffer, _boundary_rows(layout), allow_pickle=False)
            write_bytes(odometry / _LAYOUTS / f"{numbers[k]}.npy", buffer.getvalue())
    lines = [",".join([str(frame), *fields]) for frame, fields in poses.items()]
    write_text(odometry / _POSES, "\n".join(lines) + "\n")
    if truth is not None:
        _write_truth(folder, numbers, truth, frames)
    write_text(odometry / _KEYFRAMES, "".join(f"{frame}\n" for frame in poses))


def _keyframe_ids(path: Path) -> tuple[int, ...]:
    ids: set[int] = set()
    for number, line in enumerate(read_text(path, _LIMIT).splitlines(), start=1):
        word = line.split("#", 1)[0].strip()
        if not word:
            continue
        if not (word.isascii() and word.isdigit() and 1 <= len(word) <= 8 and int(word) > 0):
            raise InputError(f"{path}:{number}", repr(word[:40]), "a frame number from 1 up")
        if int(word) in ids:
            raise InputError(f"{path}:{number}", f"the keyframe {word} twice", "one line an id")
        ids.add(int(word))
    if not ids:
        raise InputError(path, "no keyframe", "one frame number a line")
    return tuple(sorted(ids))


def _valid_poses(
    ids: tuple[int, ...], rows: FloatArray, path: Path
) -> tuple[Trajectory | None, tuple[tuple[str, str], ...]]:
    """Poses of the ids whose row is valid, and (id, reason) of the others."""
    unknown = np.asarray(~np.isfinite(rows).all(axis=1))
    lost = np.asarray(~unknown & (rows[:, 3:] == 0).all(axis=1))
    skipped = tuple(
        (str(ids[k]), "no pose: NaN" if unknown[k] else "no pose: all-zero quaternion")
        for k in np.flatnonzero(unknown | lost)
    )
    good = np.flatnonzero(~(unknown | lost))
    if not len(good):
        return None, skipped
    labels = tuple(str(ids[k]) for k in good)
    try:
        trajectory = Trajectory.from_quaternions(labels, rows[good, :3], rows[good, 3:])
    except InputError as error:
        raise InputError(f"{path}, {error.source}", error.found, error.expected) from None
    return trajectory, skipped


def _true_plan(path: Path) -> TruePlan:
    data = read_json(path)
    if not isinstance(data, dict) or not isinstance(data.get("room_corners"), list):
        raise InputError(path, "no list room_corners", "room_corners: a list of polygons")
    rooms = []
    for k, corners in enumerate(data["room_corners"]):
        polygon = _points(corners, f"{path}, room_corners[{k}]")
        if len(polygon) < 3:
            raise InputError(f"{path}, room_corners[{k}]", f"{len(polygon)} corners", "3 or more")
        rooms.append(TrueRoom(f"room_{k + 1:02d}", "", counter_clockwise(polygon)))
    axis = _axis(data.get("axis_corners"), path)
    if _FLOORS not in data:
        return TruePlan(rooms=tuple(rooms), axis=axis)
    floors = frozen_array(f"{path}, {_FLOORS}", data[_FLOORS], (None,))
    told = data.get(_ROOM_LEVELS)
    if not isinstance(told, list) or len(told) != len(rooms):
        raise InputError(f"{path}, {_ROOM_LEVELS}", "not one a room", f"{len(rooms)} levels")
    levels = [level_of(item, len(floors), path, _ROOM_LEVELS) for item in told]
    placed = (replace(room, level=level) for room, level in zip(rooms, levels, strict=True))
    return TruePlan(tuple(placed), axis=axis, levels=TrueLevels(tuple(floors.tolist())))


def _axis(value: Any, path: Path) -> FloatArray | None:
    if value is None:
        return None
    ends = _points(value, f"{path}, axis_corners")
    length = float(np.hypot(*(ends[-1] - ends[0]))) if len(ends) == 2 else 0.0
    if length == 0:
        raise InputError(f"{path}, axis_corners", repr(value)[:80], "two different points")
    return frozen_array("axis", (ends[1] - ends[0]) / length, (2,))


def _points(value: Any, source: str) -> FloatArray:
    """(N, 2) numbers from lists of numbers or numeric strings."""
    if not isinstance(value, list) or not all(isinstance(point, list) for point in value):
        raise InputError(source, type(value).__name__, "a list of [x, z]")
    try:
        numbers = [[float(c) if isinstance(c, str) else c for c in point] for point in value]
    except ValueError as error:
        raise InputError(source, str(error)[:80], "numbers") from None
    return frozen_array(source, numbers, (None, 2))


def _frame_numbers(keyframes: Sequence[Keyframe], folder: Path) -> list[int]:
    if not keyframes:
        raise InputError(folder, "no keyframe", "at least one")
    frames: list[int] = []
    for keyframe in keyframes:
        name = keyframe.id
        if not (name.isascii() and name.isdigit() and str(int(name)) == name and int(name) > 0):
            raise InputError(folder, f"the keyframe id {name!r}", "a frame number from 1 up")
        if int(name) > _MAX_FRAME:
            raise InputError(folder, f"frame {name}", f"at most {_MAX_FRAME}")
        frames.append(int(name))
    if len(set(frames)) < len(frames):
        raise InputError(folder, "a keyframe id twice", "one keyframe an id")
    return frames


def _pose_fields(rotation: FloatArray, translation: FloatArray) -> list[str]:
    quaternion = Rotation.from_matrix(rotation).as_quat()
    return [repr(float(value)) for value in (*translation, *quaternion)]


def _boundary_rows(layout: Layout) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    """(3, 1024) as HorizonNet writes them; a row that is not known is NaN."""
    columns = np.arange(WIDTH, dtype=np.float64)
    source = columns * layout.width / WIDTH - 0.5
    rows = np.full((3, WIDTH), np.nan)
    if layout.ceiling_boundary is not None:
        rows[0] = -at_columns(layout.ceiling_boundary, source)
    rows[1] = -at_columns(layout.floor_boundary, source)
    if layout.corners is not None:
        rows[2] = 0.0
        for corner in (layout.corners + 0.5) * WIDTH / layout.width:
            away = np.abs((columns - corner + WIDTH / 2) % WIDTH - WIDTH / 2)
            rows[2] = np.maximum(rows[2], _CORNER_FALL**away)
    return rows.astype(np.float32)


def _write_truth(
    folder: Path, numbers: list[int], truth: GroundTruth, frames: Trajectory | None
) -> None:
    true = truth.trajectory
    if true is not None:
        if len(true) != len(numbers):
            found = f"{len(true)} true poses of {len(numbers)} keyframes"
            raise InputError(folder, found, "one a keyframe")
        known = _fields_by_number(true, numbers)
        if frames is not None:
            known |= _fields_by_number(frames, [int(label) for label in frames.labels])
        invalid = ["0"] * 7
        lines = [
            " ".join([str(frame), *known.get(frame, invalid)]) for frame in range(1, max(known) + 1)
        ]
        write_text(folder / _TRUE_POSES, "\n".join(lines) + "\n")
    axis = truth.plan.axis
    label = {
        "room_corners": [np.asarray(room.polygon).tolist() for room in truth.plan.rooms],
        "axis_corners": None if axis is None else [[0.0, 0.0], np.asarray(axis).tolist()],
        "version": "1.0",
    }
    if truth.plan.levels is not None:
        label[_FLOORS] = list(truth.plan.levels.floors_m)
        label[_ROOM_LEVELS] = [room.level for room in truth.plan.rooms]
    write_text(folder / _LABEL, json.dumps(label, indent=1) + "\n")


def _fields_by_number(poses: Trajectory, numbers: list[int]) -> dict[int, list[str]]:
    return {
        number: _pose_fields(poses.rotations[k], poses.translations[k])
        for k, number in enumerate(numbers)
    }
