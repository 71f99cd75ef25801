import numpy as np
import pytest

from panoplan.geometry.angles import line_angle, line_difference, wrapped
from panoplan.geometry.rigid import heading_of, turn
from panoplan.geometry.sphere import column_heading, heading_column, rays


def test_the_middle_between_the_centre_columns_looks_along_z():
    assert column_heading(511.5, 1024) == pytest.approx(0.0)
    assert column_heading(0, 1024) == pytest.approx(-np.pi + np.pi / 1024)


def test_heading_column_inverts_column_heading():
    columns = np.arange(1024.0)
    np.testing.assert_allclose(
        heading_column(column_heading(columns, 1024), 1024), columns, atol=1e-9
    )


def test_a_ray_below_the_horizon_points_down_which_is_positive_y():
    ray = rays(np.array([-0.3]), np.array([np.pi / 2]))[0]
    np.testing.assert_allclose(ray, [np.cos(0.3), np.sin(0.3), 0.0], atol=1e-12)


def test_heading_turns_from_z_towards_x():
    beta = 0.7
    rotation = np.array(
        [[np.cos(beta), 0, np.sin(beta)], [0, 1, 0], [-np.sin(beta), 0, np.cos(beta)]]
    )
    assert heading_of(rotation) == pytest.approx(beta)
    forward = rotation @ [0, 0, 1]
    np.testing.assert_allclose(turn(-beta) @ forward[[0, 2]], [0, 1], atol=1e-12)


def test_line_angles_have_period_pi():
    assert line_difference(np.deg2rad(179), np.deg2rad(1)) == pytest.approx(np.deg2rad(-2))
    assert line_angle(np.deg2rad(-10)) == pytest.approx(np.deg2rad(170))
    assert wrapped(3 * np.pi / 2) == pytest.approx(-np.pi / 2)
