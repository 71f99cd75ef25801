"""The plan while the walk goes on."""

from __future__ import annotations

import time
from collections.abc import Callable

from panoplan.config import Config
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.poses.walk.follow import PlacedKeyframe, Seen
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.plan import FloorPlan

LayoutOf = Callable[[Seen], Layout | None]
Follower = Callable[[PlacedKeyframe], None]
"""Is told each keyframe of a walk that got its pose."""
_SHOW_EVERY_S = 2.0


def not_followed(layout_of: LayoutOf) -> Follower:
    """Follows no walk: for who waits for its end."""
    return lambda placed: None


class LivePlan:
    """Estimates a plan from poses as they are found, before they are adjusted as a whole.

    Only the map that the walk began with is in it.

    Args:
        config: settings.
        walk: what is known of the walk.
        show: is given the plan every two seconds at most.
        layout_of: looks at a panorama; None where it shows no room.
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
        self._shown_at = time.monotonic()

    def __call__(self, placed: PlacedKeyframe) -> None:
        """Takes a keyframe that got its pose."""
        if placed.map != 0:
            return
        keyframe = Keyframe(placed.seen.name, placed.pose, self._layout_of(placed.seen))
        self._estimator.update(keyframe)
        if time.monotonic() - self._shown_at >= _SHOW_EVERY_S:
            self._show(self._estimator.plan())
            self._shown_at = time.monotonic()
