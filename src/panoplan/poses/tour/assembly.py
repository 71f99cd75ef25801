"""Photos become groups with poses: the merge that most speaks for comes first."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from panoplan.config import TourConfig
from panoplan.geometry.angles import wrapped
from panoplan.geometry.upright import UprightFit
from panoplan.poses.tour.frames import composed, heading_vector, inverted, relative
from panoplan.poses.tour.pair import Evidence, Length, Pair
from panoplan.poses.tour.posegraph import Edge, optimised
from panoplan.poses.tour.refinement import refined
from panoplan.types.arrays import FloatArray

Poses = dict[int, FloatArray]
"""(3,) x, z, heading of each photo of a group, camera heights, by the photo's number."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A relative pose of two photos that may be the true one.

    Attributes:
        a: number of the first photo.
        b: number of the second one.
        b_in_a: (3,) x, z, heading.
        evidence: of this pair alone, nats.
    """

    a: int
    b: int
    b_in_a: FloatArray
    evidence: float

    def reversed(self) -> Candidate:
        """The same with the photos' roles changed."""
        return Candidate(self.b, self.a, inverted(self.b_in_a), self.evidence)


@dataclass(frozen=True, eq=False)
class Placing:
    """One group laid into the frame of another.

    Attributes:
        candidate: the pair that it rests on.
        moved: poses of the second group in the frame of the first one.
        evidence: the sum over all pairs across, nats.
    """

    candidate: Candidate
    moved: Poses
    evidence: float


@dataclass(eq=False)
class Atlas:
    """All pairs of a tour and what was found of them.

    Attributes:
        pairs: by the numbers of the photos, the lower first.
        fits: hypotheses of each pair.
        lengths: distances of each hypothesis.
        config: settings.
    """

    pairs: Mapping[tuple[int, int], Pair]
    fits: Mapping[tuple[int, int], tuple[UprightFit, ...]]
    lengths: Mapping[tuple[int, int], tuple[tuple[Length, ...], ...]]
    config: TourConfig
    candidates: tuple[Candidate, ...] = field(init=False)

    def __post_init__(self) -> None:
        """Lists the candidates, the best first."""
        found = [
            Candidate(
                *key,
                np.array([*(np.exp(length.log_length) * heading_vector(fit.direction)), fit.yaw]),
                fit.evidence + length.evidence,
            )
            for key, fits in self.fits.items()
            for fit, lengths in zip(fits, self.lengths[key], strict=True)
            for length in lengths
        ]
        found = [c for c in found if c.evidence > self.config.candidate_evidence]
        self.candidates = tuple(sorted(found, key=lambda c: -c.evidence))

    def between(self, poses_a: Poses, poses_b: Poses) -> float:
        """Evidence of all pairs across two groups in one frame.

        What matches say adds up. That walls fit does not: one room laid onto another one fits it
        for every photo of the two, so only the best pair's counts; that they contradict does.
        """
        found = np.array([self.of(i, j, poses_a[i], poses_b[j]) for i in poses_a for j in poses_b])
        return float(self._matched(found).sum() + max(0.0, found[:, 2].max()))

    def of(self, i: int, j: int, pose_i: FloatArray, pose_j: FloatArray) -> Evidence:
        """Evidence of two photos at their poses, in one frame."""
        if i > j:
            i, j, pose_i, pose_j = j, i, pose_j, pose_i
        return self.pairs[i, j].evidence(relative(pose_i, pose_j))

    def within(self, poses: Poses) -> float:
        """What speaks for one group's poses, but for walls that fit."""
        keys = sorted(poses)
        found = [
            self.of(i, j, poses[i], poses[j]) for n, i in enumerate(keys) for j in keys[n + 1 :]
        ]
        return float(self._matched(np.array(found)).sum()) if found else 0.0

    def _matched(self, found: FloatArray) -> FloatArray:
        """(N,) what matches and contradictory walls say, of (N, 3) evidences."""
        features = np.maximum(0.0, found[:, 0] - self.config.chance_evidence)
        return features + found[:, 1] * (features > 0) + np.minimum(0.0, found[:, 2])

    def placings(self, group: Poses, other: Poses) -> list[Placing]:
        """Ways to lay another group into the frame of a group, the best first.

        Only the candidates of most evidence are looked at.
        """
        found: list[Placing] = []
        across = [c for c in self.candidates if _crosses(c, group, other)]
        for candidate in across[: self.config.placings]:
            oriented = candidate if candidate.a in group else candidate.reversed()
            moved = laid(group, other, oriented)
            if any(_same_place(moved, p.moved) for p in found):
                continue
            evidence = self.between(group, moved) + self.turned(candidate)
            found.append(Placing(oriented, moved, evidence))
        return sorted(found, key=lambda p: -p.evidence)

    def turned(self, candidate: Candidate) -> float:
        """What the headings of the walls say of a candidate's yaw."""
        if candidate.a > candidate.b:
            candidate = candidate.reversed()
        return self.pairs[candidate.a, candidate.b].yaw_evidence(float(candidate.b_in_a[2]))

    def settled(self, poses: Poses) -> Poses:
        """The poses after a pose graph over all pairs that agree with them, and refinement."""
        for _ in range(self.config.graph_rounds):
            poses = optimised(poses, self.edges(poses), self.config.graph_loss)
        return refined(poses, self.pairs, self.config)[0]

    def edges(self, poses: Poses) -> list[Edge]:
        """What the pairs of a group tell near its poses."""
        keys = sorted(poses)
        found = (
            self._edge(i, j, relative(poses[i], poses[j]))
            for n, i in enumerate(keys)
            for j in keys[n + 1 :]
        )
        return [edge for edge in found if edge is not None]

    def _edge(self, i: int, j: int, b_in_a: FloatArray) -> Edge | None:
        config, pair = self.config, self.pairs[i, j]
        length = float(np.hypot(*b_in_a[:2]))
        if length > config.longest_ch or not self._any_near(self.fits[i, j], b_in_a):
            return None
        fit = pair.nearest_fit(b_in_a)
        if not self._any_near((fit,), b_in_a):
            return None
        mode = pair.nearest_length(fit, np.log(max(length, config.shortest_ch)))
        return _edge_of(i, j, fit, mode, config)

    def _any_near(self, fits: tuple[UprightFit, ...], b_in_a: FloatArray) -> bool:
        """Whether one of some fits is of weight and near a pose."""
        direction = np.arctan2(b_in_a[0], b_in_a[1])
        near = np.deg2rad((self.config.near_yaw_deg, self.config.near_direction_deg))
        return any(
            fit.evidence >= self.config.edge_evidence
            and abs(wrapped(fit.yaw - b_in_a[2])) < near[0]
            and abs(wrapped(fit.direction - direction)) < near[1]
            for fit in fits
        )


