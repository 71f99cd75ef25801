import numpy as np
import pytest

from panoplan.geometry.polyline import resampled, straight_pieces

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])


def test_resampled_points_are_even_and_on_the_ring():
    points = resampled(SQUARE, 0.1)
    assert len(points) == 60
    assert points[0] == pytest.approx(SQUARE[0])
    steps = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    assert steps == pytest.approx(np.full(60, 0.1))


@pytest.mark.parametrize("turn", [0, 7, 23])
def test_a_noisy_rectangle_falls_into_its_four_sides(turn):
    points = np.roll(resampled(SQUARE, 0.05), turn, axis=0)
    points = points + np.random.default_rng(2).normal(0, 0.01, points.shape)
    pieces = straight_pieces(points, 0.02, 8.0)
    assert len(pieces) == 4
    assert sum(len(piece) for piece in pieces) == len(points)
    lengths = sorted(len(piece) for piece in pieces)
    assert lengths == pytest.approx([20, 20, 40, 40], abs=2)


def test_a_corner_must_pay():
    """A bend of 5 cm in the middle of a side of 2 m: two pieces if cheap, one if dear."""
    bent = np.insert(SQUARE, 1, [1.0, -0.05], axis=0)
    points = resampled(bent, 0.02)
    assert len(straight_pieces(points, 0.02, 2.0)) == 5
    assert len(straight_pieces(points, 0.02, 200.0)) == 4
