"""plan.json: the canonical plan, from which everything else is made."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.atomic import write_text
from panoplan.formats.schema import check, not_finite, read_json
from panoplan.geometry.polygons import signed_area
from panoplan.types.arrays import FloatArray, frozen_array
from panoplan.types.plan import (
    Aperture,
    FloorPlan,
    MetricScale,
    PlanPose,
    Room,
    ScaleEstimate,
    SharedWall,
    Skipped,
    Wall,
)

SCHEMA = 1
"""Version of the schema that is written and read."""

_DIGITS = 6
_AXES = (
    "plan [x, y] = [X, Z] of the trajectory's level world times the scale; polygons run "
    "counter-clockwise in it; heading in rad from +y towards +x"
)
_NUMBER_LIST = re.compile(r"\[\n\s+((?:-?[0-9.eE+-]+,?\s+)+)\]")


def write_plan(path: Path, plan: FloorPlan) -> None:
    """Writes a plan; the same plan gives the same bytes.

    Raises:
        InputError: the plan holds NaN or infinity, or the place cannot be written.
    """
    write_text(path, plan_to_text(plan))


def read_plan(path: Path) -> FloorPlan:
    """Reads a plan of at most 64 MiB.

    Raises:
        InputError: not readable, not as the schema wants it (with the JSON path), a number that
            is not finite, or an id that is there twice.
    """
    data = read_json(path)
    check(data, path, "plan.schema.json", SCHEMA, "a plan")
    rooms = data["rooms"]
    walls = [wall for room in rooms for wall in room["walls"]]
    apertures = [*data["doors"], *data["openings"], *data["windows"]]
    for kind, items in (("room", rooms), ("wall", walls), ("aperture", apertures)):
        ids = Counter(item["id"] for item in items)
        twice = next((name for name, count in ids.items() if count > 1), None)
        if twice is not None:
            raise InputError(path, f"{kind} {twice[:60]!r} more than once", "an id for each")
    return plan_from_dict(data)


def plan_to_text(plan: FloorPlan) -> str:
    """The plan as JSON text: lists of numbers on one line, a line break at the end.

    Raises:
        InputError: the plan holds NaN or infinity.
    """
    data = plan_to_dict(plan)
    where = not_finite(data, "$")
    if where is not None:
        raise InputError(f"plan, {where}", "NaN or infinity", "a finite number")
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, indent=1)
    # No string of JSON holds a raw line break, so this touches lists of numbers only.
    return _NUMBER_LIST.sub(lambda match: f"[{' '.join(match[1].split())}]", text) + "\n"


def plan_to_dict(plan: FloorPlan) -> dict[str, Any]:
    """The plan as plain values, as the schema wants it.

    Lengths and angles are rounded to 1e-6 of their unit, the scale and the camera height to 9
    digits; the keys of `settings` are sorted.
    """
    scale = plan.scale
    return {
        "schema": SCHEMA,
        "version": plan.version,
        "unit": plan.unit,
        "frame": {"axes": _AXES, "level_rotation": _numbers(plan.level_rotation, 12)},
        "camera_height_m": _factor(plan.camera_height_m),
        "metric": (
            None
            if plan.metric is None
            else {"source": plan.metric.source, "sigma": _factor(plan.metric.sigma)}
        ),
        "scale": {
            "ch_per_su": _factor(scale.ch_per_su),
            "method": scale.method,
            "sigma": _factor(scale.sigma),
            "search_range": (
                None if scale.search_range is None else [_factor(s) for s in scale.search_range]
            ),
            "at_edge": bool(scale.at_edge),
            "converged": bool(scale.converged),
            "keyframes_used": int(scale.keyframes_used),
            "curve": (
                None
                if scale.curve is None
                else [[_factor(value) for value in pair] for pair in scale.curve]
            ),
        },
        "rooms": [_room_to_dict(room) for room in plan.rooms],
        "shared_walls": [
            {
                "id": wall.id,
                "walls": list(wall.walls),
                "thickness": _length(wall.thickness),
                "measured": wall.measured,
                "solid": wall.solid,
            }
            for wall in plan.shared_walls
        ],
        "doors": [_aperture_to_dict(item) for item in plan.doors],
        "openings": [_aperture_to_dict(item) for item in plan.openings],
        "windows": [_aperture_to_dict(item) for item in plan.windows],
        "trajectory": [
            {
                "id": pose.id,
                "position": _numbers(pose.position),
                "heading": _length(pose.heading),
                "room": pose.room,
            }
            for pose in plan.trajectory
        ],
        "skipped": [
            {"keyframe": s.keyframe, "what": s.what, "reason": s.reason, "count": int(s.count)}
            for s in plan.skipped
        ],
        "settings": _sorted(plan.settings),
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
        metric=None if data["metric"] is None else MetricScale(**data["metric"]),
        rooms=tuple(_room_from_dict(room) for room in data["rooms"]),
        trajectory=tuple(
            PlanPose(p["id"], _array(p["position"]), p["heading"], p["room"])
            for p in data["trajectory"]
        ),
        skipped=tuple(Skipped(**item) for item in data["skipped"]),
        shared_walls=tuple(
            SharedWall(**{**item, "walls": tuple(item["walls"])}) for item in data["shared_walls"]
        ),
        doors=tuple(_aperture_from_dict(item) for item in data["doors"]),
        openings=tuple(_aperture_from_dict(item) for item in data["openings"]),
        windows=tuple(_aperture_from_dict(item) for item in data["windows"]),
        settings=data["settings"],
        version=data["version"],
    )


def _aperture_to_dict(item: Aperture) -> dict[str, Any]:
    return {
        "id": item.id,
        "a": _numbers(item.segment[0]),
        "b": _numbers(item.segment[1]),
        "rooms": list(item.rooms),
        "walls": list(item.walls),
        "sources": list(item.sources),
    }


def _aperture_from_dict(data: dict[str, Any]) -> Aperture:
    return Aperture(
        data["id"],
        _array([data["a"], data["b"]]),
        tuple(data["rooms"]),
        tuple(data["walls"]),
        tuple(data["sources"]),
    )


def _room_to_dict(room: Room) -> dict[str, Any]:
    area = None
    if room.polygon is not None:
        # Of the rounded outline, so that a plan read back is written with the same area.
        rings = [np.asarray(_numbers(ring)) for ring in (room.polygon, *room.holes)]
        holes = sum(abs(signed_area(hole)) for hole in rings[1:])
        area = max(0.0, abs(signed_area(rings[0])) - holes)
    return {
        "id": room.id,
        "name": room.name,
        "level": room.level,
        "polygon": None if room.polygon is None else _numbers(room.polygon),
        "holes": [_numbers(hole) for hole in room.holes],
        "failure": (room.failure or "no shape found") if room.polygon is None else None,
        "area": _length(area),
        "area_sigma": _length(room.area_sigma),
        "ceiling_height": _length(room.ceiling_height),
        "keyframes": list(room.keyframes),
        "walls": [
            {
                "id": wall.id,
                "a": _numbers(wall.a),
                "b": _numbers(wall.b),
                "sigma": _length(wall.sigma),
                "length_sigma": _length(wall.length_sigma),
            }
            for wall in room.walls
        ],
        "orientations": [_length(angle) for angle in room.orientations],
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
            Wall(w["id"], _array(w["a"]), _array(w["b"]), w["sigma"], w.get("length_sigma"))
            for w in data["walls"]
        ),
        holes=tuple(_array(hole) for hole in data["holes"]),
        area_sigma=data["area_sigma"],
        ceiling_height=data["ceiling_height"],
        level=data["level"],
        orientations=tuple(data["orientations"]),
        flags=tuple(data["flags"]),
    )


def _numbers(array: FloatArray, digits: int = _DIGITS) -> Any:
    # Adding zero turns -0.0 into 0.0.
    return (np.round(np.asarray(array, dtype=float), digits) + 0.0).tolist()


def _length(value: float | None) -> float | None:
    return None if value is None else round(float(value), _DIGITS) + 0.0


def _factor(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.9g}")


def _sorted(value: Any) -> Any:
    """Plain values with sorted keys, tuples as lists."""
    if isinstance(value, dict):
        return {str(key): _sorted(value[key]) for key in sorted(value, key=str)}
    return [_sorted(item) for item in value] if isinstance(value, list | tuple) else value


def _array(values: Any) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    array.setflags(write=False)
    return array
