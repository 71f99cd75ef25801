"""What the paper reports on its own dataset, which is another than ours.

Source: Tables I-III of "360-DFPE: Leveraging Monocular 360-Layouts for Direct Floor Plan
Estimation".
"""

from __future__ import annotations

from dataclasses import dataclass

Pair = tuple[float, float]
"""Recall and precision."""


@dataclass(frozen=True)
class Statistics:
    """A row of Table I: scenes, and mean and standard deviation of rooms and areas."""

    dataset: str
    scenes: int
    rooms: Pair
    area_m2: Pair


@dataclass(frozen=True)
class Method:
    """A row of Table II.

    Attributes:
        name: of the method.
        rooms: at an IoU of .3, .5 and .7.
        corners: within 10 px.
    """

    name: str
    rooms: tuple[Pair, Pair, Pair]
    corners: Pair


@dataclass(frozen=True)
class Shape:
    """A row of Table III.

    Attributes:
        rooms_50: at an IoU of .5.
        corners: within 10 px.
        seconds: a room.
    """

    rooms_50: Pair
    corners: Pair
    seconds: float


TABLE_I = (
    Statistics("Floor-SP", 99, (7.07, 2.26), (104.52, 44.36)),
    Statistics("MP3D-FPE", 50, (13.74, 9.00), (685.72, 760.52)),
)

TABLE_II = (
    Method("FloorNet", ((0.1982, 0.4861), (0.1160, 0.2084), (0.0653, 0.1237)), (0.1523, 0.6669)),
    Method("Floor-SP", ((0.7207, 0.7616), (0.6139, 0.6187), (0.4620, 0.4334)), (0.5358, 0.7627)),
    Method("360-DFPE, 20 %", ((0.7982, 0.8350), (0.6833, 0.7109), (0.4525, 0.4772)),
           (0.6779, 0.6982)),
    Method("360-DFPE, 100 %", ((0.8302, 0.9099), (0.7201, 0.7821), (0.5209, 0.5640)),
           (0.6766, 0.7890)),
)  # fmt: skip

TABLE_III = (
    Shape((0.7051, 0.7666), (0.7048, 0.7103), 80.71),
    Shape((0.7228, 0.7884), (0.6944, 0.7420), 29.83),
    Shape((0.7239, 0.7891), (0.7483, 0.5401), 9.92),
    Shape((0.7201, 0.7821), (0.6766, 0.7890), 34.28),
    Shape((0.7183, 0.7822), (0.6758, 0.8010), 49.03),
)
