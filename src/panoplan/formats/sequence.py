"""The sequence folder: sequence.json, trajectory.tum, layouts_pred/, and the truth beside them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.atomic import read_text
from panoplan.geometry.polygons import counter_clockwise
from panoplan.types.arrays import FloatArray, frozen_array
from panoplan.types.truth import TruePlan, TrueRoom

_LIMIT = 64 * 2**20


@dataclass(frozen=True)
class SequenceEntry:
    """A keyframe as sequence.json lists it."""

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
        keyframes: in the file's order.
    """

    name: str
    layout_size: tuple[int, int] | None
    camera_height_m: float | None
    keyframes: tuple[SequenceEntry, ...]


def read_json(path: Path) -> Any:
    """Reads a JSON file.

    Raises:
        InputError: missing, empty, too large, or broken (with the line).
    """
    text = read_text(path, _LIMIT)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"{path}:{error.lineno}", f"broken JSON ({error.msg})", "JSON") from None
    except RecursionError:
        raise InputError(path, "JSON nested too deeply", "JSON") from None


def read_sequence(path: Path) -> Sequence:
    """Reads sequence.json.

    Raises:
        InputError: not readable, or a field of wrong type.
    """
    data = _typed(read_json(path), dict, path, "the file")
    size = data.get("layout_size")
    if size is not None and not (
        isinstance(size, list) and len(size) == 2 and all(type(n) is int and n > 0 for n in size)
    ):
        raise InputError(f"{path}, layout_size", repr(size), "[height, width]")
    height = data.get("camera_height")
    if height is not None and not (type(height) in (int, float) and 0 < height < 100):
        raise InputError(f"{path}, camera_height", repr(height), "metres, above 0")
    entries = []
    for k, item in enumerate(_typed(data.get("keyframes", []), list, path, "keyframes")):
        where = f"keyframes[{k}]"
        entry = _typed(item, dict, path, where)
        entries.append(
            SequenceEntry(
                _typed(entry.get("id"), str, path, f"{where}.id"),
                _typed(entry.get("image", ""), str, path, f"{where}.image"),
                _typed(entry.get("order", k), int, path, f"{where}.order"),
            )
        )
    return Sequence(
        _typed(data.get("name", path.parent.name), str, path, "name"),
        None if size is None else (size[0], size[1]),
        None if height is None else float(height),
        tuple(entries),
    )


def read_true_plan(path: Path) -> TruePlan:
    """Reads floorplan_gt.json.

    Raises:
        InputError: not readable, or a room that is no polygon.
    """
    data = _typed(read_json(path), dict, path, "the file")
    raw = data.get("segments_raw") or {}
    height = data.get("camera_height")
    return TruePlan(
        rooms=_rooms(data.get("rooms", []), path, "rooms"),
        rooms_partial=_rooms(data.get("rooms_partial", []), path, "rooms_partial"),
        doors=_segments(data.get("doors", []), path, "doors"),
        openings=_segments(raw.get("openings", data.get("openings", [])), path, "openings"),
        windows=_segments(data.get("windows", []), path, "windows"),
        camera_height_m=None if height is None else float(height),
    )


def _rooms(items: Any, path: Path, where: str) -> tuple[TrueRoom, ...]:
    rooms = []
    for k, item in enumerate(_typed(items, list, path, where)):
        room = _typed(item, dict, path, f"{where}[{k}]")
        name = f"{path}, {where}[{k}].polygon"
        polygon = frozen_array(name, room.get("polygon", []), (None, 2))
        if len(polygon) < 3:
            raise InputError(name, f"{len(polygon)} corners", "at least 3")
        holes = tuple(
            frozen_array(f"{name} hole", hole, (None, 2)) for hole in room.get("holes", [])
        )
        rooms.append(
            TrueRoom(
                str(room.get("id", f"{where}_{k}")),
                str(room.get("label", "")),
                counter_clockwise(polygon),
                holes,
            )
        )
    return tuple(rooms)


def _segments(items: Any, path: Path, where: str) -> tuple[FloatArray, ...]:
    return tuple(
        frozen_array(f"{path}, {where}[{k}]", np.asarray(item, dtype=float), (2, 2))
        for k, item in enumerate(_typed(items, list, path, where))
    )


def _typed(value: Any, kind: type, path: Path, where: str) -> Any:
    if not isinstance(value, kind) or isinstance(value, bool):
        raise InputError(f"{path}, {where}", type(value).__name__, kind.__name__)
    return value
