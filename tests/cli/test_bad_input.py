"""Files from strangers: one line and exit 2, or counted in the plan; never a traceback."""

import io
import json
import os
import re
import shutil
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import RECTANGLE, walk

from panoplan.cli.main import main
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.formats.mp3d_fpe import write_mp3d_fpe
from panoplan.formats.plan_json import read_plan
from panoplan.formats.sequence import write_sequence
from panoplan.types.keyframe import Keyframe
from panoplan.types.pose import Pose

CAMERAS = np.array([[-1.2, -0.7], [1.1, -0.6], [0.9, 0.8], [-0.8, 0.6]])


@pytest.fixture(scope="module")
def pristine(tmp_path_factory):
    """A room walked through, as a sequence folder and as an MP3D-FPE scene."""
    root = tmp_path_factory.mktemp("pristine")
    keyframes = walk(RECTANGLE, CAMERAS, factor=0.7)
    write_sequence(root / "room", "room", keyframes)
    frames = [Keyframe(str(n + 1), k.pose, k.layout) for n, k in enumerate(keyframes)]
    write_mp3d_fpe(root / "fpe" / "v0", frames)
    return root


@pytest.fixture
def room(pristine, tmp_path):
    return shutil.copytree(pristine / "room", tmp_path / "room")


@pytest.fixture
def fpe(pristine, tmp_path):
    return shutil.copytree(pristine / "fpe", tmp_path / "fpe")


def run(scene, out, *more):
    return main(["run", str(scene), "-o", str(out), "--quiet", *more])


def refused(scene, out, capsys, *more):
    """The line that a refused run prints; nothing may be left where it should have written."""
    before = tree(out.parent)
    assert run(scene, out, *more) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.startswith("panoplan: ")
    assert "found " in captured.err
    assert "expected " in captured.err
    assert tree(out.parent) == before
    return captured.err.rstrip("\n")


def tree(folder):
    return sorted((str(path), path.lstat().st_size) for path in folder.rglob("*"))


def truncate(path, keep=0.6):
    data = path.read_bytes()
    path.write_bytes(data[: int(keep * len(data))])


def change_pose(room, index, field, text):
    path = room / "trajectory.tum"
    lines = path.read_text().splitlines()
    fields = lines[index + 1].split()
    fields[field] = text
    lines[index + 1] = " ".join(fields)
    path.write_text("\n".join(lines) + "\n")


def change_description(room, change):
    path = room / "sequence.json"
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))


def repeat(items, index):
    items.append(items[index])


def stand_still(room):
    lines = [f"{k} 1 2 3 0 0 0 1" for k in range(len(CAMERAS))]
    (room / "trajectory.tum").write_text("\n".join(lines) + "\n")


def repeat_pose(room):
    path = room / "trajectory.tum"
    path.write_text(path.read_text() + path.read_text().splitlines()[1] + "\n")


def relabel(room):
    path = room / "trajectory.tum"
    text = "\n".join(f"frame{line}" for line in path.read_text().splitlines()[1:])
    path.write_text(text + "\n")


def move(path, name):
    path.rename(path.with_name(name))


