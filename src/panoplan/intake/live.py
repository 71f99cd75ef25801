"""The plan while the walk goes on."""

from __future__ import annotations

import time
from collections.abc import Callable

from panoplan.config import Config
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.poses.walk.follow import PlacedKeyframe
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.plan import FloorPlan

LayoutOf = Callable[[PlacedKeyframe], Layout | None]
Follower = Callable[[PlacedKeyframe], None]
"""Is told each keyframe of a walk that got its pose."""
_SHOW_EVERY_S = 1.0
_LEAST_PAUSE = 4.0
"""Times what showing took: four fifths of the time are left for the walk."""


def not_followed(layout_of: LayoutOf) -> Follower:
    """Follows no walk: for who waits for its end."""
    return lambda placed: None


class LivePlan:
    """Estimates a plan from poses as they are found, before they are adjusted as a whole.

    Only the map that the walk began with is in it.

    Args:
        config: settings.
        walk: what is known of the walk.
        show: is given the plan every second, or more seldom where that takes long.
        layout_of: looks at a keyframe; None where it shows no room.
    """

    def __init__(
        self,
        config: Config,
        walk: Walk,
        show: Callable[[FloorPlan], None],
        layout_of: LayoutOf,
    ) -> None:
        self._estimator = FloorPlanEstimator(config, walk)
        self._layout_of, self._show = layout_of, show
        self._due = time.monotonic() + _SHOW_EVERY_S

    def __call__(self, placed: PlacedKeyframe) -> None:
        """Takes a keyframe that got its pose."""
        if placed.map != 0:
            return
        keyframe = Keyframe(placed.seen.name, placed.pose, self._layout_of(placed))
        self._estimator.update(keyframe)
        began = time.monotonic()
        if began >= self._due:
            self._show(self._estimator.plan())
            ended = time.monotonic()
            self._due = ended + max(_SHOW_EVERY_S, _LEAST_PAUSE * (ended - began))
