"""What a network says of every column, and the layout that follows from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from panoplan.formats.horizonnet import WIDTH, at_columns, corner_peaks
from panoplan.geometry.sphere import column_heading
from panoplan.types.arrays import FloatArray
from panoplan.types.layout import Layout, Spans

_LIKELY = 0.5
_NARROWEST, _WIDEST = 1 / 360, 230 / 360
_BESIDE, _BESIDE_OF = (2, 6), 512
"""Columns beside a passage that tell where its jamb stands, of so many."""
_SPANS = ("doors", "openings", "windows")


@dataclass(frozen=True, eq=False)
class Dense:
    """A network's answer, column u of W at heading 2π(u + ½)/W − π.

    Attributes:
        floor: (W,) elevation in rad, NaN where it says nothing.
        ceiling: (W,) elevation in rad, or None.
        sigma: (W,) standard deviation of `floor` in rad, or None.
        chances: (W,) probability by "corners", "doors", "openings", "windows".
        confidence: probability that the image is what the network expects, or None.
    """

    floor: FloatArray
    ceiling: FloatArray | None = None
    sigma: FloatArray | None = None
    chances: dict[str, FloatArray] = field(default_factory=dict)
    confidence: float | None = None


def turned(dense: Dense, columns: int, *, mirrored: bool = False) -> Dense:
    """The answer for the image rolled to the right by some columns, after mirroring it.

    Args:
        dense: of the image.
        columns: whole columns of the answer.
        mirrored: whether left and right change places first.
    """

    def turn(values: FloatArray) -> FloatArray:
        return np.roll(values[::-1] if mirrored else values, columns)

    return Dense(
        turn(dense.floor),
        None if dense.ceiling is None else turn(dense.ceiling),
        None if dense.sigma is None else turn(dense.sigma),
        {name: turn(chance) for name, chance in dense.chances.items()},
        dense.confidence,
    )


def mean(answers: Sequence[Dense]) -> Dense:
    """The mean of several answers about one image.

    The variance is the mean of the stated ones plus that of the answers about their mean, so that
    disagreement is told.

    Args:
        answers: at least one, all with the same parts.
    """
    if len(answers) == 1:
        return answers[0]
    floors = np.array([answer.floor for answer in answers])
    ceilings = [answer.ceiling for answer in answers if answer.ceiling is not None]
    sigmas = [answer.sigma for answer in answers if answer.sigma is not None]
    sure = [answer.confidence for answer in answers if answer.confidence is not None]
    variance = np.mean(np.square(sigmas), axis=0) if sigmas else 0.0
    return Dense(
        floors.mean(axis=0),
        np.mean(ceilings, axis=0) if ceilings else None,
        np.sqrt(variance + floors.var(axis=0)),
        {
            name: np.mean([answer.chances[name] for answer in answers], axis=0)
            for name in answers[0].chances
        },
        float(np.mean(sure)) if sure else None,
    )


def widened(dense: Dense, width: int) -> Dense:
    """The answer on another number of columns, linear between those that there are."""
    at = (np.arange(width, dtype=np.float64) + 0.5) * (len(dense.floor) / width) - 0.5
    return Dense(
        at_columns(dense.floor, at),
        None if dense.ceiling is None else at_columns(dense.ceiling, at),
        None if dense.sigma is None else at_columns(dense.sigma, at),
        {name: at_columns(chance, at) for name, chance in dense.chances.items()},
        dense.confidence,
    )


def layout(dense: Dense) -> Layout:
    """The layout: boundaries as they are, corners at peaks, spans where they are likely.

    Doors and openings are closed: there the floor's edge is straight. It has at least 1024 columns,
    so that walls seen at a slant are no loose points.
    """
    if len(dense.floor) < WIDTH:
        dense = widened(dense, WIDTH)
    corners = dense.chances.get("corners")
    spans, floor = None, dense.floor
    if any(name in dense.chances for name in _SPANS):
        none = np.zeros(len(dense.floor))
        chances = {name: dense.chances.get(name, none) for name in _SPANS}
        spans = Spans(**{name: likely_spans(chance) for name, chance in chances.items()})
        # Where a network wavers between door and opening there is a passage all the same.
        floor = closed(floor, likely_spans(chances["doors"] + chances["openings"]))
    return Layout(
        floor,
        dense.ceiling,
        None if corners is None else corner_peaks(corners),
        dense.sigma,
        spans,
    )


def closed(floor: FloatArray, spans: FloatArray) -> FloatArray:
    """The floor's edge drawn straight across passages, from what is seen on both sides of each.

    Where a network sees through a passage, or half through it, its edge bends away from the line
    that the jambs fix.

    Args:
        floor: (W,) elevation in rad, NaN where unknown.
        spans: (K, 2) first and last column of each passage; those narrower than a degree or wider
            than 230°, and those without an edge below the horizon on both sides, stay as they are.

    Returns:
        (W,) elevation.
    """
    width = len(floor)
    angle = column_heading(np.arange(width, dtype=np.float64), width)
    rays = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    beside = np.arange(*_BESIDE) * width // _BESIDE_OF
    out = floor.copy()
    for first, last in spans.astype(int):
        count = (last - first) % width + 1
        if not _NARROWEST <= count / width <= _WIDEST:
            continue
        jambs = [(first - beside) % width, (last + beside) % width]
        if not (floor[jambs] < 0).all():
            continue
        near, far = (np.median(rays[j] / np.tan(-floor[j])[:, None], axis=0) for j in jambs)
        normal = np.array([near[1] - far[1], far[0] - near[0]])
        columns = (first + np.arange(count)) % width
        with np.errstate(divide="ignore"):
            distance = (near @ normal) / (rays[columns] @ normal)
        on_line = distance > 0
        out[columns[on_line]] = -np.arctan(1 / distance[on_line])
    return out


def likely_spans(chance: FloatArray) -> FloatArray:
    """Runs of columns that are likelier than not.

    Args:
        chance: (W,) 0..1 around the circle.

    Returns:
        (K, 2) first and last column; a run over the image's edge ends before it starts.
    """
    likely = chance >= _LIKELY
    if likely.all():
        return np.array([[0.0, len(chance) - 1.0]])
    starts = np.flatnonzero(likely & ~np.roll(likely, 1))
    ends = np.flatnonzero(likely & ~np.roll(likely, -1))
    if len(starts) and ends[0] < starts[0]:
        ends = np.roll(ends, -1)
    return np.stack([starts, ends], axis=1).astype(np.float64)
