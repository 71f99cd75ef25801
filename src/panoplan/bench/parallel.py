"""Independent pieces of work in several processes."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Protocol, TypeVar

from panoplan.errors import PanoplanError

Work = TypeVar("Work")
Result = TypeVar("Result")


_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""As many threads as processes, for linear algebra that would take all processors in each."""


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Environment variables for processes that begin meanwhile."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


class Workers(Protocol):
    """What does independent pieces of work somewhere."""

    def __call__(
        self, function: Callable[[Work], Result], work: Sequence[Work], /
    ) -> Iterator[tuple[int, Result]]:
        """Place in the work and result of each piece, as they are done."""


class WorkerLostError(PanoplanError):
    """A process that did some of the work is gone."""


def processes(jobs: int) -> Workers:
    """Workers on this machine.

    Args:
        jobs: processes, ≥ 1; 1 for this one.

    Returns:
        The workers. They begin the work in its order. Where a process dies they raise
        WorkerLostError.
    """

    def finished(
        function: Callable[[Work], Result], work: Sequence[Work], /
    ) -> Iterator[tuple[int, Result]]:
        if jobs == 1 or len(work) < 2:
            for number, item in enumerate(work):
                yield number, function(item)
            return
        # Fresh processes: forked ones would inherit the threads of the progress display.
        context = multiprocessing.get_context("spawn")
        with (
            _environment(_ONE_THREAD),
            ProcessPoolExecutor(min(jobs, len(work)), mp_context=context) as pool,
        ):
            place = {pool.submit(function, item): number for number, item in enumerate(work)}
            try:
                for future in as_completed(place):
                    yield place[future], future.result()
            except BrokenProcessPool:
                raise WorkerLostError(
                    "a process of the benchmark died, as it does when memory is short; what was "
                    "done is kept: the same command goes on"
                ) from None
            finally:
                pool.shutdown(wait=False, cancel_futures=True)

    return finished


def mapped(
    function: Callable[[Work], Result],
    work: Sequence[Work],
    workers: Workers,
    progress: Callable[[int, int], None],
) -> list[Result]:
    """The results of a function, in the order of the work.

    Args:
        function: picklable; does not depend on what was done before.
        work: its arguments.
        workers: do it.
        progress: called with (done, in all).
    """
    results: dict[int, Result] = {}
    for number, result in workers(function, work):
        results[number] = result
        progress(len(results), len(work))
    return [results[number] for number in range(len(work))]
