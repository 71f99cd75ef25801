"""The point-cloud baseline on scans made by hand and of a simulated building."""

import numpy as np
import pytest

from panoplan.bench.points.baseline import (
    PointsConfig,
    outline,
    plan_from_points,
    wall_directions,
)
from panoplan.bench.points.maps import maps
from panoplan.bench.points.segmentation import segmented
from panoplan.errors import InputError
from panoplan.metrics.rooms import iou, region
from panoplan.simulate.flats import make_flat
from panoplan.simulate.scan import scanned

L_ROOM = np.array([[0, 0], [6, 0], [6, 3], [3, 3], [3, 5], [0, 5]], dtype=float)
SQUARE = np.array([[-2, 0], [-0.2, 0], [-0.2, 5], [-2, 5]], dtype=float)
CONFIG = PointsConfig()


def turned(ring, degrees):
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return ring @ np.array([[c, s], [-s, c]])


def cloud(*rings, step=0.025, height=2.4):
    """Walls of the rings from floor (y = 1.5) to ceiling, and the floor itself."""
    import shapely

    parts = []
    ups = np.arange(0, height, 0.05)
    for ring in rings:
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            count = int(np.hypot(*(b - a)) / step)
            at = a + np.linspace(0, 1, count)[:, None] * (b - a)
            up = np.tile(ups, (count, 1))
            parts.append(np.stack([np.repeat(at[:, 0], len(ups)), 1.5 - up.ravel(),
                                   np.repeat(at[:, 1], len(ups))], axis=1))  # fmt: skip
        low, high = ring.min(axis=0), ring.max(axis=0)
        x, z = np.meshgrid(*(np.arange(low[k], high[k], 0.05) for k in (0, 1)))
        inside = shapely.contains_xy(shapely.Polygon(ring), x, z)
        parts.append(np.stack([x[inside], np.full(inside.sum(), 1.5), z[inside]], axis=1))
    return np.concatenate(parts)


def test_walls_are_high_and_floor_is_low():
    found = maps(cloud(L_ROOM), 0.05)
    at = np.floor((np.array([[3.0, 0.0], [1.5, 1.5], [5.0, 4.0]]) - found.first_m) / 0.05)
    wall, inside, outside = (tuple(cell) for cell in at.astype(int))
    assert found.walls[wall] > 0.9
    assert (found.walls[inside], found.floor[inside]) == (0.0, True)
    assert (found.walls[outside], found.floor[outside]) == (0.0, False)
    assert np.allclose(found.metres(at), [[3.0, 0.0], [1.5, 1.5], [5.0, 4.0]], atol=0.05)


def test_two_rooms_with_a_wall_between_are_two_and_an_l_is_one():
    found = maps(cloud(L_ROOM, SQUARE), 0.05)
    masks = segmented(found, CONFIG.wall_share, CONFIG.neck, CONFIG.min_area_m2)
    assert [round(mask.sum() * 0.05**2) for mask in masks] == [24, 9]


@pytest.mark.parametrize("degrees", [0.0, 20.0, 67.0])
def test_the_shortest_path_is_the_rooms_outline(degrees):
    ring = turned(L_ROOM, degrees)
    found = maps(cloud(ring), 0.05)
    directions = wall_directions(found)
    apart = np.rad2deg(directions[0]) - degrees
    assert abs((apart + 45) % 90 - 45) <= 0.5
    (mask,) = segmented(found, CONFIG.wall_share, CONFIG.neck, CONFIG.min_area_m2)
    made = outline(found, mask, directions, CONFIG)
    assert iou(region(made), region(ring)) > 0.9
    assert len(made) <= 8


def test_a_simulated_building_is_found_from_its_scan():
    building = make_flat(3, rooms=5, opening_share=0.0)
    plan = plan_from_points(scanned(building, 1.5, 0), (), CONFIG)
    true = [region(room.polygon) for room in building.rooms]
    ours = [region(room.polygon) for room in plan.rooms if room.polygon is not None]
    best = [max(iou(room, other) for other in ours) for room in true]
    assert sorted(best)[1] > 0.7
    assert len(plan.rooms) <= 7


@pytest.mark.parametrize(
    ("points", "told"),
    [
        (np.empty((0, 3)), "no points"),
        (np.array([[0.0, 0, 0], [900.0, 0, 0]]), "900 m at 5 cm a cell"),
    ],
)
def test_scans_that_make_no_map(points, told):
    with pytest.raises(InputError, match=told):
        maps(points, 0.05)
