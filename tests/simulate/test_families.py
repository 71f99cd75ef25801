from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely

from panoplan.errors import InputError
from panoplan.simulate.families import (
    FAMILIES,
    REPORTED_SEEDS,
    TUNING_SEEDS,
    family_of,
    make_building,
    simulate_scene,
)
from panoplan.simulate.houses import make_house
from panoplan.simulate.joining import SERVANT, SHARED, WAYS

SEEDS = range(50)


@pytest.fixture(scope="module")
def houses():
    return {family: [make_building(family, seed) for seed in SEEDS] for family in FAMILIES}


@pytest.mark.parametrize("family", FAMILIES)
def test_fifty_seeds_have_the_statistics_of_their_family(family, houses):
    known = family_of(family)
    counts = np.array([len(house.rooms) for house in houses[family]])
    areas = np.array([house.area for house in houses[family]])
    for found, (mean, std) in ((counts, known.rooms), (areas, known.area_m2)):
        assert found.mean() == pytest.approx(mean, rel=0.06)
        assert found.std() == pytest.approx(std, rel=0.12)


@pytest.mark.parametrize("family", FAMILIES)
def test_tuning_and_reported_seeds_are_apart_and_alike(family):
    assert not set(TUNING_SEEDS) & set(REPORTED_SEEDS)
    sizes = [np.array([family_of(family).size(s) for s in seeds]) for seeds in
             (TUNING_SEEDS, REPORTED_SEEDS)]  # fmt: skip
    means = [s.mean(axis=0) for s in sizes]
    np.testing.assert_allclose(means[0], means[1], rtol=0.25)


def test_tails_of_the_large_family_are_heavy(houses):
    areas = np.array([house.area for house in houses["mp3d-fpe"]])
    assert np.median(areas) < 0.75 * areas.mean()
    assert areas.max() > 5 * areas.mean()
    assert np.max([len(house.rooms) for house in houses["mp3d-fpe"]]) > 35


@pytest.mark.parametrize("family", FAMILIES)
def test_rooms_are_walled_off_one_another_by_8_to_25_cm(family, houses):
    for house in houses[family]:
        floors = [room.floor for room in house.rooms]
        assert all(floor.is_valid for floor in floors)
        tree = shapely.STRtree(floors)
        for k, floor in enumerate(floors):
            near = tree.query(floor, "dwithin", 0.0789)
            assert near.tolist() == [k], (house.name, k)
        for passage in house.passages:
            assert 0.08 - 1e-6 <= passage.thickness <= 0.26


@pytest.mark.parametrize("family", FAMILIES)
def test_passages_join_every_room_and_lie_on_both_walls(family, houses):
    for house in houses[family]:
        assert house.reachable() == set(range(len(house.rooms)))
        areas = [shapely.Polygon(p.area) for p in house.passages]
        assert all(a.distance(b) > 0.05 for a, b in combinations(areas, 2))
        for passage in house.passages:
            for room, face in zip(passage.rooms, passage.faces, strict=True):
                wall = house.rooms[room].floor.exterior
                assert max(wall.distance(shapely.Point(p)) for p in face) < 1e-6
                assert wall.distance(shapely.Point(face.mean(axis=0))) < 1e-6
            if passage.kind == "opening":
                labels = {house.rooms[k].label for k in passage.rooms}
                assert labels <= WAYS | SHARED
        for k, room in enumerate(house.rooms):
            if room.label in SERVANT:
                assert len(house.neighbours(k)) == 1


def test_houses_have_all_that_homes_have(houses):
    for family in FAMILIES:
        rooms = [room for house in houses[family] for room in house.rooms]
        corners = np.array([len(room.polygon) for room in rooms])
        assert 0.2 < np.mean(corners > 4) < 0.7
        assert np.mean(corners >= 8) > 0.04
        assert any(round_walls(room.polygon) for room in rooms)
        assert any(room.holes for room in rooms)
        for label in ("corridor", "closet", "bathroom", "living", "kitchen", "bedroom"):
            assert sum(room.label == label for room in rooms) >= 10
        passages = [p for house in houses[family] for p in house.passages]
        assert 0.05 < np.mean([p.kind == "opening" for p in passages]) < 0.3
        heights = [{room.ceiling_height_m for room in house.rooms} for house in houses[family]]
        assert np.mean([len(h) > 1 for h in heights]) > 0.7
        skewed = np.mean([off_square(house) > np.deg2rad(3) for house in houses[family]])
        assert 0.2 < skewed < 0.8
        shapes = [turns_of(room.polygon) for room in rooms]
        assert sum(shape == "LLLLLR" for shape in shapes) > 10  # L
        assert sum(shape == "LLLLLLRR" for shape in shapes) > 0  # U
        assert sum(shape == "LLLLRLLR" for shape in shapes) > 0  # T
        assert any(has_a_bay(room.polygon) for room in rooms)
    courts = sum(has_a_court(house) for house in houses["mp3d-fpe"])
    assert courts >= 3


