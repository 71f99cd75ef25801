"""A layout cast onto the floor, before and after the scale is known.

Walk frame: 2-D, origin at the first keyframe's camera, second axis along that camera's heading;
the same for a walk however its world is turned or shifted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from panoplan.types.arrays import FloatArray
from panoplan.types.layout import Spans


@dataclass(frozen=True, eq=False)
class CastLayout:
    """A layout on the floor one camera height below its camera.

    Attributes:
        keyframe: id of the keyframe.
        index: place of the keyframe in the walk.
        position_su: (2,) camera, walk frame, trajectory units.
        rise_su: how much higher than the first camera, trajectory units.
        offsets: (W, 2) boundary points relative to the camera for a camera height of 1, walk
            frame; NaN where unknown.
        sigmas: (W,) standard deviations of the ranges for a camera height of 1.
        corners: (K,) columns of wall corners, or None.
        ceiling: height above the floor for a camera height of 1, NaN where unknown.
        spans: columns of passages and windows, or None.
    """

    keyframe: str
    index: int
    position_su: FloatArray
    rise_su: float
    offsets: FloatArray
    sigmas: FloatArray
    corners: FloatArray | None
    ceiling: float = math.nan
    spans: Spans | None = None


@dataclass(frozen=True, eq=False)
class RegisteredLayout:
    """A layout in the walk frame, in camera heights (Eq. 2).

    Attributes:
        keyframe: id of the keyframe.
        index: place of the keyframe in the walk.
        camera: (2,) camera.
        height: of this camera above the floor, 1 for the first.
        boundary: (W, 2) boundary points, NaN where unknown.
        sigmas: (W,) standard deviations of the boundary's ranges.
        corners: (K,) columns of wall corners, or None.
        ceiling: its height above the floor, NaN where unknown.
        spans: columns of passages and windows, or None.
    """

    keyframe: str
    index: int
    camera: FloatArray
    height: float
    boundary: FloatArray
    sigmas: FloatArray
    corners: FloatArray | None
    ceiling: float = math.nan
    spans: Spans | None = None


@dataclass(frozen=True)
class Correction:
    """How a registered layout moves: x → camera + shift + factor · R(turn) · (x − camera).

    Attributes:
        shift: of the camera, walk frame, camera heights.
        turn: rad, from the first axis to the second.
        factor: on the ranges: what the camera's height errs, and the layout's scale.
    """

    shift: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0
    factor: float = 1.0

    def apply(self, view: RegisteredLayout) -> RegisteredLayout:
        """The layout moved."""
        camera = view.camera + self.shift
        c, s = math.cos(self.turn), math.sin(self.turn)
        turned = (view.boundary - view.camera) @ np.array([[c, s], [-s, c]])
        return replace(
            view,
            camera=camera,
            boundary=camera + self.factor * turned,
            sigmas=self.factor * view.sigmas,
            ceiling=self.factor * view.ceiling,
        )
