"""What the estimator is fed with."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.types.layout import Layout
from panoplan.types.pose import Pose


@dataclass(frozen=True, eq=False)
class Keyframe:
    """One panorama of the walk.

    Attributes:
        id: its name, unique within the walk.
        pose: world_from_cam; the world is level (y down along gravity) and the same for all.
        layout: the room seen from here, or None where none could be had.
        missing: why `layout` is None.
    """

    id: str
    pose: Pose
    layout: Layout | None
    missing: str = "no layout"
