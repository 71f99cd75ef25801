"""Storeys upon one another, and the stairs between them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import shapely

from panoplan.simulate.buildings import Building, InteriorRoom, Stairs
from panoplan.simulate.joining import SERVANT, SHARED, WAYS
from panoplan.types.arrays import FloatArray

_SLAB_M = 0.3
_WIDTH_M = (0.8, 1.0)
_SLOPE_DEG = (36.0, 42.0)
_OFF_WALL_M = 0.02
_LANDING_M = 0.7
"""Free floor before the foot and beyond the head."""
_PLACES = 24


def stack(lower: Building, upper: Building, rng: np.random.Generator) -> Building | None:
    """A storey set upon a building.

    Args:
        lower: a building of one storey or more.
        upper: a building of one storey, in the same frame; its doors to the street are left out.
        rng: of the stairs.

    Returns:
        The building with stairs from its highest storey to the new one, or None where they fit
        nowhere.
    """
    top, first = len(lower.floors_m) - 1, len(lower.rooms)
    below = [k for k, room in enumerate(lower.rooms) if room.level == top]
    rise = max(lower.rooms[k].ceiling_height_m for k in below) + _SLAB_M
    stairs = _stairs(lower, below, upper, rise, rng)
    if stairs is None:
        return None
    return Building(
        lower.name,
        (*lower.rooms, *(replace(room, level=top + 1) for room in upper.rooms)),
        (
            *lower.passages,
            *(replace(p, rooms=(p.rooms[0] + first, p.rooms[1] + first)) for p in upper.passages),
        ),
        (*lower.windows, *(replace(w, room=w.room + first) for w in upper.windows)),
        lower.blind_doors,
        (*lower.floors_m, lower.floors_m[-1] + rise),
        (*lower.stairs, replace(stairs, rooms=(stairs.rooms[0], stairs.rooms[1] + first))),
    )


def _stairs(
    lower: Building, below: list[int], upper: Building, rise: float, rng: np.random.Generator
) -> Stairs | None:
    """A flight along a wall, from ways and shared rooms to their like where they allow it."""
    pairs = [
        (_rank(lower.rooms[i], upper.rooms[j]) + rng.random(), i, j)
        for i, j in product(below, range(len(upper.rooms)))
    ]
    for rank, i, j in sorted(pairs):
        if rank >= _NEVER:
            return None
        taken = shapely.union_all(
            [shapely.Polygon(s.area).buffer(_LANDING_M) for s in lower.stairs if i in s.rooms]
        )
        free = lower.rooms[i].floor.difference(taken)
        for _ in range(_PLACES):
            width = float(rng.uniform(*_WIDTH_M))
            run = rise / np.tan(np.deg2rad(rng.uniform(*_SLOPE_DEG)))
            room = (lower.rooms[i], upper.rooms[j])[int(rng.integers(2))]
            line = _along_a_wall(room, width, float(run), rng)
            if line is None:
                continue
            stairs = Stairs((i, j), line, width)
            if _fits(stairs, free, upper.rooms[j].floor):
                return stairs
    return None


_NEVER = 10.0


def _rank(lower: InteriorRoom, upper: InteriorRoom) -> float:
    """The lower the likelier that stairs join these rooms."""
    labels = (lower.label, upper.label)
    if any(label in SERVANT for label in labels):
        return _NEVER
    return float(sum(label not in WAYS | SHARED for label in labels))


def _along_a_wall(
    room: InteriorRoom, width: float, run: float, rng: np.random.Generator
) -> FloatArray | None:
    """(2, 2) the middle of a flight along one of a room's walls, or None where it is too short."""
    edge = int(rng.integers(len(room.polygon)))
    a, b = room.polygon[edge], room.polygon[(edge + 1) % len(room.polygon)]
    length = float(np.hypot(*(b - a)))
    if length < run + _LANDING_M:
        return None
    along = (b - a) / length
    inward = np.array([-along[1], along[0]])
    start = a + rng.uniform(0.0, length - run) * along + (width / 2 + _OFF_WALL_M) * inward
    line = np.array([start, start + run * along])
    return line if rng.random() < 0.5 else line[::-1]


def _fits(stairs: Stairs, below: shapely.Geometry, above: shapely.Geometry) -> bool:
    """Whether both floors hold the flight, and free floor where it begins and ends."""
    flight = shapely.Polygon(stairs.area)
    if not (below.covers(flight) and above.covers(flight)):
        return False
    half = stairs.width / 2 * np.array([-stairs.along[1], stairs.along[0]])
    ends = []
    for end, towards in zip(stairs.line, (-stairs.along, stairs.along), strict=True):
        far = end + _LANDING_M * towards
        ends.append(shapely.Polygon([end - half, end + half, far + half, far - half]))
    return bool(below.covers(ends[0]) and above.covers(ends[1]))
