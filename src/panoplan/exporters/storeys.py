"""A plan storey by storey."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.metrics.levels import aperture_level
from panoplan.metrics.rooms import region
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Aperture, FloorPlan, PlanPose, Room, SharedWall, Wall


@dataclass(frozen=True, eq=False)
class Storey:
    """What a plan holds of one level.

    Attributes:
        level: 0 for that of the first keyframe.
        rooms: those that have a polygon.
        shared_walls: whose faces are of these rooms.
        doors: of these rooms.
        openings: of these rooms.
        windows: of these rooms.
        cameras: assigned to these rooms; of the first storey also those that are of no room.
    """

    level: int
    rooms: tuple[Room, ...]
    shared_walls: tuple[SharedWall, ...]
    doors: tuple[Aperture, ...]
    openings: tuple[Aperture, ...]
    windows: tuple[Aperture, ...]
    cameras: tuple[PlanPose, ...]

    @property
    def walls(self) -> dict[str, Wall]:
        """The walls of its rooms by id."""
        return {wall.id: wall for room in self.rooms for wall in room.walls}

    @property
    def name(self) -> str:
        """What the storey is called."""
        return f"Level {self.level}"


def storeys(plan: FloorPlan) -> tuple[Storey, ...]:
    """The storeys that have rooms, lowest first.

    Apertures that name no room are of the storey whose walls they are in, else of the lowest.
    """
    shaped = [room for room in plan.rooms if room.polygon is not None]
    levels = sorted({room.level for room in shaped})
    lowest = levels[0] if levels else 0
    of_room = {room.id: room.level for room in shaped}
    of_wall = {wall.id: room.level for room in shaped for wall in room.walls}

    def of(items: tuple[Aperture, ...], level: int) -> tuple[Aperture, ...]:
        return tuple(item for item in items if aperture_level(item, of_room, of_wall) == level)

    return tuple(
        Storey(
            level,
            tuple(room for room in shaped if room.level == level),
            tuple(w for w in plan.shared_walls if of_wall.get(w.walls[0]) == level),
            of(plan.doors, level),
            of(plan.openings, level),
            of(plan.windows, level),
            tuple(c for c in plan.trajectory if of_room.get(c.room or "", lowest) == level),
        )
        for level in levels
    )


def spread(plan: FloorPlan, pitch: float | None = None) -> FloorPlan:
    """The plan with its storeys beside one another, to be drawn on one sheet, level 0 at left.

    Args:
        plan: of any number of storeys; one of a single storey is returned as it is.
        pitch: how far each is shifted from the last, plan units; None for so far that they are
            apart.
    """
    found = storeys(plan)
    if len(found) < 2:
        return plan
    if pitch is None:
        pitch = spread_pitch(plan)
    moved = [_shifted(storey, np.array([k * pitch, 0.0])) for k, storey in enumerate(found)]
    without = tuple(room for room in plan.rooms if room.polygon is None)
    kept = {camera.id: camera for storey in moved for camera in storey.cameras}
    return replace(
        plan,
        rooms=tuple(sorted((*without, *(r for s in moved for r in s.rooms)), key=lambda r: r.id)),
        trajectory=tuple(kept.get(camera.id, camera) for camera in plan.trajectory),
        doors=tuple(item for storey in moved for item in storey.doors),
        openings=tuple(item for storey in moved for item in storey.openings),
        windows=tuple(item for storey in moved for item in storey.windows),
    )


def spread_pitch(plan: FloorPlan) -> float:
    """How far apart `spread` sets storeys: the widest one and a tenth more, plan units."""
    ends = [bounds(storey, np.eye(2)) for storey in storeys(plan)]
    return 1.1 * max((float((high - low)[0]) for low, high in ends), default=0.0)


def _shifted(storey: Storey, shift: FloatArray) -> Storey:
    def aperture(item: Aperture) -> Aperture:
        return replace(item, segment=item.segment + shift)

    def room(item: Room) -> Room:
        return replace(
            item,
            polygon=None if item.polygon is None else item.polygon + shift,
            holes=tuple(hole + shift for hole in item.holes),
            walls=tuple(replace(w, a=w.a + shift, b=w.b + shift) for w in item.walls),
        )

    return replace(
        storey,
        rooms=tuple(room(item) for item in storey.rooms),
        doors=tuple(aperture(item) for item in storey.doors),
        openings=tuple(aperture(item) for item in storey.openings),
        windows=tuple(aperture(item) for item in storey.windows),
        cameras=tuple(replace(c, position=c.position + shift) for c in storey.cameras),
    )


def metric_storeys(plan: FloorPlan) -> tuple[Storey, ...]:
    """The storeys of a plan in metres.

    Raises:
        InputError: the plan is in camera heights, or no room of it has a shape.
    """
    if plan.unit != "m":
        raise InputError(
            "plan",
            "lengths in camera heights",
            "metres: run with --camera-height or --trajectory-unit m",
        )
    found = storeys(plan)
    if not found:
        raise InputError("plan", "no room with a shape", "at least one")
    return found


def room_area(room: Room) -> Any:
    """The shapely area of a room that has a polygon."""
    return region(np.empty((0, 2)) if room.polygon is None else room.polygon, room.holes)


def bounds(storey: Storey, rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(2,) least and (2,) greatest coordinates of what a storey holds, after a (2, 2) rotation."""
    parts = [room.polygon for room in storey.rooms if room.polygon is not None]
    parts += [a.segment for a in (*storey.doors, *storey.openings, *storey.windows)]
    parts += [camera.position[None] for camera in storey.cameras]
    points = np.concatenate(parts) @ rotation.T
    return points.min(axis=0), points.max(axis=0)


def through(item: Aperture, shared: Mapping[frozenset[str], SharedWall]) -> float:
    """Thickness of the wall that an aperture is in, 0 where it is not known.

    Args:
        item: the aperture.
        shared: the storey's shared walls by the ids of their faces.
    """
    wall = shared.get(frozenset(item.walls))
    return 0.0 if wall is None else wall.thickness


def by_faces(storey: Storey) -> dict[frozenset[str], SharedWall]:
    """The shared walls by the ids of their faces."""
    return {frozenset(wall.walls): wall for wall in storey.shared_walls}


def inner_walls(storey: Storey) -> Any:
    """The shapely area between rooms: the solid bodies of the walls that they share.

    Gaps of up to the thickest shared wall count as wall; openings are taken out.
    """
    rooms = shapely.union_all([room_area(room) for room in storey.rooms])
    reach = max((wall.thickness for wall in storey.shared_walls), default=0.0) / 2 + 0.01
    closed = rooms.buffer(reach, join_style="mitre").buffer(-reach, join_style="mitre")
    solid = closed.difference(rooms.buffer(1e-6, join_style="mitre"))
    shared = by_faces(storey)
    gaps = [aperture_area(item, through(item, shared) + 0.02) for item in storey.openings]
    return solid.difference(shapely.union_all(gaps))


def aperture_area(item: Aperture, thickness: float) -> Any:
    """The shapely rectangle of an aperture through a wall of a thickness."""
    line = shapely.LineString(item.segment)
    return line.buffer(max(thickness, 1e-6) / 2, cap_style="flat")
