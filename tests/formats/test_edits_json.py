import json

import pytest
from tests.metrics.plans import plan

from panoplan.editing.change import changed
from panoplan.errors import InputError
from panoplan.formats.edits_json import EDITS, read_edited, read_edits, write_edits
from panoplan.formats.plan_json import write_plan
from panoplan.types.edits import Edits


@pytest.fixture
def edits():
    return changed(
        Edits(),
        plan(),
        names=["room_01=客厅 <b>"],
        lengths=["wall_00=4.25"],
        nudges=["wall_03=-0.05"],
        door_heights=["door_01=2.03@kf0,400/1024"],
    )


def test_reading_gives_back_what_was_written(tmp_path, edits):
    write_edits(tmp_path / "a.json", edits)
    write_edits(tmp_path / "b.json", read_edits(tmp_path / "a.json"))
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    again = read_edits(tmp_path / "a.json")
    assert again.names[0].name == "客厅 <b>"
    assert again.lengths[0].metres == 4.25
    assert again.nudges[0].wall.b == pytest.approx(edits.nudges[0].wall.b)
    assert again.door_heights[0].elevation == edits.door_heights[0].elevation


def test_no_file_no_edits(tmp_path):
    assert read_edits(tmp_path / "none.json").names == ()


def test_a_plan_is_read_with_the_edits_beside_it(tmp_path, edits):
    write_plan(tmp_path / "plan.json", plan())
    assert read_edited(tmp_path / "plan.json").plan.rooms[0].name == "Room 1"
    write_edits(tmp_path / EDITS, edits)
    assert read_edited(tmp_path / "plan.json").plan.rooms[0].name == "客厅 <b>"


def newer(data):
    data["schema"] = 2


def odd_name(data):
    data["names"][0]["name"] = 5


def long_name(data):
    data["names"][0]["name"] = "x" * 10_001


def not_finite(data):
    data["nudges"][0]["metres"] = float("nan")


def no_length(data):
    data["lengths"][0]["metres"] = 0


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (newer, "schema 2.*newer panoplan"),
        (odd_name, r"\$\.names\[0\]\.name"),
        (long_name, r"\$\.names\[0\]\.name"),
        (not_finite, r"\$\.nudges\[0\]\.metres.*NaN"),
        (no_length, r"\$\.lengths\[0\]\.metres"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, edits, spoil, told):
    path = tmp_path / EDITS
    write_edits(path, edits)
    data = json.loads(path.read_text())
    spoil(data)
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, match=told) as caught:
        read_edits(path)
    assert len(str(caught.value)) < 500
