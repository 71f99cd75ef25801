"""A registered layout as a star-shaped region."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from panoplan.geometry.polar import PROFILE_BINS, profile_headings, range_profile
from panoplan.types.arrays import FloatArray
from panoplan.types.view import RegisteredLayout, picked


@dataclass(frozen=True, eq=False)
class Sights:
    """Several views, array by array.

    Attributes:
        cameras: (V, 2) positions, walk frame, camera heights.
        profiles: (V, B) range at evenly spaced headings, NaN where unknown.
        sigmas: (V, B) standard deviation of each range.
        views: the layouts themselves.
    """

    cameras: FloatArray
    profiles: FloatArray
    sigmas: FloatArray
    views: Sequence[RegisteredLayout]

    def __len__(self) -> int:
        """Number of views."""
        return len(self.views)

    def pick(self, chosen: Sequence[int]) -> Sights:
        """Some of the views, in the order given."""
        at = np.asarray(chosen, dtype=np.int64)
        return Sights(
            self.cameras[at], self.profiles[at], self.sigmas[at], picked(self.views, at.tolist())
        )


def sights(views: Sequence[RegisteredLayout]) -> Sights:
    """The regions that views see.

    Args:
        views: at least one.

    Returns:
        The regions, in the same order.
    """
    profiles = np.empty((len(views), PROFILE_BINS))
    sigmas = np.empty((len(views), PROFILE_BINS))
    cameras = np.empty((len(views), 2))
    at = profile_headings(PROFILE_BINS)
    for k, view in enumerate(views):
        cameras[k] = view.camera
        offsets = view.boundary - view.camera
        profiles[k] = range_profile(offsets)
        known = np.flatnonzero(np.isfinite(offsets[:, 0]))
        heading = np.arctan2(offsets[known, 0], offsets[known, 1])
        order = np.argsort(heading, kind="stable")
        after = np.searchsorted(heading[order], at) % max(1, len(known))
        sigmas[k] = view.sigmas[known[order[after]]] if len(known) else np.nan
    return Sights(cameras, profiles, sigmas, views)