def laid(group: Poses, other: Poses, candidate: Candidate) -> Poses:
    """The poses of `other` in the frame of `group`, by a candidate from the one to the other."""
    anchor = composed(group[candidate.a], candidate.b_in_a)
    return {k: composed(anchor, relative(other[candidate.b], pose)) for k, pose in other.items()}


def _crosses(candidate: Candidate, group: Poses, other: Poses) -> bool:
    a, b = candidate.a, candidate.b
    return (a in group and b in other) or (a in other and b in group)


def _same_place(one: Poses, other: Poses) -> bool:
    """Whether two placings differ by less than what the pose graph mends."""
    off = np.array([relative(one[k], other[k]) for k in one])
    return bool(np.all(np.hypot(*off[:, :2].T) < 0.15) and np.all(np.abs(off[:, 2]) < 0.05))


def _edge_of(i: int, j: int, fit: UprightFit, mode: Length | None, config: TourConfig) -> Edge:
    covariance = np.linalg.inv(fit.information) + np.diag(
        np.deg2rad([config.yaw_floor_deg, config.direction_floor_deg]) ** 2
    )
    root = np.zeros((3, 3))
    root[:2, :2] = np.linalg.cholesky(np.linalg.inv(covariance)).T
    told = np.array([fit.yaw, fit.direction, np.nan])
    if mode is not None:
        told[2] = mode.log_length
        root[2, 2] = 1.0 / np.hypot(mode.sigma, config.length_floor)
    return Edge(i, j, told, root)


@dataclass(frozen=True, eq=False)
class Merger:
    """Two groups as one.

    Attributes:
        poses: of all photos, settled.
        gained: evidence across the groups, less what each of them loses by it, nats.
        lead: over the best other place of the second group beside the first one, nats.
    """

    poses: Poses
    gained: float
    lead: float

    def believed(self, config: TourConfig) -> bool:
        """Whether it is enough, and clearly more than elsewhere."""
        return self.gained >= config.merge_evidence and self.lead >= config.merge_margin


