"""plan.json: the canonical plan, from which everything else is made."""

from __future__ import annotations

import functools
import json
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.atomic import write_text
from panoplan.formats.sequence import read_json
from panoplan.geometry.polygons import signed_area
from panoplan.types.arrays import FloatArray, frozen_array
from panoplan.types.plan import FloorPlan, PlanPose, Room, ScaleEstimate, Skipped, Wall

SCHEMA = 1
_DIGITS = 6
_AXES = (
    "plan [x, y] = [X, Z] of the trajectory's level world times the scale; polygons run "
    "counter-clockwise in it; heading in rad from +y towards +x"
)


def write_plan(path: Path, plan: FloorPlan) -> None:
    """Writes a plan; the same plan gives the same bytes.

    Raises:
        InputError: the place cannot be written.
    """
    write_text(path, json.dumps(plan_to_dict(plan), ensure_ascii=False, indent=1) + "\n")


def read_plan(path: Path) -> FloorPlan:
    """Reads a plan.

    Raises:
        InputError: not readable, or not as the schema wants it.
    """
    data = read_json(path)
    _validate(data, path)
    return plan_from_dict(data)


def plan_to_dict(plan: FloorPlan) -> dict[str, Any]:
    """The plan as plain values, lengths and angles rounded to 1e-6."""
    scale = plan.scale
    return {
        "schema": SCHEMA,
        "version": plan.version,
        "unit": plan.unit,
        "frame": {"axes": _AXES, "level_rotation": _numbers(plan.level_rotation, 12)},
        "camera_height_m": plan.camera_height_m,
        "scale": {
            "ch_per_su": scale.ch_per_su,
            "method": scale.method,
            "sigma": scale.sigma,
            "search_range": None if scale.search_range is None else list(scale.search_range),
            "at_edge": scale.at_edge,
            "converged": scale.converged,
            "keyframes_used": scale.keyframes_used,
            "curve": None if scale.curve is None else _numbers(scale.curve, 12),
        },
        "rooms": [_room_to_dict(room) for room in plan.rooms],
        "doors": [_numbers(s) for s in plan.doors],
        "openings": [_numbers(s) for s in plan.openings],
        "windows": [_numbers(s) for s in plan.windows],
        "trajectory": [
            {
                "id": pose.id,
                "position": _numbers(pose.position),
                "heading": round(pose.heading, _DIGITS),
                "room": pose.room,
            }
            for pose in plan.trajectory
        ],
        "skipped": [
            {"keyframe": s.keyframe, "what": s.what, "reason": s.reason, "count": s.count}
            for s in plan.skipped
        ],
        "settings": plan.settings,
    }


def plan_from_dict(data: dict[str, Any]) -> FloorPlan:
    """The inverse of `plan_to_dict`, for data that the schema has accepted."""
    scale = dict(data["scale"])
    curve, search_range = scale.pop("curve"), scale.pop("search_range")
    return FloorPlan(
        unit=data["unit"],
        level_rotation=frozen_array("level_rotation", data["frame"]["level_rotation"], (3, 3)),
        scale=ScaleEstimate(
            **scale,
            curve=None if curve is None else frozen_array("curve", curve, (None, 2)),
            search_range=None if search_range is None else (search_range[0], search_range[1]),
        ),
        camera_height_m=data["camera_height_m"],
        rooms=tuple(_room_from_dict(room) for room in data["rooms"]),
        trajectory=tuple(
            PlanPose(p["id"], _array(p["position"]), p["heading"], p["room"])
            for p in data["trajectory"]
        ),
        skipped=tuple(Skipped(**item) for item in data["skipped"]),
        doors=tuple(_array(s) for s in data["doors"]),
        openings=tuple(_array(s) for s in data["openings"]),
        windows=tuple(_array(s) for s in data["windows"]),
        settings=data["settings"],
        version=data["version"],
    )


def _room_to_dict(room: Room) -> dict[str, Any]:
    area = None
    if room.polygon is not None:
        # Of the rounded outline, so that a plan read back is written with the same area.
        rings = [np.asarray(_numbers(ring)) for ring in (room.polygon, *room.holes)]
        area = signed_area(rings[0]) - sum(abs(signed_area(hole)) for hole in rings[1:])
    return {
        "id": room.id,
        "name": room.name,
        "level": room.level,
        "polygon": None if room.polygon is None else _numbers(room.polygon),
        "holes": [_numbers(hole) for hole in room.holes],
        "failure": room.failure,
        "area": None if area is None else round(area, _DIGITS),
        "ceiling_height": room.ceiling_height,
        "keyframes": list(room.keyframes),
        "walls": [
            {"id": w.id, "a": _numbers(w.a), "b": _numbers(w.b), "sigma": w.sigma}
            for w in room.walls
        ],
        "orientations": [round(angle, _DIGITS) for angle in room.orientations],
        "flags": list(room.flags),
    }


def _room_from_dict(data: dict[str, Any]) -> Room:
    return Room(
        id=data["id"],
        name=data["name"],
        polygon=None if data["polygon"] is None else _array(data["polygon"]),
        failure=data["failure"],
        keyframes=tuple(data["keyframes"]),
        walls=tuple(
            Wall(w["id"], _array(w["a"]), _array(w["b"]), w["sigma"]) for w in data["walls"]
        ),
        holes=tuple(_array(hole) for hole in data["holes"]),
        ceiling_height=data["ceiling_height"],
        level=data["level"],
        orientations=tuple(data["orientations"]),
        flags=tuple(data["flags"]),
    )


def _numbers(array: FloatArray, digits: int = _DIGITS) -> Any:
    # Adding zero turns -0.0 into 0.0.
    return (np.round(np.asarray(array, dtype=float), digits) + 0.0).tolist()


def _array(values: Any) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    array.setflags(write=False)
    return array


@functools.cache
def _validator() -> Any:
    from jsonschema import Draft202012Validator

    text = resources.files("panoplan.formats").joinpath("plan.schema.json").read_text("utf-8")
    return Draft202012Validator(json.loads(text))


def _validate(data: Any, path: Path) -> None:
    from jsonschema.exceptions import best_match

    error = best_match(_validator().iter_errors(data))
    if error is not None:
        raise InputError(f"{path}, {error.json_path}", error.message[:200], "a plan of schema 1")
