from dataclasses import replace

import numpy as np
import pytest
import shapely

from panoplan.errors import InputError
from panoplan.formats.sequence import read_true_plan
from panoplan.formats.tum import read_tum
from panoplan.simulate.annotated import annotated_building, largest_part
from panoplan.simulate.buildings import rectangle
from panoplan.simulate.families import make_building
from panoplan.simulate.film import film
from panoplan.simulate.scene import true_plan
from panoplan.types.truth import TruePlan, TrueRoom


def test_a_made_up_house_comes_back_from_its_own_plan():
    house = make_building("flat", 6)
    again = annotated_building("again", true_plan(house))
    assert [r.label for r in again.rooms] == [r.label for r in house.rooms]
    assert len(again.windows) == len(house.windows)
    assert len(again.blind_doors) == len(house.blind_doors) == 1
    theirs = {frozenset(p.rooms): p for p in again.passages}
    assert set(theirs) == {frozenset(p.rooms) for p in house.passages}
    for passage in house.passages:
        found = theirs[frozenset(passage.rooms)]
        assert found.kind == passage.kind
        assert shapely.Polygon(found.area).symmetric_difference(
            shapely.Polygon(passage.area)
        ).area == pytest.approx(0.0, abs=1e-6)


def two_rooms(gap, **doors):
    rooms = (
        TrueRoom("a", "a", rectangle(4, 3)),
        TrueRoom("b", "b", rectangle(4, 3, (4 + gap, 0))),
    )
    return TruePlan(rooms, **doors)


def test_doors_annotated_a_little_off_their_walls_are_laid_onto_them():
    doors = (np.array([[4.02, 1.0], [4.01, 1.9]]), np.array([[4.13, 1.95], [4.16, 1.05]]))
    building = annotated_building("two", two_rooms(0.15, doors=doors))
    (passage,) = building.passages
    np.testing.assert_allclose(passage.faces[:, :, 0], [[4.0, 4.0], [4.15, 4.15]])
    assert passage.width == pytest.approx(0.85)
    assert building.blind_doors == ()


def test_what_has_nothing_opposite_is_blind():
    doors = (np.array([[4.0, 1.0], [4.0, 1.9]]), np.array([[0.0, 1.0], [0.0, 1.9]]))
    building = annotated_building("two", two_rooms(1.0, doors=doors))
    assert building.passages == ()
    assert [d.room for d in building.blind_doors] == [0, 0]


def test_rooms_whose_annotations_touch_get_a_thin_wall():
    building = annotated_building("two", two_rooms(0.0))
    a, b = (room.floor for room in building.rooms)
    assert 0.005 < a.distance(b) < 0.06


def test_without_doors_one_is_placed_where_the_way_passes_between_near_rooms():
    ways = np.array([[1.0, 1.0], [7.0, 1.6]])
    (door,) = annotated_building("two", two_rooms(0.3), ways=ways).passages
    assert door.rooms == (0, 1)
    assert door.thickness == pytest.approx(0.3)
    assert door.faces[:, :, 1].mean() == pytest.approx(1.315, abs=0.02)
    assert annotated_building("two", two_rooms(0.5), ways=ways).passages == ()
    assert annotated_building("two", two_rooms(0.3), ways=ways[:1]).passages == ()


def test_the_largest_part_is_what_can_be_walked():
    house = make_building("flat", 6)
    # Cut off the room that only one passage leads to.
    k = next(k for k in range(len(house.rooms)) if len(house.neighbours(k)) == 1)
    cut = replace(house, passages=tuple(p for p in house.passages if k not in p.rooms))
    part = largest_part(cut)
    assert len(part.rooms) == len(house.rooms) - 1
    assert part.reachable() == set(range(len(part.rooms)))
    assert len(film(part, np.random.default_rng(0)).trajectory) > 20


def test_a_plan_without_rooms_is_refused():
    with pytest.raises(InputError, match="no room"):
        annotated_building("none", TruePlan(()))


def test_the_real_home_can_be_walked(shared_data):
    folder = shared_data / "zind_000"
    building = annotated_building("home", read_true_plan(folder / "floorplan_gt.json"))
    assert len(building.rooms) == 19
    assert sum(p.kind == "opening" for p in building.passages) == 5
    assert len(building.passages) == 19
    part = largest_part(building)
    assert len(part.rooms) == 19


def test_real_levels_get_doors_where_their_cameras_walk(shared_data):
    joined = []
    for folder in sorted((shared_data / "mp3d_levels").iterdir()):
        if not folder.is_dir():
            continue
        plan = read_true_plan(folder / "floorplan_gt.json")
        ways = read_tum(folder / "trajectory_gt.tum").translations[:, [0, 2]]
        building = annotated_building(folder.name, plan, ways=ways)
        joined.append(len(largest_part(building).rooms) / len(building.rooms))
    assert len(joined) == 14
    # Many rooms of these levels stand apart from all others: halls between them are not annotated.
    assert np.mean(joined) > 0.35
    assert max(joined) == 1.0
