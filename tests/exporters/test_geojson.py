"""GeoJSON read back by shapely."""

import json

import numpy as np
import pytest
import shapely
from tests.exporters.storeys import ODD_NAMES, two_storeys
from tests.metrics.plans import FLAT, plan, square

from panoplan.errors import InputError
from panoplan.exporters.geojson import Anchor, plan_geojson


def features(made, anchor=None, **wanted):
    data = json.loads(plan_geojson(made, anchor))
    return [
        item
        for item in data["features"]
        if all(item["properties"].get(key) == value for key, value in wanted.items())
    ]


def shape(feature):
    return shapely.from_geojson(json.dumps(feature["geometry"]))


def earth_centred(longitude, latitude):
    """WGS 84 surface point in metres from the earth's centre, by the defining formula."""
    a, f = 6378137.0, 1 / 298.257223563
    e2 = f * (2 - f)
    lon, lat = np.radians([longitude, latitude])
    n = a / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    return np.array(
        [n * np.cos(lat) * np.cos(lon), n * np.cos(lat) * np.sin(lon), n * (1 - e2) * np.sin(lat)]
    )


def test_rooms_have_the_plans_areas_and_levels():
    units = features(two_storeys(), feature_type="unit")
    assert [shape(unit).area for unit in units] == pytest.approx(
        [12.0, 11.4, 10.44, 12.0], rel=1e-3
    )
    assert [unit["properties"]["level"] for unit in units] == [0, 0, 0, 1]
    assert [unit["properties"]["area_m2"] for unit in units] == pytest.approx(
        [shape(unit).area for unit in units], abs=1e-3
    )
    for unit in units:
        area = shape(unit)
        assert area.exterior.is_ccw
        assert not any(hole.is_ccw for hole in area.interiors)


def test_doors_walls_and_cameras():
    made = plan()
    (door,) = features(made, category="door")
    assert shapely.get_coordinates(shape(door)) == pytest.approx(made.doors[0].segment)
    assert door["properties"]["rooms"] == ["room_01", "room_02"]
    assert len(features(made, category="window")) == len(features(made, category="opening")) == 1
    walls = features(made, feature_type="wall")
    assert walls[0]["properties"]["sigma_m"] == 0.02
    assert walls[0]["properties"]["length_sigma_m"] == 0.03
    assert [shape(wall).length for wall in walls[:4]] == pytest.approx([4, 3, 4, 3])
    assert len(features(made, feature_type="camera")) == len(made.trajectory)


def test_local_coordinates_are_told():
    data = json.loads(plan_geojson(plan()))
    assert data["panoplan"]["coordinates"] == "metres of the plan frame"
    assert "inner faces" in data["panoplan"]["area_rule"]


@pytest.mark.parametrize("latitude", [-60.0, 0.0, 48.2, 78.0])
@pytest.mark.parametrize("north_deg", [0.0, 35.0, -120.0])
def test_an_anchor_puts_the_plan_on_the_globe(latitude, north_deg):
    anchor = Anchor(latitude, 16.37, np.radians(north_deg))
    points = np.array([[0.0, 0.0], [30.0, 0.0], [0.0, 30.0], [-20.0, 10.0]])
    globe = anchor.on_globe(points)
    assert globe[0] == pytest.approx([16.37, latitude], abs=1e-12)
    xyz = np.array([earth_centred(*place) for place in globe])
    for one, there in zip(points, xyz, strict=True):
        assert np.linalg.norm(there - xyz[0]) == pytest.approx(np.linalg.norm(one), abs=1e-3)
    # What lies towards north in the plan has the same longitude and a greater latitude.
    heading = np.radians(north_deg)
    up = anchor.on_globe(20.0 * np.array([[np.sin(heading), np.cos(heading)]]))[0]
    assert up[0] == pytest.approx(16.37, abs=1e-9)
    assert up[1] > latitude
    east = anchor.on_globe(20.0 * np.array([[np.cos(heading), -np.sin(heading)]]))[0]
    assert east[0] > 16.37


def test_areas_on_the_globe_are_the_plans():
    anchor = Anchor(48.2, 16.37, 0.6)
    for local, globe in zip(
        features(plan(), feature_type="unit"),
        features(plan(), anchor, feature_type="unit"),
        strict=True,
    ):
        metres = shapely.transform(
            shape(globe),
            lambda lonlat: (
                np.array([earth_centred(*place) for place in lonlat])
                @ np.array(
                    [
                        [
                            -np.sin(np.radians(16.37)),
                            -np.sin(np.radians(48.2)) * np.cos(np.radians(16.37)),
                        ],
                        [
                            np.cos(np.radians(16.37)),
                            -np.sin(np.radians(48.2)) * np.sin(np.radians(16.37)),
                        ],
                        [0.0, np.cos(np.radians(48.2))],
                    ]
                )
            ),
        )
        assert metres.area == pytest.approx(shape(local).area, rel=1e-3)
        assert shape(globe).exterior.is_ccw


@pytest.mark.parametrize("place", [(90.0, 0.0), (0.0, 181.0), (float("nan"), 0.0)])
def test_no_place_on_the_globe(place):
    with pytest.raises(InputError, match="latitude"):
        Anchor(*place)


def test_names_are_data():
    made = plan((*FLAT, square(8, 0, 3.0)), names=ODD_NAMES)
    names = [unit["properties"]["name"] for unit in features(made, feature_type="unit")]
    assert names[1] == "<script>alert(1)</script>"
    assert len(names[3]) <= 60
