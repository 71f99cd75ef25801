import numpy as np
import pytest

from panoplan.geometry.rigid import turn
from panoplan.metrics.tour import tour_error

TRUE = np.array([[0, 0, 0], [2, 0, 1], [4, 1, 2], [1, 3, -1], [3, 4, 0.5], [0, 5, -2]], dtype=float)


def moved(yaw, shift, scale=1.0):
    return np.column_stack([scale * TRUE[:, :2] @ turn(yaw).T + shift, TRUE[:, 2] + yaw])


def test_another_frame_is_no_error_and_a_scale_is_told():
    error = tour_error(moved(2.0, [5.0, -3.0], scale=1.02), TRUE)
    assert error.misplaced == ()
    assert error.median_m == pytest.approx(0, abs=1e-9)
    assert error.heading_deg == pytest.approx(0, abs=1e-9)
    assert error.scale == pytest.approx(1 / 1.02)


def test_one_photo_off_and_one_turned_are_misplaced_and_do_not_bend_the_fit():
    poses = moved(-1.0, [1.0, 1.0])
    poses[2, 0] += 0.8
    poses[4, 2] += np.deg2rad(7.0)
    error = tour_error(poses, TRUE)
    assert error.misplaced == (2, 4)
    assert error.median_m < 1e-6
    assert error.p90_m == pytest.approx(0.4, abs=0.01)


def test_half_a_metre_of_scale_error_counts_as_misplaced():
    assert len(tour_error(moved(0.0, [0, 0], scale=1.4), TRUE).misplaced) > 0
