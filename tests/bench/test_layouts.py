"""Judging a layout network on panoramas with true layouts."""

import json

import numpy as np
import pytest
from PIL import Image
from tests.scenes import RECTANGLE, walk

from panoplan.bench import layouts
from panoplan.bench.table import updated
from panoplan.formats.layout_npz import write_layout_npz
from panoplan.formats.sequence import write_sequence
from panoplan.layouts.contract import ModelSpec, Output
from panoplan.layouts.dense import Dense
from panoplan.layouts.network.samples import TARGETS, WIDTH
from panoplan.layouts.network.shards import HELD_OUT_SEED
from panoplan.types.layout import Layout, Spans


class _Teller:
    """A network that says the same of every panorama."""

    spec = ModelSpec("image", 256, 512, {"floor_boundary": Output("a", "elevation")}, name="same")

    def __init__(self, dense):
        self.dense = dense

    def __call__(self, pixels):
        return self.dense


@pytest.fixture
def folder(tmp_path):
    keyframes = walk(RECTANGLE, [np.zeros(2), np.zeros(2)], headings=[0.0, 0.0])
    images = {k.id: f"{k.id}.png" for k in keyframes}
    write_sequence(tmp_path, "box", keyframes, images=images)
    (tmp_path / layouts.TRUE_LAYOUTS).mkdir()
    for keyframe in keyframes:
        Image.fromarray(np.zeros((256, 512, 3), np.uint8)).save(tmp_path / images[keyframe.id])
        write_layout_npz(tmp_path / "layouts_gt" / f"{keyframe.id}.npz", keyframe.layout)
    return tmp_path, np.asarray(keyframes[0].layout.floor_boundary)


def _measured(folder, dense):
    return layouts.measure(folder, _Teller(dense), lambda done, total, now="": None)


def test_the_truth_itself_has_no_error(folder):
    path, truth = folder
    figures = _measured(path, Dense(truth, sigma=np.full(1024, 0.01)))
    assert figures["all"]["panoramas"] == 2
    assert figures["all"]["floor_px"]["mean"] == pytest.approx(0, abs=1e-3)
    assert figures["all"]["iou_2d"]["median"] == pytest.approx(1, abs=1e-5)
    assert figures["sigma"]["within_1"] == 1
    assert figures["with_openings"] == {"panoramas": 0}


def test_errors_by_hand(folder):
    path, truth = folder
    off = np.pi / 512 * np.where(np.arange(1024) < 512, 3.0, 5.0)
    sigma = np.full(1024, np.pi / 512 * 4)
    figures = _measured(path, Dense(truth - off, sigma=sigma))
    assert figures["all"]["floor_px"]["median"] == pytest.approx(4, abs=1e-3)
    assert figures["sigma"]["within_1"] == pytest.approx(0.5)
    assert figures["sigma"]["within_2"] == 1
    near, far = 1 / np.tan(-(truth - off)), 1 / np.tan(-truth)
    expected = (near**2).sum() / (far**2).sum()
    assert figures["all"]["iou_2d"]["mean"] == pytest.approx(expected, rel=1e-4)


def test_a_column_of_which_nothing_is_said_counts_as_a_guess(folder):
    path, truth = folder
    silent = np.where(np.arange(1024) < 256, np.nan, truth)
    rows = _measured(path, Dense(silent))["all"]["floor_px"]["mean"]
    assert rows == pytest.approx(layouts.UNKNOWN_ROWS / 4, rel=0.01)


def test_cameras_outside_of_their_room_are_left_out(folder):
    path, truth = folder
    description = json.loads((path / "sequence.json").read_text())
    description["keyframes"][0]["inside"] = False
    (path / "sequence.json").write_text(json.dumps(description))
    assert _measured(path, Dense(truth))["all"]["panoramas"] == 1


def test_spans_by_hand(folder):
    """Doors are in columns 10-19 and 1020-3, and are told in columns 5-14 of half as many."""
    path, truth = folder
    spans = Spans(np.array([[10.0, 19.0], [1020.0, 3.0]]), np.empty((0, 2)), np.empty((0, 2)))
    for file in (path / layouts.TRUE_LAYOUTS).iterdir():
        write_layout_npz(file, Layout(truth, spans=spans))
    chance = np.zeros(1024)
    chance[10:30] = 1
    found = _measured(path, Dense(truth, chances={"doors": chance, "openings": 0 * chance}))[
        "spans"
    ]
    assert found["doors"]["recall"] == pytest.approx(10 / 18)
    assert found["doors"]["precision"] == pytest.approx(10 / 20)
    assert found["openings"] == {"recall": None, "precision": None}


def test_the_held_out_renders_of_a_training_are_judged(tmp_path):
    rows = np.zeros((2, len(TARGETS), WIDTH), dtype=np.float32)
    floors = [-np.pi / 4, -np.arctan(1 / 0.5)]
    for k, floor in enumerate(floors):
        rows[k, 0], rows[k, 1], rows[k, 2] = floor, floor, 0.5
    rows[0, TARGETS.index("opening"), 100:200] = 1
    images = np.zeros((2, WIDTH // 2, WIDTH, 3), dtype=np.uint8)
    for name, array in (("images", images), ("targets", rows)):
        np.save(tmp_path / f"{name}-{HELD_OUT_SEED:07d}.npy", array)
        np.save(tmp_path / f"{name}-0000000.npy", array)
    figures = _measured(tmp_path, Dense(np.full(WIDTH, floors[0])))
    assert [line["id"] for line in figures["panoramas"]] == ["1000000-0", "1000000-1"]
    assert figures["with_openings"]["floor_px"]["mean"] == pytest.approx(0, abs=1e-3)
    # The second stands in a round room of 0.25 π square camera heights.
    assert figures["in_small_rooms"]["panoramas"] == 1
    off = (floors[0] - floors[1]) * layouts.ROWS / np.pi
    assert figures["in_small_rooms"]["floor_px"]["mean"] == pytest.approx(off, rel=1e-4)


def test_the_table_tells_it(folder, tmp_path):
    path, truth = folder
    figures = _measured(path, Dense(truth, sigma=np.full(1024, 0.01)))
    data = {
        "benchmark": "layouts",
        "commit": "abc",
        "settings": {"preset": "default"},
        "figures": figures,
    }
    results = tmp_path / "results"
    results.mkdir()
    (results / "layouts.json").write_text(json.dumps(data))
    page = updated("<!-- measured: layouts -->\n<!-- end of measured -->\n", results, path)
    assert "all | 2 | 0.0 | 0.0 | 1.000 | 1.000" in page
