"""Which storey of a plan is which of the true ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.plan import Aperture, FloorPlan
from panoplan.types.truth import GroundTruth, TrueLevels

UNKNOWN = -1
"""The true storey of a predicted one that is none of them."""


def camera_levels(positions_m: FloatArray, levels: TrueLevels) -> IntArray:
    """The storeys that cameras are on.

    Args:
        positions_m: (K, 3) true positions.
        levels: of the scene.

    Returns:
        (K,) the storey whose usual camera is nearest in height.
    """
    away = np.abs(-positions_m[:, 1, None] - np.array(levels.floors_m))
    return np.asarray(away.argmin(axis=1))


def true_levels(plan: FloorPlan, truth: GroundTruth) -> Mapping[int, int]:
    """The true storey of each predicted one.

    They are matched one to one so that most of the cameras that plan and truth share are on the
    same; without true poses, by their numbers.

    Args:
        plan: its rooms have storeys.
        truth: with storeys, or all is one.

    Returns:
        For each storey of the plan a true one, or `UNKNOWN`; 0 for all where all is one.
    """
    # It takes longer to import than most exports, which need only `aperture_level`, to write.
    from scipy.optimize import linear_sum_assignment

    ours = sorted({room.level for room in plan.rooms})
    if truth.plan.levels is None:
        return dict.fromkeys(ours, 0)
    true = range(len(truth.plan.levels.floors_m))
    if truth.trajectory is None:
        return {level: level if level in true else UNKNOWN for level in ours}
    on = camera_levels(truth.trajectory.translations, truth.plan.levels)
    truly = dict(zip(truth.trajectory.labels, on.tolist(), strict=True))
    of_room = {room.id: room.level for room in plan.rooms}
    shared = np.zeros((len(ours), len(true)), dtype=np.int64)
    for camera in plan.trajectory:
        if camera.id in truly and camera.room in of_room:
            shared[ours.index(of_room[camera.room]), truly[camera.id]] += 1
    rows, columns = linear_sum_assignment(shared, maximize=True)
    found = {ours[i]: int(j) for i, j in zip(rows, columns, strict=True) if shared[i, j]}
    return {level: found.get(level, UNKNOWN) for level in ours}


def aperture_level(item: Aperture, of_room: Mapping[str, int], of_wall: Mapping[str, int]) -> int:
    """The storey of an aperture: that of a room it leads to, else of a wall it is in.

    Args:
        item: the aperture.
        of_room: storeys by room.
        of_wall: storeys by wall.

    Returns:
        The storey; of one that names neither, the lowest.
    """
    rooms = [of_room[name] for name in item.rooms if name in of_room]
    walls = [of_wall[name] for name in item.walls if name in of_wall]
    return next(iter([*rooms, *walls]), min(of_room.values(), default=0))
