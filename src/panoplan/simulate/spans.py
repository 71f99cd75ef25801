"""Doors, openings and windows as a layout network tells them.

`MEASURED_SPANS` comes from 32 real panoramas of one home with a real layout network's spans,
compared with annotated segments: 161 true ones seen whole, 111 told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.simulate.views import Surface, View
from panoplan.types.arrays import BoolArray, IntArray
from panoplan.types.layout import Spans

_REFERENCE_WIDTH = 1024


@dataclass(frozen=True)
class SpanErrors:
    """How spans err.

    Attributes:
        door_recall: share of the doors seen whole that are told as doors.
        opening_recall: the same of openings.
        opening_as_door: share of the openings told as doors.
        window_recall: share of the windows told as windows.
        false_share: share of what is told that is not there.
        end_spread: (largest error of an end in columns of 1024, share of the ends within it).
    """

    door_recall: float = 1.0
    opening_recall: float = 1.0
    opening_as_door: float = 0.0
    window_recall: float = 1.0
    false_share: float = 0.0
    end_spread: tuple[tuple[float, float], ...] = ()


EXACT_SPANS = SpanErrors()
MEASURED_SPANS = SpanErrors(
    door_recall=0.90,
    opening_recall=0.70,
    opening_as_door=0.19,
    window_recall=0.96,
    false_share=0.03,
    end_spread=((3.0, 0.5), (16.0, 0.9), (40.0, 1.0)),
)

_FEWEST_COLUMNS = 8
_KINDS = (Surface.DOOR, Surface.OPENING, Surface.WINDOW)


def noisy_spans(view: View, errors: SpanErrors, rng: np.random.Generator) -> Spans:
    """What a layout network tells of the doors, openings and windows of a view.

    Args:
        view: the truth.
        errors: how the network errs.
        rng: of the errors.

    Returns:
        Columns, first and last, of what it tells.
    """
    width = len(view.range_m)
    told: dict[Surface, list[tuple[float, float]]] = {kind: [] for kind in _KINDS}
    recall = dict(
        zip(_KINDS, (errors.door_recall, errors.opening_recall, errors.window_recall), strict=True)
    )
    for kind in _KINDS:
        # Two passages that touch in the image are two.
        for first, last in column_runs(view.closed_surface == kind, view.passage):
            chance = rng.random()
            ends = [_off(column, errors, width, rng) for column in (first, last)]
            if last - first < _FEWEST_COLUMNS or ends[1] - ends[0] < _FEWEST_COLUMNS:
                continue
            span = (ends[0] % width, ends[1] % width)
            if chance < recall[kind]:
                told[kind].append(span)
            elif kind is Surface.OPENING and chance < recall[kind] + errors.opening_as_door:
                told[Surface.DOOR].append(span)
    count = sum(map(len, told.values()))
    for _ in range(rng.binomial(count, errors.false_share)):
        start, length = rng.uniform(0, width), rng.uniform(20, 120) * width / _REFERENCE_WIDTH
        kind = _KINDS[int(rng.integers(len(_KINDS)))]
        told[kind].append((start, (start + length) % width))
    return Spans(*(np.array(sorted(told[kind])).reshape(-1, 2) for kind in _KINDS))


def column_runs(there: BoolArray, group: IntArray) -> list[tuple[int, int]]:
    """Stretches of columns.

    Args:
        there: (W,) which columns belong to one.
        group: (W,) neighbours of unequal groups belong to two.

    Returns:
        First and last column of each; the last may lie beyond the image's edge.
    """
    width = len(there)
    begins = np.flatnonzero(there & ~(np.roll(there, 1) & (np.roll(group, 1) == group)))
    runs = []
    for first in begins:
        last = int(first)
        while last + 1 - first < width:
            after = (last + 1) % width
            if not there[after] or group[after] != group[first]:
                break
            last += 1
        runs.append((int(first), last))
    return runs


def _off(column: float, errors: SpanErrors, width: int, rng: np.random.Generator) -> float:
    chance, sign = rng.random(), rng.choice([-1.0, 1.0])
    if not errors.end_spread:
        return float(column)
    limits = np.array([0.0, *(columns for columns, _ in errors.end_spread)])
    shares = np.array([0.0, *(share for _, share in errors.end_spread)])
    size = np.interp(chance, shares, limits) * width / _REFERENCE_WIDTH
    return float(column + sign * size)