@pytest.mark.parametrize("family", FAMILIES)
def test_houses_are_turned_by_any_angle(family, houses):
    turns = []
    for house in houses[family]:
        edge = np.roll(house.rooms[0].polygon, -1, axis=0)[0] - house.rooms[0].polygon[0]
        turns.append(np.exp(4j * np.arctan2(edge[1], edge[0])))
    assert abs(np.mean(turns)) < 0.35


def test_a_scene_is_decided_by_family_and_seed_and_its_way_not_by_the_grade():
    mild, again = (simulate_scene("flat", 7, "mild") for _ in range(2))
    hard, other = simulate_scene("flat", 7, "hard"), simulate_scene("mp3d-fpe", 7, "mild")
    for a, b in zip(mild.keyframes, again.keyframes, strict=True):
        np.testing.assert_array_equal(a.layout.floor_boundary, b.layout.floor_boundary)
        np.testing.assert_array_equal(a.pose.translation, b.pose.translation)
    np.testing.assert_array_equal(
        mild.truth.trajectory.translations, hard.truth.trajectory.translations
    )
    assert len(mild.building.rooms) != len(other.building.rooms) or (
        mild.building.area != other.building.area
    )
    assert set(mild.keyframe_rooms) == set(range(len(mild.building.rooms)))


def test_units_are_spread_over_two_decades():
    units = [simulate_scene("flat", seed, "exact", as_stills=True).metres_per_su for seed in SEEDS]
    assert 0.1 <= min(units) < 0.2
    assert 5 < max(units) <= 10
    assert np.mean(np.log10(units)) == pytest.approx(0.0, abs=0.25)


def test_unknown_families_and_negative_seeds_are_refused():
    with pytest.raises(InputError, match=r"mp3d-fpe \| flat"):
        make_building("castle", 0)
    with pytest.raises(InputError, match="0 or more"):
        make_building("flat", -1)


def round_walls(polygon):
    """Whether five walls in a row turn a little the same way."""
    before, after = polygon - np.roll(polygon, 1, axis=0), np.roll(polygon, -1, axis=0) - polygon
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turn = np.arctan2(cross, (before * after).sum(axis=1))
    gentle = (turn > np.deg2rad(10)) & (turn < np.deg2rad(50))
    return bool(np.max(sum(np.roll(gentle, k).astype(int) for k in range(4))) == 4)


def turns_of(polygon):
    """Left and right turns round a polygon, beginning where that reads first in the alphabet."""
    before, after = polygon - np.roll(polygon, 1, axis=0), np.roll(polygon, -1, axis=0) - polygon
    left = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0
    text = "".join("L" if turn else "R" for turn in left)
    return min(text[k:] + text[:k] for k in range(len(text)))


def has_a_bay(polygon):
    """Whether a wall of at most 4.2 m stands out between two that are slanted alike."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(*edges.T)
    angle = np.arctan2(edges[:, 1], edges[:, 0])
    turn = np.rad2deg(np.angle(np.exp(1j * (np.roll(angle, -1) - angle))))
    # Out by a right turn, left twice along the bay, and back by a right turn.
    for k in range(len(polygon)):
        a, b, c, d = (turn[(k + i) % len(turn)] for i in range(4))
        front = length[(k + 2) % len(turn)]
        if a < -20 and b > 20 and c > 20 and d < -20 and front < 4.2 and abs(a + b) < 2:
            return True
    return False


def off_square(house):
    """Largest departure of a long wall from the directions of the longest one."""
    edges = np.vstack([np.roll(r.polygon, -1, axis=0) - r.polygon for r in house.rooms])
    length = np.hypot(*edges.T)
    edges, length = edges[length > 2], length[length > 2]
    angle = np.arctan2(edges[:, 1], edges[:, 0])
    return np.abs(np.angle(np.exp(4j * (angle - angle[np.argmax(length)])))).max() / 4


def has_a_court(house):
    outline = shapely.union_all(
        [room.floor.buffer(0.2, join_style="mitre") for room in house.rooms]
    )
    rings = [ring for part in shapely.get_parts(outline) for ring in part.interiors]
    return any(shapely.Polygon(ring).area > 6 for ring in rings)


def test_more_rooms_than_any_shape_holds_are_refused():
    style = replace(family_of("flat").style, closet_share=0.0)
    with pytest.raises(InputError, match="14 rooms in 150 m²"):
        make_house("home", style, 14, 150.0, np.random.default_rng(0))
