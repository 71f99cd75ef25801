import numpy as np
import pytest

from panoplan.poses.tour.frames import composed, inverted, relative
from panoplan.poses.tour.posegraph import Edge, optimised


def test_frames_are_inverse_to_one_another():
    a, b = np.array([1.0, 2.0, 0.7]), np.array([-0.5, 0.3, -2.9])
    assert composed(a, relative(a, b)) == pytest.approx(b)
    assert composed(b, inverted(relative(a, b))) == pytest.approx(a)
    # One step ahead of a camera that looks to the right is to the right.
    assert composed(np.array([0, 0, np.pi / 2]), np.array([0.0, 1.0, 0.0])) == pytest.approx(
        [1.0, 0.0, np.pi / 2]
    )


def edge(a, b, poses, off=(0.0, 0.0, 0.0)):
    x, z, yaw = relative(poses[a], poses[b])
    told = np.array([yaw, np.arctan2(x, z), np.log(np.hypot(x, z))]) + off
    return Edge(a, b, told, np.diag([200.0, 100.0, 20.0]))


def test_a_loop_without_one_length_closes_and_a_wrong_edge_is_outvoted():
    rng = np.random.default_rng(0)
    true = {k: np.array([*rng.uniform(-3, 3, 2), rng.uniform(-3, 3)]) for k in range(5)}
    true[0] = np.zeros(3)
    pairs = [(0, 1), (1, 2), (2, 3), (3, 4), (0, 4), (0, 2), (1, 3), (2, 4), (1, 4)]
    edges = [edge(a, b, true) for a, b in pairs]
    edges[3].told[2] = np.nan
    edges.append(edge(0, 3, true, (0.5, 0.8, 0.4)))
    start = {k: p + [*rng.normal(0, 0.1, 2), rng.normal(0, 0.05)] for k, p in true.items()}
    start[0] = np.zeros(3)
    found = optimised(start, edges, 2.0)
    for k, pose in true.items():
        assert relative(pose, found[k]) == pytest.approx([0, 0, 0], abs=0.02)


def test_without_edges_nothing_moves():
    assert optimised({3: np.ones(3)}, [], 2.0)[3] == pytest.approx(np.ones(3))
