"""Two methods on the same scenes: what one gains, and how sure that is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import bootstrap

_RESAMPLES = 9999


@dataclass(frozen=True)
class Difference:
    """Mean of a figure's differences over scenes.

    Attributes:
        mean: this less that.
        low: lower end of its 95 % interval, None for fewer than two scenes.
        high: upper end.
        scenes: that have the figure in both.
    """

    mean: float
    low: float | None
    high: float | None
    scenes: int


def difference(
    this: Sequence[float | None], that: Sequence[float | None], seed: int = 0
) -> Difference | None:
    """Compares scene by scene.

    Args:
        this: a figure of one method, a scene each; None where the scene has none.
        that: of the other, the same scenes.
        seed: of the resampling.

    Returns:
        The mean difference with its percentile bootstrap interval over scenes, or None where no
        scene has both.
    """
    pairs = zip(this, that, strict=True)
    apart = np.array([a - b for a, b in pairs if a is not None and b is not None])
    if not len(apart):
        return None
    mean = float(apart.mean())
    if len(apart) < 2:
        return Difference(mean, None, None, len(apart))
    interval = bootstrap(
        (apart,),
        np.mean,
        n_resamples=_RESAMPLES,
        method="percentile",
        rng=np.random.default_rng(seed),
    ).confidence_interval
    return Difference(mean, float(interval.low), float(interval.high), len(apart))
