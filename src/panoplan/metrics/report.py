"""All figures of one plan against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from panoplan.errors import InputError
from panoplan.metrics import alignment
from panoplan.metrics.alignment import (
    Alignment,
    Freedom,
    common_cameras,
    fit,
    metres_per_unit,
    transformed,
)
from panoplan.metrics.apertures import aperture_score
from panoplan.metrics.compared import Compared
from panoplan.metrics.figures import CornerFigures, RoomFigures, corner_figures, room_figures
from panoplan.metrics.levels import UNKNOWN, aperture_level, true_levels
from panoplan.metrics.rooms import Score
from panoplan.metrics.trajectory import TrajectoryError, trajectory_error
from panoplan.metrics.walls import WallFigures, wall_figures
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Aperture, FloorPlan
from panoplan.types.truth import GroundTruth, TrueLevels, TruePlan, TrueRoom

RoomsKind = Literal["rooms", "rooms_partial"]
_Apertures = Literal["doors", "openings", "windows"]


@dataclass(frozen=True, eq=False)
class Report:
    """All figures of one plan.

    Attributes:
        truth: which true rooms were compared with.
        alignment: how the plan was brought onto them.
        rooms: room figures.
        corners: corner figures.
        walls: where walls lie, and whether their stated uncertainty holds.
        doors: which were found.
        openings: which were found.
        windows: which were found.
        storeys: which were found, None where the truth does not tell of several.
        trajectory: camera positions after the alignment, None without common cameras.
        scale_error_percent: estimated scale relative to the true one, less 1; None where it
            cannot be known.
    """

    truth: RoomsKind
    alignment: Alignment
    rooms: RoomFigures
    corners: CornerFigures
    walls: WallFigures
    doors: Score
    openings: Score
    windows: Score
    storeys: Score | None
    trajectory: TrajectoryError | None
    scale_error_percent: float | None


def evaluate(
    plan: FloorPlan,
    truth: GroundTruth,
    *,
    rooms: RoomsKind = "rooms",
    visited: FloatArray | None = None,
    align: Freedom = "scale",
    true_ch_per_su: float | None = None,
) -> Report:
    """Compares a plan with the truth.

    What is on different storeys is never the same: rooms, corners and apertures are matched within
    a storey only, where the truth tells of several.

    A plan without any room is a result: recall and precision are 0, and figures over matched
    rooms are None.

    Args:
        plan: in metres or camera heights.
        truth: what is true; cameras correspond by keyframe id.
        rooms: complete true rooms, or those split at openings.
        visited: (K, 3) true camera positions in metres that say which rooms were visited; None
            for all of the true trajectory.
        align: what may be fitted to bring the plan onto the truth; "scale" is the paper's
            protocol.
        true_ch_per_su: true scale of the trajectory, where known; else the error of the scale is
            taken from a similarity of the camera positions.

    Returns:
        The report.

    Raises:
        InputError: the truth has no such rooms, or the alignment is not possible.

    Source: Sec. V of the paper; what goes beyond it is told in each figure's own doc.
    """
    if rooms not in ("rooms", "rooms_partial"):
        raise InputError("rooms", repr(rooms), "'rooms' or 'rooms_partial'")
    true_rooms: tuple[TrueRoom, ...] = getattr(truth.plan, rooms)
    if not true_rooms:
        raise InputError(f"true {rooms}", "none", "at least one room")
    found = alignment.align(plan, truth, align)
    moved = transformed(plan, found.true_from_plan)
    predicted = tuple(room for room in moved.rooms if room.polygon is not None)
    storey = true_levels(plan, truth)
    compared = Compared.of(true_rooms, predicted, storey, _visiting(truth, visited), truth)
    ate = None
    if truth.trajectory is not None:
        ate = trajectory_error(*common_cameras(moved, truth.trajectory))
    return Report(
        truth=rooms,
        alignment=found,
        rooms=room_figures(compared, len(plan.rooms) - len(predicted)),
        corners=corner_figures(compared, truth.plan.axis),
        walls=wall_figures(
            [
                (compared.true[m.true].polygon, predicted[m.predicted].walls)
                for m in compared.matches
            ]
        ),
        doors=_aperture_score(truth.plan, "doors", moved, storey),
        openings=_aperture_score(truth.plan, "openings", moved, storey),
        windows=_aperture_score(truth.plan, "windows", moved, storey),
        storeys=_storey_score(truth.plan.levels, storey),
        trajectory=ate,
        scale_error_percent=scale_error_percent(plan, truth, true_ch_per_su),
    )


def scale_error_percent(
    plan: FloorPlan, truth: GroundTruth, true_ch_per_su: float | None = None
) -> float | None:
    """Error of the estimated scale: estimated / true - 1, in percent.

    Args:
        plan: the plan.
        truth: the truth.
        true_ch_per_su: the true scale; if None, the metres a plan unit has by its own account are
            compared with those that fit the true camera positions best.

    Returns:
        The error, or None where it cannot be known.
    """
    if true_ch_per_su is not None:
        estimated = plan.scale.ch_per_su
        return None if estimated is None else 100.0 * (estimated / true_ch_per_su - 1.0)
    claimed = metres_per_unit(plan, truth.plan.camera_height_m)
    if claimed is None or truth.trajectory is None:
        return None
    try:
        fitted = fit(*common_cameras(plan, truth.trajectory), "similarity")
    except InputError:
        return None
    return 100.0 * (claimed / fitted.scale - 1.0)


def _visiting(truth: GroundTruth, visited: FloatArray | None) -> FloatArray | None:
    if visited is not None or truth.trajectory is None:
        return visited
    return truth.trajectory.translations


def _storey_score(levels: TrueLevels | None, storey: Mapping[int, int]) -> Score | None:
    if levels is None:
        return None
    hits = sum(level != UNKNOWN for level in storey.values())
    return Score(hits, len(levels.floors_m), len(storey))


def _aperture_score(
    truth: TruePlan, kind: _Apertures, moved: FloorPlan, storey: Mapping[int, int]
) -> Score:
    """The doors, openings or windows of all storeys."""
    true: tuple[FloatArray, ...] = getattr(truth, kind)
    items: tuple[Aperture, ...] = getattr(moved, kind)
    if truth.levels is None:
        return aperture_score(true, [item.segment for item in items])
    of_room = {room.id: room.level for room in moved.rooms}
    of_wall = {wall.id: room.level for room in moved.rooms for wall in room.walls}
    ours = [storey.get(aperture_level(item, of_room, of_wall), UNKNOWN) for item in items]
    theirs: tuple[int, ...] = getattr(truth.levels, kind)
    found = Score(0, 0, ours.count(UNKNOWN))
    for level in range(len(truth.levels.floors_m)):
        found += aperture_score(
            [segment for segment, on in zip(true, theirs, strict=True) if on == level],
            [item.segment for item, on in zip(items, ours, strict=True) if on == level],
        )
    return found
