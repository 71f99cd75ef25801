"""Cameras of a tour that stand in a wrong place: found by walls, told and re-placed by doors.

Still photos metres apart are placed by an aligner that may put a whole room elsewhere. Its walls
then stand in other rooms' free space, or its doors lead nowhere. Walls alone name innocent rooms as
well; the doors tell which room does not belong: an innocent one has its doors where it is, a
misplaced one has them elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial import KDTree
from scipy.spatial.distance import squareform

from panoplan.config import GroupingConfig, MisplacedConfig
from panoplan.geometry.polar import intrusions, mutual_overlaps, profile_rays
from panoplan.stages.plan.sight import Sights, sights
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.view import RegisteredLayout


@dataclass(frozen=True)
class Misplaced:
    """Views that do not stand where they were said to.

    Attributes:
        members: indices of the views, increasing.
        shift: (x, y) by which they are to be moved, camera heights; None where no place is better
            than others, so that they are to be left out.
    """

    members: tuple[int, ...]
    shift: tuple[float, float] | None


def misplaced(
    views: Sequence[RegisteredLayout], config: MisplacedConfig, grouping: GroupingConfig
) -> tuple[Misplaced, ...]:
    """Finds the views of a tour that stand in a wrong place.

    Args:
        views: of one level, any number, in the order of the tour.
        config: settings.
        grouping: settings of views' common areas.

    Returns:
        Views to be moved or left out, those first of which that is most certain. Nothing where
        the cameras stand as close as on a walk, whose odometry holds them.

    Source: docs/deviations.md, "Past the paper".
    """
    if len(views) < 3 or not is_tour(views, config):
        return ()
    tour = _Tour.of(views, config, grouping)
    found: list[Misplaced] = []
    for _ in range(len(tour.units)):
        moves = [_best_move(tour, k, config) for k in range(len(tour.units))]
        gains = [move.gain for move in moves]
        best = int(np.argmax(gains))
        if gains[best] < config.min_gain:
            break
        shift = moves[best].shift
        members = tour.units[best]
        found.append(Misplaced(members, None if shift is None else (shift[0], shift[1])))
        tour = tour.without(best) if shift is None else tour.moved(best, np.array(shift))
    return _merged(found)


def is_tour(views: Sequence[RegisteredLayout], config: MisplacedConfig) -> bool:
    """Whether the cameras stand farther from one another than a walk's keyframes do.

    Args:
        views: in the order of the walk or the tour.
        config: settings.
    """
    if len(views) < 2:
        return False
    cameras = np.array([view.camera for view in views])
    some = views[:: math.ceil(len(views) / _RANGES)]
    ranges = [np.nanmedian(np.hypot(*(view.boundary - view.camera).T)) for view in some]
    step = np.median(np.hypot(*np.diff(cameras, axis=0).T))
    return bool(step > config.min_step * np.nanmedian(ranges))


_RANGES = 100
"""The ranges of so many views tell how large rooms are."""


@dataclass(frozen=True, eq=False)
class _Doors:
    """Passages as views see them.

    Attributes:
        unit: (D,) index of the views' unit.
        middle: (D, 2).
        outward: (D, 2) unit normal away from the camera.
    """

    unit: IntArray
    middle: FloatArray
    outward: FloatArray


@dataclass(frozen=True, eq=False)
class _Walls:
    """Places on views' boundaries.

    Attributes:
        unit: (P,) index of the views' unit.
        point: (P, 2).
        outward: (P, 2) unit normal away from the camera.
        length: (P,) of the boundary that each stands for.
    """

    unit: IntArray
    point: FloatArray
    outward: FloatArray
    length: FloatArray


@dataclass(frozen=True, eq=False)
class _Tour:
    """Views in units that are moved as one, and what these see."""

    seen: Sights
    units: tuple[tuple[int, ...], ...]
    doors: _Doors
    walls: _Walls
    conflicts: FloatArray
    """(U, U) symmetric: evidence in nats that two units do not stand as they should."""
    config: MisplacedConfig

    @staticmethod
    def of(
        views: Sequence[RegisteredLayout], config: MisplacedConfig, grouping: GroupingConfig
    ) -> _Tour:
        seen = sights(views)
        shares = _shares(seen, seen, config)
        shares = np.maximum(shares, shares.T)
        common = mutual_overlaps(seen.cameras, seen.profiles, grouping.reach_ch, grouping.cell_ch)
        apart = np.where(shares > config.conflict_share, 1.0, 1.0 - common)
        np.fill_diagonal(apart, 0.0)
        tree = linkage(squareform(apart, checks=False), "complete")
        labels = fcluster(tree, 1.0 - grouping.min_overlap, "distance")
        units = tuple(
            sorted(tuple(np.flatnonzero(labels == k).tolist()) for k in np.unique(labels))
        )
        conflicts = np.zeros((len(units), len(units)))
        for k, one in enumerate(units):
            for n, other in enumerate(units[:k]):
                share = float(shares[np.ix_(one, other)].max())
                conflicts[k, n] = conflicts[n, k] = _nats(np.array(share), config)
        doors, walls = _doors(views, units, config), _walls(seen, units, config)
        return _Tour(seen, units, doors, walls, conflicts, config)

    def moved(self, unit: int, shift: FloatArray) -> _Tour:
        """The tour with one unit elsewhere."""
        cameras = self.seen.cameras.copy()
        cameras[list(self.units[unit])] += shift
        middle = self.doors.middle.copy()
        middle[self.doors.unit == unit] += shift
        point = self.walls.point.copy()
        point[self.walls.unit == unit] += shift
        seen = replace(self.seen, cameras=cameras)
        conflicts = self.conflicts.copy()
        conflicts[unit] = conflicts[:, unit] = self.conflicts_at(unit, shift)
        return replace(
            self,
            seen=seen,
            doors=replace(self.doors, middle=middle),
            walls=replace(self.walls, point=point),
            conflicts=conflicts,
        )

    def without(self, unit: int) -> _Tour:
        """The tour with one unit so far away that it has to do with no other."""
        low, high = self.seen.cameras.min(axis=0), self.seen.cameras.max(axis=0)
        return self.moved(unit, (high - low) + 4 * self.config.reach_ch)

    def conflicts_at(self, unit: int, shift: FloatArray) -> FloatArray:
        """(U,) conflicts of a unit with all others were it elsewhere."""
        own = self.seen.pick(self.units[unit])
        own = replace(own, cameras=own.cameras + shift)
        one = _shares(own, self.seen, self.config).max(axis=0)
        other = _shares(self.seen, own, self.config).max(axis=1)
        worst = np.maximum(one, other)
        shares = np.array([worst[list(members)].max() for members in self.units])
        shares[unit] = 0.0
        return _nats(shares, self.config)


def _shares(views: Sights, into: Sights, config: MisplacedConfig) -> FloatArray:
    return intrusions(
        views.cameras,
        views.profiles,
        views.sigmas,
        into.cameras,
        into.profiles,
        into.sigmas,
        config.depth_ch,
        config.reach_ch,
    )


def _nats(share: FloatArray, config: MisplacedConfig) -> FloatArray:
    """Evidence against two views, from the share of a boundary in the other's free space."""
    over = (share - config.innocent_share) / (config.conflict_share - config.innocent_share)
    return np.asarray(config.conflict_nats * np.clip(over, 0.0, 1.0))


