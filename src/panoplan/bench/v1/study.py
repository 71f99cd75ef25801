"""Measurements whose results are kept as plain values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from panoplan.bench.parallel import Workers
from panoplan.bench.v1.scenes import Simulated
from panoplan.bench.v1.store import Store
from panoplan.pipeline import Progress

Case = TypeVar("Case")


class Measurement(Protocol):
    """One piece of a study."""

    @property
    def name(self) -> str:
        """Unique in a store; a relative path without ending."""

    def key(self) -> str:
        """A hash of all that the result depends on."""

    def measure(self) -> dict[str, Any]:
        """The result, as JSON has it."""


@dataclass(frozen=True, eq=False)
class Runner:
    """Makes the measurements of studies; what is kept is not made again.

    Attributes:
        store: what is kept.
        workers: make what is missing.
        progress: called with (done, in all) and the kind of measurement.
    """

    store: Store
    workers: Workers
    progress: Progress

    def results(self, measurements: Sequence[Measurement]) -> list[dict[str, Any]]:
        """The results of measurements, in their order."""
        kept = self.store
        missing = [item for item in measurements if not kept.has_result(item.name, item.key())]
        for done, (number, result) in enumerate(self.workers(_measured, missing)):
            item = missing[number]
            kept.keep_result(item.name, item.key(), result)
            self.progress(done + 1, len(missing), item.name.partition("/")[0])
        return [kept.result(item.name) for item in measurements]

    def by_case(
        self,
        cases: Sequence[Case],
        sources: Sequence[Simulated],
        measurement: Callable[[Simulated, Case], Measurement],
    ) -> Iterator[tuple[Case, list[dict[str, Any]]]]:
        """Each case measured on each scene.

        Args:
            cases: what is compared.
            sources: scenes.
            measurement: of one case on one scene.

        Returns:
            The cases in their order, each with its results in the order of the scenes.
        """
        made = iter(self.results([measurement(s, case) for case in cases for s in sources]))
        for case in cases:
            yield case, [next(made) for _ in sources]


def _measured(item: Measurement) -> dict[str, Any]:
    return item.measure()
