"""edits.json: the edits of the plan.json beside it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.editing.apply import Edited, apply
from panoplan.formats.atomic import write_text
from panoplan.formats.plan_json import read_plan
from panoplan.formats.schema import check, read_json
from panoplan.types.arrays import frozen_array
from panoplan.types.edits import (
    Edits,
    KnownDoorHeight,
    KnownLength,
    Nudge,
    RoomMark,
    RoomName,
    WallMark,
)

SCHEMA = 1
"""Version of the schema that is written and read."""

EDITS = "edits.json"
_DIGITS = 6


def read_edited(plan: Path) -> Edited:
    """Reads a plan and applies the edits in the file edits.json beside it, if there is one.

    Raises:
        InputError: either is not readable or not as its schema wants it, or an edit cannot be done.
    """
    return apply(read_plan(plan), read_edits(plan.with_name(EDITS)))


def read_edits(path: Path) -> Edits:
    """Reads edits; a file that does not exist holds none.

    Raises:
        InputError: not readable or not as the schema wants it.
    """
    if not path.exists():
        return Edits()
    data = read_json(path)
    check(data, path, "edits.schema.json", SCHEMA, "edits")
    return Edits(
        data["units_per_su"],
        tuple(RoomName(_room(item["room"]), item["name"]) for item in data["names"]),
        tuple(KnownLength(_wall(item["wall"]), item["metres"]) for item in data["lengths"]),
        tuple(Nudge(_wall(item["wall"]), item["metres"]) for item in data["nudges"]),
        tuple(
            KnownDoorHeight(
                _wall(item["door"]),
                item["metres"],
                item["keyframe"],
                item["elevation"],
                item["sigma"],
            )
            for item in data["door_heights"]
        ),
    )


def write_edits(path: Path, edits: Edits) -> None:
    """Writes edits; the same edits give the same bytes.

    Raises:
        InputError: the place cannot be written.
    """
    data = {
        "schema": SCHEMA,
        "units_per_su": edits.units_per_su,
        "names": [
            {
                "room": {
                    "id": item.room.id,
                    "level": item.room.level,
                    "polygon": np.round(item.room.polygon, _DIGITS).tolist(),
                },
                "name": item.name,
            }
            for item in edits.names
        ],
        "lengths": [{"wall": _mark(e.wall), "metres": e.metres} for e in edits.lengths],
        "nudges": [{"wall": _mark(e.wall), "metres": e.metres} for e in edits.nudges],
        "door_heights": [
            {
                "door": _mark(item.door),
                "metres": item.metres,
                "keyframe": item.keyframe,
                "elevation": item.elevation,
                "sigma": item.sigma,
            }
            for item in edits.door_heights
        ],
    }
    write_text(path, json.dumps(data, ensure_ascii=False, allow_nan=False, indent=1) + "\n")


def _mark(wall: WallMark) -> dict[str, Any]:
    a, b = np.round([wall.a, wall.b], _DIGITS).tolist()
    return {"id": wall.id, "level": wall.level, "a": a, "b": b}


def _wall(data: dict[str, Any]) -> WallMark:
    ends = frozen_array("wall", [data["a"], data["b"]], (2, 2))
    return WallMark(data["id"], data["level"], *ends)


def _room(data: dict[str, Any]) -> RoomMark:
    polygon = frozen_array("polygon", data["polygon"], (None, 2))
    return RoomMark(data["id"], data["level"], polygon)
