"""The studies beside Table II."""

from dataclasses import replace

import numpy as np
import pytest
from tests.bench.v1.small import Small, runner

from panoplan.bench.v1 import scale
from panoplan.bench.v1.ispa import PATHS, Shaped, shaped
from panoplan.bench.v1.pictures import chosen, f_score, write_pictures
from panoplan.bench.v1.predict import Prediction, Row, Task
from panoplan.bench.v1.scale import scaled
from panoplan.bench.v1.store import Store
from panoplan.bench.v1.sweeps import SWEEPS, Swept, noise, thinned
from panoplan.bench.v1.tables import scale as scale_table
from panoplan.bench.v1.tables import shapes, sweeps
from panoplan.metrics.alignment import align
from panoplan.simulate.noise import REAL


@pytest.fixture(scope="module")
def source():
    return Small("flat", 3)


@pytest.fixture(scope="module")
def by_path(source, tmp_path_factory):
    """Figures of Table III of one small flat."""
    return shaped([source], runner(tmp_path_factory.mktemp("ispa")))


def _file(benchmark, figures, preset="paper"):
    return {
        "benchmark": benchmark,
        "settings": {"preset": preset},
        "figures": {"scenes_of": "flat", **figures},
    }


def test_the_same_rooms_are_shaped_in_five_ways(by_path):
    scenes = [figures["scenes"][0] for figures in by_path["paths"].values()]
    assert len({scene["shaped"] for scene in scenes}) == 1
    assert all(scene["aligned"]["rooms_30"][0] >= 2 for scene in scenes)
    # Short edges leave corners that later rounds take away.
    corners = {
        name: f["scenes"][0]["aligned"]["corners"][2] for name, f in by_path["paths"].items()
    }
    once, again = corners[PATHS[2].name], corners[PATHS[3].name]
    assert once > again
    assert all(figures["seconds_a_room"] > 0 for figures in by_path["paths"].values())


def test_table_iii_has_the_papers_beside_it(by_path):
    rows = [line for line in shapes([_file("v1-ispa", by_path)]).splitlines() if "|" in line][2:]
    assert [row.split(" | ")[0].strip("| ") for row in rows] == [path.name for path in PATHS]
    assert rows[3].endswith("| *0.72 / 0.78* | *0.68 / 0.79* | *34.3 s* |")


def test_the_key_of_a_shape_is_of_the_scene(source):
    assert Shaped(source).key() != Shaped(replace(source, seed=4)).key()


def test_the_error_of_the_scale_by_layouts(source, tmp_path, monkeypatch):
    monkeypatch.setattr(scale, "LAYOUTS", (5, 20, 500))
    figures = scaled([source], runner(tmp_path))
    few, more, none = figures["methods"]["default"]["layouts"]
    assert (few["walks"], more["walks"], none["walks"]) == (1, 1, 0)
    assert more["median"] < 8
    assert more["median"] == more["percentile_90"]
    assert none["median"] is None
    text = scale_table([_file("v1-scale", figures, "default")])
    assert (
        "| scale of | 5 layouts (1 walks) | 20 layouts (1 walks) | 500 layouts (0 walks) |" in text
    )
    assert f"| {more['median']:.2f} / {more['median']:.1f} | – / – |" in text


@pytest.mark.parametrize("swept", list(SWEEPS))
def test_a_factor_of_one_changes_nothing(swept):
    assert noise(swept, 1.0) == REAL


def test_each_sweep_changes_its_own_error():
    drift, leaks, layouts = noise("drift", 2), noise("leaks", 4), noise("layout errors", 0.5)
    assert drift.odometry.heading_deg == 2 * REAL.odometry.heading_deg
    assert drift.odometry.lost_share == REAL.odometry.lost_share
    assert (drift.bins, drift.door_leak) == (REAL.bins, REAL.door_leak)
    assert leaks.door_leak == min(1.0, 4 * REAL.door_leak)
    assert leaks.opening_leak + leaks.opening_part <= 1.0
    assert leaks.odometry == REAL.odometry
    assert [b.core_deg for b in layouts.bins] == [b.core_deg / 2 for b in REAL.bins]
    assert (layouts.scale_std, layouts.odometry) == (REAL.scale_std / 2, REAL.odometry)


def test_fewer_keyframes_have_the_same_rooms_to_find(source):
    whole = source.open()
    thin = thinned(whole, 4)
    assert thin.keyframes == whole.keyframes[::4]
    assert thin.truth is whole.truth


def test_a_sweep_is_measured_and_told(source):
    item = Swept(source, Row("paper", 1.0), "keyframes", 0.5)
    made = item.measure()
    assert made["keyframes"] == (len(source.open().keyframes) + 1) // 2
    assert made["aligned"]["rooms_30"][1] == 5
    summary = {"scenes": 1, "scale_error_percent_median": 1.0, "aligned": {
        **{f"{n} {m}": 0.5 for n in ("rooms_50", "rooms_70", "corners", "doors")
           for m in ("recall", "precision")}, "mean_iou": 0.75}}  # fmt: skip
    point = {"swept": "drift", "factor": 2.0, "keyframes_a_room": 20.4, "summary": summary}
    text = sweeps([_file("v1-sweeps", {"share": 0.2, "points": [point]})])
    assert "| drift × 2 | 20 | 0.50 / 0.50 |" in text


def test_best_median_and_worst_are_by_rooms_and_corners():
    def scene(hits):
        return {"aligned": {"rooms_70": [hits, 9, 9], "corners": [hits, 9, 9]}}

    assert chosen([scene(3), scene(9), scene(0), scene(5), scene(1)]) == {
        "best": 1, "median": 0, "worst": 2
    }  # fmt: skip
    assert f_score([3, 6, 4]) == pytest.approx(2 * 0.5 * 0.75 / 1.25)
    assert f_score([0, 6, 0]) == 0.0


def test_pictures_are_of_scenes_that_have_a_plan(source, tmp_path):
    store, row = Store(tmp_path / "kept"), Row("paper", 1.0)
    recording = source.open()
    other = replace(source, seed=4)
    for one, plan in ((source, _true_plan(recording)), (other, None)):
        store.keep_scene(one, recording)
        failure = None if plan else "lost"
        store.keep_prediction(Task(one, row), Prediction(plan, failure, 0.0))
    scenes = [{"aligned": {name: [hits, 5, 5] for name in ("rooms_70", "corners")}}
              for hits in (5, 0)]  # fmt: skip
    paths = write_pictures(tmp_path / "pictures", "flat", row, scenes, [source, other], store)
    assert [path.name for path in paths] == ["v1-flat-best.png"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)


def _true_plan(recording):
    from panoplan.exporters.compare import true_plan

    plan = true_plan(recording.truth)
    assert np.isclose(align(plan, recording.truth, "scale").true_from_plan.scale, 1.0)
    return plan
