"""Shortest cycle through corner candidates that winds once around a room's core (iSPA)."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


# A little less than π: an edge through the core itself winds neither way.
_HALF_TURN = np.pi - 1e-6


@dataclass(frozen=True, eq=False)
class CycleGraph:
    """Edges between corner candidates in the order of one lap, with their costs.

    Candidates are sorted by `order`, their place on the lap. An edge goes forward: to a candidate
    farther along the lap, or, across the lap's seam, to one before.

    Attributes:
        starts: (N + 1,) first edge of each candidate.
        ends: (E,) candidate that an edge leads to.
        costs: (E,) cost of the edge.
    """

    starts: IntArray
    ends: IntArray
    costs: FloatArray


@dataclass(frozen=True)
class EdgeWeights:
    """Weights of Eq. 11; lengths in cells, angles in rad.

    Attributes:
        orientation: cost a radian.
        plane: cost a cell off every wall.
        mask: cost a cell inside the mask.
        complexity: cost an edge.
    """

    orientation: float
    plane: float
    mask: float
    complexity: float


@dataclass(frozen=True)
class EdgeLimits:
    """Which edges are admissible.

    Attributes:
        advance: largest advance along the lap.
        length: longest edge in cells.
        manhattan: whether length is |Δx| + |Δy|.
        angle: largest angle to the nearest wall direction, rad; π/2 allows all.
    """

    advance: float
    length: float = np.inf
    manhattan: bool = False
    angle: float = np.pi / 2


def build_graph(
    nodes: FloatArray,
    order: FloatArray,
    lap: float,
    turn: FloatArray,
    off_wall: FloatArray,
    inside: FloatArray,
    directions: FloatArray,
    weights: EdgeWeights,
    limits: EdgeLimits,
) -> CycleGraph:
    """All admissible edges with their costs, Eq. 8-11.

    An edge is admissible if it advances along the lap, keeps within the limits, and turns around
    the core by the difference of its ends' `turn`: so every cycle of one lap winds around the
    core exactly once.

    Args:
        nodes: (N, 2) candidates in cells, sorted by `order`.
        order: (N,) place on the lap, in [0, lap).
        lap: length of the lap.
        turn: (N,) unwrapped angle around the core in rad, growing by 2π a lap.
        off_wall: (n, m) 1 − M_P, sampled at cell centres.
        inside: (n, m) M_H, sampled at cell centres.
        directions: (K,) likely wall directions in rad; where empty, L_ori is 0.
        weights: λ of Eq. 11.
        limits: which edges are admissible.

    Returns:
        The graph.

    Source: Eq. 8-11; L_ori is the angle between the wall's direction and the edge.
    """
    bounds = (limits.advance, limits.length, limits.manhattan, limits.angle)
    count = _count_edges(nodes, order, lap, turn, directions, bounds)
    starts = np.concatenate([[0], np.cumsum(count)])
    ends = np.empty(starts[-1], dtype=np.int64)
    costs = np.empty(starts[-1])
    _fill_edges(
        nodes,
        order,
        lap,
        turn,
        off_wall,
        inside,
        directions,
        weights.orientation,
        weights.plane,
        weights.mask,
        weights.complexity,
        bounds,
        starts,
        ends,
        costs,
    )
    return CycleGraph(starts, ends, costs)


def shortest_cycle(graph: CycleGraph) -> tuple[IntArray, float] | None:
    """The cheapest cycle of exactly one lap.

    A cycle crosses the seam by one edge, whose end is its first candidate. For a set of possible
    first candidates, the cheapest path from any of them back to any of them is a lower bound;
    where it ends at the one it began with, it is a cycle. Sets are halved, the most promising
    first, until the best bound is a cycle: the answer is exact.

    Args:
        graph: edges with costs ≥ 0.

    Returns:
        Candidates along the cycle and its cost, or None where no cycle exists.

    Source: branch and bound over start nodes, after Appleton and Sun, Circular shortest paths by
    branch and bound, Pattern Recognition 36 (2003).
    """
    n = len(graph.starts) - 1
    heads = np.unique(graph.ends[_crosses_seam(graph.starts, graph.ends)])
    if not len(heads):
        return None
    tie = 0
    queue: list[tuple[float, int, IntArray, IntArray]] = []

    def push(candidates: IntArray) -> None:
        nonlocal tie
        bound, path = _bound(graph.starts, graph.ends, graph.costs, n, candidates)
        if len(path):
            heapq.heappush(queue, (float(bound), tie, candidates, path))
            tie += 1

    push(heads)
    while queue:
        bound, _, candidates, path = heapq.heappop(queue)
        if path[0] == path[-1]:
            return path[:-1], bound
        half = len(candidates) // 2
        push(candidates[:half])
        push(candidates[half:])
    return None


@njit(cache=True)
def _angle_to_nearest(dx, dy, directions):
    angle = np.arctan2(dy, dx)
    smallest = np.pi
    for d in range(directions.size):
        gap = abs((angle - directions[d] + 0.5 * np.pi) % np.pi - 0.5 * np.pi)
        smallest = min(smallest, gap)
    return smallest


@njit(cache=True)
def _admissible(i, j, nodes, order, lap, turn, directions, bounds):
    max_advance, max_length, manhattan, max_angle = bounds
    advance = order[j] - order[i]
    rotation = turn[j] - turn[i]
    if j < i:
        advance += lap
        rotation += 2 * np.pi
    if advance <= 0.0 or advance > max_advance or abs(rotation) >= _HALF_TURN:
        return False
    dx, dy = nodes[j, 0] - nodes[i, 0], nodes[j, 1] - nodes[i, 1]
    if manhattan:
        if abs(dx) + abs(dy) > max_length:
            return False
    elif dx * dx + dy * dy > max_length * max_length:
        return False
    if max_angle < 0.5 * np.pi and directions.size:
        return _angle_to_nearest(dx, dy, directions) <= max_angle
    return True


@njit(cache=True)
def _count_edges(nodes, order, lap, turn, directions, bounds):
    n = nodes.shape[0]
    count = np.zeros(n, dtype=np.int64)
    for i in range(n):
        for step in range(1, n):
            j = (i + step) % n
            advance = order[j] - order[i] + (lap if j < i else 0.0)
            if advance > bounds[0]:
                break
            if _admissible(i, j, nodes, order, lap, turn, directions, bounds):
                count[i] += 1
    return count


@njit(cache=True)
def _fill_edges(
    nodes,
    order,
    lap,
    turn,
    off_wall,
    inside,
    directions,
    w_orientation,
    w_plane,
    w_mask,
    w_complexity,
    bounds,
    starts,
    ends,
    costs,
):
    n = nodes.shape[0]
    rows, cols = off_wall.shape
    for i in range(n):
        at = starts[i]
        for step in range(1, n):
            j = (i + step) % n
            advance = order[j] - order[i] + (lap if j < i else 0.0)
            if advance > bounds[0]:
                break
            if not _admissible(i, j, nodes, order, lap, turn, directions, bounds):
                continue
            dx, dy = nodes[j, 0] - nodes[i, 0], nodes[j, 1] - nodes[i, 1]
            length = np.sqrt(dx * dx + dy * dy)
            samples = max(1, int(np.ceil(length)))
            plane = 0.0
            covered = 0.0
            for k in range(samples):
                share = (k + 0.5) / samples
                # Bilinear between cell centres.
                x = min(max(nodes[i, 0] + share * dx - 0.5, 0.0), rows - 1.001)
                y = min(max(nodes[i, 1] + share * dy - 0.5, 0.0), cols - 1.001)
                a, b = int(x), int(y)
                fx, fy = x - a, y - b
                w00, w01 = (1 - fx) * (1 - fy), (1 - fx) * fy
                w10, w11 = fx * (1 - fy), fx * fy
                plane += (
                    w00 * off_wall[a, b]
                    + w01 * off_wall[a, b + 1]
                    + w10 * off_wall[a + 1, b]
                    + w11 * off_wall[a + 1, b + 1]
                )
                covered += (
                    w00 * inside[a, b]
                    + w01 * inside[a, b + 1]
                    + w10 * inside[a + 1, b]
                    + w11 * inside[a + 1, b + 1]
                )
            cost = w_complexity + (w_plane * plane + w_mask * covered) * length / samples
            if directions.size:
                cost += w_orientation * _angle_to_nearest(dx, dy, directions)
            ends[at] = j
            costs[at] = cost
            at += 1


@njit(cache=True)
def _crosses_seam(starts, ends):
    crosses = np.zeros(ends.size, dtype=np.bool_)
    for i in range(starts.size - 1):
        for e in range(starts[i], starts[i + 1]):
            crosses[e] = ends[e] < i
    return crosses


@njit(cache=True)
def _bound(starts, ends, costs, n, candidates):
    allowed = np.zeros(n, dtype=np.bool_)
    distance = np.full(n, np.inf)
    before = np.full(n, -1, dtype=np.int64)
    for c in candidates:
        allowed[c] = True
        distance[c] = 0.0
    best, last, head = np.inf, -1, -1
    for i in range(n):
        if distance[i] == np.inf:
            continue
        for e in range(starts[i], starts[i + 1]):
            j = ends[e]
            total = distance[i] + costs[e]
            if j < i:
                if allowed[j] and total < best:
                    best, last, head = total, i, j
            elif total < distance[j]:
                distance[j] = total
                before[j] = i
    if last < 0:
        return best, np.empty(0, dtype=np.int64)
    length = 2
    at = last
    while before[at] >= 0:
        at = before[at]
        length += 1
    path = np.empty(length, dtype=np.int64)
    path[length - 1] = head
    at = last
    for k in range(length - 2, -1, -1):
        path[k] = at
        at = before[at]
    return best, path
