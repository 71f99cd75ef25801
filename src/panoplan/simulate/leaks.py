"""Boundaries that go through doors and openings."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from panoplan.simulate.noise import NoiseModel
from panoplan.simulate.views import View

_PERCENTILE_90_Z = 1.2815515655446004


@dataclass(frozen=True)
class Leak:
    """A boundary that goes through a door or an opening.

    Attributes:
        depth_m: how far, square to the wall.
        partly: whether it does so in a part of the columns only.
    """

    depth_m: float
    partly: bool = False


def draw_leaks(
    doors: Iterable[int],
    openings: Iterable[int],
    model: NoiseModel,
    rng: np.random.Generator,
    near: Container[int] = (),
) -> dict[int, Leak]:
    """Which passages of a room a view goes through, and how deep.

    Args:
        doors: indices of the room's doors.
        openings: indices of its openings.
        model: the grade.
        rng: of the draw.
        near: those that the camera stands in or right before.

    Returns:
        The leaks, by index of the passage.
    """
    spread = np.log(model.leak_percentile_90_m / model.leak_median_m) / _PERCENTILE_90_Z
    leaks = {}
    for indices, share, part in (
        (doors, model.door_leak, model.door_part),
        (openings, model.opening_leak, model.opening_part),
    ):
        for k in indices:
            chance, depth = rng.random(), rng.standard_normal()
            whole = max(share, model.doorway_leak) if k in near else share
            if chance < whole + part:
                depth_m = float(model.leak_median_m * np.exp(spread * depth))
                leaks[k] = Leak(depth_m, chance >= whole)
    return leaks


def partly_closed(view: View, leaks: Mapping[int, Leak], rng: np.random.Generator) -> View:
    """The view with leaks that are partial closed in the rest of their columns.

    Args:
        view: with all leaks.
        leaks: by index of the passage.
        rng: of the part.

    Returns:
        The view; a part of one fifth to four fifths at one end stays open.
    """
    closed = np.zeros(len(view.range_m), dtype=np.bool_)
    for k in (k for k, leak in leaks.items() if leak.partly):
        columns = np.flatnonzero(view.leaked & (view.passage == k))
        # Columns in the order of the image, over its edge where need be.
        gap = (
            int(np.argmax(np.diff(columns, append=columns[:1] + len(closed))))
            if len(columns)
            else 0
        )
        columns = np.roll(columns, -gap - 1)
        stays, at_start = int(rng.uniform(0.2, 0.8) * len(columns)), rng.random() < 0.5
        closed[columns[stays:] if at_start else columns[: len(columns) - stays]] = True
    if not closed.any():
        return view
    return replace(
        view,
        range_m=np.where(closed, view.closed_range_m, view.range_m),
        surface=np.where(closed, view.closed_surface, view.surface),
        leaked=view.leaked & ~closed,
    )
