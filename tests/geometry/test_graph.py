from itertools import product

import numpy as np
import pytest

from panoplan.geometry.graph import EdgeLimits, EdgeWeights, build_graph, shortest_cycle


def _ring(count, radii):
    angles = np.repeat(np.arange(count) * 2 * np.pi / count, len(radii))
    radius = np.tile(radii, count)
    nodes = 20 + radius[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return nodes, np.repeat(np.arange(count, dtype=float), len(radii)), angles


def _graph(nodes, order, turn, lap, off_wall, inside, complexity=0.1, orientation=0.0):
    return build_graph(
        nodes, order, lap, turn, off_wall, inside, np.array([0.0, np.pi / 2]),
        EdgeWeights(orientation, 1.0, 5.0, complexity), EdgeLimits(lap),
    )  # fmt: skip


def _brute_force(graph, layers, per_layer):
    cost = {}
    for i in range(len(graph.starts) - 1):
        for e in range(graph.starts[i], graph.starts[i + 1]):
            cost[i, int(graph.ends[e])] = graph.costs[e]
    best = np.inf
    for choice in product(range(-1, per_layer), repeat=layers):
        cycle = [k * per_layer + c for k, c in enumerate(choice) if c >= 0]
        if len(cycle) < 2:
            continue
        pairs = zip(cycle, cycle[1:] + cycle[:1], strict=True)
        best = min(best, sum(cost.get(pair, np.inf) for pair in pairs))
    return best


@pytest.mark.parametrize("seed", range(8))
def test_shortest_cycle_is_the_best_of_all_cycles(seed):
    rng = np.random.default_rng(seed)
    nodes, order, turn = _ring(6, [8.0, 10.0, 13.0])
    graph = _graph(nodes, order, turn, 6.0, rng.random((40, 40)), np.zeros((40, 40)))
    found = shortest_cycle(graph)
    assert found is not None
    assert found[1] == pytest.approx(_brute_force(graph, 6, 3))


def test_cycle_winds_around_the_core_once():
    rng = np.random.default_rng(1)
    nodes, order, turn = _ring(12, [6.0, 9.0])
    graph = _graph(nodes, order, turn, 12.0, rng.random((40, 40)), np.zeros((40, 40)), 3.0)
    found = shortest_cycle(graph)
    assert found is not None
    corners = nodes[found[0]] - 20
    bearing = np.arctan2(corners[:, 1], corners[:, 0])
    steps = np.mod(np.roll(bearing, -1) - bearing + np.pi, 2 * np.pi) - np.pi
    assert steps.sum() == pytest.approx(2 * np.pi)


def test_edge_cost_by_hand():
    nodes = np.array([[2.0, 10.0], [12.0, 10.0], [7.0, 16.0]])
    turn = np.arctan2(nodes[:, 1] - 12, nodes[:, 0] - 7)
    turn = np.array([turn[0], turn[1], turn[2]])
    off_wall = np.full((20, 20), 0.25)
    inside = np.full((20, 20), 0.5)
    graph = build_graph(
        nodes, np.arange(3.0), 3.0, turn, off_wall, inside, np.array([np.deg2rad(30)]),
        EdgeWeights(2.0, 1.0, 4.0, 0.7), EdgeLimits(3.0),
    )  # fmt: skip
    first = graph.costs[graph.starts[0]]
    assert graph.ends[graph.starts[0]] == 1
    assert first == pytest.approx(0.7 + 10 * 0.25 + 4 * 10 * 0.5 + 2 * np.deg2rad(30))


def test_closing_edge_is_costed():
    nodes, order, turn = _ring(4, [8.0])
    free = np.zeros((40, 40))
    graph = _graph(nodes, order, turn, 4.0, free + 0.5, free, 1.0)
    found = shortest_cycle(graph)
    assert found is not None
    around = np.linalg.norm(np.roll(nodes, -1, axis=0) - nodes, axis=1).sum()
    assert found[1] == pytest.approx(4 * 1.0 + 0.5 * around)


def test_no_cycle_where_the_lap_is_broken():
    nodes, order, turn = _ring(8, [8.0])
    half = order < 4
    graph = _graph(nodes[half], order[half], turn[half], 8.0, np.ones((40, 40)), np.zeros((40, 40)))
    assert shortest_cycle(graph) is None


@pytest.mark.parametrize(
    ("limits", "kept"),
    [
        (EdgeLimits(4.0, 12.0), 4),
        (EdgeLimits(4.0, 11.0), 0),
        (EdgeLimits(4.0, 15.9, manhattan=True), 0),
        (EdgeLimits(4.0, 16.1, manhattan=True), 4),
        (EdgeLimits(4.0, 12.0, angle=np.deg2rad(14)), 0),
        (EdgeLimits(4.0, 12.0, angle=np.deg2rad(16)), 4),
    ],
)
def test_only_edges_within_the_limits_are_built(limits, kept):
    """A square on its corner, sides of 11.3 cells at 45°; the wall directions are 30° and 120°."""
    nodes, order, turn = _ring(4, [8.0])
    free = np.zeros((40, 40))
    directions = np.deg2rad([30.0, 120.0])
    graph = build_graph(
        nodes, order, 4.0, turn, free, free, directions, EdgeWeights(1.0, 1.0, 1.0, 1.0), limits
    )
    assert len(graph.ends) == kept
