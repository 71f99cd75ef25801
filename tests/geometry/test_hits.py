import numpy as np
import pytest

from panoplan.geometry.hits import edge_directions, first_hits

L_SHAPE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0], [2.0, 4.0], [0.0, 4.0]])


def test_the_first_edge_and_where():
    rays = np.array([[1.0, 0.0], [0.0, -1.0], [np.sqrt(0.5), np.sqrt(0.5)]])
    hits = first_hits(np.array([1.0, 1.5]), rays, L_SHAPE)
    assert hits.edge.tolist() == [1, 0, 3]
    assert hits.at == pytest.approx([1.5, 1.0, 0.5])
    assert hits.range == pytest.approx([3.0, 1.5, np.sqrt(2.0)])
    assert hits.sine == pytest.approx([1.0, 1.0, np.sqrt(0.5)])


def test_from_outside_a_ray_may_meet_nothing():
    hits = first_hits(np.array([5.0, 1.0]), np.array([[1.0, 0.0], [-1.0, 0.0]]), L_SHAPE)
    assert np.isinf(hits.range[0])
    assert hits.range[1] == pytest.approx(1.0)


def test_directions_of_the_edges():
    along, length = edge_directions(L_SHAPE)
    assert along[2] == pytest.approx([-1.0, 0.0])
    assert length == pytest.approx([4, 2, 2, 2, 2, 4])
