"""Streaming odometry: a panorama in, its pose out; losses are told, maps kept apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from panoplan.geometry.similarity import fit_similarity
from panoplan.poses.walk.features import Features, Places, matches
from panoplan.poses.walk.map import Map, verified
from panoplan.types.pose import Pose

_RECENT_ARE_NO_LOOPS = 3
_LOST_LOOKUPS = 3
_WAITING_TRIED = 8
_FEWEST_JOINED = 3
_JOIN_TOLERANCE = 0.05


@dataclass(frozen=True)
class OdometrySettings:
    """How poses are found.

    Attributes:
        recent: panoramas before a new one that it is matched with.
        lookups: panoramas seen long before that it is matched with because they look alike.
        least_pair_inliers: points that two panoramas must share to be connected.
        least_map_inliers: points of a map that a panorama must see to get a pose in it.
        patience: panoramas lost before so many others wait for no new map any more.
        growth: the whole map is adjusted whenever it has grown by this factor.
    """

    recent: int = 4
    lookups: int = 2
    least_pair_inliers: int = 25
    least_map_inliers: int = 25
    patience: int = 40
    growth: float = 1.4


@dataclass(frozen=True, eq=False)
class Placed:
    """A panorama that got its pose.

    Attributes:
        number: of the panorama, from 0 in the order of `Odometry.add`.
        map: of the pose, from 0; poses of different maps have nothing to do with one another.
        pose: world_from_cam in that map, as known now.
    """

    number: int
    map: int
    pose: Pose


class Odometry:
    """Finds the poses of panoramas one by one.

    Args:
        width: of the panoramas in px.
        height: of the panoramas in px.
        settings: how.

    Raises:
        MissingExtraError: pycolmap is not installed.
    """

    def __init__(
        self,
        width: int,
        height: int,
        settings: OdometrySettings | None = None,
    ) -> None:
        self.settings = settings or OdometrySettings()
        self._size = (width, height)
        self._features: list[Features] = []
        self._places = Places()
        self._geometries: dict[tuple[int, int], Any] = {}
        self._neighbours: dict[int, list[int]] = {}
        self._maps: list[Map] = []
        self._map_of: dict[int, int] = {}
        self._adjusted_at: dict[int, int] = {}
        self._waiting: list[int] = []
        self._fresh = self._new_map()

    def __len__(self) -> int:
        """Number of panoramas seen."""
        return len(self._features)

    @property
    def lost(self) -> tuple[int, ...]:
        """Panoramas that have no pose, in their order."""
        return tuple(n for n in range(len(self)) if n not in self._map_of)

    def add(self, features: Features) -> list[Placed]:
        """Takes the next panorama.

        Args:
            features: its points, as an `Extractor` gives them.

        Returns:
            What got a pose by it: itself; it and others that waited for it; or nothing where the
            camera is lost.
        """
        number = len(self._features)
        self._features.append(features)
        self._connect(number)
        self._places.add(features)
        placed = self._place(number)
        if placed is None:
            self._waiting.append(number)
            return self._begin()
        return [placed, *self._catch_up()]

    def poses(self) -> list[dict[int, Pose]]:
        """Poses by number of each map as known now, the largest map first."""
        told = [
            {n: known.pose(n) for n in known.numbers() if self._map_of.get(n) == k}
            for k, known in enumerate(self._maps)
        ]
        return sorted((poses for poses in told if poses), key=lambda poses: -len(poses))

    def finish(self) -> list[Placed]:
        """Adjusts every map as a whole, joins maps, and tries once more what has no pose.

        Two maps are joined where panoramas of the smaller one see the points of the larger one
        and find poses there that agree with those they had.

        Returns:
            What got a pose by it.
        """
        for k in range(len(self._maps)):
            self._adjust(k)
        by_size = sorted(range(len(self._maps)), key=lambda k: len(self._maps[k].numbers()))
        for place, small in enumerate(by_size):
            # The largest one first; what has joined one is in no other.
            for large in reversed(by_size[place + 1 :]):
                if self._join(small, large):
                    break
        placed = self._place_waiting(self._waiting)
        for k in {told.map for told in placed}:
            self._adjust(k)
        return placed

    def _join(self, small: int, large: int) -> bool:
        """Moves the panoramas of one map that fit into another one; whether it did."""
        members = {n for n, k in self._map_of.items() if k == small}
        moved = self._registered_in(large, members)
        if len(moved) < _FEWEST_JOINED or not self._agree(moved, small, large):
            for number in moved:
                self._maps[large].release(number)
            return False
        for number in moved:
            self._map_of[number] = large
        self._adjust(large)
        return True

    def _registered_in(self, large: int, members: set[int]) -> list[int]:
        """Registers panoramas in another map, from those it shares points with onwards."""
        known = self._maps[large]
        # All before any is registered: the map counts what each sees of those registered later.
        for number in sorted(members):
            self._tell(known, number)
        moved: list[int] = []
        progress = True
        while progress:
            progress = False
            for number in sorted(members - set(moved)):
                if not any(known.has(n) for n in self._neighbours[number]):
                    continue
                if known.register(number):
                    moved.append(number)
                    progress = True
        return moved

    def _agree(self, numbers: list[int], small: int, large: int) -> bool:
        """Whether poses in two maps differ by a similarity only."""
        here, there = (
            np.array([self._maps[k].pose(n).translation for n in numbers]) for k in (small, large)
        )
        fit = fit_similarity(here, there)
        off = np.linalg.norm(fit(here) - there, axis=1)
        extent = np.linalg.norm(there - there.mean(axis=0), axis=1)
        return bool(np.median(off) <= _JOIN_TOLERANCE * np.median(extent))

    def _new_map(self) -> Map:
        return Map(*self._size, self.settings.least_map_inliers)

    def _connect(self, number: int) -> None:
        """Matches a new panorama with the ones before it and with places that look alike."""
        told = self.settings
        recent = list(range(max(0, number - told.recent), number))
        lookups = told.lookups * (_LOST_LOOKUPS if self._waiting else 1)
        old = max(0, number - _RECENT_ARE_NO_LOOPS * told.recent)
        looked_up = self._places.like(self._features[number], old, lookups)
        waiting = self._waiting[-_WAITING_TRIED:]
        self._neighbours[number] = []
        for other in dict.fromkeys([*recent, *looked_up, *waiting]):
            one, two = self._features[other], self._features[number]
            pairs = matches(one, two)
            geometry = verified(self._fresh.camera, one, two, pairs, told.least_pair_inliers)
            if geometry is not None:
                self._geometries[other, number] = geometry
                self._neighbours[number].append(other)
                self._neighbours[other].append(number)

    def _place(self, number: int) -> Placed | None:
        """Registers a panorama in the map that shares most points with it."""
        shared: dict[int, int] = {}
        for other in self._neighbours[number]:
            k = self._map_of.get(other)
            if k is not None:
                shared[k] = shared.get(k, 0) + len(self._geometry(other, number).inlier_matches)
        for k in sorted(shared, key=lambda k: -shared[k]):
            self._tell(self._maps[k], number)
            if self._maps[k].register(number):
                self._map_of[number] = k
                if len(self._maps[k].numbers()) >= self.settings.growth * self._adjusted_at[k]:
                    self._adjust(k)
                if self._maps[k].has(number):
                    return Placed(number, k, self._maps[k].pose(number))
                del self._map_of[number]
        return None

    def _tell(self, known: Map, number: int) -> None:
        """Makes a map know a panorama and its connections with those it knows."""
        if not known.knows(number):
            others = [n for n in self._neighbours[number] if known.knows(n)]
            geometries = {n: self._geometry(n, number) for n in others}
            known.add(number, self._features[number], geometries)

    def _geometry(self, one: int, other: int) -> Any:
        return self._geometries[min(one, other), max(one, other)]

    def _adjust(self, k: int) -> None:
        """Adjusts a whole map; what loses its pose by that waits again."""
        known = self._maps[k]
        known.adjust()
        self._adjusted_at[k] = len(known.numbers())
        for number in [n for n, m in self._map_of.items() if m == k and not known.has(n)]:
            del self._map_of[number]
            self._waiting.append(number)

    def _begin(self) -> list[Placed]:
        """Starts a map from panoramas that wait, where two of them are far enough apart."""
        newest = self._waiting[-1]
        self._tell(self._fresh, newest)
        patient = [n for n in self._waiting if n > newest - self.settings.patience]
        waiting = set(patient)
        for other in sorted(n for n in self._neighbours[newest] if n in waiting):
            if self._fresh.knows(other) and self._fresh.start(other, newest):
                k = len(self._maps)
                self._maps.append(self._fresh)
                self._fresh = self._new_map()
                self._adjusted_at[k] = 2
                first = []
                for number in (other, newest):
                    self._map_of[number] = k
                    self._waiting.remove(number)
                    first.append(Placed(number, k, self._maps[k].pose(number)))
                patient = [n for n in patient if n not in (other, newest)]
                return [*first, *self._place_waiting(patient)]
        return []

    def _catch_up(self) -> list[Placed]:
        """Places what was lost just before a panorama that is not."""
        newest = len(self) - 1
        tried = [n for n in self._waiting[-_WAITING_TRIED:] if n >= newest - _WAITING_TRIED]
        return self._place_waiting(tried)

    def _place_waiting(self, numbers: Sequence[int]) -> list[Placed]:
        """Places waiting panoramas, the newest first, as long as that makes others placeable."""
        placed: list[Placed] = []
        left = list(numbers)
        progress = True
        while progress and left:
            progress = False
            for number in reversed(list(left)):
                told = self._place(number)
                if told is not None:
                    left.remove(number)
                    self._waiting.remove(number)
                    placed.append(told)
                    progress = True
        return placed
