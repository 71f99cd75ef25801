"""The sequence folder: sequence.json, trajectory.tum, layouts_pred/, and the truth beside them."""

from __future__ import annotations

import collections
import json
import re
from collections.abc import Iterable, Mapping
from collections.abc import Sequence as Items
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder, write_text
from panoplan.formats.layout_npz import write_layout_npz
from panoplan.formats.schema import read_json
from panoplan.formats.tum import write_tum
from panoplan.geometry.polygons import counter_clockwise
from panoplan.types.arrays import FloatArray, frozen_array
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TrueLevels, TruePlan, TrueRoom

DESCRIPTION = "sequence.json"
TRAJECTORY = "trajectory.tum"
LAYOUTS = "layouts_pred"
TRUE_TRAJECTORY = "trajectory_gt.tum"
TRUE_PLAN = "floorplan_gt.json"
TRUE_LAYOUTS = "layouts_gt"
_NAME_LIMIT = 200


@dataclass(frozen=True)
class SequenceEntry:
    """A keyframe as sequence.json lists it.

    Attributes:
        id: its name, unique.
        image: path of its image within the folder, may be empty.
        order: its place in the walk, unique.
    """

    id: str
    image: str
    order: int


@dataclass(frozen=True)
class Sequence:
    """What a run may know of a sequence.json; every other field in it is truth.

    Attributes:
        name: of the scene.
        layout_size: (H, W) of the layouts, or None.
        camera_height_m: metres, or None.
        keyframes: in the order of the walk.
    """

    name: str
    layout_size: tuple[int, int] | None
    camera_height_m: float | None
    keyframes: tuple[SequenceEntry, ...]


def read_sequence(folder: Path) -> Sequence:
    """Reads the sequence.json of a folder.

    Args:
        folder: a sequence folder.

    Returns:
        Name, layout_size, camera_height and the keyframes' id, image and order; nothing else of
        the file is looked at.

    Raises:
        InputError: not readable, a field of wrong type, or an id or order that stands twice.
    """
    path = folder / DESCRIPTION
    data = _typed(read_json(path), dict, path, "the file")
    size = data.get("layout_size")
    if size is not None and not (
        isinstance(size, list) and len(size) == 2 and all(type(n) is int and n > 0 for n in size)
    ):
        raise InputError(f"{path}, layout_size", repr(size), "[height, width]")
    entries = []
    for k, item in enumerate(_typed(data.get("keyframes", []), list, path, "keyframes")):
        where = f"keyframes[{k}]"
        entry = _typed(item, dict, path, where)
        image = entry.get("image", "")
        entries.append(
            SequenceEntry(
                _name(entry.get("id"), path, f"{where}.id"),
                _name(image, path, f"{where}.image") if image else "",
                _typed(entry.get("order", k), int, path, f"{where}.order"),
            )
        )
    for field in ("id", "order"):
        counts = collections.Counter(getattr(entry, field) for entry in entries)
        twice = [value for value, count in counts.items() if count > 1]
        if twice:
            raise InputError(path, f"two keyframes of {field} {twice[0]}", f"one a {field}")
    return Sequence(
        _name(data.get("name", folder.resolve().name or "scene"), path, "name"),
        None if size is None else (size[0], size[1]),
        _height(data.get("camera_height"), path),
        tuple(sorted(entries, key=lambda entry: entry.order)),
    )


