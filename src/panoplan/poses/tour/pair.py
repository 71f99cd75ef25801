"""Two panoramas: what speaks for the one standing at a certain place in the frame of the other."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from panoplan.config import TourConfig
from panoplan.geometry.lifting import coincidence, length_evidence, length_pull, triangulated
from panoplan.geometry.rigid import turn
from panoplan.geometry.upright import CEILING, FLOOR, WALL, UprightFit, evidence, pull, refine
from panoplan.poses.tour.frames import heading_vector
from panoplan.poses.tour.heading import WallHeading, log_yaw_ratio, quarter_difference, yaw_prior
from panoplan.poses.tour.matching import Matches
from panoplan.poses.tour.room import RoomSeen, log_surface_ranges
from panoplan.poses.tour.twoview import caps, hypotheses
from panoplan.types.arrays import BoolArray, FloatArray, IntArray

_LENGTH_STEP = 0.025
_NEAR_STEPS = 9
"""A length is looked for up to so many steps from where the poses have it."""
_MODES_APART = 4
"""Steps within which two lengths are one."""
_LENGTH_SIGMAS = (0.015, 0.15)
"""A length's relative standard deviation is within these, whatever its peak looks like."""


@dataclass(frozen=True, eq=False)
class Place:
    """A panorama as a tour sees it.

    Attributes:
        name: of the photo.
        room: what its layout tells, or None where it has none.
        walls: their heading, or None where unknown.
    """

    name: str
    room: RoomSeen | None
    walls: WallHeading | None


class Evidence(NamedTuple):
    """What speaks for a relative pose, log likelihood ratios against chance, nats.

    Attributes:
        features: matches that agree with yaw and direction.
        lifted: where the matched points lie in the two rooms, at this length.
        walls: how the walls of the two rooms fit; against it where two cameras that near in one
            room have too little in common.
    """

    features: float
    lifted: float
    walls: float


class Length(NamedTuple):
    """A distance between two cameras at which there is a peak of evidence.

    Attributes:
        log_length: logarithm of the camera heights.
        sigma: its standard deviation.
        evidence: of points and walls there, nats.
    """

    log_length: float
    sigma: float
    evidence: float


