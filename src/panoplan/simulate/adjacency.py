"""Where two rooms stand wall to wall."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from panoplan.types.arrays import FloatArray

_PARALLEL_RAD = np.deg2rad(1.0)


@dataclass(frozen=True, eq=False)
class SharedWall:
    """A stretch of wall between two rooms.

    Attributes:
        rooms: indices of the two rooms, the lower first.
        origin: (2,) where the stretch begins on the first room's face, metres.
        direction: (2,) unit, along the face, the first room on its left.
        length: of the stretch, metres.
        thickness: from face to face, metres.
    """

    rooms: tuple[int, int]
    origin: FloatArray
    direction: FloatArray
    length: float
    thickness: float

    @property
    def outward(self) -> FloatArray:
        """(2,) unit normal from the first room to the second."""
        return np.array([self.direction[1], -self.direction[0]])

    def faces(self, start: float, end: float) -> FloatArray:
        """Both faces of a part of the stretch.

        Args:
            start: metres along the stretch.
            end: metres along the stretch.

        Returns:
            (2, 2, 2): the segment on the first room's face and the one opposite, on the second's.
        """
        near = self.origin + np.array([[start], [end]]) * self.direction
        return np.stack([near, near + self.thickness * self.outward])


def shared_walls(
    polygons: Sequence[FloatArray],
    max_thickness: float = 0.35,
    min_length: float = 0.3,
    max_turn: float = _PARALLEL_RAD,
) -> list[SharedWall]:
    """All stretches where a wall of one room faces a parallel wall of another.

    Args:
        polygons: rooms, (N, 2) each, counter-clockwise, metres.
        max_thickness: faces farther apart than this (metres) are no wall.
        min_length: shorter stretches (metres) are left out.
        max_turn: faces that differ more in direction (rad) are not parallel.

    Returns:
        The stretches, by room pair.
    """
    low = np.array([p.min(axis=0) for p in polygons])
    high = np.array([p.max(axis=0) for p in polygons])
    found: list[SharedWall] = []
    for i in range(len(polygons)):
        near = np.all((low <= high[i] + max_thickness) & (high >= low[i] - max_thickness), axis=1)
        for j in np.flatnonzero(near).tolist():
            if j > i:
                found += _between(
                    (i, j), polygons[i], polygons[j], max_thickness, min_length, max_turn
                )
    return found


def longest_walls(walls: Iterable[SharedWall]) -> list[SharedWall]:
    """The longest stretch of each pair of rooms, in the order of their first ones.

    Args:
        walls: as of `shared_walls`.
    """
    longest: dict[tuple[int, int], SharedWall] = {}
    for wall in walls:
        longest[wall.rooms] = max(wall, longest.get(wall.rooms, wall), key=lambda w: w.length)
    return list(longest.values())


def _between(
    rooms: tuple[int, int],
    first: FloatArray,
    second: FloatArray,
    max_thickness: float,
    min_length: float,
    max_turn: float,
) -> list[SharedWall]:
    found = []
    for a, b in zip(first, np.roll(first, -1, axis=0), strict=True):
        length = float(np.hypot(*(b - a)))
        along = (b - a) / length
        outward = np.array([along[1], -along[0]])
        for c, d in zip(second, np.roll(second, -1, axis=0), strict=True):
            opposite = (d - c) / np.hypot(*(d - c))
            turn = abs(along[0] * opposite[1] - along[1] * opposite[0])
            gap = float(outward @ ((c + d) / 2 - a))
            if along @ opposite > 0 or turn > max_turn or not 0 < gap <= max_thickness:
                continue
            start = max(0.0, float(along @ (d - a)))
            end = min(length, float(along @ (c - a)))
            if end - start >= min_length:
                found.append(SharedWall(rooms, a + start * along, along, end - start, gap))
    return found
