"""Room identification (Section III-D, Eq. 5-6, Algorithm 1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from panoplan.config import RoomsConfig
from panoplan.geometry.polar import range_profile, star_evidence
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.room import RoomDensity
from panoplan.types.view import RegisteredLayout


@dataclass(frozen=True, eq=False)
class Patch:
    """What one keyframe says of the floor around it: the clipped boundary, filled.

    Attributes:
        camera: (2,) position in camera heights.
        density: evidence of this view alone.
        area_cells: number of free cells.
    """

    camera: FloatArray
    density: RoomDensity
    area_cells: int


def clipped_patch(view: RegisteredLayout, config: RoomsConfig) -> Patch:
    """The area inside the clipped boundary of a keyframe.

    Args:
        view: the registered layout.
        config: settings.

    Returns:
        The filled boundary; empty where no column is known.

    Source: Eq. 5-6.
    """
    profile = range_profile(view.boundary - view.camera)
    reach = config.clip_radius_ch
    if config.clip_quartiles > 0 and np.isfinite(profile).any():
        far = profile > config.clip_quartiles * np.nanpercentile(profile, 25)
        profile = np.where(far, np.minimum(profile, reach), profile)
        reach = float(np.nanmax(profile))
    low = np.floor((view.camera - reach) / config.cell_ch).astype(int)
    high = np.floor((view.camera + reach) / config.cell_ch).astype(int) + 1
    first = (int(low[0]), int(low[1]))
    free, against = star_evidence(
        view.camera,
        profile,
        reach,
        config.wall_band_ch,
        config.beyond_weight,
        config.cell_ch,
        first,
        (int(high[0] - low[0]), int(high[1] - low[1])),
    )
    known = profile[np.isfinite(profile)]
    near = float(np.percentile(known, _NEAR_PERCENTILE)) if known.size else 0.0
    weight = np.float32(np.clip(near / _CLOSE_TO_WALL_CH, _MIN_WEIGHT, 1.0))
    if config.normalise != "coverage":
        weight = np.float32(1.0)
    evidence = _masked(first, free * weight, against * weight, config)
    return Patch(view.camera, evidence, int(free.sum()))


# A camera in a doorway or at a wall gives a layout several times worse (docs/deviations.md).
_NEAR_PERCENTILE = 5.0
_CLOSE_TO_WALL_CH = 0.25
_MIN_WEIGHT = 0.2


def add(room: RoomDensity, patch: RoomDensity, config: RoomsConfig) -> RoomDensity:
    """A room's density with one more view, or with another room's.

    Args:
        room: the room so far.
        patch: what is added.
        config: settings; `normalise = running_max` divides by the maximum each time.

    Returns:
        The new density; its arrays cover both.

    Source: Algorithm 1, lines 4-5.
    """
    first, free, against = _embedded(room, patch)
    _add_at(free, patch.free, patch.first_cell, first)
    _add_at(against, patch.against, patch.first_cell, first)
    if config.normalise == "running_max":
        free /= max(float(free.max()), np.finfo(np.float32).tiny)
    return _masked(first, free, against, config)


def density(room: RoomDensity, config: RoomsConfig) -> FloatArray:
    """The room density H of each cell, 0-1.

    Args:
        room: accumulated evidence.
        config: settings.

    Returns:
        (n, m) density: the share of the evidence that speaks for the cell, or counts over their
        maximum.
    """
    return _density(room.free, room.against, config)


def _density(
    free: NDArray[np.float32], against: NDArray[np.float32], config: RoomsConfig
) -> FloatArray:
    if config.normalise == "coverage":
        total = free + against
        share = np.divide(free, total, out=np.zeros_like(total), where=total > 0)
        return np.asarray(share, dtype=np.float64)
    return free.astype(float) / max(float(free.max(initial=0.0)), 1e-12)


def choose(
    patch: Patch, rooms: Sequence[RoomDensity], current: int | None, config: RoomsConfig
) -> tuple[int | None, tuple[float, ...]]:
    """The room that a keyframe belongs to.

    Args:
        patch: the keyframe's filled boundary.
        rooms: densities of the known rooms.
        current: index of the room that the last keyframe was assigned to.
        config: settings.

    Returns:
        Index of the room, or None where a new one must be made, and the evidence for each room:
        the camera's density, or the overlap, 0-1.

    Source: Algorithm 1; "current" is the room last assigned (docs/deviations.md).
    """
    if config.membership == "camera":
        scores = [_camera_density(patch.camera, room, config) for room in rooms]
        stay = enter = config.threshold
    else:
        scores = [overlap(patch.density, room) for room in rooms]
        stay, enter = config.overlap_stay, config.overlap_min
    if current is not None and scores[current] >= stay:
        better = max(scores) if config.membership == "overlap" else scores[current]
        if better <= max(scores[current], enter):
            return current, tuple(scores)
    best = int(np.argmax(scores)) if scores else None
    if best is not None and scores[best] >= enter:
        return best, tuple(scores)
    return None, tuple(scores)


def overlap(
    one: RoomDensity, other: RoomDensity, over: Literal["smaller", "union"] = "smaller"
) -> float:
    """Common cells of two masks over those of the smaller mask, or of their union, 0-1."""
    box = _common_box(one, other)
    if box is None:
        return 0.0
    common = int(np.count_nonzero(_crop(one, box) & _crop(other, box)))
    if over == "union":
        return common / (one.mask_cells + other.mask_cells - common)
    return common / min(one.mask_cells, other.mask_cells)


def claimed(room: RoomDensity, others: Sequence[RoomDensity]) -> float:
    """Share of a room's mask that lies in the masks of other rooms, 0-1."""
    left = room.mask.copy()
    for other in others:
        box = _common_box(room, other)
        if box is not None:
            part = _cropped(left, room, box)
            part &= ~_crop(other, box)
    return 1.0 - int(np.count_nonzero(left)) / max(1, room.mask_cells)


