"""True and predicted rooms laid over one another, storey by storey."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from panoplan.metrics import rooms
from panoplan.metrics.levels import UNKNOWN, camera_levels
from panoplan.metrics.rooms import Match, Region
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.plan import Room
from panoplan.types.truth import GroundTruth, TrueRoom


@dataclass(frozen=True, eq=False)
class Compared:
    """True and predicted rooms in one frame, in metres.

    Attributes:
        true: T true rooms.
        predicted: P predicted rooms, each with a polygon.
        true_regions: of the true rooms.
        predicted_regions: of the predicted rooms.
        true_level: (T,) storey of each.
        predicted_level: (P,) true storey that each is on, `UNKNOWN` where on none.
        overlap: (T, P) IoU; 0 on different storeys.
        visited: (T,) whether a camera stands in it; None where no camera is known.
        matches: rooms of one another.
    """

    true: tuple[TrueRoom, ...]
    predicted: tuple[Room, ...]
    true_regions: tuple[Region, ...]
    predicted_regions: tuple[Region, ...]
    true_level: IntArray
    predicted_level: IntArray
    overlap: FloatArray
    visited: BoolArray | None
    matches: tuple[Match, ...]

    @staticmethod
    def of(
        true: tuple[TrueRoom, ...],
        predicted: tuple[Room, ...],
        storey: Mapping[int, int],
        cameras: FloatArray | None,
        truth: GroundTruth,
    ) -> Compared:
        """Lays rooms over one another.

        Args:
            true: true rooms.
            predicted: predicted rooms in the frame of the truth, metres.
            storey: true storey of each level of the plan, `UNKNOWN` where there is none.
            cameras: (K, 3) true positions that say which rooms were visited, or None.
            truth: that the rooms are of.
        """
        true_regions = tuple(rooms.region(room.polygon, room.holes) for room in true)
        predicted_regions = tuple(
            rooms.region(room.polygon, room.holes) for room in predicted if room.polygon is not None
        )
        levels = truth.plan.levels
        true_level = np.array([0 if levels is None else room.level for room in true])
        predicted_level = np.array([storey[room.level] for room in predicted], dtype=np.int64)
        overlap = rooms.iou_matrix(true_regions, predicted_regions)
        overlap[true_level[:, None] != predicted_level] = 0.0
        visited = None
        if cameras is not None:
            on = np.zeros(len(cameras)) if levels is None else camera_levels(cameras, levels)
            visited = np.zeros(len(true), dtype=np.bool_)
            for level in np.unique(true_level):
                there = np.flatnonzero(true_level == level)
                regions = [true_regions[k] for k in there]
                visited[there] = rooms.visited_rooms(regions, cameras[on == level][:, [0, 2]])
        return Compared(
            true,
            predicted,
            true_regions,
            predicted_regions,
            true_level,
            predicted_level,
            overlap,
            visited,
            rooms.matching(overlap, rooms.MATCH_IOU),
        )

    @property
    def storeys(self) -> list[tuple[IntArray, IntArray]]:
        """True and predicted rooms of each storey; those of no true one come last."""
        levels = [*np.unique(self.true_level), UNKNOWN]
        return [
            (np.flatnonzero(self.true_level == k), np.flatnonzero(self.predicted_level == k))
            for k in levels
        ]
