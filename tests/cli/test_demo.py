"""The demonstration, on the first steps of its walk."""

import os
from dataclasses import replace

import pytest

from panoplan.cli.main import main
from panoplan.formats.image import list_images
from panoplan.formats.plan_json import read_plan
from panoplan.simulate.render import sample
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth

for package in ("embreex", "onnxruntime", "pycolmap"):
    pytest.importorskip(package, reason="needs the extras images and render")

STEPS = 10


def _first_steps(home):
    walked = home.truth.trajectory
    some = Trajectory(walked.labels[:STEPS], walked.rotations[:STEPS], walked.translations[:STEPS])
    return replace(home, keyframes=home.keyframes[:STEPS], truth=GroundTruth(home.truth.plan, some))


def test_a_plan_comes_from_photographs_alone(tmp_path, monkeypatch, capsys):
    whole = sample.sample_home(5)
    assert len(whole.building.rooms) == 5
    monkeypatch.setattr(sample, "sample_home", lambda seed: _first_steps(whole))
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    monkeypatch.setenv("PANOPLAN_CACHE", str(tmp_path / "cache"))
    place = tmp_path / "demo"
    assert main(["demo", "-o", str(place)]) == 0
    told = capsys.readouterr().out
    assert f"{STEPS} of {STEPS} keyframes have poses in one frame" in told
    assert "of 5 rooms at IoU 0.5" in told
    assert len(list_images(place / "photographs")) == STEPS
    assert not (place / "truth" / "images").exists()
    plan = read_plan(place / "plan" / "plan.json")
    assert plan.unit == "m"
    assert any(room.polygon is not None for room in plan.rooms)
    assert (place / "comparison.png").read_bytes().startswith(b"\x89PNG")
    # Stopped after the photographs, it goes on with them; those of another home are told.
    (place / "comparison.png").unlink()
    taken = {path.name: path.stat().st_mtime_ns for path in list_images(place / "photographs")}
    assert main(["demo", "-o", str(place)]) == 0
    assert (place / "comparison.png").exists()
    now = {path.name: path.stat().st_mtime_ns for path in list_images(place / "photographs")}
    assert now == taken
    other = sample.simulate(whole.building, 6, "exact", keyframes_per_room=1)
    other = replace(other, name="another")
    monkeypatch.setattr(sample, "sample_home", lambda seed: other)
    assert main(["demo", "-o", str(place), "--seed", "6"]) == 2
    assert "another home's" in capsys.readouterr().err


def test_a_folder_with_something_in_it_is_left_alone(tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["demo", "-o", str(tmp_path)]) == 2
    assert "a new folder" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
