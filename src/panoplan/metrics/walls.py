"""Where walls lie across themselves, and whether their stated uncertainty holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from panoplan.types.arrays import FloatArray
from panoplan.types.plan import Wall

FARTHEST_M = 0.5
"""A true wall farther away than this is another one."""

_PARALLEL = np.cos(np.deg2rad(15.0))
_MIN_SHARE = 0.5


@dataclass(frozen=True)
class WallFigures:
    """Distances of predicted walls from the true ones, across the wall.

    Attributes:
        predicted: walls of matched rooms.
        compared: those of them that have a true wall.
        median_cm: median absolute distance, None where none was compared.
        stated: compared walls that state a sigma.
        within_1_sigma: share of them within it, None where there is none.
        within_2_sigma: share within twice it.
    """

    predicted: int
    compared: int
    median_cm: float | None
    stated: int
    within_1_sigma: float | None
    within_2_sigma: float | None


def wall_figures(pairs: Sequence[tuple[FloatArray, Sequence[Wall]]]) -> WallFigures:
    """Compares the walls of matched rooms.

    Args:
        pairs: true outline (N, 2) and the predicted walls of each, in metres.

    Returns:
        The figures.
    """
    errors, sigmas, count = [], [], 0
    for outline, walls in pairs:
        for wall in walls:
            count += 1
            error = wall_error(wall, outline)
            if error is not None:
                errors.append(abs(error))
                sigmas.append(np.nan if wall.sigma is None else wall.sigma)
    distance, sigma = np.array(errors), np.array(sigmas)
    told = np.isfinite(sigma)
    shares = [
        float(np.mean(distance[told] <= k * sigma[told])) if told.any() else None for k in (1, 2)
    ]
    return WallFigures(
        predicted=count,
        compared=len(errors),
        median_cm=100.0 * float(np.median(distance)) if len(errors) else None,
        stated=int(told.sum()),
        within_1_sigma=shares[0],
        within_2_sigma=shares[1],
    )


SAME_CORNER_M = 0.3
"""A true corner farther away than this is another one."""


def true_wall(wall: Wall, outlines: Sequence[FloatArray]) -> FloatArray | None:
    """The true wall whose two corners both are those of a predicted one.

    Args:
        wall: predicted, metres.
        outlines: (N, 2) of the true rooms, counter-clockwise.

    Returns:
        (2, 2) from corner to corner, or None where no true wall begins and ends within 0.3 m of
        where the predicted one does.
    """
    edges = np.concatenate([np.stack([o, np.roll(o, -1, axis=0)], axis=1) for o in outlines])
    apart = np.hypot(*np.moveaxis(edges - np.array([wall.a, wall.b]), -1, 0)).max(axis=1)
    nearest = int(np.argmin(apart))
    return edges[nearest] if apart[nearest] <= SAME_CORNER_M else None


def wall_error(wall: Wall, outline: FloatArray) -> float | None:
    """How far a wall lies outside the true one, metres.

    Args:
        wall: predicted.
        outline: (N, 2) of the true room, counter-clockwise.

    Returns:
        The distance across the wall at the middle of what the two have in common, positive
        outwards; None where no true wall that is parallel within 15° lies beside half of it.
    """
    start, end = outline, np.roll(outline, -1, axis=0)
    length = np.maximum(np.hypot(*(end - start).T), 1e-9)
    along = (end - start) / length[:, None]
    own = wall.b - wall.a
    reach = float(np.hypot(*own))
    if reach < 1e-9:
        return None
    at = np.sort(np.stack([((p - start) * along).sum(axis=1) for p in (wall.a, wall.b)]), axis=0)
    low, high = np.maximum(at[0], 0.0), np.minimum(at[1], length)
    beside = high - low > _MIN_SHARE * np.minimum(reach, length)
    chosen = beside & (along @ own > _PARALLEL * reach)
    if not chosen.any():
        return None
    outward = np.stack([along[:, 1], -along[:, 0]], axis=-1)
    # The predicted wall at the middle of the common part.
    middle = (low + high) / 2
    share = (middle - ((wall.a - start) * along).sum(axis=1)) / np.where(
        np.abs(along @ own) > 1e-9, along @ own, np.inf
    )
    off = ((wall.a + share[:, None] * own - start) * outward).sum(axis=1)
    off = np.where(chosen & (np.abs(off) <= FARTHEST_M), off, np.inf)
    nearest = int(np.argmin(np.abs(off)))
    return float(off[nearest]) if np.isfinite(off[nearest]) else None
