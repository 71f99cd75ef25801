"""Accuracy floor on six small flats that no figure is reported of; the benchmark runs more."""

from panoplan.bench.parallel import processes
from panoplan.bench.v1.predict import Row
from panoplan.bench.v1.run import run
from panoplan.bench.v1.scenes import Simulated
from panoplan.bench.v1.store import Store

SEEDS = (50, 69, 73, 88, 92, 96)
FLOOR = {
    "rooms_50 recall": 0.95,
    "rooms_50 precision": 0.95,
    "rooms_70 recall": 0.9,
    "rooms_70 precision": 0.9,
    "corners recall": 0.8,
    "corners precision": 0.8,
    "doors recall": 0.9,
    "doors precision": 0.9,
}


def test_the_floor_of_default(tmp_path):
    sources, here = [Simulated("flat", seed) for seed in SEEDS], processes(1)
    row = Row("default", 1.0)
    made = run(sources, [row], Store(tmp_path), here, here, lambda *_: None)[row.name]["summary"]
    assert made["failures"] == 0
    means = made["aligned"]
    assert {name: means[name] for name, floor in FLOOR.items() if means[name] < floor} == {}
    assert made["scale_error_percent_median"] < 2.0
