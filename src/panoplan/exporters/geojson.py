"""A plan as GeoJSON, in metres of its own frame or on the globe."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.exporters.labels import printable
from panoplan.exporters.sheet.title import AREA_RULE
from panoplan.exporters.storeys import Storey, metric_storeys, room_area
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Aperture, FloorPlan, Room

_WGS84_AXIS_M = 6378137.0
_WGS84_ECCENTRICITY2 = 6.69437999014e-3
_FARTHEST_LATITUDE = 89.0


@dataclass(frozen=True)
class Anchor:
    """Where the plan's origin lies on the globe.

    Attributes:
        latitude_deg: of WGS 84, within ±89.
        longitude_deg: within ±180.
        north: rad, heading of north in the plan, from its second axis towards its first.
    """

    latitude_deg: float
    longitude_deg: float
    north: float = 0.0

    def __post_init__(self) -> None:
        """Refuses what is no place."""
        if not (
            abs(self.latitude_deg) <= _FARTHEST_LATITUDE
            and abs(self.longitude_deg) <= 180.0
            and np.isfinite(self.north)
        ):
            raise InputError(
                "anchor",
                f"{self.latitude_deg:g}, {self.longitude_deg:g}, north {self.north:g}",
                "a latitude within ±89° and a longitude within ±180°",
            )

    def on_globe(self, points: FloatArray) -> FloatArray:
        """(N, 2) points of the plan as (longitude, latitude) in degrees.

        The plane that touches WGS 84 at the anchor: off by less than a millimetre at 100 m.
        """
        c, s = np.cos(self.north), np.sin(self.north)
        east, north = (np.asarray(points) @ np.array([[c, s], [-s, c]])).T
        latitude = np.radians(self.latitude_deg)
        bulge = 1.0 - _WGS84_ECCENTRICITY2 * np.sin(latitude) ** 2
        across = _WGS84_AXIS_M / np.sqrt(bulge)
        along = across * (1.0 - _WGS84_ECCENTRICITY2) / bulge
        turned = np.radians(self.longitude_deg) + east / (across * np.cos(latitude))
        return np.asarray(np.degrees(np.stack([turned, latitude + north / along], axis=1)))


def plan_geojson(plan: FloorPlan, anchor: Anchor | None = None) -> bytes:
    """A plan as a GeoJSON FeatureCollection.

    Rooms are polygons of `feature_type` "unit", doors, openings and windows lines of "opening",
    wall faces lines of "wall", cameras points of "camera"; each has its `level`. Without an anchor
    coordinates are metres of the plan frame, told by the member `panoplan.coordinates`, and no
    longitudes.

    Raises:
        InputError: not metric or without rooms.
    """
    placed = _local if anchor is None else anchor.on_globe
    digits = 4 if anchor is None else 9
    features = [
        feature for floor in metric_storeys(plan) for feature in _features(floor, placed, digits)
    ]
    data = {
        "type": "FeatureCollection",
        "panoplan": {
            "coordinates": "metres of the plan frame" if anchor is None else "WGS 84",
            "area_rule": AREA_RULE,
            "metres_by": None if plan.metric is None else plan.metric.source,
            "scale_sigma": None if plan.metric is None else round(plan.metric.sigma, 6),
            "version": printable(plan.version),
        },
        "features": features,
    }
    return (json.dumps(data, ensure_ascii=False, allow_nan=False, indent=1) + "\n").encode()


def _local(points: FloatArray) -> FloatArray:
    return np.asarray(points)


def _features(
    floor: Storey, placed: Callable[[FloatArray], FloatArray], digits: int
) -> Iterable[dict[str, Any]]:
    def feature(kind: str, geometry: Any, key: str, /, **properties: Any) -> dict[str, Any]:
        on_map = shapely.transform(geometry, placed)
        return {
            "type": "Feature",
            "id": key,
            "geometry": _rounded(shapely.geometry.mapping(on_map), digits),
            "properties": {"feature_type": kind, "level": floor.level, **properties},
        }

    for room in floor.rooms:
        # GeoJSON wants outer rings counter-clockwise and holes clockwise.
        area = shapely.orient_polygons(room_area(room))
        yield feature("unit", area, room.id, **_room_properties(room, area))
        for wall in room.walls:
            line = shapely.LineString([wall.a, wall.b])
            own = {"sigma_m": wall.sigma, "length_sigma_m": wall.length_sigma}
            yield feature("wall", line, wall.id, room=room.id, **own)
    kinds: tuple[tuple[str, tuple[Aperture, ...]], ...] = (
        ("door", floor.doors),
        ("opening", floor.openings),
        ("window", floor.windows),
    )
    for category, items in kinds:
        for item in items:
            line = shapely.LineString(item.segment)
            rooms, sources = list(item.rooms), list(item.sources)
            yield feature("opening", line, item.id, category=category, rooms=rooms, sources=sources)
    for camera in floor.cameras:
        yield feature("camera", shapely.Point(camera.position), camera.id, room=camera.room)


def _room_properties(room: Room, area: Any) -> dict[str, Any]:
    return {
        "name": printable(room.name),
        "area_m2": round(float(area.area), 4),
        "area_sigma_m2": room.area_sigma,
        "ceiling_height_m": room.ceiling_height,
        "keyframes": len(room.keyframes),
    }


def _rounded(value: Any, digits: int) -> Any:
    if isinstance(value, float):
        return round(value, digits) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(item, digits) for key, item in value.items()}
    return [_rounded(item, digits) for item in value] if isinstance(value, list | tuple) else value