def nest(path):
    path.write_text("[" * 100_000)


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (shutil.rmtree, "room: found nothing; expected a folder"),
        (lambda room: (room / "trajectory.tum").unlink(), "room: found no trajectory"),
        (lambda room: (room / "trajectory.tum").write_text(""), "trajectory.tum: found an empty"),
        (lambda room: (room / "trajectory.tum").write_text("# none\n"), "found no pose"),
        (lambda room: truncate(room / "trajectory.tum"), r"trajectory.tum:4: found 2 fields"),
        (lambda room: (room / "trajectory.tum").write_bytes(b"\xff\xfe\x00"), "no UTF-8"),
        (lambda room: change_pose(room, 1, 2, "nan"), "trajectory.tum, pose 1: found NaN"),
        (lambda room: change_pose(room, 1, 2, "inf"), "trajectory.tum, pose 1: found NaN or inf"),
        (lambda room: change_pose(room, 2, 7, "9"), "pose 2: found a quaternion of length 9"),
        (lambda room: change_pose(room, 0, 3, "1e999999"), "pose 0: found NaN or infinity"),
        (lambda room: change_pose(room, 0, 3, "1e300"), r"expected at most 1e\+100"),
        (lambda room: change_pose(room, 0, 3, "one"), "expected seven numbers"),
        (repeat_pose, "trajectory.tum: found the label 0 twice"),
        (relabel, "trajectory.tum: found labels such as frame0"),
        (stand_still, "trajectory.tum: found 4 cameras at one spot"),
        (lambda room: (room / "sequence.json").write_text(""), "sequence.json: found an empty"),
        (lambda room: truncate(room / "sequence.json"), r"sequence.json:\d+: found broken JSON"),
        (lambda room: nest(room / "sequence.json"), "sequence.json: found JSON nested too deeply"),
        (lambda room: (room / "sequence.json").write_text("[]"), "the file: found list"),
        (
            lambda room: change_description(room, lambda d: repeat(d["keyframes"], 0)),
            "sequence.json: found two keyframes of id kf000",
        ),
        (
            lambda room: change_description(room, lambda d: d.update(camera_height="high")),
            "camera_height: found 'high'",
        ),
        (
            lambda room: change_description(room, lambda d: d.update(keyframes={"0": {}})),
            "keyframes: found dict; expected list",
        ),
        (lambda room: shutil.rmtree(room / "layouts_pred"), "layouts_pred: found no folder"),
        (
            lambda room: [p.unlink() for p in (room / "layouts_pred").iterdir()],
            "layouts_pred: found no layout",
        ),
        (
            lambda room: [move(p, f"other_{p.name}") for p in (room / "layouts_pred").iterdir()],
            r"layouts_pred: found no usable layout of 4 \(no layout\)",
        ),
        (
            lambda room: [p.write_bytes(b"") for p in (room / "layouts_pred").iterdir()],
            r"no usable layout of 4 \(unreadable layout: found an empty file",
        ),
    ],
)
def test_a_folder_that_cannot_be_used(spoil, told, room, tmp_path, capsys):
    spoil(room)
    error = refused(room, tmp_path / "out", capsys)
    assert re.search(told, error), error


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (
            lambda odometry: (odometry / "keyframe_list.txt").write_text("1\n1\n2\n3\n"),
            "keyframe_list.txt:2: found the keyframe 1 twice",
        ),
        (
            lambda odometry: truncate(odometry / "cam_pose_estimated.csv"),
            "cam_pose_estimated.csv:3: found",
        ),
        (
            lambda odometry: (odometry / "cam_pose_estimated.csv").unlink(),
            "cam_pose_estimated.csv: found nothing",
        ),
        (lambda odometry: shutil.rmtree(odometry / "hn_mp3d"), "hn_mp3d: found no folder"),
        (
            lambda odometry: shutil.copy(odometry / "hn_mp3d/1.npy", odometry / "hn_mp3d/01.npy"),
            "hn_mp3d: found two layouts of one frame",
        ),
    ],
)
def test_an_mp3d_fpe_scene_that_cannot_be_used(spoil, told, fpe, tmp_path, capsys):
    spoil(fpe / "v0" / "vo_final")
    assert told in refused(fpe, tmp_path / "out", capsys)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--trajectory", "{room}/none.tum"], "none.tum: found nothing"),
        (["--trajectory", "{room}/layouts_pred"], "layouts_pred: found a folder without"),
        (["--layouts", "{room}/none"], "none: found no folder"),
        (["--layouts", "{room}/trajectory.tum"], "trajectory.tum: found no folder"),
        (["--config", "{room}/sequence.json"], "sequence.json: found broken TOML"),
        (["--version", "v1"], "room: found no MP3D-FPE scene"),
    ],
)
def test_a_path_that_leads_nowhere(words, told, room, tmp_path, capsys):
    words = [word.format(room=room) for word in words]
    assert told in refused(room, tmp_path / "out", capsys, *words)


class Pickled:
    def __reduce__(self):
        return os.system, ("touch /tmp/panoplan-was-here",)


def npz(**members):
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **members)
    return buffer.getvalue()


def npy(array):
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def oversized():
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("floor_boundary.npy", bytes(17 * 2**20))
    return buffer.getvalue()


