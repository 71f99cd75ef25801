import json

import pytest
from tests.exporters.model.painted import painted_plan, write_panoramas
from tests.exporters.storeys import ODD_NAMES
from tests.metrics.plans import plan

from panoplan.cli.main import main
from panoplan.formats.plan_json import plan_to_dict, write_plan


@pytest.fixture
def folder(tmp_path):
    write_plan(tmp_path / "plan.json", plan())
    return tmp_path


def test_export_writes_what_it_is_asked_for(folder, capsys):
    out = folder / "out"
    words = ["export", str(folder / "plan.json"), "--to", "svg,csv,geojson", "-o", str(out)]
    words += ["--north", "30", "--anchor", "48.2,16.37", "--paper", "A2", "--title", "My flat"]
    assert main(words) == 0
    assert capsys.readouterr().out.split() == [
        str(out / name) for name in ("sheet.svg", "rooms.csv", "plan.geojson")
    ]
    text = (out / "sheet.svg").read_text(encoding="utf-8")
    assert "My flat" in text
    assert 'width="594mm"' in text
    assert "north" in text
    assert json.loads((out / "plan.geojson").read_bytes())["panoplan"]["coordinates"] == "WGS 84"


def test_images_texture_the_model(tmp_path, capsys):
    pytest.importorskip("trimesh", reason="the extra 'export' is not installed")
    made = painted_plan()
    write_plan(tmp_path / "plan.json", made)
    files = write_panoramas(tmp_path, made, width=128)
    words = ["export", str(tmp_path / "plan.json"), "--to", "glb", "--quiet"]
    for name, more in (("plain", []), ("photos", ["--images", str(tmp_path)])):
        assert main([*words, "-o", str(tmp_path / name), *more]) == 0
    sizes = [(tmp_path / name / "plan.glb").stat().st_size for name in ("plain", "photos")]
    assert sizes[1] > sizes[0] + 10_000
    files["kf1"].unlink()
    assert main([*words, "-o", str(tmp_path / "one"), "--images", str(tmp_path)]) == 0
    assert "no image of 1 of 2 keyframes" in capsys.readouterr().err
    files["kf0"].write_bytes(b"broken")
    assert main([*words, "-o", str(tmp_path / "two"), "--images", str(tmp_path)]) == 2
    files["kf0"].unlink()
    assert main([*words, "-o", str(tmp_path / "two"), "--images", str(tmp_path)]) == 2
    assert "no image of any keyframe" in capsys.readouterr().err
    assert not (tmp_path / "two").exists()


ODD_KINDS = ("svg", "pdf", "dxf", "geojson", "ifc", "glb", "csv", "html")


@pytest.mark.parametrize("name", [name for name in ODD_NAMES if name != "x" * 10_000])
def test_odd_names_are_harmless_in_every_format(tmp_path, name):
    write_plan(tmp_path / "plan.json", plan(names=[name, "x" * 10_000, "\u202e\x07\n"]))
    words = ["export", str(tmp_path / "plan.json"), "--to", ",".join(ODD_KINDS), "--quiet"]
    assert main([*words, "-o", str(tmp_path / "out"), "--title", name]) == 0
    for path in (tmp_path / "out").iterdir():
        data = path.read_bytes()
        if path.name != "plan.glb":
            assert b"\x07" not in data or path.suffix == ".pdf"
        # Scripts are the report's own, data in others.
        if path.suffix == ".svg":
            assert b"<script" not in data
        if path.suffix == ".html":
            assert data.count(b"<script") == 2


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "empty"),
        (b"\x00\xff\xfe", "UTF-8"),
        (b"[1, 2]", "object"),
        (b'{"schema": 1', "broken JSON"),
        (b"[" * 100_000, "nested too deeply"),
        (None, "folder"),
    ],
)
def test_files_that_are_no_plan_are_one_line(tmp_path, capsys, content, told):
    path = tmp_path / "plan.json"
    path.mkdir() if content is None else path.write_bytes(content)
    assert main(["export", str(path), "--to", "csv", "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_where_one_file_cannot_be_written_none_is(folder, capsys):
    (folder / "out" / "plan.geojson").mkdir(parents=True)
    words = ["export", str(folder / "plan.json"), "--to", "csv,geojson,svg"]
    assert main([*words, "-o", str(folder / "out")]) == 2
    assert "plan.geojson: found Is a directory" in capsys.readouterr().err
    assert [path.name for path in (folder / "out").iterdir()] == ["plan.geojson"]


def newer(data):
    data["schema"] = 7


def not_finite(data):
    data["rooms"][0]["polygon"][0][0] = float("inf")


def no_polygon(data):
    del data["rooms"][0]["polygon"]


@pytest.mark.parametrize(
    ("spoil", "more", "told"),
    [
        (newer, [], "schema 7"),
        (not_finite, [], "infinity"),
        (no_polygon, [], r"polygon"),
        (None, ["--to", "dwg"], "'dwg'; expected some of svg,pdf"),
        (None, ["--anchor", "48,16"], "--north"),
        (None, ["--anchor", "48", "--north", "0"], "LATITUDE,LONGITUDE"),
        (None, ["--anchor", "99,16", "--north", "0"], "latitude within"),
        (None, ["--north", "nan"], "--north"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(folder, capsys, spoil, more, told):
    if spoil is not None:
        data = plan_to_dict(plan())
        spoil(data)
        (folder / "plan.json").write_text(json.dumps(data))
    words = ["export", str(folder / "plan.json"), "--to", "csv", "-o", str(folder / "out"), *more]
    assert main(words) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not (folder / "out").exists()
