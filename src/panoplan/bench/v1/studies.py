"""The studies beside Table II, each with its scenes and its method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from panoplan.bench.v1.ablation import ablated
from panoplan.bench.v1.ispa import ROW, shaped
from panoplan.bench.v1.predict import SHARES, Row
from panoplan.bench.v1.scale import scaled
from panoplan.bench.v1.scenes import Simulated
from panoplan.bench.v1.study import Runner
from panoplan.bench.v1.sweeps import swept
from panoplan.simulate.families import REPORTED_SEEDS, TUNING_SEEDS

_DEFAULT = Row("default", SHARES[0])


@dataclass(frozen=True)
class Study:
    """One study.

    Attributes:
        measure: of scenes and what does the work.
        seeds: of the scenes, where none are asked for.
        row: whose settings stand beside the figures.
    """

    measure: Callable[[Sequence[Simulated], Runner], dict[str, Any]]
    seeds: Sequence[int]
    row: Row


STUDIES = {
    "ispa": Study(shaped, REPORTED_SEEDS[:10], ROW),
    "scale": Study(scaled, REPORTED_SEEDS, _DEFAULT),
    "sweeps": Study(partial(swept, row=_DEFAULT), REPORTED_SEEDS[::4][:6], _DEFAULT),
    "ablation": Study(partial(ablated, row=_DEFAULT), TUNING_SEEDS, _DEFAULT),
}
