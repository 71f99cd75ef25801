import numpy as np
import pytest
import shapely

from panoplan.geometry.polygons import signed_area
from panoplan.simulate.adjacency import shared_walls
from panoplan.simulate.buildings import Building, InteriorRoom, rectangle
from panoplan.simulate.features import (
    Draft,
    alcove_closet,
    apse,
    bay,
    convex_corners,
    corner_closet,
    cut_corner,
    faces_outside,
    habitable,
    pillar,
)
from panoplan.simulate.views import ViewCaster
from panoplan.simulate.walks import walk

ROOM = Draft("room", rectangle(6, 5))


@pytest.mark.parametrize("corner", range(4))
def test_a_corner_closet_takes_itself_and_its_walls(corner):
    closet, rest = corner_closet(ROOM, corner, (1.5, 2.0), 0.1)
    assert closet.floor.area == pytest.approx(3.0)
    assert rest.floor.area == pytest.approx(30 - 1.6 * 2.1)
    walls = shared_walls([closet.polygon, rest.polygon], 0.11)
    assert [w.thickness for w in walls] == pytest.approx([0.1, 0.1])


def test_in_a_slanted_corner_the_walls_are_as_thick():
    slanted = Draft("room", np.array([[0.0, 0.0], [6.0, 0.0], [5.0, 5.0], [0.0, 5.0]]))
    closet, rest = corner_closet(slanted, 1, (1.5, 2.0), 0.2)
    walls = shared_walls([closet.polygon, rest.polygon], 0.25)
    assert [w.thickness for w in walls] == pytest.approx([0.2, 0.2])


def test_a_closet_in_a_wall_leaves_a_u():
    closet, rest = alcove_closet(ROOM, 0, 2.0, 1.5, 1.2, 0.1)
    assert closet.floor.area == pytest.approx(1.5 * 1.2)
    assert rest.floor.area == pytest.approx(30 - 1.7 * 1.3)
    assert len(rest.polygon) == 8
    assert len(shared_walls([closet.polygon, rest.polygon], 0.11)) == 3


def test_bays_and_breasts_change_the_floor_by_their_trapezium():
    assert bay(ROOM, 1, 1.0, 2.0, 0.8, 0.5).floor.area == pytest.approx(30 + 0.8 * 1.5)
    assert bay(ROOM, 1, 1.0, 2.0, -0.5, 0.0).floor.area == pytest.approx(30 - 1.0)


def test_an_apse_approaches_half_an_ellipse():
    fine = apse(ROOM, 2, 1.0, 3.0, 1.0, 200)
    assert fine.floor.area == pytest.approx(30 + np.pi * 1.5 * 1.0 / 2, rel=1e-4)
    coarse = apse(ROOM, 2, 1.0, 3.0, 1.0, 6)
    assert len(coarse.polygon) == 4 + 7
    assert 30 < coarse.floor.area < fine.floor.area


def test_a_cut_corner_is_a_quarter_of_a_circle_or_a_triangle():
    assert cut_corner(ROOM, 3, 1.0, 1).floor.area == pytest.approx(30 - 0.5)
    round_one = cut_corner(ROOM, 0, 1.0, 300)
    assert round_one.floor.area == pytest.approx(30 - (1 - np.pi / 4), rel=1e-5)
    assert round_one.floor.is_valid


def test_only_walls_with_nothing_behind_them_face_outside():
    other = Draft("room", rectangle(3, 3, (6.15, 1)))
    house = shapely.union_all([ROOM.floor, other.floor])
    assert [faces_outside(ROOM, k, 1.0, house) for k in range(4)] == [True, False, True, True]


def test_what_cannot_be_lived_in():
    assert habitable(ROOM, 3.0)
    assert not habitable(ROOM, 31.0)
    assert not habitable(Draft("room", rectangle(6, 0.8)), 3.0)
    # A neck that nobody gets through.
    assert not habitable(bay(ROOM, 0, 2.0, 1.0, -4.5, 0.0), 3.0)
    assert not habitable(bay(ROOM, 0, 0.1, 1.0, 0.5, 0.0), 3.0)


def test_convex_corners_of_an_l():
    _, rest = corner_closet(ROOM, 2, (1.5, 1.5), 0.1)
    assert len(convex_corners(ROOM.polygon)) == 4
    assert len(convex_corners(rest.polygon)) == 5


def test_a_pillar_stops_views_and_is_walked_round():
    standing = pillar(ROOM, np.array([3.0, 2.5]), 0.5, 0.0, 4)
    assert signed_area(standing.holes[0]) == pytest.approx(-0.25)
    room = InteriorRoom("room", standing.polygon, 2.5, standing.holes)
    building = Building("pillared", (room,))
    view = ViewCaster(building).view(np.array([1.0, 2.5]), np.pi / 2, 1.5)
    assert view.range_m[512] == pytest.approx(1.75, rel=1e-3)
    assert view.range_m[0] == pytest.approx(1.0, rel=1e-3)
    for seed in range(5):
        way = walk(building, np.random.default_rng(seed))
        assert shapely.LineString(way.path).distance(shapely.Polygon(room.holes[0])) > 0.1
