import csv
import shutil

import pytest
from tests.metrics.plans import plan
from tests.scenes import RECTANGLE, walk

from panoplan.cli.main import main
from panoplan.formats.plan_json import read_plan, write_plan
from panoplan.formats.sequence import write_sequence


@pytest.fixture
def folder(tmp_path):
    write_plan(tmp_path / "plan.json", plan(unit="ch"))
    return tmp_path


def test_edits_are_kept_beside_the_estimate_and_exports_follow(folder, capsys):
    path, estimate = folder / "plan.json", (folder / "plan.json").read_bytes()
    words = ["edit", str(path), "--name", "room_01=Kitchen", "--length", "wall_00=6"]
    assert main(words) == 0
    told = capsys.readouterr().out
    assert "times 1.50000" in told
    assert "metres by length, ±" in told
    assert path.read_bytes() == estimate
    assert "Kitchen" in (folder / "plan.svg").read_text(encoding="utf-8")
    assert main(["export", str(path), "--to", "csv", "-o", str(folder / "out")]) == 0
    with (folder / "out" / "rooms.csv").open(newline="", encoding="utf-8") as stream:
        (row, *_) = csv.DictReader(stream)
    assert row["name"] == "Kitchen"
    assert float(row["area_m2"]) == pytest.approx(12.0 * 1.5**2)
    assert main(["edit", str(path), "--drop", "wall_00"]) == 0
    assert main(["export", str(path), "--to", "csv", "-o", str(folder / "out")]) == 2


def test_list_names_what_can_be_edited(folder, capsys):
    assert main(["edit", str(folder / "plan.json"), "--list"]) == 0
    told = capsys.readouterr().out
    for word in ("room_01  Room 1", "wall_00  4.000 ch", "door_01  between room_01 and room_02"):
        assert word in told
    assert not (folder / "edits.json").exists()


@pytest.mark.parametrize(
    "more", [["--name", "room_77=x"], ["--length", "wall_00=-1"], ["--nudge", "wall_00=0.1"]]
)
def test_a_bad_edit_is_one_line_and_nothing_is_written(folder, capsys, more):
    before = sorted(item.name for item in folder.iterdir())
    assert main(["edit", str(folder / "plan.json"), *more]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert sorted(item.name for item in folder.iterdir()) == before


def test_edits_survive_a_new_run(tmp_path, capsys):
    cameras = [[-1.2, -0.7], [1.1, -0.6], [0.9, 0.8], [-0.8, 0.6]]
    write_sequence(tmp_path / "room", "room", walk(RECTANGLE, cameras))
    out = tmp_path / "plan"
    words = ["run", str(tmp_path / "room"), "-o", str(out), "--quiet"]
    assert main(words) == 0
    assert main(["edit", str(out / "plan.json"), "--name", "room_01=Study"]) == 0
    kept = (out / "edits.json").read_bytes()
    assert main([*words, "--camera-height", "1.5"]) == 0
    assert read_plan(out / "plan.json").rooms[0].name == "Room 1"
    assert (out / "edits.json").read_bytes() == kept
    assert "Study" in (out / "plan.svg").read_text(encoding="utf-8")
    assert main(["export", str(out / "plan.json"), "--to", "csv", "-o", str(out / "x")]) == 0
    assert "Study" in (out / "x" / "rooms.csv").read_text(encoding="utf-8")


def test_an_edit_that_lost_its_place_is_told(folder, capsys):
    path = folder / "plan.json"
    assert main(["edit", str(path), "--name", "room_03=Bath", "--length", "wall_00=4"]) == 0
    write_plan(path, plan(plan().rooms[0].polygon[None], unit="ch"))
    capsys.readouterr()
    assert main(["export", str(path), "--to", "csv", "-o", str(folder / "out")]) == 0
    assert "edit not applied: name of room_03, 'Bath'" in capsys.readouterr().err
    shutil.rmtree(folder / "out")
