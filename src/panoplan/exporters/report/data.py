"""What a report tells, as plain values for its script."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from panoplan.exporters.drawing import room_colours
from panoplan.exporters.labels import printable, room_label
from panoplan.exporters.metres import metres_told
from panoplan.exporters.sheet.dimensions import wall_length
from panoplan.exporters.sheet.title import AREA_RULE
from panoplan.exporters.storeys import (
    Storey,
    bounds,
    by_faces,
    inner_walls,
    metric_storeys,
    room_area,
    through,
)
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import FloorPlan, Room, ScaleEstimate

_LONGEST_NAME = 200
_LABEL_M = (0.12, 0.32)
"""Font sizes of rooms' names on the plan, least and largest."""


def report_data(plan: FloorPlan, title: str) -> dict[str, Any]:
    """The plan as a report shows it, names cut to 200 characters, lengths in metres.

    Raises:
        InputError: not metric or without rooms.
    """
    floors = metric_storeys(plan)
    colours = room_colours(plan.rooms)
    rooms = [room for floor in floors for room in floor.rooms]
    area = sum(float(room_area(room).area) for room in rooms)
    return {
        "title": _name(title),
        "version": _name(plan.version),
        "summary": f"{len(rooms)} rooms, {area:.1f} m², {len(plan.trajectory)} keyframes",
        "metres": metres_told(plan),
        "area_rule": AREA_RULE,
        "storeys": [_storey(floor, colours) for floor in floors],
        "missing": [
            {
                "name": _name(room.name),
                "storey": f"Level {room.level}",
                "reason": _name(room.failure or "no shape found"),
                "count": len(room.keyframes),
            }
            for room in plan.rooms
            if room.polygon is None
        ],
        "skipped": [
            {
                "keyframe": _name(item.keyframe),
                "what": item.what,
                "reason": _name(item.reason),
                "count": item.count,
            }
            for item in plan.skipped
        ],
        "scale": _scale(plan.scale),
    }


def _name(text: str) -> str:
    return printable(text, _LONGEST_NAME)


def _storey(floor: Storey, colours: dict[str, str]) -> dict[str, Any]:
    low, high = bounds(floor, np.eye(2))
    shared = by_faces(floor)
    cameras = np.array([camera.position for camera in floor.cameras]).reshape(-1, 2)
    kinds = {"doors": floor.doors, "openings": floor.openings, "windows": floor.windows}
    return {
        "name": floor.name,
        "bounds": _points(np.array([low, high])).ravel().tolist(),
        "walls": _rings(inner_walls(floor)),
        "rooms": [_room(room, colours[room.id], cameras) for room in floor.rooms],
        "apertures": {
            kind: [
                {
                    "segment": _points(item.segment).tolist(),
                    "through": round(through(item, shared), 4),
                }
                for item in items
            ]
            for kind, items in kinds.items()
        },
        "cameras": [
            {
                "id": camera.id,
                "position": _points(camera.position).tolist(),
                "heading": round(camera.heading, 5),
                "room": camera.room,
            }
            for camera in floor.cameras
        ],
    }


def _room(room: Room, colour: str, cameras: FloatArray) -> dict[str, Any]:
    area = room_area(room)
    label = room_label(area, _name(room.name), f"{area.area:.1f} m²", 1.0, _LABEL_M, cameras)
    return {
        "id": room.id,
        "name": _name(room.name),
        "colour": colour,
        "area": round(float(area.area), 4),
        "area_sigma": room.area_sigma,
        "perimeter": round(float(area.length), 4),
        "ceiling": room.ceiling_height,
        "rings": _rings(area),
        "label": label
        and {
            "at": _points(label.position).tolist(),
            "lines": label.lines,
            "size": round(label.size_pt, 4),
        },
        "keyframes": [_name(keyframe) for keyframe in room.keyframes],
        "flags": [_name(flag) for flag in room.flags],
        "walls": [
            {
                "id": wall.id,
                "length": round(wall_length(wall), 4),
                "length_sigma": wall.length_sigma,
                "sigma": wall.sigma,
            }
            for wall in room.walls
        ],
    }


def _scale(scale: ScaleEstimate) -> dict[str, Any]:
    told = "The scale of the trajectory is not known."
    if scale.ch_per_su is not None:
        told = f"{scale.ch_per_su:.5g} camera heights a trajectory unit ({scale.method}"
        told += ")" if scale.sigma is None else f", ± {100 * scale.sigma:.2f} %)"
        told += f", from {scale.keyframes_used} keyframes."
        if scale.at_edge:
            told += " It lies at the edge of the range that was searched: do not trust it."
        if not scale.converged:
            told += " It had not settled when the walk ended."
    return {
        "told": told,
        "value": scale.ch_per_su,
        "curve": None if scale.curve is None else scale.curve.tolist(),
        "no_curve": "The scale was given, so no curve was searched."
        if scale.method == "given"
        else "There is no curve of the search.",
    }


def _rings(area: Any) -> list[Any]:
    return [
        _points(shapely.get_coordinates(ring)[:-1]).tolist()
        for part in shapely.get_parts(area)
        if isinstance(part, shapely.Polygon) and not part.is_empty
        for ring in (part.exterior, *part.interiors)
    ]


def _points(points: FloatArray) -> FloatArray:
    return np.round(points, 4) + 0.0
