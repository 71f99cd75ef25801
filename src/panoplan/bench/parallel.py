"""Independent pieces of work in several processes."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

Work = TypeVar("Work")
Result = TypeVar("Result")


def mapped(
    function: Callable[[Work], Result],
    work: Sequence[Work],
    jobs: int,
    progress: Callable[[int, int], None],
) -> list[Result]:
    """The results of a function, in the order of the work.

    Args:
        function: picklable; does not depend on what was done before.
        work: its arguments.
        jobs: processes, ≥ 1; 1 for this one.
        progress: called with (done, in all).
    """
    results: list[Result] = []
    if jobs == 1 or len(work) < 2:
        for number, item in enumerate(work):
            results.append(function(item))
            progress(number + 1, len(work))
        return results
    # Fresh processes: forked ones would inherit the threads of the progress display.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, len(work)), mp_context=context) as pool:
        for number, result in enumerate(pool.map(function, work)):
            results.append(result)
            progress(number + 1, len(work))
    return results
