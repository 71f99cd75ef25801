import json
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from tests.metrics.plans import FLAT, LEFT, plan, square

import panoplan.formats
from panoplan.errors import InputError
from panoplan.formats.plan_json import plan_to_dict, plan_to_text, read_plan, write_plan
from panoplan.types.plan import Aperture


def assert_equal(one, other):
    """Two plans alike all the way down; tuples in settings come back as lists."""
    if is_dataclass(one):
        assert type(one) is type(other)
        for item in fields(one):
            assert_equal(getattr(one, item.name), getattr(other, item.name))
    elif isinstance(one, np.ndarray):
        assert one.shape == other.shape
        assert one == pytest.approx(other, abs=0.51e-6)
    elif isinstance(one, tuple | list):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            assert_equal(a, b)
    elif isinstance(one, dict):
        assert sorted(one) == sorted(other)
        for key in one:
            assert_equal(one[key], other[key])
    elif isinstance(one, float):
        assert one == pytest.approx(other, rel=1e-8, abs=0.51e-6)
    else:
        assert one == other


def full_plan():
    rooms = (*FLAT, None, square(9, 9) / 3)
    made = plan(rooms, names=["Küche", 'a "b" \\ c', "客厅", "x\ny", ""])
    holed = replace(made.rooms[0], holes=(square(1, 1, 0.5)[::-1],), level=-1)
    return replace(made, rooms=(holed, *made.rooms[1:]))


def change(data, path, value):
    *way, last = path
    for key in way:
        data = data[key]
    data[last] = value


@pytest.mark.parametrize("made", [full_plan(), plan((), ()), plan(unit="ch")], ids=["m", "0", "ch"])
def test_reading_gives_back_what_was_written(tmp_path, made):
    path = tmp_path / "plan.json"
    write_plan(path, made)
    again = read_plan(path)
    assert_equal(made, again)
    assert plan_to_text(again).encode() == path.read_bytes()


def test_a_scale_that_is_not_known(tmp_path):
    scale = replace(
        plan().scale, ch_per_su=None, method="unknown", sigma=None, search_range=None, curve=None
    )
    write_plan(tmp_path / "plan.json", plan(scale=scale))
    assert_equal(scale, read_plan(tmp_path / "plan.json").scale)


def test_a_tiny_scale_keeps_its_digits(tmp_path):
    scale = replace(plan().scale, ch_per_su=1.23456789e-7)
    write_plan(tmp_path / "plan.json", plan(scale=scale))
    assert read_plan(tmp_path / "plan.json").scale.ch_per_su == pytest.approx(
        1.23456789e-7, rel=1e-9
    )


def test_text_is_the_same_for_the_same_plan():
    text = plan_to_text(full_plan())
    assert text == plan_to_text(full_plan())
    assert text.endswith("}\n")
    other = plan(settings={"scale": {"a": "x", "b": [1, 2]}})
    assert plan_to_text(plan()) == plan_to_text(other)
    noise = replace(plan().rooms[0], polygon=LEFT + 3e-7)
    assert plan_to_dict(plan(rooms=()))["rooms"] == []
    assert plan_to_dict(replace(plan(), rooms=(noise,)))["rooms"][0]["polygon"] == LEFT.tolist()


def test_points_stand_on_one_line_and_names_are_left_alone():
    made = plan((LEFT,), names=["[\n 1,\n 2\n]"])
    text = plan_to_text(made)
    assert "[4.0, 3.0]" in text
    assert json.loads(text)["rooms"][0]["name"] == "[\n 1,\n 2\n]"


def test_area_takes_holes_off():
    rooms = plan_to_dict(full_plan())["rooms"]
    assert rooms[0]["area"] == pytest.approx(12 - 0.25)
    assert (rooms[3]["area"], rooms[3]["polygon"]) == (None, None)
    assert rooms[3]["failure"] == "no closed path"


def test_the_schema_is_a_schema_and_is_strict():
    from importlib import resources

    schema = json.loads(resources.files(panoplan.formats).joinpath("plan.schema.json").read_text())
    Draft202012Validator.check_schema(schema)
    pending = [schema]
    while pending:
        node = pending.pop()
        if isinstance(node, dict):
            if node.get("type") == "object" and "properties" in node:
                assert node["additionalProperties"] is False
                # Plans that were written before there was this one stay readable.
                later = {"length_sigma"}
                assert set(node["required"]) == set(node["properties"]) - later
            pending += node.values()
        elif isinstance(node, list):
            pending += node