@dataclass(frozen=True, eq=False)
class Pair:
    """Two panoramas with what they have in common.

    Attributes:
        a: the first one.
        b: the second one.
        matches: of their features.
        config: settings.
        log_surfaces: (M, 2) how far the layouts say that the first surface along each match is.
        surface_sigmas: (M, 2) their standard deviations.
        passages: (M, 2) whether that surface is a wall with a door or an opening.
        surfaces: (M,) WALL, FLOOR or CEILING: the level surface that a match lies on in either.
        cells: (M,) cell of the first panorama in which evidence is capped.
    """

    a: Place
    b: Place
    matches: Matches
    config: TourConfig
    log_surfaces: FloatArray = field(init=False)
    surface_sigmas: FloatArray = field(init=False)
    passages: BoolArray = field(init=False)
    surfaces: IntArray = field(init=False)
    cells: IntArray = field(init=False)

    def __post_init__(self) -> None:
        """Lifts every match on both layouts."""
        angles = self.matches.angles
        ranges, sigmas = np.full((2, len(angles), 2), np.nan)
        level = np.zeros(len(angles), dtype=bool)
        passages = np.zeros((len(angles), 2), dtype=bool)
        for k, room in enumerate((self.a.room, self.b.room)):
            if room is not None:
                ranges[:, k], sigmas[:, k], on_level, passages[:, k] = log_surface_ranges(
                    room, angles[:, 2 * k], angles[:, 2 * k + 1]
                )
                level |= on_level
        cells = np.floor(angles[:, :2] / np.deg2rad(self.config.evidence_cell_deg))
        object.__setattr__(self, "log_surfaces", ranges)
        object.__setattr__(self, "surface_sigmas", sigmas)
        object.__setattr__(self, "passages", passages)
        side = np.where(angles[:, 1] < 0, FLOOR, CEILING)
        object.__setattr__(self, "surfaces", np.where(level, side, WALL))
        numbers = np.unique(cells, axis=0, return_inverse=True)[1]
        object.__setattr__(self, "cells", numbers.reshape(-1))

    def hypotheses(self) -> tuple[UprightFit, ...]:
        """Yaws and directions that the matches and the walls' headings speak for."""
        steps = round(360.0 / self.config.yaw_step_deg)
        prior = yaw_prior(self.a.walls, self.b.walls, steps, self.config)
        return hypotheses(self.matches, self.surfaces, prior, self.config)

    def lengths(self, fit: UprightFit) -> tuple[Length, ...]:
        """Distances that points and walls speak for at a yaw and direction, the best first."""
        low, high = np.log(self.config.shortest_ch), np.log(self.config.longest_ch)
        logs = np.arange(low, high, _LENGTH_STEP)
        inlier = self._features(fit.yaw, fit.direction)[1]
        at = np.exp(logs)[:, None] * heading_vector(fit.direction)
        total = self._lifted(fit.yaw, fit.direction, inlier, logs) + self._walls(fit.yaw, at)
        if not np.any(total != 0):
            return ()
        return tuple(_modes(logs, total, self.config))

    def nearest_fit(self, b_in_a: FloatArray) -> UprightFit:
        """The yaw and direction that the matches speak for near a pose."""
        config = self.config
        return refine(
            self.matches.angles,
            self.matches.prior,
            self.surfaces,
            float(b_in_a[2]),
            float(np.arctan2(b_in_a[0], b_in_a[1])),
            np.deg2rad(config.match_sigma_deg),
            caps(config),
        )

    def nearest_length(self, fit: UprightFit, log_length: float) -> Length | None:
        """The distance that points and walls speak for near one, None where they speak for none."""
        steps = np.arange(-_NEAR_STEPS, _NEAR_STEPS + 1, dtype=np.float64)
        logs = log_length + _LENGTH_STEP * steps
        inlier = self._features(fit.yaw, fit.direction)[1]
        at = np.exp(logs)[:, None] * heading_vector(fit.direction)
        total = self._lifted(fit.yaw, fit.direction, inlier, logs) + self._walls(fit.yaw, at)
        return _peak(logs, total, int(np.argmax(total)))

    def pull(self, b_in_a: FloatArray, width: float) -> tuple[FloatArray, FloatArray]:
        """Where matches and points pull yaw, direction and log length, as least squares has it.

        Args:
            b_in_a: (3,) pose of the second camera beside the first one.
            width: factor on the standard deviation of the matches.

        Returns:
            (3, 3) information and (3,) information times the step to the optimum, with what is
            common to all matches of a pair (tilt, height, scale of a layout) in the information.
        """
        config = self.config
        yaw, direction = float(b_in_a[2]), float(np.arctan2(b_in_a[0], b_in_a[1]))
        length = max(float(np.hypot(*b_in_a[:2])), config.shortest_ch)
        sigma = np.deg2rad(config.match_sigma_deg)
        turning, toward, inlier = pull(
            self.matches.angles, self.matches.prior, yaw, direction, width * sigma
        )
        information, gradient = np.zeros((3, 3)), np.zeros(3)
        common = np.diag(np.deg2rad([config.yaw_floor_deg, config.direction_floor_deg]) ** 2)
        information[:2, :2] = np.linalg.inv(np.linalg.inv(turning) + common)
        gradient[:2] = information[:2, :2] @ np.linalg.solve(turning, toward)
        rows = np.flatnonzero(inlier > _LEAST_INLIER)
        if len(rows):
            ranges, sigmas = triangulated(self.matches.angles[rows], yaw, direction, sigma)
            told, drawn = length_pull(
                np.log(ranges * length) - self.log_surfaces[rows],
                np.hypot(sigmas, self.surface_sigmas[rows]),
                inlier[rows],
                self.passages[rows],
            )
            if told > 0:
                information[2, 2] = 1.0 / (1.0 / told + config.length_floor**2)
                gradient[2] = information[2, 2] * drawn / told
        return information, gradient

    def evidence(self, b_in_a: FloatArray) -> Evidence:
        """What speaks for the second camera having a pose, (3,) x, z, heading, beside the first."""
        place, yaw = b_in_a[:2], float(b_in_a[2])
        length = float(np.hypot(*place))
        if length > self.config.longest_ch:
            return Evidence(0.0, 0.0, 0.0)
        direction = float(np.arctan2(place[0], place[1]))
        features, inlier = self._features(yaw, direction)
        log_length = np.array([np.log(max(length, self.config.shortest_ch))])
        lifted = self._lifted(yaw, direction, inlier, log_length)[0] if features > 0 else 0.0
        walls = float(self._walls(yaw, place[None])[0])
        return Evidence(features, float(lifted), walls - self._strange(length, features, walls))

    def _strange(self, length: float, features: float, walls: float) -> float:
        """What speaks against one room of which two cameras so near have so little in common."""
        config = self.config
        if length >= config.same_room_near_ch or walls <= 0:
            return 0.0
        share_missing = max(0.0, 1 - features / config.same_room_evidence)
        return config.same_room_cost * share_missing * walls / config.walls_cap

    def features(self, b_in_a: FloatArray) -> float:
        """Evidence of the matches alone for a pose of the second camera beside the first one."""
        return self._features(float(b_in_a[2]), float(np.arctan2(b_in_a[0], b_in_a[1])))[0]

    def yaw_evidence(self, yaw: float) -> float:
        """What the headings of the walls say of a yaw, nats."""
        one, other = self.a.walls, self.b.walls
        if one is None or other is None:
            return 0.0
        off = quarter_difference(yaw, one.heading - other.heading)
        steps = round(360.0 / self.config.yaw_step_deg)
        return float(log_yaw_ratio(off, one, other, steps, self.config))

    def inliers(self, yaw: float, direction: float) -> FloatArray:
        """(M,) probability of each match to be one at a yaw and direction."""
        return self._features(yaw, direction)[1]

    def _features(self, yaw: float, direction: float) -> tuple[float, FloatArray]:
        config = self.config
        if not len(self.matches):
            return 0.0, np.empty(0)
        total, _, inlier = evidence(
            self.matches.angles,
            self.matches.prior,
            self.surfaces,
            yaw,
            direction,
            np.deg2rad(config.match_sigma_deg),
            caps(config),
        )
        return total, inlier

    def _lifted(
        self, yaw: float, direction: float, inlier: FloatArray, log_lengths: FloatArray
    ) -> FloatArray:
        rows = np.flatnonzero(inlier > _LEAST_INLIER)
        if not len(rows):
            return np.zeros(len(log_lengths))
        sigma = np.deg2rad(self.config.match_sigma_deg)
        ranges, sigmas = triangulated(self.matches.angles[rows], yaw, direction, sigma)
        return length_evidence(
            log_lengths,
            np.log(ranges),
            self.log_surfaces[rows],
            np.hypot(sigmas, self.surface_sigmas[rows]),
            inlier[rows],
            self.passages[rows],
            self.cells[rows],
            self.surfaces[rows] != WALL,
            self.config.length_cap,
            self.config.length_surface_cap,
        ) - _crowded(log_lengths, self.config)

    def _walls(self, yaw: float, places: FloatArray) -> FloatArray:
        """Log likelihood ratio of the two rooms' walls with the second camera at (L, 2) places."""
        one, other = self.a.room, self.b.room
        if one is None or other is None:
            return np.zeros(len(places))
        back = -places @ turn(-yaw).T
        told = coincidence(
            other.points, other.point_sigmas, yaw, places, one.log_profile, one.profile_sigmas
        ) + coincidence(
            one.points, one.point_sigmas, -yaw, back, other.log_profile, other.profile_sigmas
        )
        told *= self.config.wall_patches / 2
        odds = np.log(self.config.same_room / (1 - self.config.same_room))
        fit = np.logaddexp(odds + told[:, 0], told[:, 1])
        return np.asarray(np.minimum(fit, self.config.walls_cap))


