"""Sources of light."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.types.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Lamp:
    """A lamp, small as seen from what it lights.

    Attributes:
        position: (3,) scene frame.
        power: (3,) light on a surface that faces it one metre away.
    """

    position: FloatArray
    power: FloatArray


@dataclass(frozen=True, eq=False)
class Sun:
    """Direct sunlight.

    Attributes:
        towards: (3,) unit vector to the sun, scene frame.
        power: (3,) light on a surface that faces it.
    """

    towards: FloatArray
    power: FloatArray