def _doors(
    views: Sequence[RegisteredLayout], units: Sequence[tuple[int, ...]], config: MisplacedConfig
) -> _Doors:
    """Each passage once a unit, from the view that is nearest."""
    unit: list[int] = []
    middle: list[FloatArray] = []
    outward: list[FloatArray] = []
    for number, members in enumerate(units):
        faces = [face for k in members for face in _faces(views[k])]
        own: list[tuple[FloatArray, FloatArray]] = []
        for _, at, normal in sorted(faces, key=lambda face: face[0]):
            if all(
                np.hypot(*(at - there)) > config.same_door_ch or normal @ other < 0.5
                for there, other in own
            ):
                own.append((at, normal))
        unit += [number] * len(own)
        middle += [at for at, _ in own]
        outward += [normal for _, normal in own]
    return _Doors(
        np.array(unit, dtype=np.int64),
        np.array(middle).reshape(-1, 2),
        np.array(outward).reshape(-1, 2),
    )


def _faces(view: RegisteredLayout) -> list[tuple[float, FloatArray, FloatArray]]:
    """Range, middle and outward normal of each passage that a view sees."""
    if view.spans is None:
        return []
    width = len(view.boundary)
    faces = []
    for columns in np.concatenate([view.spans.doors, view.spans.openings]):
        ends = view.boundary[np.round(columns).astype(np.int64) % width]
        along = ends[1] - ends[0]
        length = float(np.hypot(*along))
        if not length > 0.0:
            continue
        middle = ends.mean(axis=0)
        normal = np.array([along[1], -along[0]]) / length
        away = middle - view.camera
        faces.append((float(np.hypot(*away)), middle, normal if normal @ away > 0 else -normal))
    return faces


def _walls(seen: Sights, units: Sequence[tuple[int, ...]], config: MisplacedConfig) -> _Walls:
    bins = seen.profiles.shape[1]
    rays = profile_rays(bins)
    ranges = seen.profiles[..., None]
    points = seen.cameras[:, None] + ranges * rays
    ahead = np.roll(points, -_SPAN, axis=1) - np.roll(points, _SPAN, axis=1)
    normal = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1)
    length = np.hypot(ahead[..., 0], ahead[..., 1])
    outward = normal / np.maximum(length, 1e-12)[..., None]
    outward *= np.sign((outward * rays).sum(axis=-1))[..., None]
    # Where the boundary jumps from one wall to another it is on none.
    smooth = (length < _STEEP * _SPAN * 2 * np.pi / bins * ranges[..., 0]) & (length > 0)
    good = smooth & (ranges[..., 0] < config.reach_ch)
    good[:, np.arange(bins) % _SPAN != 0] = False
    unit_of = np.empty(len(seen), dtype=np.int64)
    for number, members in enumerate(units):
        unit_of[list(members)] = number
    view, _ = np.nonzero(good)
    return _Walls(unit_of[view], points[good], outward[good], length[good])