@pytest.mark.parametrize(
    ("path", "value", "told"),
    [
        (("schema",), 2, r"\$\.schema"),
        (("unit",), "ft", r"\$\.unit"),
        (("extra",), 1, "extra"),
        (("rooms", 1, "polygon"), [[0, 0], [1, 1]], r"\$\.rooms\[1\]\.polygon"),
        (("rooms", 1, "polygon", 2), [0, "1"], r"\$\.rooms\[1\]\.polygon"),
        (("rooms", 0, "polygon"), None, r"\$\.rooms\[0\]"),
        (("rooms", 0, "failure"), "none", r"\$\.rooms\[0\]\.failure"),
        (("rooms", 0, "walls", 0, "sigma"), -1, r"\$\.rooms\[0\]\.walls\[0\]\.sigma"),
        (("trajectory", 0, "position"), [1, 2, 3], r"\$\.trajectory\[0\]\.position"),
        (("trajectory", 0, "heading"), float("nan"), r"\$\.trajectory\[0\]\.heading.*NaN"),
        pytest.param(
            ("trajectory", 0, "position", 1), 10**400, r"\$\.trajectory.*infinity", id="huge"
        ),
        (("skipped", 0, "count"), 0, r"\$\.skipped\[0\]\.count"),
        (("camera_height_m",), True, r"\$\.camera_height_m"),
        (("settings",), [], r"\$\.settings"),
        (("frame", "level_rotation"), [[1, 0], [0, 1]], r"\$\.frame\.level_rotation"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, path, value, told):
    data = json.loads(plan_to_text(plan()))
    change(data, path, value)
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(data))
    with pytest.raises(InputError, match=told) as caught:
        read_plan(file)
    message = str(caught.value)
    assert "plan.json" in message
    assert "\n" not in message
    assert len(message) < 500


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "[" * 100_000, '{"schema": 1}', "1e999"])
def test_what_is_no_plan_is_refused(tmp_path, text):
    file = tmp_path / "plan.json"
    file.write_text(text)
    with pytest.raises(InputError):
        read_plan(file)


def test_numbers_beyond_all_bounds_are_refused(tmp_path):
    file = tmp_path / "plan.json"
    file.write_text(plan_to_text(plan()).replace("[4.0, 3.0]", "[4.0, 1e999]", 1))
    with pytest.raises(InputError, match=r"rooms\[0\]\.polygon\[2\]\[1\].*infinity"):
        read_plan(file)


def test_a_plan_that_is_not_finite_is_not_written(tmp_path):
    broken = plan(doors=(Aperture("door_01", np.array([[0.0, np.nan], [1.0, 1.0]])),))
    with pytest.raises(InputError, match=r"\$\.doors\[0\]\.a\[1\]"):
        write_plan(tmp_path / "plan.json", broken)
    assert not list(tmp_path.iterdir())


def test_a_file_of_any_size_is_not_read(tmp_path):
    file = tmp_path / "plan.json"
    with file.open("wb") as stream:
        stream.truncate(65 * 2**20)
    with pytest.raises(InputError, match="at most"):
        read_plan(file)


def test_half_a_character_is_refused(tmp_path):
    path = tmp_path / "plan.json"
    data = plan_to_dict(plan())
    data["rooms"][0]["name"] = "a\ud800b"
    path.write_text(json.dumps(data), "ascii")
    with pytest.raises(InputError, match=r"\$\.rooms\[0\]\.name: found half of a character"):
        read_plan(path)
    data["rooms"][0]["name"] = "\U0001f600"
    path.write_text(json.dumps(data), "ascii")
    assert read_plan(path).rooms[0].name == "\U0001f600"


@pytest.mark.parametrize("kind", ["room", "wall", "aperture"])
def test_an_id_that_is_there_twice_is_refused(tmp_path, kind):
    path = tmp_path / "plan.json"
    doors = tuple(
        Aperture(name, np.array([[4.0, 1.0], [4.0, 1.9]]), ("room_01",), ("wall_01",))
        for name in ("door_01", "door_02")
    )
    data = plan_to_dict(replace(plan(), doors=doors))
    walls = [wall for room in data["rooms"] for wall in room["walls"]]
    items = {"room": data["rooms"], "wall": walls, "aperture": data["doors"]}[kind]
    path.write_text(json.dumps(data))
    read_plan(path)
    items[1]["id"] = items[0]["id"]
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, match=f"{kind} '{items[0]['id']}' more than once"):
        read_plan(path)
