"""Metres from what is known of a plan: lengths of walls, heights of doors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from panoplan.editing.match import door_of, wall_of
from panoplan.types.edits import Edits, KnownDoorHeight, KnownLength
from panoplan.types.plan import Aperture, FloorPlan, MetricScale, MetricSource, Room, Wall

TAPE_SIGMA_M = 0.005
"""Standard deviation of a length that somebody measured."""

DOOR_SIGMA_M = 0.01
"""That of the height of a door."""

_PLACE_SIGMA = 0.02
"""Relative, of the distance from a camera to a door."""

_HEIGHT_SIGMA = 0.012
"""Relative, of one camera's height against the plan: it bobs by a centimetre or two, and the plan's
size errs a little against the height that the layouts have in common."""

_UNKNOWN_SIGMA = 0.05
"""Camera heights, of a length whose own is not known."""


@dataclass(frozen=True)
class Witness:
    """One thing of which the true and the estimated size are known.

    Attributes:
        source: what it is.
        metres: its true size.
        units: its estimated size, plan units.
        sigma: relative standard deviation of their ratio.
    """

    source: MetricSource
    metres: float
    units: float
    sigma: float


def witnesses(plan: FloorPlan, edits: Edits) -> tuple[list[Witness], list[str]]:
    """What edits tell of the scale of a plan.

    Returns:
        Witnesses, and in words those edits of which the plan has nothing any more.
    """
    found: list[Witness] = []
    lost: list[str] = []
    for known in edits.lengths:
        wall = wall_of(known.wall, plan)
        if wall is None:
            lost.append(f"length of {known.wall.id}: no wall lies there any more")
        else:
            found.append(_length_witness(known, wall, plan))
    for door in edits.door_heights:
        seen = _door_witness(door, plan)
        if isinstance(seen, str):
            lost.append(f"height of {door.door.id}: {seen}")
        else:
            found.append(seen)
    return found, lost


def combined(found: Sequence[Witness]) -> tuple[float, MetricScale]:
    """Metres a plan unit, by the weighted mean of what the witnesses say, and how sure it is.

    Args:
        found: one or more.
    """
    weights = np.array([witness.sigma**-2 for witness in found])
    ratios = np.array([witness.metres / witness.units for witness in found])
    factor = float(weights @ ratios / weights.sum())
    first = found[int(np.argmax(weights))]
    sigma = float(weights.sum() ** -0.5)
    if len(found) > 1:
        # Witnesses that disagree make it less sure than each says.
        spread = float(weights @ (ratios / factor - 1) ** 2) / (len(found) - 1)
        sigma *= max(1.0, spread) ** 0.5
    return factor, MetricScale(first.source, sigma)


def rescaled(plan: FloorPlan, factor: float, metric: MetricScale) -> FloorPlan:
    """The plan in metres, every length of it times a factor.

    Args:
        plan: in any unit.
        factor: metres a plan unit.
        metric: how it was found.
    """

    def room(item: Room) -> Room:
        return replace(
            item,
            polygon=None if item.polygon is None else factor * item.polygon,
            holes=tuple(factor * hole for hole in item.holes),
            walls=tuple(
                Wall(
                    wall.id,
                    factor * wall.a,
                    factor * wall.b,
                    _times(factor, wall.sigma),
                    _times(factor, wall.length_sigma),
                )
                for wall in item.walls
            ),
            area_sigma=_times(factor**2, item.area_sigma),
            ceiling_height=_times(factor, item.ceiling_height),
        )

    def aperture(item: Aperture) -> Aperture:
        return replace(item, segment=factor * item.segment)

    return replace(
        plan,
        unit="m",
        metric=metric,
        camera_height_m=factor * _camera_height(plan),
        rooms=tuple(room(item) for item in plan.rooms),
        trajectory=tuple(replace(p, position=factor * p.position) for p in plan.trajectory),
        shared_walls=tuple(
            replace(wall, thickness=factor * wall.thickness) for wall in plan.shared_walls
        ),
        doors=tuple(aperture(item) for item in plan.doors),
        openings=tuple(aperture(item) for item in plan.openings),
        windows=tuple(aperture(item) for item in plan.windows),
    )


def _times(factor: float, value: float | None) -> float | None:
    return None if value is None else factor * value


def _camera_height(plan: FloorPlan) -> float:
    """Of the cameras above the floor, plan units."""
    return 1.0 if plan.camera_height_m is None else plan.camera_height_m


def _length_witness(known: KnownLength, wall: Wall, plan: FloorPlan) -> Witness:
    units = float(np.hypot(*(wall.b - wall.a)))
    own = _UNKNOWN_SIGMA * _camera_height(plan) if wall.length_sigma is None else wall.length_sigma
    sigma = float(np.hypot(TAPE_SIGMA_M / known.metres, own / units))
    return Witness("length", known.metres, units, sigma)


def _door_witness(known: KnownDoorHeight, plan: FloorPlan) -> Witness | str:
    door = door_of(known.door, plan)
    if door is None:
        return "no door lies there any more"
    camera = next((pose for pose in plan.trajectory if pose.id == known.keyframe), None)
    if camera is None:
        return f"there is no camera {known.keyframe} any more"
    height = _camera_height(plan)
    distance = float(np.hypot(*(door.segment.mean(axis=0) - camera.position)))
    units = height + distance * float(np.tan(known.elevation))
    if not units > 0:
        return "its upper edge would lie below the floor"
    slope = float(np.tan(known.elevation))
    errors = (
        distance * known.sigma * (1 + slope**2),
        slope * _PLACE_SIGMA * distance,
        _HEIGHT_SIGMA * height,
    )
    sigma = np.hypot(DOOR_SIGMA_M / known.metres, float(np.linalg.norm(errors)) / units)
    return Witness("door height", known.metres, units, float(sigma))
