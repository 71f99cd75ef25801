"""Measurements whose results are kept as plain values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from panoplan.bench.parallel import Workers
from panoplan.bench.v1.store import Store
from panoplan.pipeline import Progress


class Measurement(Protocol):
    """One piece of a study."""

    @property
    def name(self) -> str:
        """Unique in a store; a relative path without ending."""

    def key(self) -> str:
        """A hash of all that the result depends on."""

    def measure(self) -> dict[str, Any]:
        """The result, as JSON has it."""


def studied(
    measurements: Sequence[Measurement], store: Store, workers: Workers, progress: Progress
) -> list[dict[str, Any]]:
    """The results of measurements; those kept are not made again.

    Args:
        measurements: any order.
        store: what is kept.
        workers: make those that are missing.
        progress: called with (done, in all) and the kind of measurement.

    Returns:
        The results in their order.
    """
    missing = [item for item in measurements if not store.has_result(item.name, item.key())]
    for done, (number, result) in enumerate(workers(_measured, missing)):
        item = missing[number]
        store.keep_result(item.name, item.key(), result)
        progress(done + 1, len(missing), item.name.partition("/")[0])
    return [store.result(item.name) for item in measurements]


def _measured(item: Measurement) -> dict[str, Any]:
    return item.measure()