def assemble(count: int, atlas: Atlas, progress: Callable[[int, int], None]) -> list[Poses]:
    """Joins photos into groups.

    Each photo begins as a group. Of all ways to lay one group into the frame of another the one of
    most evidence, summed over all pairs across, is tried first. A pose graph settles it and its
    rivals; it is taken if what is then gained is enough, and clearly more than at the best other
    place.

    Args:
        count: number of photos.
        atlas: their pairs.
        progress: called with (photos joined, photos).

    Returns:
        The groups, the largest first.
    """
    config = atlas.config
    groups: list[Poses] = [{k: np.zeros(3)} for k in range(count)]
    known: dict[tuple[frozenset[int], frozenset[int]], list[Placing]] = {}
    refused: set[tuple[frozenset[int], frozenset[int]]] = set()
    while True:
        proposals = []
        for one, other in _group_pairs(groups, atlas.candidates):
            key = (frozenset(one), frozenset(other))
            if key not in known:
                known[key] = atlas.placings(one, other)
            if key not in refused and known[key]:
                proposals.append((known[key][0].evidence, key, one, other))
        proposals = [p for p in proposals if p[0] >= config.trial_evidence]
        if not proposals:
            return sorted(groups, key=lambda g: (-len(g), min(g)))
        _, key, one, other = max(proposals, key=lambda p: p[0])
        merger = merged(one, other, known[key], atlas)
        if not merger.believed(config):
            refused.add(key)
            continue
        groups = [g for g in groups if g is not one and g is not other] + [merger.poses]
        progress(count - len(groups) + 1, count)


def merged(one: Poses, other: Poses, placings: list[Placing], atlas: Atlas) -> Merger:
    """Settles the best placings of a group beside another and takes the one that gains most.

    Args:
        one: the group whose frame is kept.
        other: the group that is placed.
        placings: the best first, not empty.
        atlas: the pairs.
    """
    config = atlas.config
    apart = [atlas.within(group) for group in (one, other)]
    tried: list[tuple[float, Poses]] = []
    for placing in _rivals(one, other, placings, config):
        poses = atlas.settled(one | placing.moved)
        parts = [{k: poses[k] for k in group} for group in (one, other)]
        # That a group fits itself better after settling once more speaks for no place of the other.
        lost = sum(
            min(0.0, atlas.within(part) - before) for part, before in zip(parts, apart, strict=True)
        )
        gained = atlas.between(*parts) + lost + atlas.turned(placing.candidate)
        tried.append((gained, poses))
    tried.sort(key=lambda t: -t[0])
    gained, poses = tried[0]
    others = [g for g, p in tried[1:] if differ(one, other, poses, p, config)]
    return Merger(poses, gained, gained - max([0.0, *others]))


def _rivals(one: Poses, other: Poses, placings: list[Placing], config: TourConfig) -> list[Placing]:
    """The best placing and others of weight, each a place of its own."""
    found: list[Placing] = []
    for placing in placings:
        if placing.evidence < config.rival_share * placings[0].evidence:
            break
        poses = one | placing.moved
        if all(differ(one, other, poses, one | p.moved, config) for p in found):
            found.append(placing)
    return found[: config.rivals]


def differ(one: Poses, other: Poses, poses: Poses, rival: Poses, config: TourConfig) -> bool:
    """Whether two ways to join two groups are different places, not one told with an error."""
    anchor = next(iter(one))
    off = np.array(
        [
            relative(relative(poses[anchor], poses[k]), relative(rival[anchor], rival[k]))
            for k in other
        ]
    )
    far = float(np.median(np.hypot(*off[:, :2].T)))
    turned = float(np.median(np.abs(off[:, 2])))
    return far > config.place_apart_ch or turned > np.deg2rad(config.place_apart_deg)


def _group_pairs(groups: list[Poses], candidates: Iterable[Candidate]) -> list[tuple[Poses, Poses]]:
    """Groups that some candidate joins, the larger one first."""
    of = {photo: g for g, group in enumerate(groups) for photo in group}
    pairs = {tuple(sorted((of[c.a], of[c.b]))) for c in candidates}
    both = [(groups[a], groups[b]) for a, b in sorted(pairs) if a != b]
    return [(x, y) if len(x) >= len(y) else (y, x) for x, y in both]