FLOOR = np.full(64, -0.5)
CORNERS = [[0.1, 0.3], [0.1, 0.7], [0.4, 0.3], [0.4, 0.7], [0.8, 0.3], [0.8, 0.7]]
UNREADABLE = {
    "empty.npz": (b"", "an empty file"),
    "truncated.npz": (npz(floor_boundary=FLOOR)[:150], "no readable archive"),
    "text.npz": (b"floor", "no readable archive"),
    "pickled.npz": (npz(floor_boundary=np.array([Pickled()] * 64)), "pickled objects"),
    "oversized.npz": (oversized(), "17825792 bytes"),
    "shape.npz": (npz(floor_boundary=FLOOR.reshape(8, 8)), "shape (8, 8)"),
    "text_array.npz": (npz(floor_boundary=np.array(["a"] * 64)), "an array of type"),
    "complex.npz": (npz(floor_boundary=FLOOR + 1j), "an array of type complex"),
    "degrees.npz": (npz(floor_boundary=FLOOR * 57), "an elevation of"),
    "sigma.npz": (npz(floor_boundary=FLOOR, floor_sigma=FLOOR[:9]), "shape (9,)"),
    "corners.npz": (npz(floor_boundary=FLOOR, corners=[2.0, 900.0]), "a column outside"),
    "other.npz": (npz(walls=FLOOR), "no floor_boundary"),
    "empty.npy": (b"", "an empty file"),
    "truncated.npy": (npy(np.stack([-FLOOR, -FLOOR]))[:300], "cut short"),
    "shape.npy": (npy(FLOOR), "shape (64,)"),
    "pickled.npy": (npy(np.array([[Pickled()] * 64] * 2)), "pickled objects"),
    "above.npy": (npy(np.stack([-FLOOR, FLOOR])), "above the horizon"),
    "empty.json": (b"", "an empty file"),
    "broken.json": (b'{"uv": [[0.1,', "broken JSON"),
    "other.json": (b"[1, 2]", "no list uv"),
    "odd.json": (json.dumps({"uv": CORNERS[:5]}).encode(), "5 points"),
    "outside.json": (json.dumps({"uv": [[9, 9], *CORNERS[1:]]}).encode(), "9 at most"),
    "words.json": (json.dumps({"uv": [["a", "b"]] * 6}).encode(), "found"),
}


def test_unreadable_layouts_are_counted_and_the_others_used(room, tmp_path):
    keyframes = walk(RECTANGLE, np.resize(CAMERAS, (4 + len(UNREADABLE), 2)), factor=0.7)
    shutil.rmtree(room)
    write_sequence(room, "room", keyframes)
    spoilt = {}
    for k, (name, (data, told)) in enumerate(UNREADABLE.items(), start=4):
        (room / "layouts_pred" / f"kf{k:03d}.npz").unlink()
        (room / "layouts_pred" / f"kf{k:03d}{name[name.index('.') :]}").write_bytes(data)
        spoilt[f"kf{k:03d}"] = told
    assert run(room, tmp_path / "out") == 0
    plan = read_plan(tmp_path / "out" / "plan.json")
    assert len(plan.rooms) == 1
    assert plan.rooms[0].keyframes == ("kf000", "kf001", "kf002", "kf003")
    reasons = {s.keyframe: s.reason for s in plan.skipped if s.what == "keyframe"}
    assert reasons.keys() == spoilt.keys()
    for keyframe, told in spoilt.items():
        assert reasons[keyframe].startswith("unreadable layout: found ")
        assert told in reasons[keyframe]


@pytest.mark.parametrize("name", UNREADABLE)
def test_the_only_layout_is_unreadable(name, room, tmp_path, capsys):
    data, told = UNREADABLE[name]
    for path in (room / "layouts_pred").iterdir():
        path.unlink()
    (room / "layouts_pred" / f"kf000{name[name.index('.') :]}").write_bytes(data)
    error = refused(room, tmp_path / "out", capsys)
    assert "layouts_pred" in error
    assert told in error


def test_two_layouts_of_one_keyframe(room, tmp_path, capsys):
    (room / "layouts_pred" / "kf001.json").write_text(json.dumps({"uv": CORNERS}))
    assert "two layouts of kf001" in refused(room, tmp_path / "out", capsys)


def test_an_unreadable_folder_of_a_scene_is_a_file(tmp_path, capsys):
    (tmp_path / "room").write_text("no folder")
    assert "found a file; expected a folder" in refused(tmp_path / "room", tmp_path / "o", capsys)


