import numpy as np
import pytest

from panoplan.geometry.polar import range_profile, star_evidence
from panoplan.geometry.sphere import column_heading


def _circle(radius, width=720):
    heading = column_heading(np.arange(width), width)
    return radius * np.stack([np.sin(heading), np.cos(heading)], axis=1)


def test_profile_of_a_circle_and_of_a_gap():
    points = _circle(2.0)
    points[100:200] = np.nan
    profile = range_profile(points, 360, np.deg2rad(2))
    known = np.isfinite(profile)
    np.testing.assert_allclose(profile[known], 2.0, rtol=1e-6)
    assert (~known).sum() == pytest.approx(50, abs=2)


def test_cells_inside_are_free_and_those_beyond_speak_against():
    profile = np.full(360, 1.0)
    free, against = star_evidence(np.zeros(2), profile, 2.0, 0.3, 0.1, 0.1, (-25, -25), (50, 50))
    at = (np.arange(50) - 25 + 0.5) * 0.1
    distance = np.hypot(at[:, None], at[None, :])
    np.testing.assert_array_equal(free == 1, distance < 1.0)
    np.testing.assert_array_equal(against == 1, (distance >= 1.0) & (distance < 1.3))
    np.testing.assert_array_equal(np.isclose(against, 0.1), (distance >= 1.3) & (distance <= 2.0))
    assert free.sum() * 0.01 == pytest.approx(np.pi, rel=0.02)


def test_the_first_axis_lies_a_quarter_turn_clockwise_of_the_second():
    profile = np.full(360, 1.0)
    heading = column_heading(np.arange(360), 360)
    profile[np.abs(heading - np.pi / 2) < 0.3] = 2.0
    free, _ = star_evidence(np.zeros(2), profile, 3.0, 0.0, 0.0, 0.1, (-30, -30), (60, 60))
    assert free[45, 30] == 1
    assert free[30, 45] == 0
    assert free[15, 30] == 0
