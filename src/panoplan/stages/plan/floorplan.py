"""All rooms of a set of views: grouped, fused, outlined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from panoplan.config import Config
from panoplan.stages.plan.fusion import NOBODY, Floor, Territories, floor_beside, floor_of, fuse
from panoplan.stages.plan.grouping import Group, group
from panoplan.stages.plan.outline import outline
from panoplan.stages.plan.sight import Sights, sights
from panoplan.types.arrays import BoolArray
from panoplan.types.room import RoomShape
from panoplan.types.view import RegisteredLayout, picked


@dataclass(frozen=True, eq=False)
class PlannedRoom:
    """A room and its views.

    Attributes:
        members: indices of its views, increasing; views from its doorways last.
        shape: its outline, or why there is none.
        floor: that the outline is of, None where its views agree on none.
    """

    members: tuple[int, ...]
    shape: RoomShape
    floor: Floor | None


def plan_rooms(
    views: Sequence[RegisteredLayout],
    config: Config,
    known: Sequence[Sequence[int]] | None = None,
) -> tuple[PlannedRoom, ...]:
    """Finds the rooms that views show.

    A view from a doorway makes a room of its own of what it alone sees, as of a closet; where it
    sees no more than others, it belongs to the room that its camera stands in or next to.

    Args:
        views: registered layouts, any number.
        config: settings.
        known: indices of the views of each room as found before, where rooms are only to be shaped
            anew.

    Returns:
        The rooms by their first view; every view is a member of exactly one.
    """
    made = []
    for apart in _separate(views, config):
        place = {k: number for number, k in enumerate(apart)}
        groups = None
        if known is not None:
            parts = (sorted(place[k] for k in members if k in place) for members in known)
            groups = [tuple(part) for part in parts if part]
        made += [
            replace(room, members=tuple(apart[k] for k in room.members))
            for room in _rooms_together(picked(views, apart), config, groups)
        ]
    return tuple(sorted(made, key=lambda room: min(room.members)))


def _separate(views: Sequence[RegisteredLayout], config: Config) -> list[list[int]]:
    """Sets of views that have nothing to do with one another.

    They lie so far apart that no two regions touch; one lattice over all of them would take
    memory without end where a single pose is lost.
    """
    if not views:
        return []
    reach = 2 * max(config.fusion.reach_ch, config.grouping.reach_ch) + 1.0
    blocks, block = np.unique(
        np.floor(np.array([view.camera for view in views]) / reach), axis=0, return_inverse=True
    )
    # Between blocks that are no neighbours lies a whole one.
    one, other = KDTree(blocks).query_pairs(1.5, p=np.inf, output_type="ndarray").T
    touching = coo_array((np.ones(len(one)), (one, other)), shape=(len(blocks), len(blocks)))
    count, part = connected_components(touching, directed=False)
    return [np.flatnonzero(part[block] == k).tolist() for k in range(count)]


def _rooms_together(
    views: Sequence[RegisteredLayout], config: Config, groups: Sequence[Group] | None
) -> list[PlannedRoom]:
    seen = sights(views)
    grouping = group(seen, config.grouping, config.fusion, groups)
    territories = grouping.territories
    assert territories is not None
    taken = _Taken(territories)
    rooms: list[PlannedRoom] = []
    for index, (members, evidence) in enumerate(
        zip(grouping.rooms, grouping.evidences, strict=True)
    ):
        own = seen.pick(members)
        floor = floor_of(index, evidence, territories, own.cameras, config.fusion)
        if floor is None:
            shape = RoomShape(None, "its views agree on no floor")
        else:
            taken.add(floor)
            shape = outline(floor, own, config.outline, config.fusion)
        rooms.append(PlannedRoom(members, shape, floor))
    through_door: dict[int, list[int]] = {}
    closets: list[PlannedRoom] = []
    for view in grouping.doorways:
        closet = _closet(view, seen, taken, config)
        if closet is None:
            home = _home(view, seen, grouping.rooms, territories, config)
            through_door.setdefault(home, []).append(view)
        else:
            closets.append(closet)
    rooms = [
        replace(room, members=(*room.members, *through_door.get(k, [])))
        for k, room in enumerate(rooms)
    ]
    return [*rooms, *closets]


@dataclass
class _Taken:
    """Cells that rooms hold, and with their walls."""

    territories: Territories
    cells: BoolArray = field(init=False)

    def __post_init__(self) -> None:
        self.cells = np.zeros(self.territories.owner.shape, dtype=bool)

    def add(self, floor: Floor) -> None:
        """Marks a room's floor; what lies beyond the territories is nobody's."""
        here, there = self._common(floor.first_cell, floor.mask.shape)
        self.cells[here] |= floor.mask[there]

    def around(self, first_cell: tuple[int, int], shape: tuple[int, int]) -> BoolArray:
        """The cells taken, grown by a wall, in a window of the lattice."""
        out = np.zeros(shape, dtype=bool)
        here, there = self._common(first_cell, shape)
        out[there] = self.cells[here]
        return np.asarray(ndimage.binary_dilation(out, iterations=_WALL_CELLS))

    def _common(
        self, first_cell: tuple[int, int], shape: tuple[int, ...]
    ) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
        low = np.maximum(first_cell, self.territories.first_cell)
        high = np.minimum(
            np.add(first_cell, shape), np.add(self.territories.first_cell, self.cells.shape)
        )
        high = np.maximum(high, low)
        here, there = low - self.territories.first_cell, low - first_cell
        size = high - low
        return (
            (slice(here[0], here[0] + size[0]), slice(here[1], here[1] + size[1])),
            (slice(there[0], there[0] + size[0]), slice(there[1], there[1] + size[1])),
        )


_WALL_CELLS = 2


def _closet(view: int, seen: Sights, taken: _Taken, config: Config) -> PlannedRoom | None:
    own = seen.pick([view])
    evidence = fuse(own, config.fusion)
    around = taken.around(evidence.first_cell, evidence.total.shape)
    floor = floor_beside(evidence, around, own.cameras[0], config.fusion)
    if floor is None:
        return None
    shape = outline(floor, own, config.outline, config.fusion)
    if shape.polygon is None:
        return None
    taken.add(floor)
    return PlannedRoom((view,), shape, floor)


def _home(
    view: int,
    seen: Sights,
    rooms: Sequence[tuple[int, ...]],
    territories: Territories,
    config: Config,
) -> int:
    """The room whose floor a doorway's camera stands on, else that of the nearest other camera."""
    owner = territories.owner_at(seen.cameras[view], config.fusion.cell_ch)
    if owner != NOBODY:
        return owner
    away = [
        float(np.hypot(*(seen.cameras[list(members)] - seen.cameras[view]).T).min())
        for members in rooms
    ]
    return int(np.argmin(away))
