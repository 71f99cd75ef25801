import numpy as np
import pytest

from panoplan.metrics.trajectory import trajectory_error


def test_error_of_known_positions():
    true = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 9.0]])
    error = trajectory_error(true + [[0.0, 0.0], [0.3, 0.4], [0.0, 0.1]], true)
    assert error.cameras == 3
    assert error.length_m == pytest.approx(10.0)
    assert error.median_cm == pytest.approx(10.0)
    rmse = 100 * np.sqrt((0.25 + 0.01) / 3)
    assert error.rmse_cm == pytest.approx(rmse)
    assert error.rmse_percent_of_length == pytest.approx(rmse / 10.0)


def test_a_camera_that_stands_still_has_no_length():
    error = trajectory_error(np.ones((1, 2)), np.ones((1, 2)))
    assert (error.rmse_cm, error.rmse_percent_of_length) == (0.0, None)


def test_no_camera_no_error():
    assert trajectory_error(np.empty((0, 2)), np.empty((0, 2))) is None