_LEAST_INLIER = 0.02


def _crowded(log_lengths: FloatArray, config: TourConfig) -> FloatArray:
    """What speaks against photos as near one another as this: a tour is taken to see more."""
    short = np.maximum(0.0, np.log(config.usual_ch) - log_lengths)
    return np.asarray(0.5 * (short / config.usual_spread) ** 2)


def _modes(logs: FloatArray, total: FloatArray, config: TourConfig) -> list[Length]:
    """Peaks of evidence over the logarithm of the length, the highest first."""
    left = total.copy()
    found: list[Length] = []
    while len(found) < config.length_modes:
        at = int(np.argmax(left))
        if left[at] < total.max() - config.length_drop:
            break
        peak = _peak(logs, total, at)
        if peak is not None:
            found.append(peak)
        left[max(0, at - _MODES_APART) : at + _MODES_APART + 1] = -np.inf
    return found


def _peak(logs: FloatArray, total: FloatArray, at: int) -> Length | None:
    """The length at a peak inside the range, by a parabola; None where it is no peak."""
    if not 0 < at < len(logs) - 1 or total[at] < max(total[at - 1], total[at + 1]):
        return None
    bend = 2 * total[at] - total[at - 1] - total[at + 1]
    if bend <= 0:
        return None
    shift = 0.5 * (total[at + 1] - total[at - 1]) / bend
    sigma = np.clip(_LENGTH_STEP / np.sqrt(bend), *_LENGTH_SIGMAS)
    return Length(float(logs[at] + shift * _LENGTH_STEP), float(sigma), float(total[at]))
