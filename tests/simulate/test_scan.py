"""Scans of simulated buildings."""

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from panoplan.simulate.families import simulate_scene
from panoplan.simulate.flats import make_flat
from panoplan.simulate.scan import scanned


@pytest.fixture(scope="module")
def scene():
    return simulate_scene("flat", 9, "exact")


@pytest.fixture(scope="module")
def clouds(scene):
    """The scan of the empty flat, and of the same furnished; x, z and height above the floor."""

    def cloud(walked):
        points = scanned(scene.building, scene.camera_height_m, 2, walked=walked)
        return np.stack([points[:, 0], points[:, 2], scene.camera_height_m - points[:, 1]], axis=1)

    return cloud(None), cloud(scene.truth.trajectory.translations)


def _amid(scene, points, low, high):
    """The points that stand in rooms, away from walls, floors and ceilings."""
    middle = shapely.union_all([room.floor.buffer(-0.1) for room in scene.building.rooms])
    there = shapely.contains_xy(middle, points[:, :2]) & (points[:, 2] > low)
    return points[there & (points[:, 2] < high), :2]


def test_a_scan_has_gaps_where_doors_are():
    building = make_flat(3, rooms=5, opening_share=0.0)
    points = scanned(building, 1.5, 0)
    door = building.doors[0].faces[0].mean(axis=0)
    near = points[np.hypot(*(points[:, [0, 2]] - door).T) < 0.2]
    up = 1.5 - near[:, 1]
    assert not np.any((up > 0.2) & (up < 1.9))
    assert np.any(up > 2.0)
    assert np.any(up < 0.1)


def test_furniture_stands_where_nobody_walks(scene, clouds):
    empty, furnished = (_amid(scene, points, 0.2, 1.9) for points in clouds)
    assert len(empty) == 0
    assert len(furnished) > 2000
    walked = scene.truth.trajectory.translations[:, [0, 2]]
    assert cKDTree(walked).query(furnished)[0].min() > 0.2


def test_furniture_hides_floor_and_walls(scene, clouds):
    below = [_amid(scene, points, -0.1, 0.06) for points in clouds]
    assert len(below[1]) < 0.99 * len(below[0])
    assert len(below[1]) > 0.7 * len(below[0])
    things = _amid(scene, clouds[1], 0.2, 1.9)
    bare = [
        room for room in scene.building.rooms if not shapely.contains_xy(room.floor, things).any()
    ]
    assert bare
    for room in bare:
        counts = [shapely.contains_xy(room.floor, cloud[:, :2]).sum() for cloud in clouds]
        assert counts[1] > 0.97 * counts[0]


def test_the_same_seed_scans_the_same(scene):
    walked = scene.truth.trajectory.translations
    one, again, other = (scanned(scene.building, 1.5, n, walked=walked) for n in (4, 4, 5))
    assert np.array_equal(one, again)
    assert len(one) != len(other)
