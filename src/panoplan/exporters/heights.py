"""Heights that a plan tells, and those that it leaves open and models assume."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from panoplan.exporters.storeys import Storey
from panoplan.types.plan import Room

CEILING_M = 2.5
"""Ceiling of a room where no ceiling of the plan was seen."""

DOOR_HEAD_M = 2.03
"""Height of doors: plans do not tell it."""

WINDOW_SILL_M = 0.9
WINDOW_HEAD_M = 2.1
"""Lower and upper edge of windows: plans do not tell them."""

SLAB_M = 0.3
"""Between the ceilings of one storey and the floor of the next: plans do not tell it."""

_LINTEL_M = 0.05


def ceilings(floors: Sequence[Storey]) -> dict[str, float]:
    """Floor to ceiling of every room in metres, by its id.

    A room whose ceiling was not seen has the median of its storey, else of all, else `CEILING_M`.
    """
    everywhere = _median([room for floor in floors for room in floor.rooms], CEILING_M)
    found = {}
    for floor in floors:
        usual = _median(floor.rooms, everywhere)
        for room in floor.rooms:
            found[room.id] = room.ceiling_height or usual
    return found


def elevations(floors: Sequence[Storey]) -> dict[int, float]:
    """Height of each storey's floor above that of level 0 in metres, by level.

    Storeys are stacked by their highest ceilings; without a level 0 the lowest is at 0.
    """
    heights = ceilings(floors)
    rise, found = 0.0, {}
    for floor in floors:
        found[floor.level] = rise
        rise += max(heights[room.id] for room in floor.rooms) + SLAB_M
    ground = found.get(0, 0.0)
    return {level: height - ground for level, height in found.items()}


def door_head(ceiling: float) -> float:
    """Upper edge of a door below a ceiling, metres."""
    return min(DOOR_HEAD_M, ceiling - _LINTEL_M)


def window_edges(ceiling: float) -> tuple[float, float]:
    """Lower and upper edge of a window below a ceiling, metres."""
    head = min(WINDOW_HEAD_M, ceiling - _LINTEL_M)
    return min(WINDOW_SILL_M, head / 2), head


def _median(rooms: Sequence[Room], otherwise: float) -> float:
    seen = [room.ceiling_height for room in rooms if room.ceiling_height is not None]
    return float(np.median(seen)) if seen else otherwise
