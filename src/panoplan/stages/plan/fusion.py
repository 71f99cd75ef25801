"""Views of one room fused by truncated signed distance, and rooms told from one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from panoplan.config import FusionConfig
from panoplan.geometry.polar import profile_rays, signed_distance_sums
from panoplan.stages.plan.sight import Sights
from panoplan.types.arrays import BoolArray, FloatArray, IntArray

NOBODY = -1


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a room's views say of the floor around them.

    Cell (i, j) has its centre at ((i + first_cell[0] + ½)·cell, ...).

    Attributes:
        first_cell: lattice index of the arrays' first cell.
        total: (n, m) sum of weight × signed distance, positive where the floor is free.
        weight: (n, m) sum of weights.
    """

    first_cell: tuple[int, int]
    total: FloatArray
    weight: FloatArray


@dataclass(frozen=True, eq=False)
class Territories:
    """To which room each cell belongs.

    Attributes:
        first_cell: lattice index of the arrays' first cell.
        owner: (n, m) index of the room with most evidence, `NOBODY` where no evidence is positive.
        best: (n, m) its evidence, at least 0.
        second: (n, m) the next one's, at least 0.
    """

    first_cell: tuple[int, int]
    owner: IntArray
    best: FloatArray
    second: FloatArray

    def window(self, evidence: Evidence) -> tuple[slice, slice]:
        """Where a room's evidence lies in these arrays."""
        i, j = np.subtract(evidence.first_cell, self.first_cell)
        n, m = evidence.total.shape
        return slice(i, i + n), slice(j, j + m)

    def owner_at(self, point: FloatArray, cell: float) -> int:
        """The room that a point belongs to, or `NOBODY`."""
        i, j = np.floor(point / cell).astype(int) - self.first_cell
        n, m = self.owner.shape
        return int(self.owner[i, j]) if 0 <= i < n and 0 <= j < m else NOBODY


@dataclass(frozen=True, eq=False)
class Floor:
    """The cells of one room.

    Attributes:
        first_cell: lattice index of the arrays' first cell.
        mask: (n, m) cells of the room, one piece without holes.
        field: (n, m) mean signed distance in camera heights, less the strongest other room's:
            positive inside.
        holes: (n, m) cells inside that are no room, such as pillars.
    """

    first_cell: tuple[int, int]
    mask: BoolArray
    field: FloatArray
    holes: BoolArray


def fuse(views: Sights, config: FusionConfig) -> Evidence:
    """Sums the truncated signed distances to the views' boundaries.

    Args:
        views: of one room, at least one.
        config: settings.

    Returns:
        The evidence over the box that holds nearly all of their boundaries.

    Source: docs/deviations.md, "Past the paper".
    """
    low, high = _box(views, config.reach_ch)
    first = np.floor(low / config.cell_ch).astype(int) - _RIM
    shape = np.floor(high / config.cell_ch).astype(int) + 1 + _RIM - first
    first_cell = (int(first[0]), int(first[1]))
    total, weight = signed_distance_sums(
        views.cameras,
        views.profiles,
        views.sigmas,
        config.truncation_ch,
        config.blur_ch,
        config.beyond_weight,
        config.reach_ch,
        config.cell_ch,
        first_cell,
        (int(shape[0]), int(shape[1])),
    )
    return Evidence(first_cell, total, weight)


_RIM = 3
_OUTLYING = 0.002
"""Share of the boundary beyond the box on each of its sides: single columns that leak."""


def _box(views: Sights, reach: float) -> tuple[FloatArray, FloatArray]:
    ranges = np.minimum(views.profiles, reach)[..., None]
    ends = views.cameras[:, None] + ranges * profile_rays(views.profiles.shape[1])
    ends = ends.reshape(-1, 2)
    ends = ends[np.isfinite(ends[:, 0])]
    if len(ends) == 0:
        return views.cameras.min(axis=0), views.cameras.max(axis=0)
    low, high = np.quantile(ends, [_OUTLYING, 1 - _OUTLYING], axis=0)
    return np.minimum(low, views.cameras.min(axis=0)), np.maximum(high, views.cameras.max(axis=0))