_SPAN = 8
"""Directions between the places looked at."""
_STEEP = 12.0
"""Boundaries at a smaller angle to the ray than the arcsine of a sixth are taken for jumps."""


@dataclass(frozen=True)
class _Move:
    """What becomes better by moving a unit, in nats; by leaving it out where shift is None."""

    gain: float
    shift: tuple[float, float] | None


def _best_move(tour: _Tour, unit: int, config: MisplacedConfig) -> _Move:
    """The best place of a unit against where it stands, all others as they are."""
    doors = tour.doors
    own, others = np.flatnonzero(doors.unit == unit), np.flatnonzero(doors.unit != unit)
    backed = _Backed(tour.walls, unit, config)
    against = float(tour.conflicts[unit].sum())
    here = _met(doors, own, others, np.zeros(2), config) + backed.nats(np.zeros(2)) - against
    best = _Move(-here, None) if against > 0 else _Move(0.0, None)
    one, other = np.nonzero(doors.outward[own] @ doors.outward[others].T < -_FACING)
    shifts = (
        doors.middle[others[other]]
        - doors.middle[own[one]]
        - config.wall_ch / 2 * doors.outward[own[one]]
    )
    far = np.hypot(*shifts.T)
    shifts = shifts[(far > config.near_ch) & (far < config.search_ch)]
    prior = float(np.log(1 + len(shifts)))
    tried: list[tuple[float, FloatArray]] = []
    for shift in shifts:
        gain = _met(doors, own, others, shift, config) - prior - here
        if gain + config.wall_nats > max(best.gain, config.min_gain) - config.margin:
            gain += backed.nats(shift) - float(tour.conflicts_at(unit, shift).sum())
            tried.append((gain, shift))
    for gain, shift in tried:
        if gain > best.gain:
            best = _Move(gain, (float(shift[0]), float(shift[1])))
    if best.shift is None:
        return best
    second = max(
        (gain for gain, at in tried if math.dist(at, best.shift) > config.same_door_ch), default=0.0
    )
    return best if best.gain - second > config.margin else replace(best, shift=None)


_FACING = math.cos(math.radians(20.0))
"""The two sides of a door, or of a wall, face opposite ways to within 20°."""


def _met(
    doors: _Doors, own: IntArray, others: IntArray, shift: FloatArray, config: MisplacedConfig
) -> float:
    """Evidence in nats of the doors of a unit for a place: how many have another side."""
    away = doors.middle[others] - (doors.middle[own] + shift)[:, None]
    outward = doors.outward[own][:, None]
    gap = (away * outward).sum(axis=-1)
    along = np.abs(away[..., 0] * outward[..., 1] - away[..., 1] * outward[..., 0])
    beside = np.abs(gap - config.wall_ch / 2) - config.wall_ch / 2
    off = (along**2 + np.maximum(beside, 0.0) ** 2) / config.door_sigma_ch**2
    off = np.where(doors.outward[own] @ doors.outward[others].T < -_FACING, off, np.inf)
    met = config.met_share
    # A door that meets none speaks for nothing, nor does the other one that then meets none.
    best = np.exp(-off.min(axis=1, initial=np.inf) / 2)
    return float(np.log1p(met / (1.0 - met) ** 2 * best / config.chance).sum())


class _Backed:
    """How much of a unit's boundary has another unit's wall right behind it."""

    def __init__(self, walls: _Walls, unit: int, config: MisplacedConfig) -> None:
        own, others = walls.unit == unit, walls.unit != unit
        self._config = config
        self._reach = config.wall_ch / 2 + config.door_sigma_ch
        # Apart by their directions as much as by their places.
        self._bend = self._reach / math.sqrt(2 * (1 - _FACING))
        self._tree = KDTree(np.hstack([walls.point[others], self._bend * walls.outward[others]]))
        self._outward = -self._bend * walls.outward[own]
        self._behind = walls.point[own] + config.wall_ch / 2 * walls.outward[own]
        self._length = walls.length[own]

    def nats(self, shift: FloatArray) -> float:
        """Evidence for a place."""
        total = float(self._length.sum())
        if total == 0.0:
            return 0.0
        near, _ = self._tree.query(
            np.hstack([self._behind + shift, self._outward]), distance_upper_bound=self._reach
        )
        share = float(self._length[np.isfinite(near)].sum()) / total
        config = self._config
        over = (share - config.backed_share) / config.backed_share
        return config.wall_nats * min(max(over, -1.0), 1.0)


def _merged(found: Sequence[Misplaced]) -> tuple[Misplaced, ...]:
    """Several moves of the same views as one."""
    out: dict[tuple[int, ...], Misplaced] = {}
    for item in found:
        before = out.get(item.members)
        if before is not None and before.shift is not None and item.shift is not None:
            item = Misplaced(
                item.members, (before.shift[0] + item.shift[0], before.shift[1] + item.shift[1])
            )
        out[item.members] = item
    return tuple(out.values())