def _masked(
    first: tuple[int, int],
    free: NDArray[np.float32],
    against: NDArray[np.float32],
    config: RoomsConfig,
) -> RoomDensity:
    """The evidence with its mask: the cells whose density reaches the threshold."""
    mask: BoolArray = (_density(free, against, config) >= config.threshold) & (free > 0)
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = (0, 0, 0, 0)
    if len(rows):
        i, j = first
        box = (
            i + int(rows[0]), j + int(columns[0]), i + int(rows[-1]) + 1, j + int(columns[-1]) + 1,
        )  # fmt: skip
    return RoomDensity(first, free, against, mask, box, int(np.count_nonzero(mask)))


def _common_box(one: RoomDensity, other: RoomDensity) -> tuple[int, int, int, int] | None:
    a, b = one.mask_box, other.mask_box
    box = (max(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3]))
    return box if box[0] < box[2] and box[1] < box[3] else None


def _crop(room: RoomDensity, box: tuple[int, int, int, int]) -> BoolArray:
    return _cropped(room.mask, room, box)


def _cropped(cells: BoolArray, room: RoomDensity, box: tuple[int, int, int, int]) -> BoolArray:
    i, j = room.first_cell
    return cells[box[0] - i : box[2] - i, box[1] - j : box[3] - j]


def _camera_density(camera: FloatArray, room: RoomDensity, config: RoomsConfig) -> float:
    i, j = (np.floor(camera / config.cell_ch).astype(int) - room.first_cell).tolist()
    n, m = room.free.shape
    if not (0 <= i < n and 0 <= j < m):
        return 0.0
    return float(density(room, config)[i, j])


def _embedded(
    room: RoomDensity, patch: RoomDensity
) -> tuple[tuple[int, int], np.ndarray, np.ndarray]:
    low = np.minimum(room.first_cell, patch.first_cell)
    high = np.maximum(
        np.add(room.first_cell, room.free.shape), np.add(patch.first_cell, patch.free.shape)
    )
    first = (int(low[0]), int(low[1]))
    free = np.zeros(tuple(high - low), dtype=np.float32)
    against = np.zeros_like(free)
    _add_at(free, room.free, room.first_cell, first)
    _add_at(against, room.against, room.first_cell, first)
    return first, free, against


def _add_at(
    target: np.ndarray, values: np.ndarray, at: tuple[int, int], first: tuple[int, int]
) -> None:
    i, j = at[0] - first[0], at[1] - first[1]
    target[i : i + values.shape[0], j : j + values.shape[1]] += values
