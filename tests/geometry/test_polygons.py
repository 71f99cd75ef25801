"""Polygons that cross themselves."""

import numpy as np
import pytest

from panoplan.geometry.polygons import signed_area, untangled

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])


def _rings(polygon):
    """All rotations of a ring, as which corner is first does not matter."""
    return [np.roll(polygon, k, axis=0).tolist() for k in range(len(polygon))]


@pytest.mark.parametrize("ring", [SQUARE, SQUARE[::-1]])
def test_a_simple_polygon_stays_counter_clockwise(ring):
    assert untangled(ring).tolist() in _rings(SQUARE)


def test_a_notch_whose_walls_cross_ends_where_they_cross():
    # From above into the square, down to (2, 1), its sides crossing at (2, 2).
    notched = [*SQUARE[:3], [2.5, 4.0], [1.5, 1.0], [2.5, 1.0], [1.5, 4.0], SQUARE[3]]
    simple = untangled(np.array(notched))
    assert any(np.allclose(at, [2.0, 2.5]) for at in simple)
    # The square less the triangle above the crossing; the loop below it is floor.
    assert signed_area(simple) == pytest.approx(16.0 - 1.5 / 2)
    assert len(simple) == 7


def test_of_a_bow_tie_the_larger_half_stays():
    tie = np.array([[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 2.0]])
    simple = untangled(tie)
    assert signed_area(simple) == pytest.approx(16 / 2 - 4 * (4 / 3) / 2)


def test_what_encloses_nothing_is_empty():
    line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    assert untangled(line).shape == (0, 2)
    assert untangled(line[:2]).shape == (0, 2)
    assert [signed_area(line[:count]) for count in range(4)] == [0.0] * 4
