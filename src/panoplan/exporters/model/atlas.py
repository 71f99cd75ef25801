"""Small pictures laid out on a large one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_WIDEST_PX = 4096


@dataclass(frozen=True, eq=False)
class Atlas:
    """A sheet of pictures.

    Attributes:
        pixels: (H, W, 3) RGB.
        places: column and row of the upper left corner of each picture on it, by name.
    """

    pixels: NDArray[np.uint8]
    places: dict[str, tuple[int, int]]


def packed(pictures: Mapping[str, NDArray[np.uint8]]) -> Atlas:
    """Lays pictures out in rows, the highest first.

    Args:
        pictures: (H, W, 3) by name, one or more.
    """
    order = sorted(pictures, key=lambda name: (-pictures[name].shape[0], name))
    area = sum(picture.shape[0] * picture.shape[1] for picture in pictures.values())
    widest = max(picture.shape[1] for picture in pictures.values())
    width = max(widest, min(_WIDEST_PX, int(1.1 * np.sqrt(area))))
    places: dict[str, tuple[int, int]] = {}
    x = y = tall = 0
    for name in order:
        rows, columns = pictures[name].shape[:2]
        if x + columns > width:
            x, y, tall = 0, y + tall, 0
        places[name] = (x, y)
        x, tall = x + columns, max(tall, rows)
    pixels = np.full((y + tall, width, 3), 128, dtype=np.uint8)
    for name, (left, top) in places.items():
        rows, columns = pictures[name].shape[:2]
        pixels[top : top + rows, left : left + columns] = pictures[name]
    return Atlas(pixels, places)