def write_sequence(
    folder: Path,
    name: str,
    keyframes: Items[Keyframe],
    truth: GroundTruth | None = None,
    camera_height_m: float | None = None,
    images: Mapping[str, str] | None = None,
    true_layouts: Iterable[Layout] | None = None,
) -> None:
    """Writes a sequence folder; sequence.json, which makes it one, comes last.

    Args:
        folder: made where it does not exist.
        name: of the scene.
        keyframes: in the order of the walk; ids are used as file names.
        truth: written to floorplan_gt.json and trajectory_gt.tum; its trajectory has one pose a
            keyframe, in the same order, or is None.
        camera_height_m: metres, or None.
        images: path within the folder of each keyframe's image, by its id, where there are any.
        true_layouts: of each keyframe, written to layouts_gt/, where they are known.

    Raises:
        InputError: no keyframe, ids that stand twice or are no file names, a true trajectory of
            another length, or a place that cannot be written.
    """
    _check_ids(keyframes, folder)
    make_folder(folder / LAYOUTS)
    orders = tuple(str(k) for k in range(len(keyframes)))
    widths = []
    for keyframe in keyframes:
        if keyframe.layout is not None:
            widths.append(keyframe.layout.width)
            write_layout_npz(folder / LAYOUTS / f"{keyframe.id}.npz", keyframe.layout)
    write_tum(
        folder / TRAJECTORY,
        Trajectory(
            orders,
            np.array([k.pose.rotation for k in keyframes]),
            np.array([k.pose.translation for k in keyframes]),
        ),
    )
    if truth is not None:
        _write_truth(folder, truth, orders)
    if true_layouts is not None:
        make_folder(folder / TRUE_LAYOUTS)
        for keyframe, layout in zip(keyframes, true_layouts, strict=True):
            write_layout_npz(folder / TRUE_LAYOUTS / f"{keyframe.id}.npz", layout)
    description = {
        "name": name,
        "layout_size": [widths[0] // 2, widths[0]] if len(set(widths)) == 1 else None,
        "camera_height": camera_height_m,
        "keyframes": [
            {"id": k.id, "order": n} | ({"image": images[k.id]} if images else {})
            for n, k in enumerate(keyframes)
        ],
    }
    write_text(folder / DESCRIPTION, json.dumps(description, ensure_ascii=False, indent=1) + "\n")


def read_true_plan(path: Path) -> TruePlan:
    """Reads floorplan_gt.json.

    Args:
        path: `rooms`, `rooms_partial` (objects with id, label, polygon, holes, level), `doors`,
            `windows`, `openings` (segments, as annotated in `segments_raw` where the file has
            that), `axis`, `camera_height`; metres, plan frame; and of several storeys `levels`:
            `floors`, and the level of each of `doors`, `openings`, `windows`.

    Returns:
        The true plan, polygons counter-clockwise.

    Raises:
        InputError: not readable, or a room that is no polygon.
    """
    data = _typed(read_json(path), dict, path, "the file")
    raw = _typed(data.get("segments_raw") or {}, dict, path, "segments_raw")
    axis = data.get("axis")
    plan = TruePlan(
        rooms=_rooms(data.get("rooms", []), path, "rooms"),
        rooms_partial=_rooms(data.get("rooms_partial", []), path, "rooms_partial"),
        doors=_segments(raw.get("doors", data.get("doors", [])), path, "doors"),
        openings=_segments(raw.get("openings", data.get("openings", [])), path, "openings"),
        windows=_segments(raw.get("windows", data.get("windows", [])), path, "windows"),
        axis=None if axis is None else frozen_array(f"{path}, axis", axis, (2,)),
        camera_height_m=_height(data.get("camera_height"), path),
    )
    return replace(plan, levels=_levels(data.get("levels"), plan, path))


def _levels(value: Any, plan: TruePlan, path: Path) -> TrueLevels | None:
    if value is None:
        return None
    data = _typed(value, dict, path, "levels")
    floors = frozen_array(f"{path}, levels.floors", data.get("floors", []), (None,))
    of = {
        kind: tuple(
            level_of(item, len(floors), path, f"levels.{kind}[{k}]")
            for k, item in enumerate(_typed(data.get(kind, []), list, path, f"levels.{kind}"))
        )
        for kind in ("doors", "openings", "windows")
    }
    for kind, levels in of.items():
        if len(levels) != len(getattr(plan, kind)):
            expected = f"{len(getattr(plan, kind))}, one each"
            raise InputError(f"{path}, levels.{kind}", f"{len(levels)} levels", expected)
    for room in (*plan.rooms, *plan.rooms_partial):
        level_of(room.level, len(floors), path, f"level of {room.id}")
    return TrueLevels(tuple(floors.tolist()), of["doors"], of["openings"], of["windows"])


def level_of(value: Any, count: int, path: Path, where: str) -> int:
    """A storey that a file tells, one of `count`.

    Raises:
        InputError: it is none of them.
    """
    if type(value) is not int or not 0 <= value < count:
        raise InputError(f"{path}, {where}", repr(value)[:80], f"a level from 0 to {count - 1}")
    return value


def write_true_plan(path: Path, plan: TruePlan) -> None:
    """Writes floorplan_gt.json.

    Raises:
        InputError: the place cannot be written.
    """

    def rooms(items: tuple[TrueRoom, ...]) -> list[dict[str, Any]]:
        return [
            {
                "id": room.id,
                "label": room.label,
                "polygon": np.asarray(room.polygon).tolist(),
                "holes": [np.asarray(hole).tolist() for hole in room.holes],
            }
            | ({} if plan.levels is None else {"level": room.level})
            for room in items
        ]

    data = {
        "axes": "plan [x, y] = [X, Z] of the world of trajectory_gt.tum; metres",
        "rooms": rooms(plan.rooms),
        "rooms_partial": rooms(plan.rooms_partial),
        "doors": [np.asarray(s).tolist() for s in plan.doors],
        "windows": [np.asarray(s).tolist() for s in plan.windows],
        "openings": [np.asarray(s).tolist() for s in plan.openings],
        "axis": None if plan.axis is None else np.asarray(plan.axis).tolist(),
        "camera_height": plan.camera_height_m,
    }
    if plan.levels is not None:
        data["levels"] = {
            "floors": plan.levels.floors_m,
            "doors": plan.levels.doors,
            "openings": plan.levels.openings,
            "windows": plan.levels.windows,
        }
    write_text(path, json.dumps(data, ensure_ascii=False, indent=1) + "\n")


def _write_truth(folder: Path, truth: GroundTruth, labels: tuple[str, ...]) -> None:
    true = truth.trajectory
    if true is not None:
        if len(true) != len(labels):
            found = f"{len(true)} true poses of {len(labels)} keyframes"
            raise InputError(folder, found, "one a keyframe")
        write_tum(folder / TRUE_TRAJECTORY, Trajectory(labels, true.rotations, true.translations))
    write_true_plan(folder / TRUE_PLAN, truth.plan)


def _check_ids(keyframes: Items[Keyframe], folder: Path) -> None:
    if not keyframes:
        raise InputError(folder, "no keyframe", "at least one")
    for keyframe, count in collections.Counter(k.id for k in keyframes).items():
        if count > 1:
            raise InputError(folder, f"two keyframes named {keyframe}", "one keyframe an id")
        if not re.fullmatch(r"[^\W_][\w.\-]{0,199}", keyframe):
            expected = "letters, digits, '.', '-' and '_', for a file's name"
            raise InputError(folder, f"the keyframe id {keyframe!r}", expected)


def _rooms(items: Any, path: Path, where: str) -> tuple[TrueRoom, ...]:
    rooms = []
    for k, item in enumerate(_typed(items, list, path, where)):
        room = _typed(item, dict, path, f"{where}[{k}]")
        name = f"{path}, {where}[{k}].polygon"
        polygon = frozen_array(name, room.get("polygon", []), (None, 2))
        if len(polygon) < 3:
            raise InputError(name, f"{len(polygon)} corners", "at least 3")
        holes = tuple(
            frozen_array(f"{name} hole", hole, (None, 2))
            for hole in _typed(room.get("holes", []), list, path, f"{where}[{k}].holes")
        )
        rooms.append(
            TrueRoom(
                str(room.get("id", f"{where}_{k}")),
                str(room.get("label", "")),
                counter_clockwise(polygon),
                holes,
                _typed(room.get("level", 0), int, path, f"{where}[{k}].level"),
            )
        )
    return tuple(rooms)


def _segments(items: Any, path: Path, where: str) -> tuple[FloatArray, ...]:
    return tuple(
        frozen_array(f"{path}, {where}[{k}]", item, (2, 2))
        for k, item in enumerate(_typed(items, list, path, where))
    )


def _height(value: Any, path: Path) -> float | None:
    if value is not None and not (type(value) in (int, float) and 0 < value < 100):
        raise InputError(f"{path}, camera_height", repr(value), "metres, above 0")
    return None if value is None else float(value)


def _name(value: Any, path: Path, where: str) -> str:
    text: str = _typed(value, str, path, where)
    if not (text.isprintable() and 0 < len(text) <= _NAME_LIMIT):
        found = repr(text[:40])
        raise InputError(f"{path}, {where}", found, f"1 to {_NAME_LIMIT} printable characters")
    return text


def _typed(value: Any, kind: type, path: Path, where: str) -> Any:
    if not isinstance(value, kind) or isinstance(value, bool):
        raise InputError(f"{path}, {where}", type(value).__name__, kind.__name__)
    return value
