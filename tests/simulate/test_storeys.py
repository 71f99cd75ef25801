"""Buildings of several storeys, the walks up and down in them, and what is made of these."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from panoplan.config import Config
from panoplan.errors import InputError
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk as Known
from panoplan.metrics.report import evaluate
from panoplan.simulate.families import FAMILIES, make_building, simulate_scene
from panoplan.simulate.film import film
from panoplan.simulate.frozen import buildings_digest
from panoplan.simulate.scan import scanned
from panoplan.simulate.walks import stills

BUILDINGS = [(family, seed, 2) for family in FAMILIES for seed in range(3, 8)]


@pytest.fixture(scope="module")
def houses():
    return [make_building(*drawn) for drawn in BUILDINGS]


@pytest.fixture(scope="module")
def tower():
    return make_building("flat", 13, 3)


@pytest.fixture(scope="module")
def small():
    """A walk through a flat of 52 m² on each of two storeys, with measured errors."""
    return simulate_scene("flat", 7, storeys=2)


def test_storeys_stand_upon_one_another(houses):
    for house in houses:
        floors = [
            shapely.union_all([room.floor for room in house.rooms if room.level == level])
            for level in range(2)
        ]
        common = floors[0].intersection(floors[1]).area
        assert common / min(floor.area for floor in floors) > 0.75, house.name
        assert sum(floor.area for floor in floors) == pytest.approx(
            sum(room.floor.area for room in house.rooms)
        )
        highest = max(room.ceiling_height_m for room in house.rooms if room.level == 0)
        assert house.floors_m[1] == pytest.approx(highest + 0.3)


def test_stairs_lie_in_both_rooms_and_can_be_climbed(houses, tower):
    for house in (*houses, tower):
        assert len(house.stairs) == len(house.floors_m) - 1
        for k, stairs in enumerate(house.stairs):
            rooms = [house.rooms[i] for i in stairs.rooms]
            assert [room.level for room in rooms] == [k, k + 1]
            assert all(room.floor.covers(shapely.Polygon(stairs.area)) for room in rooms)
            rise = house.floors_m[k + 1] - house.floors_m[k]
            run = np.hypot(*(stairs.line[1] - stairs.line[0]))
            assert 34 < np.rad2deg(np.arctan2(rise, run)) < 44
            assert not {room.label for room in rooms} & {"bathroom", "closet"}


def test_doors_join_rooms_of_one_storey_and_only_the_first_has_a_front_door(houses):
    for house in houses:
        levels = [room.level for room in house.rooms]
        assert all(levels[a] == levels[b] for a, b in (p.rooms for p in house.passages))
        assert all(levels[door.room] == 0 for door in house.blind_doors)


def test_a_seed_gives_the_same_storeys():
    one, again, other = (make_building("flat", seed, 2) for seed in (4, 4, 5))
    assert buildings_digest([one]) == buildings_digest([again])
    assert buildings_digest([one]) != buildings_digest([other])
    with pytest.raises(InputError, match="1 to 4"):
        make_building("flat", 4, 5)


def test_a_storey_is_a_building_of_its_own(tower):
    for level in range(3):
        first, storey = tower.storey(level)
        assert len(storey.reachable()) == len(storey.rooms)
        same = [room for room in tower.rooms if room.level == level]
        assert [room.label for room in storey.rooms] == [room.label for room in same]
        assert storey.rooms[0].label == tower.rooms[first].label
        assert len(storey.windows) + len(storey.passages) > 0
    assert sum(len(tower.storey(level)[1].windows) for level in range(3)) == len(tower.windows)


@pytest.mark.parametrize("seed", range(4))
def test_a_walk_sees_every_room_and_changes_height_on_stairs_only(tower, seed):
    way = film(tower, np.random.default_rng(seed))
    assert set(way.rooms) == set(range(len(tower.rooms)))
    places = way.frames.translations
    up = -places[:, 1]
    stairs = shapely.union_all([shapely.Polygon(s.area) for s in tower.stairs]).buffer(0.35)
    off = ~shapely.contains_xy(stairs, places[:, 0], places[:, 2])
    assert off.mean() > 0.8
    assert np.abs(up[off, None] - np.array(tower.floors_m)).min(axis=1).max() < 0.08
    # Up and down by steps of a person.
    assert np.abs(np.diff(up)).max() < 0.2
    assert up.max() == pytest.approx(tower.floors_m[2], abs=0.08)
    joined = {frozenset(p.rooms) for p in tower.passages} | {
        frozenset(s.rooms) for s in tower.stairs
    }
    changes = way.rooms[np.concatenate([[True], np.diff(way.rooms) != 0])]
    assert all(frozenset(pair) in joined for pair in pairwise(changes.tolist()))


def test_half_of_the_people_come_down_again(tower):
    ends = [film(tower, np.random.default_rng(seed)).rooms[-1] for seed in range(12)]
    levels = [tower.rooms[room].level for room in ends]
    assert {0, 2} == set(levels)


def test_photos_stand_on_the_floor_of_their_rooms(tower):
    way = stills(tower, np.random.default_rng(0))
    assert set(way.rooms) == set(range(len(tower.rooms)))
    floors = [tower.floor_m(room) for room in way.rooms]
    assert np.abs(-way.trajectory.translations[:, 1] - floors).max() < 0.03
    levels = [tower.rooms[room].level for room in way.rooms]
    assert levels == sorted(levels)


def test_truth_tells_the_storey_of_everything(tower):
    scene = simulate_scene("flat", 13, "exact", as_stills=True, storeys=3)
    plan = scene.truth.plan
    assert [room.level for room in plan.rooms] == [room.level for room in tower.rooms]
    assert plan.levels.floors_m == tower.floors_m
    doors = list(zip(plan.doors, plan.levels.doors, strict=True))
    assert {level for _, level in doors} == {0, 1, 2}
    for kind in ("doors", "openings", "windows"):
        told = zip(getattr(plan, kind), getattr(plan.levels, kind), strict=True)
        for segment, level in told:
            walls = [shapely.LinearRing(r.polygon) for r in plan.rooms if r.level == level]
            assert min(wall.distance(shapely.Point(segment.mean(axis=0))) for wall in walls) < 1e-6


def test_a_scan_has_all_floors_and_the_stairs_go_through(small):
    house, scene = small.building, small
    points = scanned(house, scene.camera_height_m, 0, walked=scene.frames.translations[::10])
    up = scene.camera_height_m - points[:, 1]
    ceiling = house.rooms[house.stairs[0].rooms[0]].ceiling_height_m
    for floor_m in house.floors_m:
        assert np.mean(np.abs(up - floor_m) < 0.05) > 0.05
    inner = shapely.Polygon(house.stairs[0].area).buffer(-0.1)
    over = up[shapely.contains_xy(inner, points[:, 0], points[:, 2])]
    share = np.histogram(over, np.linspace(0.1, house.floors_m[1] - 0.1, 9))[0] / len(over)
    # The flight goes up evenly, through a hole in the ceiling.
    assert share.min() > 0.5 * share.max()
    assert np.mean(np.abs(over - ceiling) < 0.05) < 0.1


@pytest.mark.parametrize(
    ("storeys", "as_stills", "unit", "recall"),
    [(2, False, "unknown", 0.9), (2, True, "unknown", 0.9), (3, True, "m", 0.6)],
)
def test_default_finds_every_storey_and_mixes_none(small, storeys, as_stills, unit, recall):
    metres = 1.0 if unit == "m" else None
    scene = small
    if as_stills:
        seed = {2: 7, 3: 13}[storeys]
        scene = simulate_scene("flat", seed, as_stills=True, storeys=storeys, metres_per_su=metres)
    known = Known(unit, scene.camera_height_m, len(scene.keyframes))
    estimator = FloorPlanEstimator(Config(), known)
    for keyframe in scene.keyframes:
        estimator.update(keyframe)
    estimator.finish()
    plan, truth = estimator.plan(), scene.truth
    assert {room.level for room in plan.rooms} == set(range(storeys))
    report = evaluate(plan, truth, align="none")
    assert (report.storeys.hits, report.storeys.predicted) == (storeys, storeys)
    heights = dict(zip(truth.trajectory.labels, -truth.trajectory.translations[:, 1], strict=True))
    floors = scene.building.floors_m
    for room in plan.rooms:
        off = [abs(heights[k] - floors[room.level]) for k in room.keyframes]
        assert max(off) < 0.6, (room.id, max(off))
    assert report.rooms.scores[1].recall >= recall
    assert report.rooms.overlap_m2 < 0.05
