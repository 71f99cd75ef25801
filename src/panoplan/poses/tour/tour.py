"""From photos and their layouts to groups of poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panoplan.config import Config, TourConfig
from panoplan.poses.tour.assembly import Atlas, Poses, assemble, merged
from panoplan.poses.tour.features import Features, upright_features
from panoplan.poses.tour.frames import relative
from panoplan.poses.tour.heading import wall_heading
from panoplan.poses.tour.matching import match, without_distant
from panoplan.poses.tour.pair import Pair, Place
from panoplan.poses.tour.refinement import refined
from panoplan.poses.tour.room import room_seen
from panoplan.types.arrays import FloatArray
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory

Progress = Callable[[int, int, str], None]
"""Is told what is done, of how much, and what it is."""
FeatureFinder = Callable[[str, NDArray[np.uint8], TourConfig], Features]


@dataclass(frozen=True, eq=False)
class TourGroup:
    """Photos in one frame.

    The frame is that of the first photo, lengths are camera heights.

    Attributes:
        photos: names, in the order given.
        poses: (N, 3) x, z and heading (rad, clockwise seen from above) of each.
        covariances: (N, 3, 3) of each pose relative to the first photo.
    """

    photos: tuple[str, ...]
    poses: FloatArray
    covariances: FloatArray

    def trajectory(self) -> Trajectory:
        """The poses as a trajectory in camera heights, level, y down."""
        positions = np.zeros((len(self.photos), 3))
        positions[:, [0, 2]] = self.poses[:, :2]
        rotations = np.zeros((len(self.photos), 3, 3))
        sin, cos = np.sin(self.poses[:, 2]), np.cos(self.poses[:, 2])
        rotations[:, 0, 0], rotations[:, 0, 2] = cos, sin
        rotations[:, 2, 0], rotations[:, 2, 2] = -sin, cos
        rotations[:, 1, 1] = 1.0
        return Trajectory(self.photos, rotations, positions)


@dataclass(frozen=True, eq=False)
class Guess:
    """Where a group may belong that could not be joined: to be shown as a guess, never used.

    Attributes:
        group: its number.
        poses: (N, 3) of its photos in the frame of the first group.
        evidence: gained by it, nats; a merge needs more, or a clearer lead.
        lead: over the best other place, nats.
    """

    group: int
    poses: FloatArray
    evidence: float
    lead: float


@dataclass(frozen=True, eq=False)
class TourResult:
    """What became of a photo tour.

    Attributes:
        groups: photos in one frame each, the largest group first; frames of different groups have
            nothing to do with one another.
        reasons: why each photo outside the first group is not in it, by name.
        guesses: where other groups may belong.
    """

    groups: tuple[TourGroup, ...]
    reasons: Mapping[str, str]
    guesses: tuple[Guess, ...]


def found_features(name: str, image: NDArray[np.uint8], config: TourConfig) -> Features:
    """The features of a photo, whatever its name."""
    return upright_features(image, config)


def join_tour(
    images: Mapping[str, NDArray[np.uint8]],
    layouts: Mapping[str, Layout],
    config: Config,
    progress: Progress,
    features: FeatureFinder = found_features,
) -> TourResult:
    """Joins sparse photos, metres apart, into groups with poses.

    All cameras are level and of one height. What cannot be joined with enough evidence, or could
    be at two places, stays a group of its own.

    Args:
        images: (H, W) grey levels of each equirectangular photo by name, W = 2 H; each is asked
            for once, so they may be read when asked for.
        layouts: by the same names; a photo without one is joined by its features alone.
        config: settings.
        progress: is told how far the work has come.
        features: finds them, or remembers them.

    Returns:
        The groups.

    Raises:
        MissingExtraError: pycolmap is not installed.
    """
    names = tuple(images)
    places = [_place(name, layouts.get(name), config) for name in names]
    seen = []
    for done, name in enumerate(names):
        progress(done, len(names), "features")
        seen.append(features(name, images[name], config.tour))
    atlas = _atlas(places, seen, config.tour, progress)
    groups = assemble(
        len(names), atlas, lambda done, total: progress(done, total, "joining photos")
    )
    told = [_told(group, names, atlas) for group in groups]
    reasons: dict[str, str] = {}
    guesses = []
    for number, group in enumerate(groups[1:], start=1):
        reason, guess = _why_apart(groups[0], group, number, told[0], atlas)
        reasons |= {names[k]: reason for k in sorted(group)}
        if guess is not None:
            guesses.append(guess)
    return TourResult(tuple(told), reasons, tuple(guesses))


def _place(name: str, layout: Layout | None, config: Config) -> Place:
    if layout is None:
        return Place(name, None, None)
    room = room_seen(layout, config.registration)
    return Place(name, room, wall_heading(room, config.tour))


def _atlas(
    places: list[Place], seen: list[Features], config: TourConfig, progress: Progress
) -> Atlas:
    keys = [(i, j) for i in range(len(places)) for j in range(i + 1, len(places))]
    pairs, fits, lengths = {}, {}, {}
    for done, (i, j) in enumerate(keys):
        progress(done, len(keys), "comparing photos")
        matches = without_distant(
            match(seen[i], seen[j], config), places[i].room, places[j].room, config
        )
        pair = Pair(places[i], places[j], matches, config)
        pairs[i, j] = pair
        fits[i, j] = pair.hypotheses()
        lengths[i, j] = tuple(pair.lengths(fit) for fit in fits[i, j])
    return Atlas(pairs, fits, lengths, config)


def _told(group: Poses, names: tuple[str, ...], atlas: Atlas) -> TourGroup:
    """The group in the frame of its first photo, with covariances."""
    keys = sorted(group)
    ordered = {k: relative(group[keys[0]], group[k]) for k in keys}
    poses, covariance = refined(ordered, atlas.pairs, atlas.config)
    blocks = [covariance[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] for k in range(len(keys))]
    return TourGroup(
        tuple(names[k] for k in keys), np.array([poses[k] for k in keys]), np.array(blocks)
    )


def _why_apart(
    largest: Poses, group: Poses, number: int, told: TourGroup, atlas: Atlas
) -> tuple[str, Guess | None]:
    config = atlas.config
    placings = atlas.placings(largest, group)
    if not placings or placings[0].evidence < config.candidate_evidence:
        return "nothing that it is known to have in common with the others", None
    merger = merged(largest, group, placings, atlas)
    anchor = merger.poses[min(largest)]
    poses = np.array([relative(anchor, merger.poses[k]) for k in sorted(group)])
    guess = Guess(number, poses, merger.gained, merger.lead)
    if merger.gained < config.merge_evidence:
        reason = f"evidence of {merger.gained:.0f} nats, {config.merge_evidence:.0f} are needed"
    else:
        reason = f"two places alike: the better one leads by {merger.lead:.0f} nats, "
        reason += f"{config.merge_margin:.0f} are needed"
    return reason, guess