def write_file(out):
    out.write_text("mine")


def write_parent(out):
    out.parent.rmdir()
    out.parent.write_text("mine")


def write_other(out):
    out.mkdir()
    (out / "letter.txt").write_text("mine")


def write_blocked(out):
    """A folder of an earlier run in which a file cannot be replaced."""
    out.mkdir()
    (out / "settings.toml").mkdir()


@pytest.mark.parametrize(
    ("block", "told"),
    [
        (write_file, "out: found Not a directory"),
        (write_parent, "out: found Not a directory"),
        (write_other, "out: found a folder with other files"),
        (write_blocked, "settings.toml: found Is a directory"),
    ],
)
def test_an_output_that_cannot_be_written(block, told, room, tmp_path, capsys):
    out = tmp_path / "there" / "out"
    out.parent.mkdir()
    block(out)
    assert told in refused(room, out, capsys)


@pytest.mark.parametrize("name", ["log.jsonl", "plan.json", "plan.svg", "plan.png"])
def test_a_file_of_the_output_that_cannot_be_written(name, room, tmp_path, capsys):
    out = tmp_path / "out"
    (out / name).mkdir(parents=True)
    (out / "settings.toml").write_text("")
    assert run(room, out) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert f"{name}: found Is a directory; expected a place that can be written" in error
    if name != "plan.json":
        assert not (out / "plan.json").exists()


def test_a_disk_that_fills_up_leaves_no_plan(room, tmp_path, capsys, monkeypatch):
    out = tmp_path / "out"

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    assert run(room, out) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "settings.toml: found No space left on device" in error
    assert list(out.iterdir()) == []


def test_a_log_that_can_no_longer_be_written(room, tmp_path, capsys, monkeypatch):
    out, update = tmp_path / "out", FloorPlanEstimator.update

    def replaced(self, keyframe):
        (out / "log.jsonl").unlink(missing_ok=True)
        (out / "log.jsonl").mkdir()
        return update(self, keyframe)

    monkeypatch.setattr(FloorPlanEstimator, "update", replaced)
    assert run(room, out) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "log.jsonl: found Is a directory; expected a place that can be written" in error
    assert not (out / "plan.json").exists()


