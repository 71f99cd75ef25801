import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely
from tests.scenes import RECTANGLE, walk

from panoplan.cli.main import main
from panoplan.datasets.detect import open_scene, read_truth
from panoplan.formats.mp3d_fpe import read_mp3d_fpe
from panoplan.formats.plan_json import read_plan
from panoplan.formats.ply import read_ply_points
from panoplan.formats.sequence import write_sequence
from panoplan.simulate.families import simulate_scene
from panoplan.types.layout import Layout

EXAMPLE = Path(__file__).parents[2] / "examples" / "flat"
OUTPUTS = {"plan.json", "plan.svg", "plan.png", "log.jsonl", "settings.toml"}


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "plan"
    assert main(["run", str(EXAMPLE), "-o", str(folder), "--quiet"]) == 0
    return folder


@pytest.fixture
def room(tmp_path):
    cameras = np.random.default_rng(0).uniform([-1.4, -0.9], [1.4, 0.9], (6, 2))
    write_sequence(tmp_path / "room", "room", walk(RECTANGLE, cameras))
    return tmp_path / "room"


def test_run_writes_its_files_and_nothing_else(ran):
    assert {path.name for path in ran.iterdir()} == OUTPUTS


def test_the_example_is_found_room_by_room(ran, capsys):
    assert main(["eval", str(ran / "plan.json"), str(EXAMPLE), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    text = json.dumps(report)
    assert "NaN" not in text
    plan = read_plan(ran / "plan.json")
    assert plan.unit == "m"
    assert len([r for r in plan.rooms if r.polygon is not None]) == 6


def test_truth_is_never_read(ran, tmp_path):
    bare = tmp_path / "bare"
    shutil.copytree(EXAMPLE, bare, ignore=shutil.ignore_patterns("*_gt*"))
    assert main(["run", str(bare), "-o", str(tmp_path / "plan"), "--quiet"]) == 0
    assert (tmp_path / "plan/plan.json").read_bytes() == (ran / "plan.json").read_bytes()


def test_compare_draws(ran, tmp_path, capsys):
    picture = tmp_path / "figure.png"
    assert main(["compare", str(ran / "plan.json"), str(EXAMPLE), "-o", str(picture)]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_simulate_makes_what_run_reads(tmp_path, capsys):
    flat = tmp_path / "flat"
    assert main(["simulate", "-o", str(flat), "--seed", "3", "--rooms", "5", "--stills"]) == 0
    assert main(["run", str(flat), "-o", str(tmp_path / "plan"), "--quiet"]) == 0
    true, made = sorted((flat / "layouts_gt").iterdir()), sorted((flat / "layouts_pred").iterdir())
    assert [path.name for path in true] == [path.name for path in made]


def test_simulate_makes_scenes_of_a_family(tmp_path, capsys):
    words = ["simulate", "--family", "flat", "--seed", "7", "--scenes", "2", "--stills", "--quiet"]
    assert main([*words, "-o", str(tmp_path / "scenes")]) == 0
    folders = sorted((tmp_path / "scenes").iterdir())
    assert [folder.name[:9] for folder in folders] == ["flat_0007", "flat_0008"]
    assert all(len(read_truth(folder).plan.rooms) >= 3 for folder in folders)
    assert main([*words, "-o", str(tmp_path / "mp3d"), "--format", "mp3d-fpe"]) == 0
    assert all(read_truth(folder).trajectory for folder in (tmp_path / "mp3d").iterdir())


def test_simulate_writes_whole_mp3d_fpe_scenes(tmp_path, capsys):
    scene = tmp_path / "flat" / "0"
    words = ["--family", "flat", "--seed", "19", "--format", "mp3d-fpe", "--quiet"]
    assert main(["simulate", "-o", str(scene), *words]) == 0
    made = simulate_scene("flat", 19)
    read = open_scene(scene)
    assert [int(k.id) for k in read.keyframes] == [int(k.id) for k in made.keyframes]
    odometry = read_mp3d_fpe(scene).trajectory
    np.testing.assert_allclose(odometry.translations, made.odometry.translations, atol=1e-9)
    for a, b in zip(read.keyframes, made.keyframes, strict=True):
        gap = np.abs(a.layout.floor_boundary - b.layout.floor_boundary)
        assert np.median(gap) < 1e-3
    truth = read_truth(scene)
    np.testing.assert_allclose(
        truth.trajectory.translations, made.truth.trajectory.translations, atol=1e-9
    )
    assert len(truth.plan.rooms) == len(made.building.rooms)
    assert len((scene / "frm_ref.txt").read_text().splitlines()) == len(made.frames)
    points = read_ply_points(scene / "pcl.ply")
    cameras = made.truth.trajectory.translations
    assert np.quantile(points[:, 1], 0.1) < cameras[:, 1].min()
    assert points[:, 1].max() == pytest.approx(made.camera_height_m, abs=0.1)
    floor = shapely.union_all([room.floor for room in made.building.rooms]).buffer(0.3)
    assert shapely.contains_xy(floor, points[::500, [0, 2]]).mean() > 0.99
    up = made.camera_height_m - points[:, 1]
    amid = shapely.union_all([room.floor.buffer(-0.15) for room in made.building.rooms])
    furniture = shapely.contains_xy(amid, points[:, [0, 2]]) & (up > 0.2) & (up < 1.9)
    assert furniture.sum() > 1000


def test_another_walk_goes_through_the_rooms_of_a_truth(tmp_path, capsys):
    first, again = tmp_path / "first", tmp_path / "again"
    words = ["--family", "flat", "--seed", "7", "--stills", "--quiet"]
    assert main(["simulate", "-o", str(first), *words]) == 0
    words = ["--building", str(first), "--seed", "2", "--stills", "--quiet"]
    assert main(["simulate", "-o", str(again), *words]) == 0
    true, made = read_truth(first), read_truth(again)
    assert len(made.plan.rooms) == len(true.plan.rooms)
    for one, other in zip(true.plan.rooms, made.plan.rooms, strict=True):
        assert one.label == other.label
        np.testing.assert_allclose(one.polygon, other.polygon, atol=1e-6)
    assert len(made.plan.doors) == len(true.plan.doors)
    assert made.trajectory.translations[0] != pytest.approx(true.trajectory.translations[0])


@pytest.mark.parametrize(("name", "rooms"), [("zind_000", 19), ("mp3d_levels", 2)])
def test_a_walk_goes_through_real_rooms(tmp_path, shared_data, name, rooms):
    source = shared_data / name
    if name == "mp3d_levels":
        source = next(p for p in sorted(source.iterdir()) if p.is_dir())
    words = ["--building", str(source), "--stills", "--quiet"]
    assert main(["simulate", "-o", str(tmp_path / "out"), *words]) == 0
    assert len(read_truth(tmp_path / "out").plan.rooms) == rooms


@pytest.mark.parametrize("kind", ["sequence", "mp3d-fpe"])
def test_a_house_of_two_storeys_goes_all_the_way(tmp_path, capsys, kind):
    scene, out = tmp_path / "house" / "0", tmp_path / "plan"
    words = ["--family", "flat", "--seed", "7", "--storeys", "2", "--stills", "--format", kind]
    assert main(["simulate", "-o", str(scene), *words, "--quiet"]) == 0
    truth = read_truth(scene).plan
    made = simulate_scene("flat", 7, as_stills=True, storeys=2).truth.plan
    assert [room.level for room in truth.rooms] == [room.level for room in made.rooms]
    assert truth.levels.floors_m == made.levels.floors_m
    assert (truth.levels.doors == made.levels.doors) == (kind == "sequence")
    height = ["--camera-height", f"{made.camera_height_m}"]
    assert main(["run", str(scene), "-o", str(out), "--quiet", *height]) == 0
    assert {room.level for room in read_plan(out / "plan.json").rooms} == {0, 1}
    capsys.readouterr()
    assert main(["eval", str(out / "plan.json"), str(scene), "--align", "scale"]) == 0
    assert "(2 of 2 true, 2 predicted)" in capsys.readouterr().out.split("storeys")[1]
    assert main(["compare", str(out / "plan.json"), str(scene), "--align", "scale",
                 "-o", str(tmp_path / "both.png")]) == 0  # fmt: skip
    assert (tmp_path / "both.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--family", "flat", "--rooms", "5"], "one of them"),
        (["--storeys", "2"], "a family"),
        (["--family", "flat", "--building", "."], "one of them"),
        (["--building", "."], "found no truth"),
        (["--family", "flat", "--storeys", "9"], "1 to 4"),
        (["--family", "flat", "--storeys", "2", "--render", "preview"], "one of them"),
        (["--family", "flat", "--step", "1"], "expected one of them"),
        (["--stills", "--step", "1"], "expected one of them"),
        (["--step", "9"], "0.05 to 5"),
        (["--image-width", "512"], "found no --render"),
        (["--scenes", "0"], "1 to"),
        (["--family", "flat", "--seed", "-1"], "0 or more"),
    ],
)
def test_simulate_refuses_what_it_cannot_make(tmp_path, capsys, words, told):
    assert main(["simulate", "-o", str(tmp_path / "out"), "--quiet", *words]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_version_and_help(capsys):
    for words in (["--version"], ["--help"], ["run", "--help"], ["eval", "--help"]):
        with pytest.raises(SystemExit) as stop:
            main(words)
        assert stop.value.code == 0
    assert "example: panoplan run" in capsys.readouterr().out


def test_help_loads_nothing_heavy():
    program = (
        "import sys\nfrom panoplan.cli.main import main\n"
        "try:\n    main(['run', '--help'])\nexcept SystemExit:\n    pass\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "--camera-height" in done.stdout
    loaded = set(done.stdout.splitlines()[-1].split())
    assert not loaded & {"numba", "scipy", "matplotlib", "shapely", "jsonschema", "rich"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["run", "nowhere", "-o", "x"], "nowhere: found nothing"),
        (["run", "{room}", "-o", "{out}", "--set", "rooms.treshold=1"], "rooms.threshold"),
        (["run", "{room}", "-o", "{out}", "--set", "rooms.threshold=2"], "0.0 to 1.0"),
        (["run", "{room}", "-o", "{out}", "--set", "rooms.threshold=much"], "float"),
        (["run", "{room}", "-o", "{out}", "--config", "none.toml"], "none.toml: found nothing"),
        (["run", "{room}", "-o", "{room}"], "other files"),
        (["eval", "{room}/sequence.json", "{room}"], "a plan of schema 1"),
    ],
)
def test_bad_usage_is_one_line_and_exit_2(words, message, room, tmp_path, capsys):
    words = [word.format(room=room, out=tmp_path / "out") for word in words]
    before = sorted(path.name for path in room.iterdir())
    assert main(words) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert sorted(path.name for path in room.iterdir()) == before


