"""Edits applied to a plan."""

from __future__ import annotations

from dataclasses import dataclass, replace

from panoplan.editing.match import room_of, units_per_su, wall_of
from panoplan.editing.nudge import nudged
from panoplan.editing.scale import combined, rescaled, witnesses
from panoplan.errors import InputError
from panoplan.types.edits import Edits, KnownDoorHeight, KnownLength, Nudge, RoomName, WallMark
from panoplan.types.plan import FloorPlan


@dataclass(frozen=True, eq=False)
class Edited:
    """A plan after its edits.

    Attributes:
        plan: with all edits that found their place.
        lost: in words, those that did not.
        factor: what lengths were multiplied by, 1 where no size was given.
    """

    plan: FloorPlan
    lost: tuple[str, ...] = ()
    factor: float = 1.0


def apply(plan: FloorPlan, edits: Edits) -> Edited:
    """Applies edits to an estimate: the scale first, then walls, then names.

    Rooms and walls are found by where they lie, so edits outlive a new estimate.

    Args:
        plan: the estimate, in the frame of the trajectory the edits were made in.
        edits: in any order.

    Raises:
        InputError: a nudge that the plan does not allow, or one of a plan that is not metric.
    """
    edits = in_units_of(edits, plan)
    found, lost = witnesses(plan, edits)
    walls = [(nudge, wall_of(nudge.wall, plan)) for nudge in edits.nudges]
    rooms = [(name, room_of(name.room, plan)) for name in edits.names]
    factor = 1.0
    if found:
        factor, metric = combined(found)
        plan = rescaled(plan, factor, metric)
    for nudge, wall in walls:
        if wall is None:
            lost.append(f"nudge of {nudge.wall.id}: no wall lies there any more")
            continue
        if plan.unit != "m":
            raise InputError(
                f"nudge of {nudge.wall.id}",
                "a plan in camera heights",
                "a metric one: give a --length, too",
            )
        plan = nudged(plan, wall.id, nudge.metres)
    names = {}
    for name, room in rooms:
        if room is None:
            lost.append(f"name of {name.room.id}, {name.name!r}: no room lies there any more")
        else:
            names[room.id] = name.name
    named = tuple(replace(r, name=names[r.id]) if r.id in names else r for r in plan.rooms)
    return Edited(replace(plan, rooms=named), tuple(lost), factor)


def in_units_of(edits: Edits, plan: FloorPlan) -> Edits:
    """The edits with their marks in the units of a plan, which may be of another scale."""
    now = units_per_su(plan)
    if edits.units_per_su is None or now is None:
        return replace(edits, units_per_su=now)
    k = now / edits.units_per_su

    def wall(mark: WallMark) -> WallMark:
        return replace(mark, a=k * mark.a, b=k * mark.b)

    return Edits(
        now,
        tuple(RoomName(replace(n.room, polygon=k * n.room.polygon), n.name) for n in edits.names),
        tuple(KnownLength(wall(n.wall), n.metres) for n in edits.lengths),
        tuple(Nudge(wall(n.wall), n.metres) for n in edits.nudges),
        tuple(
            KnownDoorHeight(wall(n.door), n.metres, n.keyframe, n.elevation, n.sigma)
            for n in edits.door_heights
        ),
    )
