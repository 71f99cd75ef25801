from itertools import pairwise

import numpy as np
import pytest
import shapely

from panoplan.errors import InputError
from panoplan.geometry.rigid import heading_of
from panoplan.simulate.buildings import Building, InteriorRoom, rectangle
from panoplan.simulate.flats import building_from_rooms, make_corridor_building, make_flat
from panoplan.simulate.walks import locate, stills, walk

SEEDS = range(25)


@pytest.fixture(scope="module")
def walked():
    flats = [make_flat(seed, opening_share=0.2) for seed in SEEDS]
    return [(f, walk(f, np.random.default_rng(k))) for k, f in enumerate(flats)]


def free_space(building):
    rooms = [shapely.Polygon(r.polygon).buffer(1e-6) for r in building.rooms]
    return shapely.union_all([*rooms, *(shapely.Polygon(p.area) for p in building.passages)])


def test_the_path_never_goes_through_a_wall(walked):
    for flat, way in walked:
        walls = free_space(flat).boundary
        path = shapely.LineString(way.path)
        assert free_space(flat).covers(path)
        assert path.distance(walls) > 0.1, flat.name


def test_the_path_keeps_off_the_walls_of_wide_rooms(walked):
    for flat, way in walked:
        room = max((r for r in flat.rooms if r.label != "corridor"), key=lambda r: r.area)
        inside = shapely.contains_xy(shapely.Polygon(room.polygon), *way.path.T)
        ring = shapely.Polygon(room.polygon).exterior
        away = shapely.distance(ring, shapely.points(way.path[inside]))
        assert np.median(away) > 0.4


def test_every_room_is_visited_and_some_are_left_through_the_door_they_were_entered_by(walked):
    returns = 0
    for flat, way in walked:
        changes = way.rooms[np.concatenate([[True], np.diff(way.rooms) != 0])]
        assert set(changes) == set(range(len(flat.rooms)))
        doors = {frozenset(p.rooms) for p in flat.passages}
        assert all({a, b} in doors for a, b in pairwise(changes))
        returns += len(changes) > len(flat.rooms)
    assert returns == len(walked)


def test_doors_are_crossed_in_the_middle_at_a_right_angle(walked):
    crossings = 0
    for flat, way in walked:
        moved = np.gradient(way.path, axis=0)
        for passage in flat.passages:
            inside = shapely.contains_xy(shapely.Polygon(passage.area), *way.path.T)
            if not inside.any():
                continue
            crossings += 1
            along = (passage.faces[0, 1] - passage.faces[0, 0]) / passage.width
            assert np.abs((way.path[inside] - passage.faces.mean(axis=(0, 1))) @ along).max() < 0.01
            assert np.abs(moved[inside] @ along).max() < 1e-3
    assert crossings > 100


def test_keyframes_follow_one_another_at_walking_steps(walked):
    for _, way in walked:
        plan = way.trajectory.translations[:, [0, 2]]
        steps = np.hypot(*np.diff(plan, axis=0).T)
        assert steps.max() <= 0.5 + 1e-9
        assert 0.33 < np.mean(steps) < 0.42


def test_the_camera_looks_where_it_goes_and_turns_smoothly(walked):
    off, turns = [], []
    for _, way in walked:
        plan = way.trajectory.translations[:, [0, 2]]
        headings = np.array([heading_of(r) for r in way.trajectory.rotations])
        moved = np.diff(plan, axis=0)
        motion = np.arctan2(moved[:, 0], moved[:, 1])
        off.append(np.abs(np.angle(np.exp(1j * (headings[:-1] - motion)))))
        turns.append(np.abs(np.angle(np.exp(1j * np.diff(headings)))))
    assert np.median(np.concatenate(off)) < np.deg2rad(15)
    assert np.quantile(np.concatenate(turns), 0.9) < np.deg2rad(50)


def test_the_camera_is_level_and_bobs_by_a_centimetre_or_two(walked):
    for _, way in walked:
        assert 1.4 <= way.camera_height_m <= 1.7
        np.testing.assert_allclose(way.trajectory.rotations[:, 1, 1], 1.0)
        assert 0.008 < way.trajectory.translations[:, 1].std() < 0.025
    heights = [way.camera_height_m for _, way in walked]
    assert np.ptp(heights) > 0.15


def test_tilt_is_as_large_as_asked():
    way = walk(make_flat(1), np.random.default_rng(1), tilt_deg=2.0)
    down = np.arccos(way.trajectory.rotations[:, 1, 1])
    assert np.rad2deg(np.sqrt(np.mean(down**2))) == pytest.approx(2 * np.sqrt(2), rel=0.3)


def test_long_walk_through_forty_rooms():
    building = make_corridor_building(40, 2)
    way = walk(building, np.random.default_rng(0), keyframes_per_room=20)
    assert len(way.trajectory) > 1500
    assert free_space(building).covers(shapely.LineString(way.path))
    counts = np.bincount(way.rooms, minlength=len(building.rooms))
    assert counts.min() >= 18


def test_stills_are_few_and_inside_their_rooms():
    for seed in range(10):
        flat = make_flat(seed)
        tour = stills(flat, np.random.default_rng(seed), per_room=(1, 3))
        counts = np.bincount(tour.rooms, minlength=len(flat.rooms))
        assert counts.min() >= 1
        assert counts.max() <= 3
        for position, room in zip(tour.trajectory.translations[:, [0, 2]], tour.rooms, strict=True):
            ring = shapely.Polygon(flat.rooms[room].polygon)
            assert ring.contains(shapely.Point(position))
            assert ring.exterior.distance(shapely.Point(position)) > 0.3


def test_more_stills_stand_in_doorways():
    flat = make_flat(3)
    usual, more = (stills(flat, np.random.default_rng(3), doorways=k) for k in (0, 3))
    places = more.trajectory.translations[:, [0, 2]]
    assert len(places) == len(usual.trajectory) + 3
    middles = np.array([p.area.mean(axis=0) for p in flat.passages])
    nearest = np.hypot(*(places[-3:, None] - middles).transpose(2, 0, 1)).argmin(axis=1)
    assert places[-3:] == pytest.approx(middles[nearest])
    assert len(set(nearest)) == 3


def test_a_camera_in_a_doorway_is_in_the_room_it_looks_into():
    rooms = [InteriorRoom("a", rectangle(3, 3)), InteriorRoom("b", rectangle(3, 3, (3.2, 0)))]
    building = building_from_rooms("two", rooms, 0)
    middle = building.passages[0].faces.mean(axis=(0, 1))
    where = locate(building, np.array([middle, middle]), np.array([np.pi / 2, -np.pi / 2]))
    assert where.tolist() == [1, 0]


def test_places_in_walls_and_unreachable_rooms_are_refused():
    rooms = (InteriorRoom("a", rectangle(3, 3)), InteriorRoom("b", rectangle(3, 3, (3.2, 0))))
    building = Building("apart", rooms)
    with pytest.raises(InputError, match="inside a room"):
        locate(building, np.array([[3.1, 1.0]]), np.array([0.0]))
    with pytest.raises(InputError, match="cannot be reached"):
        walk(building, np.random.default_rng(0))
