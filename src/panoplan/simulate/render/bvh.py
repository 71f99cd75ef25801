"""Rays against triangles without Embree: a tree of boxes, compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from panoplan.simulate.render.materials import Float32Array
from panoplan.simulate.render.mesh import Int32Array

_LEAF = 4
_DEPTH = 64


class Tree(NamedTuple):
    """Boxes around boxes around triangles.

    Attributes:
        triangles: (T, 3, 3) in the order of the leaves.
        order: (T,) their indices as they were given.
        low: (N, 3) least corner of each node's box.
        high: (N, 3) greatest.
        left: (N,) first child, the second follows it; −1 for a leaf.
        first: (N,) first triangle of a leaf.
        members: (N,) number of triangles of a leaf.
    """

    triangles: Float32Array
    order: Int32Array
    low: Float32Array
    high: Float32Array
    left: Int32Array
    first: Int32Array
    members: Int32Array


def grow(triangles: Float32Array) -> Tree:
    """The tree of some triangles, split at the median of their longest side.

    Args:
        triangles: (T, 3, 3), T ≥ 1.
    """
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    middle = (low + high) / 2
    lows: list[Float32Array] = []
    highs: list[Float32Array] = []
    nodes: list[list[int]] = []
    order: list[Int32Array] = []
    todo = [(np.arange(len(triangles)), -1)]
    placed = 0
    while todo:
        members, at = todo.pop()
        if at < 0:
            at = 0
            lows, highs, nodes = [low[0]], [high[0]], [[-1, 0, 0]]
        lows[at], highs[at] = low[members].min(axis=0), high[members].max(axis=0)
        if len(members) <= _LEAF:
            nodes[at] = [-1, placed, len(members)]
            order.append(members.astype(np.int32))
            placed += len(members)
            continue
        spread = middle[members]
        axis = int(np.argmax(np.ptp(spread, axis=0)))
        half = len(members) // 2
        split = members[np.argpartition(spread[:, axis], half)]
        child = len(nodes)
        nodes[at] = [child, 0, 0]
        for k, part in enumerate((split[:half], split[half:])):
            lows.append(low[0])
            highs.append(high[0])
            nodes.append([-1, 0, 0])
            todo.append((part, child + k))
    table = np.array(nodes, dtype=np.int32)
    indices = np.concatenate(order)
    return Tree(
        np.ascontiguousarray(triangles[indices], dtype=np.float32),
        indices,
        np.array(lows, dtype=np.float32),
        np.array(highs, dtype=np.float32),
        *(np.ascontiguousarray(table[:, k]) for k in range(3)),
    )


@njit(cache=True)
def first_hits(tree, origins, directions, reach, any_hit):
    """The first triangle on each ray.

    Args:
        tree: of the triangles.
        origins: (N, 3) float32.
        directions: (N, 3) float32.
        reach: (N,) farthest distance, in lengths of the direction.
        any_hit: whether any triangle will do.

    Returns:
        (N,) index of the triangle as given, −1 where there is none, and (N,) its distance.
    """
    count = len(origins)
    triangle = np.full(count, -1, dtype=np.int32)
    distance = np.empty(count, dtype=np.float32)
    stack = np.empty(_DEPTH, dtype=np.int32)
    for k in range(count):
        ox, oy, oz = origins[k, 0], origins[k, 1], origins[k, 2]
        dx, dy, dz = directions[k, 0], directions[k, 1], directions[k, 2]
        ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
        best = reach[k]
        stack[0] = 0
        size = 1
        while size > 0:
            size -= 1
            node = stack[size]
            x0, x1 = (tree.low[node, 0] - ox) * ix, (tree.high[node, 0] - ox) * ix
            y0, y1 = (tree.low[node, 1] - oy) * iy, (tree.high[node, 1] - oy) * iy
            z0, z1 = (tree.low[node, 2] - oz) * iz, (tree.high[node, 2] - oz) * iz
            enter = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), np.float32(0)))
            leave = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), best))
            if enter > leave * np.float32(1.00001) + np.float32(1e-6):
                continue
            if tree.left[node] >= 0:
                stack[size], stack[size + 1] = tree.left[node], tree.left[node] + 1
                size += 2
                continue
            for t in range(tree.first[node], tree.first[node] + tree.members[node]):
                found = _meet(tree.triangles[t], ox, oy, oz, dx, dy, dz)
                if 0 < found < best:
                    best = found
                    triangle[k] = tree.order[t]
            if any_hit and triangle[k] >= 0:
                break
        distance[k] = best
    return triangle, distance


@njit(cache=True)
def _inverse(x):
    return np.float32(1) / x if abs(x) > 1e-12 else np.float32(1e12)


@njit(cache=True)
def _meet(corners, ox, oy, oz, dx, dy, dz):
    """Distance along a ray to a triangle, −1 where they do not meet (Möller and Trumbore)."""
    ax, ay, az = corners[0, 0], corners[0, 1], corners[0, 2]
    ex, ey, ez = corners[1, 0] - ax, corners[1, 1] - ay, corners[1, 2] - az
    fx, fy, fz = corners[2, 0] - ax, corners[2, 1] - ay, corners[2, 2] - az
    px, py, pz = dy * fz - dz * fy, dz * fx - dx * fz, dx * fy - dy * fx
    det = ex * px + ey * py + ez * pz
    if abs(det) < 1e-12:
        return np.float32(-1)
    inverse = np.float32(1) / det
    sx, sy, sz = ox - ax, oy - ay, oz - az
    u = (sx * px + sy * py + sz * pz) * inverse
    if u < -1e-5 or u > 1.00001:
        return np.float32(-1)
    qx, qy, qz = sy * ez - sz * ey, sz * ex - sx * ez, sx * ey - sy * ex
    v = (dx * qx + dy * qy + dz * qz) * inverse
    if v < -1e-5 or u + v > 1.00001:
        return np.float32(-1)
    return (fx * qx + fy * qy + fz * qz) * inverse