@pytest.mark.parametrize(
    ("plan", "truth", "told"),
    [
        ("none.json", "{truth}", "none.json: found nothing"),
        ("empty.json", "{truth}", "empty.json: found an empty file"),
        ("broken.json", "{truth}", r"broken.json"),
        ("plan.json", "none", "none: found no truth"),
        ("plan.json", "broken", "floorplan_gt.json:1: found broken JSON"),
        ("plan.json", "corners", "polygon: found 2 corners"),
    ],
)
@pytest.mark.parametrize("command", ["eval", "compare"])
def test_plans_and_truths_that_cannot_be_used(command, plan, truth, told, ran, tmp_path, capsys):
    truths = {"broken": '{"rooms": [', "corners": '{"rooms": [{"polygon": [[0, 0], [1, 0]]}]}'}
    for name, text in truths.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "floorplan_gt.json").write_text(text)
    (tmp_path / "empty.json").write_text("")
    shutil.copy(ran / "plan.json", tmp_path / "plan.json")
    shutil.copy(ran / "plan.json", tmp_path / "broken.json")
    truncate(tmp_path / "broken.json")
    words = [str(tmp_path / plan), str(tmp_path / truth.format(truth="corners"))]
    picture = tmp_path / "picture.png"
    more = ["-o", str(picture)] if command == "compare" else []
    assert main([command, *words, *more]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert told in captured.err
    assert not picture.exists()


@pytest.fixture(scope="module")
def ran(pristine, tmp_path_factory):
    out = tmp_path_factory.mktemp("ran") / "out"
    assert run(pristine / "room", out) == 0
    return out


def test_what_is_no_layout_is_counted_and_the_plan_is_the_same(room, ran, tmp_path):
    def add(data):
        data["keyframes"] += [{"id": f"more{k}", "order": k} for k in range(4, 8)]

    change_description(room, add)
    with (room / "trajectory.tum").open("a") as stream:
        stream.writelines(f"{k} 0.1 0 0.{k} 0 0 0 1\n" for k in range(4, 8))
    layouts = room / "layouts_pred"
    (layouts / "more4.npz").write_bytes(npz(floor_boundary=np.full(64, 0.2)))
    (layouts / "more5.npz").write_bytes(npz(floor_boundary=np.full(64, np.nan)))
    (layouts / "more6.npz").write_bytes(b"PK broken")
    assert run(room, tmp_path / "out") == 0
    plan = read_plan(tmp_path / "out" / "plan.json")
    horizon = "no column of the layout is below the horizon"
    reasons = {s.keyframe: s.reason for s in plan.skipped}
    assert reasons.keys() == {"more4", "more5", "more6", "more7"}
    assert (reasons["more4"], reasons["more5"], reasons["more7"]) == (horizon, horizon, "no layout")
    assert reasons["more6"].startswith("unreadable layout: found no readable archive")
    expected = read_plan(ran / "plan.json")
    assert [r.keyframes for r in plan.rooms] == [r.keyframes for r in expected.rooms]
    np.testing.assert_array_equal(plan.rooms[0].polygon, expected.rooms[0].polygon)


def test_columns_at_the_horizon_are_unknown_not_far(room, ran, tmp_path):
    for path in (room / "layouts_pred").iterdir():
        with np.load(path) as archive:
            floor = archive["floor_boundary"]
        floor[100:130] = [0.0, -1e-12, -1e-5, 0.3, np.nan] * 6
        path.write_bytes(npz(floor_boundary=floor))
    assert run(room, tmp_path / "out") == 0
    (plan,), (expected,) = (read_plan(f / "plan.json").rooms for f in (tmp_path / "out", ran))
    difference = np.abs(np.sort(plan.polygon, axis=0) - np.sort(expected.polygon, axis=0))
    assert difference.max() < 0.05


def test_layouts_without_corners_and_with_them(room, tmp_path):
    """Each layout says where its corners are or not; `paper` uses them, `default` does not."""
    for k, path in enumerate(sorted((room / "layouts_pred").iterdir())):
        with np.load(path) as archive:
            floor = archive["floor_boundary"]
        more = {"corners": np.flatnonzero(np.diff(np.sign(np.diff(floor))) > 0)} if k % 2 else {}
        path.write_bytes(npz(floor_boundary=floor, **more))
    for preset in ("paper", "default"):
        assert run(room, tmp_path / preset, "--preset", preset) == 0
        assert len(read_plan(tmp_path / preset / "plan.json").rooms) == 1


def test_an_all_zero_row_of_mp3d_fpe_is_skipped_and_shifts_no_other(fpe, tmp_path):
    path = fpe / "v0" / "vo_final" / "cam_pose_estimated.csv"
    lines = path.read_text().splitlines()
    lines[1] = lines[1].split(",")[0] + ",0,0,0,0,0,0,0"
    path.write_text("\n".join(lines) + "\n")
    assert run(fpe, tmp_path / "out") == 0
    plan = read_plan(tmp_path / "out" / "plan.json")
    assert [(s.keyframe, s.reason) for s in plan.skipped if s.what == "keyframe"] == [
        ("2", "no pose: all-zero quaternion")
    ]
    assert plan.rooms[0].keyframes == ("1", "3", "4")


def test_one_keyframe_is_one_room_in_camera_heights(tmp_path, capsys):
    keyframes = walk(RECTANGLE, [[0.2, 0.1]])
    write_sequence(tmp_path / "one", "one", keyframes)
    assert run(tmp_path / "one", tmp_path / "out") == 0
    data = json.loads((tmp_path / "out" / "plan.json").read_text())
    assert (data["unit"], data["scale"]["ch_per_su"], len(data["rooms"])) == ("ch", None, 1)
    polygon = read_plan(tmp_path / "out" / "plan.json").rooms[0].polygon
    np.testing.assert_allclose(np.ptp(polygon, axis=0), [4, 3], atol=0.1)


def test_nothing_that_is_a_room_is_exit_3_with_reasons(room, tmp_path, capsys):
    thin = np.array([[-3.0, -0.02], [3.0, -0.02], [3.0, 0.02], [-3.0, 0.02]])
    cameras = np.array([[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    shutil.rmtree(room)
    write_sequence(room, "thin", walk(thin, cameras))
    assert run(room, tmp_path / "out") == 3
    assert capsys.readouterr().err == ""
    plan = read_plan(tmp_path / "out" / "plan.json")
    assert all(r.polygon is None and r.failure for r in plan.rooms)
    assert plan.rooms or plan.skipped


@pytest.mark.parametrize(
    ("preset", "lost"),
    [
        ("default", (1e4, 0, -1e4)),
        ("default", (1e99, 0, 0)),
        ("default", (0, -1e6, 0)),
        ("paper", (1e4, 0, -1e4)),
        ("released", (1e99, 0, 0)),
    ],
)
def test_a_lost_pose_is_left_out_or_apart_and_the_room_is_found(preset, lost, tmp_path):
    keyframes = walk(RECTANGLE, np.vstack([CAMERAS, CAMERAS[::-1] * 0.9]), factor=0.7)
    astray = Pose(keyframes[5].pose.rotation, keyframes[5].pose.translation + np.array(lost))
    keyframes[5] = replace(keyframes[5], pose=astray)
    write_sequence(tmp_path / "room", "room", keyframes)
    out = tmp_path / "out"
    known = ["--trajectory-unit", "m", "--camera-height", "1.43"]
    assert run(tmp_path / "room", out, "--preset", preset, *known) == 0
    plan = read_plan(out / "plan.json")
    # `paper` and `released` do not look at heights.
    assert len(max((r.keyframes for r in plan.rooms), key=len)) >= 7
    skipped = [s.keyframe for s in plan.skipped if s.what == "keyframe"]
    assert skipped in ([], ["kf005"])


NUMBERS = [b"0", b"-1", b"nan", b"inf", b"1e400", b"1e80", b"1e-80", b"9" * 30, b"null", b'"a"']


def damaged(data, rng):
    """Some bytes changed, cut off, taken out or put in, or a number replaced."""
    data = bytearray(data)
    at = int(rng.integers(len(data)))
    match rng.integers(5):
        case 0:
            return bytes(data[:at])
        case 1:
            for k in rng.integers(len(data), size=rng.integers(1, 9)):
                data[k] = rng.integers(256)
        case 2:
            del data[at : at + int(rng.integers(1, 40))]
        case 3:
            data[at:at] = rng.choice([b"\x00\xff", b'"', b"[", b"{", b"\n", b"#", *NUMBERS])
        case 4:
            found = list(re.finditer(rb"-?\d[\d.e+-]*", data))
            if found:
                start, stop = found[rng.integers(len(found))].span()
                data[start:stop] = rng.choice(NUMBERS)
    return bytes(data)


@pytest.mark.parametrize("kind", ["sequence", "arrays", "mp3d_fpe", "corners"])
def test_damage_of_any_kind_ends_in_an_exit_code_of_ours(
    kind, room, fpe, tmp_path, capsys, monkeypatch
):
    """Seeded; a failure tells the file's damaged bytes."""
    monkeypatch.setattr("panoplan.pipeline.write_plan_pictures", lambda *_: None)
    folder = fpe if kind == "mp3d_fpe" else room
    layouts = sorted((room / "layouts_pred").iterdir())
    if kind == "corners":
        for path in layouts:
            path.with_suffix(".json").write_text(json.dumps({"uv": CORNERS}))
            path.unlink()
    files = {
        "sequence": [room / "trajectory.tum", room / "sequence.json"],
        "arrays": layouts,
        "corners": [path.with_suffix(".json") for path in layouts],
        "mp3d_fpe": sorted(path for path in fpe.rglob("*") if path.is_file()),
    }[kind]
    whole = {path: path.read_bytes() for path in files}
    rng = np.random.default_rng(5)
    ends = set()
    for number in range(12):
        path = files[rng.integers(len(files))]
        path.write_bytes(damaged(whole[path], rng))
        out = tmp_path / f"out{number}"
        code = run(folder, out)
        told = capsys.readouterr().err
        assert code in (0, 2, 3), (path.name, path.read_bytes()[:4000], told)
        assert told.count("\n") == (code == 2)
        assert (out / "plan.json").exists() == (code != 2)
        if code != 2:
            read_plan(out / "plan.json")
        path.write_bytes(whole[path])
        ends.add(code)
    assert 0 in ends
