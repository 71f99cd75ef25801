"""Footprints of houses: wings, convex areas that stand wall to wall."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from panoplan.geometry.polygons import signed_area
from panoplan.simulate.partition import clip
from panoplan.types.arrays import FloatArray

Shape = Literal["I", "L", "T", "U", "H", "O"]
Gallery = Literal["low", "high"]
_BETWEEN_WINGS_M = 2.0
_SHORTEST_M = 3.0


@dataclass(frozen=True, eq=False)
class Wing:
    """A convex part of a house.

    Attributes:
        outline: (N, 2) inside of its outer walls, counter-clockwise, in the wing's own frame: x
            along the wing; metres.
        angle: rad, of the wing's x axis in the house.
        origin: (2,) of the wing's frame in the house, metres.
        gallery: the long side along which a corridor runs, or None for one in the middle.
    """

    outline: FloatArray
    angle: float
    origin: FloatArray
    gallery: Gallery | None = None

    @property
    def area(self) -> float:
        """Inner area, m²."""
        return signed_area(self.outline)

    def placed(self, points: FloatArray) -> FloatArray:
        """(N, 2) points of the wing's frame in the house."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.asarray(points @ np.array([[c, s], [-s, c]]) + self.origin)


def make_wings(
    rng: np.random.Generator, shape: Shape, area_m2: float, depth_m: float, skewed: bool
) -> list[Wing] | None:
    """Wings whose areas come to a sum.

    Args:
        rng: of lengths, places and angles.
        shape: seen from above; "O" goes round a courtyard.
        area_m2: of all wings together.
        depth_m: of a wing across, about.
        skewed: whether wings may meet and end at angles other than 90°.

    Returns:
        The wings, the main one first, or None where a draw does not fit: too short, or side
        wings that meet.
    """
    if shape == "O":
        return _around_a_court(rng, area_m2, depth_m)
    sides = {"I": 0, "L": 1, "T": 1, "U": 2, "H": 4}[shape]
    share = 1.0 if sides == 0 else rng.uniform(0.42, 0.6)
    depth = depth_m * rng.uniform(0.9, 1.15)
    length = share * area_m2 / depth
    main = _ended(rng, _box(length, depth), skewed)
    wings = [Wing(main, 0.0, np.zeros(2))]
    parts = (1 - share) * area_m2 * rng.dirichlet(np.full(sides, 12.0)) if sides else np.empty(0)
    for part, (at, up) in zip(parts, _joints(rng, shape, length, depth_m), strict=True):
        across = min(depth_m * rng.uniform(0.85, 1.1), 0.95 * length)
        reach = part / across
        if reach < _SHORTEST_M or length < _SHORTEST_M:
            return None
        turn = np.deg2rad(rng.uniform(8, 35)) * rng.choice([-1, 1])
        turn = turn if skewed and rng.random() < 0.5 else 0.0
        wings.append(_side_wing(rng, at, up, across, reach, turn, depth, skewed))
    return wings if _apart(wings) else None


def _box(length: float, depth: float) -> FloatArray:
    return np.array([[0.0, 0.0], [length, 0.0], [length, depth], [0.0, depth]])


def _ended(rng: np.random.Generator, box: FloatArray, skewed: bool) -> FloatArray:
    """A box along x whose short ends may be slanted, at about the same area."""
    length, depth = box.max(axis=0)
    for x, sign in ((0.0, -1.0), (length, 1.0)):
        if not skewed or rng.random() < 0.6:
            continue
        slant = np.deg2rad(rng.uniform(5, 18)) * rng.choice([-1, 1])
        normal = sign * np.array([np.cos(slant), np.sin(slant)])
        inset = depth / 4 * abs(np.tan(slant))
        box = clip(box, normal, float(normal @ [x - sign * inset, depth / 2]))
    return box


def _joints(
    rng: np.random.Generator, shape: Shape, length: float, depth: float
) -> list[tuple[float, bool]]:
    """(middle along the main wing, whether on its upper side) of each side wing."""
    low, high = depth / 2, max(length - depth / 2, depth / 2)
    up = bool(rng.random() < 0.5)
    if shape == "L":
        return [(float(rng.choice([low, high])), up)]
    if shape == "T":
        middle = float(rng.uniform(0.35, 0.65) * length)
        return [(middle, up)]
    if shape == "U":
        return [(low, up), (high, up)]
    if shape == "H":
        return [(low, True), (high, True), (low, False), (high, False)]
    return []


def _side_wing(
    rng: np.random.Generator,
    at: float,
    up: bool,
    across: float,
    reach: float,
    turn: float,
    main_depth: float,
    skewed: bool,
) -> Wing:
    """A wing that begins behind the wall of the main wing's long side."""
    wall = float(rng.uniform(0.12, 0.25))
    back = across / 2 * abs(np.tan(turn)) + 0.01
    box = _ended(rng, _box(reach + 2 * back, across), skewed)
    angle = (np.pi / 2 if up else -np.pi / 2) + turn
    c, s = np.cos(angle), np.sin(angle)
    # The wing's own axis passes through the joint; its near end is cut along the main wing.
    joint = np.array([at, main_depth + wall if up else -wall])
    origin = joint - back * np.array([c, s]) - across / 2 * np.array([-s, c])
    outwards = 1.0 if up else -1.0
    normal = np.array([-outwards * s, -outwards * c])
    outline = clip(box, normal, -outwards * float(joint[1] - origin[1]))
    return Wing(outline, angle, origin)


def _around_a_court(rng: np.random.Generator, area: float, depth: float) -> list[Wing] | None:
    """Two wings along the court and beyond its ends, two between them."""
    across = depth * rng.uniform(0.62, 0.8)
    wall = float(rng.uniform(0.12, 0.25))
    # Inner area of the ring: 2·w·across + 2·h·across.
    half = area / across / 2
    width = half * rng.uniform(0.5, 0.62)
    height = half - width
    court = width - 2 * across
    if court < _SHORTEST_M or height < _SHORTEST_M:
        return None
    zero = np.zeros(2)
    top = height + 2 * wall + across
    return [
        Wing(_box(width, across), 0.0, zero, "high"),
        Wing(_box(width, across), 0.0, np.array([0.0, top]), "low"),
        Wing(_box(height, across), np.pi / 2, np.array([across, across + wall]), "low"),
        Wing(_box(height, across), np.pi / 2, np.array([width, across + wall]), "high"),
    ]


def _apart(wings: Sequence[Wing]) -> bool:
    """Whether side wings keep clear of one another, so that courts and gaps can be told."""
    placed = [shapely.Polygon(w.placed(w.outline)) for w in wings]
    return all(
        a.distance(b) > _BETWEEN_WINGS_M for k, a in enumerate(placed[1:]) for b in placed[k + 2 :]
    ) and all(p.is_valid and p.area > 0 for p in placed)
