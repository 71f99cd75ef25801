"""Cutting convex floor areas into rooms with walls of a given thickness between them.

A straight cut takes a strip as wide as the wall out of the area: what remains on both sides are
interior faces, parallel to one another however slanted the cut is.
"""

from __future__ import annotations

import numpy as np

from panoplan.types.arrays import FloatArray

_WELD_M = 1e-6


def clip(polygon: FloatArray, normal: FloatArray, offset: float) -> FloatArray:
    """The part of a convex polygon where normal·x ≤ offset.

    Args:
        polygon: (N, 2) convex, counter-clockwise.
        normal: (2,) any length but 0.
        offset: right-hand side.

    Returns:
        (M, 2) convex, counter-clockwise; (0, 2) where nothing is left.
    """
    excess = polygon @ normal - offset
    kept: list[FloatArray] = []
    for a, b, da, db in zip(
        polygon, np.roll(polygon, -1, axis=0), excess, np.roll(excess, -1), strict=True
    ):
        if da <= 0:
            kept.append(a)
        if da * db < 0:
            kept.append(a + (b - a) * (da / (da - db)))
    return _welded(kept)


def cut(
    polygon: FloatArray, point: FloatArray, direction: FloatArray, thickness: float
) -> tuple[FloatArray, FloatArray]:
    """Puts a wall across a convex polygon.

    Args:
        polygon: (N, 2) convex, counter-clockwise, metres.
        point: (2,) on the wall's centre line.
        direction: (2,) unit, along the wall.
        thickness: of the wall, metres.

    Returns:
        What is left of the wall and what is right of it, seen along `direction`.
    """
    right = np.array([direction[1], -direction[0]])
    at = float(right @ point)
    return (
        clip(polygon, right, at - thickness / 2),
        clip(polygon, -right, -(at + thickness / 2)),
    )


def upright_cut(
    polygon: FloatArray, x: float, slant: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Puts a wall across x.

    Args:
        polygon: (N, 2) convex, counter-clockwise, metres.
        x: where the wall is in the middle of the polygon's depth.
        slant: by which it leaves the square, rad.
        rng: of its thickness.

    Returns:
        What lies at lower x, and at higher x.
    """
    middle = np.array([x, (polygon[:, 1].min() + polygon[:, 1].max()) / 2])
    return cut(polygon, middle, np.array([np.sin(slant), np.cos(slant)]), wall_thickness(rng))


def wall_thickness(rng: np.random.Generator) -> float:
    """Of an inner wall, 8 to 25 cm, in metres."""
    return float(rng.uniform(0.08, 0.25))


def notch(
    polygon: FloatArray, corner: int, sizes: tuple[float, float], thickness: float
) -> tuple[FloatArray, FloatArray]:
    """Walls off a corner of a convex polygon.

    Args:
        polygon: (N, 2) convex, counter-clockwise, metres.
        corner: index of the vertex.
        sizes: how far the small room reaches from the edge before the corner and from the
            edge after it, metres.
        thickness: of the walls, metres.

    Returns:
        The small room in the corner, and the rest: an L with the same corner cut out.
    """
    vertex = polygon[corner]
    towards = [polygon[corner - 1] - vertex, polygon[(corner + 1) % len(polygon)] - vertex]
    back, ahead = (v / np.hypot(v[0], v[1]) for v in towards)
    sine = abs(float(back[0] * ahead[1] - back[1] * ahead[0]))
    # Inward normals of the two edges.
    from_back = np.array([back[1], -back[0]])
    from_ahead = np.array([-ahead[1], ahead[0]])

    def at(depth_back: float, depth_ahead: float) -> FloatArray:
        return np.asarray(vertex + ahead * (depth_back / sine) + back * (depth_ahead / sine))

    small = clip(polygon, from_back, float(from_back @ vertex) + sizes[0])
    small = clip(small, from_ahead, float(from_ahead @ vertex) + sizes[1])
    a, b = sizes[0] + thickness, sizes[1] + thickness
    others = [polygon[(corner + k) % len(polygon)] for k in range(1, len(polygon))]
    rest = np.array([at(a, 0.0), *others, at(0.0, b), at(a, b)])
    return small, rest


def without_straight_corners(ring: FloatArray) -> FloatArray:
    """(M, 2) the ring (N, 2) less its corners at which it goes straight on."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(ring[np.abs(cross) > 1e-6 * np.hypot(*before.T) * np.hypot(*after.T)])


def _welded(points: list[FloatArray]) -> FloatArray:
    kept = [
        p
        for k, p in enumerate(points)
        if np.hypot(*(p - points[k - 1])) > _WELD_M or len(points) == 1
    ]
    return np.array(kept) if len(kept) >= 3 else np.empty((0, 2))
