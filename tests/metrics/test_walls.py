import numpy as np
import pytest
from tests.metrics.plans import square

from panoplan.metrics.walls import true_wall, wall_error, wall_figures
from panoplan.types.plan import Wall

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])


def _wall(a, b, sigma=None):
    return Wall("w", np.array(a, dtype=float), np.array(b, dtype=float), sigma)


def test_the_error_is_across_the_wall_and_positive_outwards():
    assert wall_error(_wall((0.2, -0.05), (3.9, -0.05)), SQUARE) == pytest.approx(0.05)
    assert wall_error(_wall((4.0, 0.0), (3.9, 3.0)), SQUARE) == pytest.approx(-0.05, abs=1e-3)


@pytest.mark.parametrize(
    "wall",
    [
        _wall((0.0, -0.6), (4.0, -0.6)),  # farther than any wall of this room
        _wall((4.0, 0.0), (0.0, 0.0)),  # the room on its other side
        _wall((0.0, 0.0), (4.0, 1.5)),  # 20 degrees off
        _wall((3.9, 0.0), (7.0, 0.0)),  # beside the true one over a tenth only
    ],
)
def test_other_walls_have_no_true_one(wall):
    assert wall_error(wall, SQUARE) is None


def test_shares_within_the_stated_sigma():
    walls = [
        _wall((0, -0.01), (4, -0.01), 0.02),
        _wall((4.03, 0), (4.03, 3), 0.02),
        _wall((4, 3.05), (0, 3.05), 0.02),
        _wall((-0.08, 3), (-0.08, 0)),
        _wall((1, 1), (2, 1)),
    ]
    figures = wall_figures([(SQUARE, walls)])
    assert (figures.predicted, figures.compared, figures.stated) == (5, 4, 3)
    assert figures.median_cm == pytest.approx(4.0)
    assert figures.within_1_sigma == pytest.approx(1 / 3)
    assert figures.within_2_sigma == pytest.approx(2 / 3)


def test_a_true_wall_has_both_corners_where_the_predicted_one_has():
    outlines = [square(0, 0), square(2.1, 0)]
    near = Wall("w", np.array([2.1, 0.1]), np.array([1.9, 2.1]))
    assert true_wall(near, outlines) == pytest.approx(np.array([[2.0, 0.0], [2.0, 2.0]]))
    # The other face runs the other way.
    turned = Wall("w", near.b, near.a)
    assert true_wall(turned, outlines) == pytest.approx(np.array([[2.1, 2.0], [2.1, 0.0]]))
    short = Wall("w", np.array([2.0, 0.0]), np.array([2.0, 1.6]))
    assert true_wall(short, outlines) is None
