"""A layout cast onto the floor, before and after the scale is known.

Walk frame: 2-D, origin at the first keyframe's camera, second axis along that camera's heading;
the same for a walk however its world is turned or shifted.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import overload

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

    @property
    def column_worth(self) -> float:
        """How many columns of a layout of 1024 one column is as wide as."""
        return 1024 / len(self.boundary)


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


class CorrectedLayouts(Sequence[RegisteredLayout]):
    """Layouts moved by their corrections, each made when it is asked for.

    All of a long walk at once would take as much memory again.

    Args:
        layouts: as registered.
        corrections: one each.
    """

    def __init__(
        self, layouts: Sequence[RegisteredLayout], corrections: Sequence[Correction]
    ) -> None:
        self._layouts, self._corrections = layouts, corrections

    def __len__(self) -> int:
        """Number of layouts."""
        return len(self._layouts)

    @overload
    def __getitem__(self, index: int) -> RegisteredLayout: ...
    @overload
    def __getitem__(self, index: slice) -> CorrectedLayouts: ...
    def __getitem__(self, index: int | slice) -> RegisteredLayout | CorrectedLayouts:
        """The layout at `index`, or a part of them."""
        if isinstance(index, slice):
            return CorrectedLayouts(self._layouts[index], self._corrections[index])
        return self._corrections[index].apply(self._layouts[index])

    def pick(self, chosen: Iterable[int]) -> CorrectedLayouts:
        """Some of them, in the order given."""
        at = list(chosen)
        return CorrectedLayouts([self._layouts[k] for k in at], [self._corrections[k] for k in at])


def picked(
    layouts: Sequence[RegisteredLayout], chosen: Iterable[int]
) -> Sequence[RegisteredLayout]:
    """Some of the layouts, in the order given; corrected ones are still made when asked for."""
    if isinstance(layouts, CorrectedLayouts):
        return layouts.pick(chosen)
    return tuple(layouts[k] for k in chosen)
