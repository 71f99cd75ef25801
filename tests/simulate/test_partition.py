import numpy as np
import pytest
import shapely

from panoplan.geometry.polygons import signed_area
from panoplan.simulate.adjacency import shared_walls
from panoplan.simulate.buildings import rectangle
from panoplan.simulate.partition import clip, cut, notch, without_straight_corners


def test_cut_takes_out_the_wall():
    left, right = cut(rectangle(4, 3), np.array([1.0, 0.0]), np.array([0.0, 1.0]), 0.2)
    assert left[:, 0].max() == pytest.approx(0.9)
    assert right[:, 0].min() == pytest.approx(1.1)
    assert signed_area(left) + signed_area(right) == pytest.approx(12 - 0.6)


@pytest.mark.parametrize("corner", range(4))
def test_notch_leaves_an_l_parallel_to_the_small_room(corner):
    trapezium = np.array([[0.0, 0.0], [5.0, 0.0], [4.5, 4.0], [0.3, 4.0]])
    small, rest = notch(trapezium, corner, (1.5, 1.8), 0.1)
    assert len(small) == 4
    assert len(rest) == 6
    assert signed_area(rest) > 0
    assert shapely.Polygon(rest).is_valid
    walls = shared_walls([small, rest], max_thickness=0.11)
    assert len(walls) == 2
    assert [w.thickness for w in walls] == pytest.approx([0.1, 0.1])


def test_clip_can_leave_nothing():
    assert len(clip(rectangle(1, 1), np.array([1.0, 0.0]), -1.0)) == 0


def test_corners_at_which_a_ring_goes_straight_on_are_left_out():
    ring = np.array([[0, 0], [1, 0], [4, 0], [4, 3], [0, 3], [0, 2.5]])
    np.testing.assert_array_equal(without_straight_corners(ring), rectangle(4, 3))
