"""What an edit marks, found again in a plan: by where it lies, not by its id."""

from __future__ import annotations

import numpy as np
import shapely

from panoplan.types.arrays import FloatArray
from panoplan.types.edits import RoomMark, WallMark
from panoplan.types.plan import Aperture, FloorPlan, Room, Wall

_MIN_IOU = 0.5
_PARALLEL = np.cos(np.deg2rad(15.0))
_MIN_SHARE = 0.5
_FARTHEST_SHARE = 0.25


def units_per_su(plan: FloorPlan) -> float | None:
    """Plan units a trajectory unit, None where the scale is not known."""
    if plan.scale.ch_per_su is None:
        return None
    return plan.scale.ch_per_su * (plan.camera_height_m or 1.0)


def room_of(mark: RoomMark, plan: FloorPlan) -> Room | None:
    """The room of the plan that covers what was marked best, at an IoU of 0.5 or more."""
    marked = _valid(mark.polygon)
    best, found = _MIN_IOU, None
    for room in plan.rooms:
        if room.polygon is None or room.level != mark.level:
            continue
        area = _valid(room.polygon)
        union = float(marked.union(area).area)
        iou = float(marked.intersection(area).area) / union if union > 0 else 0.0
        if iou >= best:
            best, found = iou, room
    return found


def wall_of(mark: WallMark, plan: FloorPlan) -> Wall | None:
    """The wall that runs along the marked one and the same way, or None.

    It is parallel within 15°, has at least half of the longer in common with it, and lies no
    farther off than a quarter of the marked length.
    """
    walls = [w for room in plan.rooms if room.level == mark.level for w in room.walls]
    return _nearest(mark, walls)


def door_of(mark: WallMark, plan: FloorPlan) -> Aperture | None:
    """The door that lies where one was marked, or None."""
    doors = {door.id: door for door in plan.doors}
    both_ways = [(d.id, *ends) for d in plan.doors for ends in (d.segment, d.segment[::-1])]
    found = _nearest(mark, [Wall(*ends) for ends in both_ways])
    return None if found is None else doors[found.id]


def _nearest(mark: WallMark, walls: list[Wall]) -> Wall | None:
    length = float(np.hypot(*(mark.b - mark.a)))
    if length < 1e-9:
        return None
    along = (mark.b - mark.a) / length
    across = np.array([-along[1], along[0]])
    best, found = np.inf, None
    for wall in walls:
        own = wall.b - wall.a
        size = float(np.hypot(*own))
        if size < 1e-9 or own @ along < _PARALLEL * size:
            continue
        low, high = float((wall.a - mark.a) @ along), float((wall.b - mark.a) @ along)
        common = min(high, length) - max(low, 0.0)
        off = abs(float(((wall.a + wall.b - mark.a - mark.b) / 2) @ across))
        if common < _MIN_SHARE * max(size, length) or off > _FARTHEST_SHARE * length:
            continue
        apart = float(np.hypot(*(wall.a - mark.a)) + np.hypot(*(wall.b - mark.b)))
        if apart < best:
            best, found = apart, wall
    return found


def _valid(polygon: FloatArray) -> shapely.Geometry:
    return shapely.make_valid(shapely.Polygon(polygon))