def contest(evidences: Sequence[Evidence]) -> Territories:
    """Gives each cell to the room with most evidence for it.

    A room that leaks into another through a door has less evidence there than the other's own
    views: far columns weigh little, and most views end at the door.

    Args:
        evidences: one a room, at least one.

    Returns:
        The territories over the box that holds all of them.
    """
    first = np.min([e.first_cell for e in evidences], axis=0)
    last = np.max([np.add(e.first_cell, e.total.shape) for e in evidences], axis=0)
    shape = tuple(int(n) for n in last - first)
    made = Territories(
        (int(first[0]), int(first[1])),
        np.full(shape, NOBODY, dtype=np.int64),
        np.zeros(shape),
        np.zeros(shape),
    )
    for index, evidence in enumerate(evidences):
        window = made.window(evidence)
        best, second = made.best[window], made.second[window]
        wins = evidence.total > best
        second[...] = np.where(wins, best, np.maximum(second, evidence.total))
        made.owner[window][wins] = index
        best[wins] = evidence.total[wins]
    return made


def floor_of(
    index: int,
    evidence: Evidence,
    territories: Territories,
    cameras: FloatArray,
    config: FusionConfig,
) -> Floor | None:
    """The floor of one room.

    Args:
        index: of the room in `territories`.
        evidence: of the room.
        territories: of all rooms.
        cameras: (V, 2) where its views stand.
        config: settings.

    Returns:
        The piece of its territory in which most of its cameras stand, or the largest one where
        they stand in none; None where there is none.
    """
    window = territories.window(evidence)
    owner, best = territories.owner[window], territories.best[window]
    own = owner == index
    rival = np.where(own, territories.second[window], best)
    piece = main_piece(own, evidence.first_cell, cameras, config)
    if piece is None:
        return None
    return _floor(piece, evidence, rival, config)


def floor_beside(
    evidence: Evidence, taken: BoolArray, camera: FloatArray, config: FusionConfig
) -> Floor | None:
    """The floor that a view from a doorway adds to what other rooms hold.

    Args:
        evidence: of the view.
        taken: cells of its arrays that belong to other rooms or their walls.
        camera: (2,) where the view stands.
        config: settings.

    Returns:
        The piece nearest to the camera of those as large as a room, None where it is not next to
        the camera: what else the view alone holds are slivers that its errors make, even far away.
    """
    pieces, _ = ndimage.label(_opened((evidence.total > 0) & ~taken, config))
    large = np.bincount(pieces.ravel()) * config.cell_ch**2 >= config.min_area_ch2
    large[0] = False
    cells = np.argwhere(large[pieces])
    away = np.hypot(*((cells + evidence.first_cell + 0.5) * config.cell_ch - camera).T)
    if away.min(initial=np.inf) > _DOORSTEP_CH:
        return None
    piece = pieces == pieces[tuple(cells[away.argmin()])]
    return _floor(piece, evidence, np.where(taken, np.inf, 0.0), config)


_DOORSTEP_CH = 0.35
"""A camera in a doorway is no farther than this from the floor behind it: half a metre."""


def _floor(piece: BoolArray, evidence: Evidence, rival: FloatArray, config: FusionConfig) -> Floor:
    filled: BoolArray = ndimage.binary_fill_holes(piece)
    field = np.full(piece.shape, -config.truncation_ch)
    seen = evidence.weight > 0
    field[seen] = np.maximum(
        (evidence.total[seen] - rival[seen]) / evidence.weight[seen], -config.truncation_ch
    )
    return Floor(evidence.first_cell, filled, field, filled & (field < 0))


def main_piece(
    cells: BoolArray, first_cell: tuple[int, int], cameras: FloatArray, config: FusionConfig
) -> BoolArray | None:
    """The connected piece of some cells that holds most cameras, slits removed.

    Args:
        cells: (n, m).
        first_cell: lattice index of the first cell.
        cameras: (V, 2) positions.
        config: settings.

    Returns:
        The piece; the largest one where no camera stands in any; None where none is left.
    """
    pieces, count = ndimage.label(_opened(cells, config))
    if count == 0:
        return None
    at = np.floor(cameras / config.cell_ch).astype(int) - first_cell
    inside = ((at >= 0) & (at < cells.shape)).all(axis=1)
    standing = pieces[tuple(at[inside].T)]
    standing = standing[standing > 0]
    if len(standing):
        chosen = int(np.bincount(standing).argmax())
    else:
        sizes = np.bincount(pieces.ravel())
        sizes[0] = 0
        chosen = int(sizes.argmax())
    return np.asarray(pieces == chosen)


def _opened(cells: BoolArray, config: FusionConfig) -> BoolArray:
    width = config.opening_cells
    return np.asarray(ndimage.binary_opening(cells, np.ones((width, width), dtype=bool)))
