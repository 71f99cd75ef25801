"""A wall moved across itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from panoplan.errors import InputError
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Aperture, FloorPlan, Room, Wall

_PARALLEL = np.sin(np.deg2rad(10.0))


def nudged(plan: FloorPlan, wall_id: str, outward: float) -> FloorPlan:
    """The plan with one wall of a room moved out of it, or into it.

    The walls beside it are lengthened or shortened along themselves; where one runs the same way,
    a step is left. A wall that it shares becomes thinner or thicker; doors, openings and windows in
    it move along.

    Args:
        plan: any.
        wall_id: of the wall.
        outward: plan units, negative into the room.

    Raises:
        InputError: the room would vanish or cross itself, or the wall would go through the room
            behind it.
    """
    room = next(r for r in plan.rooms if any(w.id == wall_id for w in r.walls))
    place = next(k for k, w in enumerate(room.walls) if w.id == wall_id)
    moved = _moved(room, place, outward)
    along = room.walls[place].b - room.walls[place].a
    normal = np.array([along[1], -along[0]]) / float(np.hypot(*along))
    shared = []
    for item in plan.shared_walls:
        if wall_id in item.walls:
            left = item.thickness - outward
            if left < 0:
                raise InputError(
                    f"nudge of {wall_id}",
                    f"{outward:g}, through the wall",
                    f"at most {item.thickness:.3f}, its thickness",
                )
            item = replace(item, thickness=left)
        shared.append(item)

    def aperture(item: Aperture) -> Aperture:
        if wall_id not in item.walls:
            return item
        # Between two faces it stays in their middle.
        return replace(item, segment=item.segment + outward / len(item.walls) * normal)

    return replace(
        plan,
        rooms=tuple(moved if r.id == room.id else r for r in plan.rooms),
        shared_walls=tuple(shared),
        doors=tuple(aperture(item) for item in plan.doors),
        openings=tuple(aperture(item) for item in plan.openings),
        windows=tuple(aperture(item) for item in plan.windows),
    )


def _moved(room: Room, place: int, outward: float) -> Room:
    import shapely

    walls = list(room.walls)
    count = len(walls)
    before, wall, after = walls[place - 1], walls[place], walls[(place + 1) % count]
    along = (wall.b - wall.a) / float(np.hypot(*(wall.b - wall.a)))
    shift = np.array([along[1], -along[0]]) * outward
    a, step_a = _corner(before.b - before.a, wall.a, along, shift)
    b, step_b = _corner(after.b - after.a, wall.b, along, shift)
    walls[place] = replace(wall, a=a, b=b)
    walls[place - 1] = replace(before, b=wall.a if step_a else a)
    walls[(place + 1) % count] = replace(walls[(place + 1) % count], a=wall.b if step_b else b)
    if step_a:
        walls.insert(place, Wall(f"{wall.id}a", wall.a, a, wall.sigma))
    if step_b:
        walls.insert(place + (2 if step_a else 1), Wall(f"{wall.id}b", b, wall.b, wall.sigma))
    ring = np.array([w.a for w in walls])
    area = shapely.Polygon(ring)
    if not (area.is_valid and area.exterior.is_ccw):
        raise InputError(
            f"nudge of {wall.id}", f"{outward:g}, a room turned inside out", "a smaller one"
        )
    return replace(room, walls=tuple(walls), polygon=ring)


def _corner(
    neighbour: FloatArray, corner: FloatArray, along: FloatArray, shift: FloatArray
) -> tuple[FloatArray, bool]:
    """Where a moved wall meets its neighbour's line, and whether it does so over a step."""
    direction = neighbour / max(float(np.hypot(*neighbour)), 1e-12)
    cross = float(along[0] * direction[1] - along[1] * direction[0])
    if abs(cross) < _PARALLEL:
        return corner + shift, True
    reach = float(along[0] * shift[1] - along[1] * shift[0]) / cross
    return corner + reach * direction, False