def test_no_room_is_exit_3_with_reasons(room, tmp_path):
    for path in (room / "layouts_pred").iterdir():
        from panoplan.formats.layout_npz import write_layout_npz

        write_layout_npz(path, Layout(np.full(1024, 0.1)))
    assert main(["run", str(room), "-o", str(tmp_path / "plan"), "--quiet"]) == 3
    plan = read_plan(tmp_path / "plan/plan.json")
    assert plan.rooms == ()
    assert {s.reason for s in plan.skipped} == {"no column of the layout is below the horizon"}


def test_one_keyframe(tmp_path):
    write_sequence(tmp_path / "one", "one", walk(RECTANGLE, [[0.2, 0.1]]))
    assert main(["run", str(tmp_path / "one"), "-o", str(tmp_path / "plan"), "--quiet"]) == 0
    plan = read_plan(tmp_path / "plan/plan.json")
    assert (plan.unit, plan.scale.ch_per_su, len(plan.rooms)) == ("ch", None, 1)


def test_an_interrupted_run_goes_on_and_ends_the_same(ran, tmp_path, monkeypatch, capsys):
    from panoplan.estimator.front import FloorPlanEstimator

    update, count = FloorPlanEstimator.update, 0

    def interrupted(self, keyframe):
        nonlocal count
        count += 1
        if count == 60:
            raise KeyboardInterrupt
        return update(self, keyframe)

    words = ["run", str(EXAMPLE), "-o", str(tmp_path / "plan"), "--quiet"]
    monkeypatch.setattr(FloorPlanEstimator, "update", interrupted)
    assert main(words) == 130
    assert "goes on with: panoplan run" in capsys.readouterr().err
    assert main(words) == 0
    keyframes = len(list((EXAMPLE / "layouts_pred").iterdir()))
    assert count == 60 + keyframes - 59
    for name in ("plan.json", "log.jsonl", "plan.svg"):
        assert (tmp_path / "plan" / name).read_bytes() == (ran / name).read_bytes()
    assert {path.name for path in (tmp_path / "plan").iterdir()} == OUTPUTS


def test_an_mp3d_fpe_folder_runs_as_the_sequence_does(tmp_path, capsys):
    scene = tmp_path / "scene"
    words = ["--seed", "4", "--rooms", "5", "--step", "0.8", "--format", "mp3d-fpe"]
    assert main(["simulate", "-o", str(scene / "0"), *words]) == 0
    out = tmp_path / "plan"
    assert main(["run", str(scene), "-o", str(out), "--camera-height", "1.5"]) == 0
    assert "MP3D-FPE" in capsys.readouterr().out
    assert len(read_plan(out / "plan.json").rooms) == 5


def test_bench_accuracy_writes_figures_with_their_settings(tmp_path, capsys):
    out = tmp_path / "accuracy.json"
    words = ["bench", "accuracy", "--flats", "1", "--quiet", "-o", str(out), "--seed", "5"]
    assert main(words) == 0
    result = json.loads(out.read_text())
    assert result["settings"]["seed"] == 5
    for grade in ("mild", "hard"):
        (scene,) = result["figures"][grade]["scenes"]
        assert result["figures"][grade]["summary"]["rooms"] == scene["rooms"] > 0
    assert result["figures"]["mild"]["summary"]["lost"] == 0
