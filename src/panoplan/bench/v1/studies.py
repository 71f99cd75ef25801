"""The studies beside Table II, each with its scenes and its method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from panoplan.bench.parallel import Workers
from panoplan.bench.v1.ablation import ablated
from panoplan.bench.v1.ispa import ROW, shaped
from panoplan.bench.v1.predict import SHARES, Row
from panoplan.bench.v1.scale import scaled
from panoplan.bench.v1.scenes import Simulated
from panoplan.bench.v1.store import Store
from panoplan.bench.v1.sweeps import swept
from panoplan.pipeline import Progress
from panoplan.simulate.families import REPORTED_SEEDS, TUNING_SEEDS

_DEFAULT = Row("default", SHARES[0])


@dataclass(frozen=True)
class Study:
    """One study.

    Attributes:
        measure: of scenes, what is kept, workers and progress.
        seeds: of the scenes, where none are asked for.
        row: whose settings stand beside the figures.
    """

    measure: Callable[[Sequence[Simulated], Store, Workers, Progress], dict[str, Any]]
    seeds: Sequence[int]
    row: Row


def _of_row(
    function: Callable[[Sequence[Simulated], Row, Store, Workers, Progress], dict[str, Any]],
    sources: Sequence[Simulated],
    *rest: Any,
) -> dict[str, Any]:
    return function(sources, _DEFAULT, *rest)


STUDIES = {
    "ispa": Study(shaped, REPORTED_SEEDS[:10], ROW),
    "scale": Study(scaled, REPORTED_SEEDS, _DEFAULT),
    "sweeps": Study(partial(_of_row, swept), REPORTED_SEEDS[::4][:6], _DEFAULT),
    "ablation": Study(partial(_of_row, ablated), TUNING_SEEDS, _DEFAULT),
}
