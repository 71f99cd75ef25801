import math
import os
from operator import itemgetter
from pathlib import Path

import pytest

from panoplan.bench import accuracy
from panoplan.bench.parallel import WorkerLostError, mapped, processes
from panoplan.bench.v1.scenes import mp3d_fpe_scenes
from panoplan.config import preset
from panoplan.errors import InputError


@pytest.mark.parametrize("jobs", [1, 3])
def test_results_come_in_the_order_of_the_work(jobs):
    told = []
    results = mapped(
        math.factorial, [5, 900, 3, 0], processes(jobs), lambda *done: told.append(done)
    )
    assert results == [120, math.factorial(900), 6, 1]
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_a_failure_in_another_process_is_raised_here():
    with pytest.raises(IndexError):
        mapped(itemgetter(2), [[1, 2, 3], [1]], processes(2), lambda *_: None)


def test_an_input_error_in_another_process_is_one_here():
    with pytest.raises(InputError, match="nowhere: found no folder"):
        mapped(mp3d_fpe_scenes, [Path("nowhere")] * 2, processes(2), lambda *_: None)


def test_processes_have_one_thread_each_and_this_one_as_before(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    names = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"]
    assert mapped(os.getenv, names, processes(2), lambda *_: None) == ["1", "1"]
    assert os.environ["OMP_NUM_THREADS"] == "7"


def test_a_process_that_dies_is_told():
    with pytest.raises(WorkerLostError, match="the same command goes on"):
        mapped(os._exit, [1, 1], processes(2), lambda *_: None)


def test_figures_do_not_depend_on_the_number_of_processes():
    alone, together = (
        accuracy.measure(range(3, 4), preset("paper"), lambda *_: None, metric=True, jobs=jobs)
        for jobs in (1, 2)
    )
    assert alone == together
    assert alone["mild"]["summary"]["rooms"] > 0
