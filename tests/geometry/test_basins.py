import numpy as np

from panoplan.geometry.basins import basins


def two_hills(pass_height):
    """Peaks of 5 and 8 with a pass between."""
    return np.array([[1.0, 5.0, pass_height, 8.0, 2.0]])


def test_a_low_pass_keeps_two_basins_apart():
    labels = basins(two_hills(2.0), 0.5)
    assert labels[0, 1] != labels[0, 3]
    # The pass belongs to the higher side, each foot to its own peak.
    assert labels[0].tolist() == [labels[0, 1]] * 2 + [labels[0, 3]] * 3


def test_a_high_pass_joins_them():
    assert set(basins(two_hills(2.5), 0.5).ravel()) == {1}


def test_what_does_not_touch_is_apart_and_nothing_is_zero():
    height = np.zeros((5, 7))
    height[1:4, 1:3] = 1.0
    height[1:4, 4:6] = 2.0
    labels = basins(height, 0.0)
    assert set(labels[height == 0]) == {0}
    assert sorted({labels[2, 1], labels[2, 4]}) == [1, 2]
    assert len(set(labels[height == 1])) == len(set(labels[height == 2])) == 1


def test_a_flat_map_is_one_basin():
    assert set(basins(np.ones((20, 30)), 1.0).ravel()) == {1}


def test_nothing_has_no_basin():
    assert not basins(np.zeros((3, 4)), 0.5).any()
