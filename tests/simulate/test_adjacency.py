import numpy as np
import pytest

from panoplan.simulate.adjacency import longest_walls, shared_walls
from panoplan.simulate.buildings import l_shape, rectangle


def test_shared_wall_is_the_overlap_of_both_faces():
    a, b = rectangle(4, 3), rectangle(3, 3, (4.12, 1.0))
    (wall,) = shared_walls([a, b])
    assert wall.length == pytest.approx(2.0)
    assert wall.thickness == pytest.approx(0.12)
    np.testing.assert_allclose(wall.outward, [1, 0], atol=1e-12)
    np.testing.assert_allclose(wall.faces(0, 2), [[[4, 1], [4, 3]], [[4.12, 1], [4.12, 3]]])
    assert shared_walls([a, rectangle(3, 3, (4.6, 0))]) == []


def test_the_longest_stretch_of_two_rooms():
    other = np.array([[5.1, 0], [7, 0], [7, 4], [4.1, 4], [4.1, 1.1], [5.1, 1.1]])
    walls = shared_walls([l_shape(5, 4, 1, 3), other])
    assert sorted(wall.length for wall in walls) == pytest.approx([0.9, 1.0, 2.9])
    (longest,) = longest_walls(walls)
    assert longest.length == pytest.approx(2.9)
    assert longest_walls([]) == []
