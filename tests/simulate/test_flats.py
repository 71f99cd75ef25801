from itertools import combinations

import numpy as np
import pytest
import shapely

from panoplan.errors import InputError
from panoplan.geometry.polygons import signed_area
from panoplan.simulate.buildings import InteriorRoom, rectangle
from panoplan.simulate.flats import building_from_rooms, make_corridor_building, make_flat

SEEDS = range(60)


@pytest.fixture(scope="module")
def flats():
    return [make_flat(seed, opening_share=0.2) for seed in SEEDS]


def edges(polygon):
    return np.roll(polygon, -1, axis=0) - polygon


def test_rooms_are_simple_counter_clockwise_and_apart(flats):
    for flat in flats:
        areas = [shapely.Polygon(r.polygon) for r in flat.rooms]
        assert all(
            a.is_valid and signed_area(r.polygon) > 2
            for a, r in zip(areas, flat.rooms, strict=True)
        )
        for a, b in combinations(areas, 2):
            assert a.distance(b) > 0.079


def test_rooms_have_no_slivers_and_can_be_walked_in(flats):
    for flat in flats:
        for room in flat.rooms:
            assert np.hypot(*edges(room.polygon).T).min() > 0.45
            inner = shapely.Polygon(room.polygon).buffer(-0.5, join_style="mitre")
            assert isinstance(inner, shapely.Polygon)
            assert not inner.is_empty


def test_passages_lie_on_the_walls_of_both_their_rooms(flats):
    for flat in flats:
        for passage in flat.passages:
            for room, face in zip(passage.rooms, passage.faces, strict=True):
                wall = shapely.Polygon(flat.rooms[room].polygon).exterior
                assert shapely.LineString(face).hausdorff_distance(
                    wall.intersection(shapely.LineString(face).buffer(1e-6))
                ) == pytest.approx(0.0, abs=1e-5)
            # Jambs are square to the wall, the second room lies outwards of the first.
            through = passage.faces[1] - passage.faces[0]
            np.testing.assert_allclose(
                through, [passage.thickness * passage.outward] * 2, atol=1e-9
            )
            assert 0.08 - 1e-9 <= passage.thickness <= 0.25 + 1e-9
            low, high = (0.7, 0.95) if passage.kind == "door" else (1.2, 3.0)
            assert low <= passage.width <= high


def test_passages_cross_no_room_and_no_other_passage(flats):
    for flat in flats:
        floors = [shapely.Polygon(p.area) for p in flat.passages]
        for a, b in combinations(floors, 2):
            assert a.distance(b) > 0.05
        for floor, passage in zip(floors, flat.passages, strict=True):
            for k, room in enumerate(flat.rooms):
                overlap = floor.intersection(shapely.Polygon(room.polygon)).area
                assert overlap < 1e-9, (flat.name, passage.rooms, k)


def test_every_room_can_be_reached(flats):
    for flat in flats:
        assert flat.reachable() == set(range(len(flat.rooms)))
        assert len({p.rooms for p in flat.passages}) == len(flat.passages)


def test_windows_are_on_outer_walls(flats):
    for flat in flats:
        areas = [shapely.Polygon(r.polygon) for r in flat.rooms]
        for window in flat.windows:
            ring = areas[window.room].exterior
            assert all(ring.distance(shapely.Point(p)) < 1e-9 for p in window.segment)
            near = shapely.LineString(window.segment).buffer(0.3)
            others = [a for k, a in enumerate(areas) if k != window.room]
            assert not shapely.intersects(near.buffer(-0.05), others).any()


def test_flats_have_real_sizes():
    flats = [make_flat(seed) for seed in range(200)]
    counts = np.array([len(f.rooms) for f in flats])
    areas = np.array([f.area for f in flats])
    assert counts.min() >= 5
    assert counts.max() <= 9
    assert counts.mean() == pytest.approx(7, abs=0.4)
    assert areas.mean() == pytest.approx(105, abs=15)
    assert 28 < areas.std() < 50
    with_l = np.mean([any(len(r.polygon) > 4 for r in f.rooms) for f in flats])
    assert with_l > 0.5
    openings = sum(len(f.openings) for f in flats) / sum(len(f.passages) for f in flats)
    assert 0.04 < openings < 0.16


@pytest.mark.parametrize("skewed", [False, True])
def test_only_skewed_flats_leave_the_right_angle(skewed):
    off = []
    for seed in range(25):
        flat = make_flat(seed, skewed=skewed)
        along = np.vstack([edges(r.polygon) for r in flat.rooms])
        angle = np.arctan2(along[:, 1], along[:, 0])
        off.append(np.abs(np.angle(np.exp(4j * (angle - angle[0])))).max() / 4)
    if skewed:
        assert np.mean(np.array(off) > np.deg2rad(1.5)) > 0.8
        assert max(off) < np.deg2rad(25)
    else:
        assert max(off) < 1e-6


def test_the_seed_decides():
    first, again, other = make_flat(4), make_flat(4), make_flat(5)
    for a, b in zip(first.rooms, again.rooms, strict=True):
        np.testing.assert_array_equal(a.polygon, b.polygon)
    assert other.area != first.area


def test_number_of_rooms_and_openings_as_asked():
    for rooms in (5, 7, 9):
        assert len(make_flat(1, rooms=rooms).rooms) == rooms
    assert make_flat(2, opening_share=0.0).openings == ()
    with pytest.raises(InputError, match="rooms"):
        make_flat(1, rooms=12)


def test_corridor_building_has_the_rooms_asked_for():
    building = make_corridor_building(40, 1)
    assert sum(r.label == "office" for r in building.rooms) == 40
    assert building.reachable() == set(range(len(building.rooms)))
    areas = [shapely.Polygon(r.polygon) for r in building.rooms]
    assert min(a.distance(b) for a, b in combinations(areas, 2)) > 0.07
    longest = max(np.ptp(r.polygon, axis=0).max() for r in building.rooms)
    assert longest < 20


def test_rooms_too_far_apart_cannot_be_joined():
    rooms = [InteriorRoom("a", rectangle(3, 3)), InteriorRoom("b", rectangle(3, 3, (5, 0)))]
    with pytest.raises(InputError, match="no door can lead"):
        building_from_rooms("two", rooms, 0)
