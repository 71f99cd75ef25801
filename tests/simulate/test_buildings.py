import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.geometry.polygons import signed_area
from panoplan.simulate.buildings import InteriorRoom, Passage, l_shape, rectangle, single_room
from panoplan.simulate.flats import make_flat


def test_shapes_have_the_area_their_arguments_say():
    assert signed_area(rectangle(4, 3, (1, -2))) == pytest.approx(12)
    assert signed_area(l_shape(5, 4, 2, 1.5)) == pytest.approx(20 - 3)
    assert single_room(rectangle(4, 3)[::-1]).area == pytest.approx(12)


def test_a_room_that_crosses_itself_is_refused():
    with pytest.raises(InputError, match="crosses itself"):
        InteriorRoom("bow tie", [[0, 0], [1, 1], [1, 0], [0, 1]])


def test_a_passage_leads_out_of_either_room():
    door = Passage("door", (3, 7), [[[4, 2], [4, 1]], [[4.2, 2], [4.2, 1]]])
    np.testing.assert_array_equal(door.outward_from(3), [-1, 0])
    np.testing.assert_array_equal(door.outward_from(7), [1, 0])


def test_moving_a_building_moves_all_of_it():
    flat = make_flat(3)
    moved = flat.moved(np.pi / 2, np.array([1.0, 2.0]))
    turned = flat.passages[0].faces @ np.array([[0.0, 1.0], [-1.0, 0.0]]) + [1.0, 2.0]
    np.testing.assert_allclose(moved.passages[0].faces, turned, atol=1e-12)
    assert moved.area == pytest.approx(flat.area)
