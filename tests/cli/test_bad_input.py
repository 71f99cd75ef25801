"""Bad input through the command line: one line, exit code 2, nothing half-written."""

import io
import json
import random
import zipfile

import numpy as np
import pytest
from tests.scenes import RECTANGLE, walk

from panoplan.cli.main import main
from panoplan.formats.layout_npz import write_layout_npz
from panoplan.formats.plan_json import read_plan
from panoplan.formats.sequence import write_sequence
from panoplan.types.layout import Layout

CAMERAS = np.random.default_rng(0).uniform([-1.4, -0.9], [1.4, 0.9], (6, 2))


@pytest.fixture
def room(tmp_path):
    folder = tmp_path / "room"
    write_sequence(folder, "room", walk(RECTANGLE, CAMERAS))
    return folder


def _layout(folder):
    return sorted((folder / "layouts_pred").iterdir())[2]


def _all_layouts(folder):
    return sorted((folder / "layouts_pred").iterdir())


def _trajectory(folder):
    return folder / "trajectory.tum"


def _rows(folder, change):
    """Changes the words of each pose."""
    path = _trajectory(folder)
    rows = [line.split() for line in path.read_text().splitlines() if line[0] != "#"]
    path.write_text("\n".join(" ".join(row) for row in change(rows)) + "\n")


def _npz(path, **arrays):
    np.savez(path, **arrays)


def _oversized(path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        header = io.BytesIO()
        np.lib.format.write_array_header_1_0(
            header, {"descr": "<f8", "fortran_order": False, "shape": (4_000_000,)}
        )
        archive.writestr("floor_boundary.npy", header.getvalue() + bytes(32_000_000))


def _with(rows, row, column, word):
    rows[row][column] = word
    return rows


def _every(folder, spoil):
    for path in _all_layouts(folder):
        spoil(path)


SPOILED = {
    "no trajectory": (lambda f: _trajectory(f).unlink(), "trajectory"),
    "an empty trajectory": (lambda f: _trajectory(f).write_text(""), "trajectory.tum"),
    "a truncated trajectory": (
        lambda f: _trajectory(f).write_text(_trajectory(f).read_text()[:-30]),
        "trajectory.tum",
    ),
    "a pose that is no number": (
        lambda f: _rows(f, lambda r: _with(r, 1, 2, "north")),
        "trajectory.tum",
    ),
    "a pose of NaN": (lambda f: _rows(f, lambda r: _with(r, 1, 2, "nan")), "trajectory.tum"),
    "a quaternion of length 2": (
        lambda f: _rows(f, lambda r: [[*row[:4], "0", "0", "0", "2"] for row in r]),
        "trajectory.tum",
    ),
    "two poses of one id": (
        lambda f: _rows(f, lambda r: _with(r, 1, 0, r[0][0])),
        "trajectory.tum",
    ),
    "all cameras at one spot": (
        lambda f: _rows(f, lambda r: [[row[0], "1", "0", "1", *row[4:]] for row in r]),
        "one spot",
    ),
    "no layouts": (lambda f: _every(f, lambda p: p.unlink()), "layouts_pred"),
    "layouts that match no pose": (
        lambda f: (
            [p.rename(p.with_name(f"other{k}x.npz")) for k, p in enumerate(_all_layouts(f))]
            and _all_layouts(f)[0].unlink()
        ),
        "layouts",
    ),
    "layouts that are all broken": (
        lambda f: _every(f, lambda p: p.write_bytes(p.read_bytes()[:60])),
        ".npz",
    ),
    "layouts that are all pickled": (
        lambda f: _every(f, lambda p: _npz(p, floor_boundary=np.array([{}, None] * 16))),
        "pickled",
    ),
    "layouts of a wrong shape": (
        lambda f: _every(f, lambda p: _npz(p, floor_boundary=np.zeros((4, 32)))),
        "shape (4, 32)",
    ),
    "layouts of a wrong type": (
        lambda f: _every(f, lambda p: _npz(p, floor_boundary=np.array(["a"] * 32))),
        "real numbers",
    ),
    "oversized members": (lambda f: _every(f, _oversized), "at most 16777216"),
    "a description that is no JSON": (
        lambda f: (f / "sequence.json").write_text('{"keyframes": ['),
        "sequence.json",
    ),
}


@pytest.mark.parametrize("case", SPOILED)
def test_bad_input_is_one_line_and_exit_2(case, room, tmp_path, capsys):
    spoil, told = SPOILED[case]
    spoil(room)
    assert main(["run", str(room), "-o", str(tmp_path / "plan"), "--quiet"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith("panoplan: ")
    assert "found" in error
    assert "expected" in error
    assert told in error
    assert not (tmp_path / "plan").exists()


def test_a_place_that_cannot_be_written(room, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["run", str(room), "-o", str(tmp_path / "file/plan"), "--quiet"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "file" in error


def _ran(folder, out):
    assert main(["run", str(folder), "-o", str(out), "--quiet"]) == 0
    return read_plan(out / "plan.json")


def test_an_unreadable_layout_among_many_is_told(room, tmp_path):
    path = _layout(room)
    path.write_bytes(path.read_bytes()[:60])
    plan = _ran(room, tmp_path / "plan")
    (skipped,) = [s for s in plan.skipped if s.what == "keyframe"]
    assert skipped.keyframe == path.stem
    assert "archive" in skipped.reason
    assert len(plan.rooms) == 1


def test_a_keyframe_without_layout_is_told(room, tmp_path):
    path = _layout(room)
    path.unlink()
    plan = _ran(room, tmp_path / "plan")
    assert [s.keyframe for s in plan.skipped if s.what == "keyframe"] == [path.stem]
    assert len(plan.trajectory) == len(CAMERAS)


def test_columns_at_the_horizon_are_unknown_not_far(room, tmp_path):
    for path in _all_layouts(room):
        with np.load(path) as arrays:
            floor = arrays["floor_boundary"].astype(float)
        floor[100:160] = 0.0
        floor[400:420] = 0.05
        write_layout_npz(path, Layout(floor))
    plan = _ran(room, tmp_path / "plan")
    (one,) = plan.rooms
    # Camera heights; the room is 4 x 3 of them.
    size = np.ptp(one.polygon, axis=0)
    assert np.sort(size) == pytest.approx([3.0, 4.0], rel=0.03)


def test_any_damage_ends_in_an_exit_code_of_ours(room, tmp_path, capsys):
    """Bytes changed at random never end in a bug (exit code 1)."""
    files = [_trajectory(room), room / "sequence.json", *_all_layouts(room)[:2]]
    whole = {path: path.read_bytes() for path in files}
    rng = random.Random(5)
    for number in range(60):
        path = rng.choice(files)
        data = bytearray(whole[path])
        how = rng.randrange(4)
        if how == 0:
            data = data[: rng.randrange(len(data))]
        elif how == 1:
            for _ in range(rng.randrange(1, 20)):
                data[rng.randrange(len(data))] = rng.randrange(256)
        elif how == 2:
            at = rng.randrange(len(data))
            data[at:at] = rng.choice(
                [b"nan ", b"1e400 ", b"-", b"\x00\xff", b'"', b"[", b"9" * 300]
            )
        else:
            at = rng.randrange(len(data))
            del data[at : at + rng.randrange(1, 40)]
        path.write_bytes(bytes(data))
        out = tmp_path / f"plan{number}"
        code = main(["run", str(room), "-o", str(out), "--quiet"])
        assert code in (0, 2, 3), (path.name, how, capsys.readouterr().err)
        if code == 0:
            json.loads((out / "plan.json").read_text())
        path.write_bytes(whole[path])
