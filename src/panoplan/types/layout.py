"""The layout of one panorama: where floor meets wall, column by column."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.errors import InputError
from panoplan.types.arrays import FloatArray, frozen_array


@dataclass(frozen=True, eq=False)
class Spans:
    """Where a layout's source sees passages and windows in the walls.

    Each is (K, 2) columns in [0, W], first and last; a span over the image's edge ends before it
    starts.

    Attributes:
        doors: with or without a leaf.
        openings: where the room goes on without a door.
        windows: in outer walls.
    """

    doors: FloatArray
    openings: FloatArray
    windows: FloatArray

    def __post_init__(self) -> None:
        """Copies and checks the arrays."""
        for name in ("doors", "openings", "windows"):
            columns = np.asarray(getattr(self, name), dtype=np.float64).reshape(-1, 2)
            object.__setattr__(self, name, frozen_array(name, columns, (None, 2)))


@dataclass(frozen=True, eq=False)
class Layout:
    """Room layout seen from one camera.

    Column u of W looks along heading 2π(u + ½)/W − π, clockwise seen from above, 0 along the
    camera's z axis. Elevations are positive upwards.

    Attributes:
        floor_boundary: (W,) elevation of the floor-wall boundary in rad, NaN where unknown;
            the floor lies below the horizon, so known values are negative, and a value at or
            above the horizon says nothing about range.
        ceiling_boundary: (W,) elevation of the ceiling-wall boundary in rad, NaN where
            unknown, or None.
        corners: (K,) columns of wall corners, sorted, in [0, W), or None where the layout's
            source gives none.
        floor_sigma: (W,) standard deviation of `floor_boundary` in rad as its source states
            it, or None.
        spans: passages and windows, or None where the layout's source tells none.
    """

    floor_boundary: FloatArray
    ceiling_boundary: FloatArray | None = None
    corners: FloatArray | None = None
    floor_sigma: FloatArray | None = None
    spans: Spans | None = None

    def __post_init__(self) -> None:
        """Copies and checks the arrays."""
        floor = frozen_array("floor_boundary", self.floor_boundary, (None,), finite=False)
        width = len(floor)
        if width < 16:
            raise InputError("floor_boundary", f"{width} columns", "at least 16")
        known = floor[~np.isnan(floor)]
        if np.any(np.abs(known) > np.pi / 2):
            raise InputError(
                "floor_boundary",
                f"an elevation of {known[np.argmax(np.abs(known))]:.4g}",
                "radians within ±π/2, or NaN",
            )
        object.__setattr__(self, "floor_boundary", floor)
        for name in ("ceiling_boundary", "floor_sigma"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen_array(name, value, (width,), finite=False))
        if self.corners is not None:
            corners = frozen_array("corners", self.corners, (None,))
            if np.any((corners < -0.5) | (corners > width)):
                raise InputError("corners", "a column outside the image", f"columns in 0..{width}")
            corners = np.sort(corners % width)
            corners.setflags(write=False)
            object.__setattr__(self, "corners", corners)
        if self.spans is not None:
            for name in ("doors", "openings", "windows"):
                columns = getattr(self.spans, name)
                if np.any((columns < -0.5) | (columns > width)):
                    raise InputError(name, "a column outside the image", f"columns in 0..{width}")

    @property
    def width(self) -> int:
        """Number of image columns W."""
        return len(self.floor_boundary)
