import numpy as np
import pytest

from panoplan.geometry.lines import farthest_from_chord, ransac_line


def test_ransac_finds_the_line_among_outliers():
    rng = np.random.default_rng(0)
    x = np.linspace(0, 4, 80)
    points = np.stack([x, 0.5 * x + 1 + rng.normal(0, 0.005, 80)], axis=1)
    points[::10, 1] += 1.0
    fit = ransac_line(points, rng.integers(0, 80, (50, 2)), 0.03)
    assert fit is not None
    assert fit.inliers.sum() == 72
    slope = -fit.normal[0] / fit.normal[1]
    assert slope == pytest.approx(0.5, abs=0.005)
    assert fit.offset / fit.normal[1] == pytest.approx(1.0, abs=0.01)


def test_coincident_pairs_give_no_line():
    assert ransac_line(np.ones((5, 2)), np.array([[0, 1], [2, 2]]), 0.1) is None


def test_farthest_from_chord():
    points = np.array([[0.0, 0.0], [1.0, 0.2], [2.0, 0.5], [4.0, 0.0]])
    assert farthest_from_chord(points) == (2, pytest.approx(0.5))
