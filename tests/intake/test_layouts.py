import json

import numpy as np
import pytest
from tests.networks import WIDTH, brightness_network, painted
from tests.scenes import RECTANGLE, exact_layout, yaw

from panoplan.cli.main import main
from panoplan.formats.image import write_jpeg
from panoplan.formats.plan_json import read_plan
from panoplan.formats.tum import write_tum
from panoplan.types.pose import Trajectory

CAMERAS = np.random.default_rng(0).uniform([-1.4, -0.9], [1.4, 0.9], (6, 2))


@pytest.fixture(autouse=True)
def empty_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("PANOPLAN_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def network(tmp_path):
    return brightness_network(tmp_path / "brightness.onnx")


@pytest.fixture
def photos(tmp_path):
    """A room of 4 m × 3 m, photographed from 6 places; the colours tell the boundary."""
    folder = tmp_path / "room"
    (folder / "images").mkdir(parents=True)
    rotations = np.array([yaw(0.3 * k) for k in range(len(CAMERAS))])
    for k, camera in enumerate(CAMERAS):
        floor = -exact_layout(RECTANGLE, camera, rotations[k], width=WIDTH).floor_boundary
        write_jpeg(folder / "images" / f"{k:02d}.jpg", painted(np.minimum(floor, 1)))
    positions = np.stack([CAMERAS[:, 0], np.zeros(len(CAMERAS)), CAMERAS[:, 1]], axis=1)
    labels = tuple(f"{k:02d}" for k in range(len(CAMERAS)))
    write_tum(folder / "trajectory.tum", Trajectory(labels, rotations, positions))
    return folder


def test_images_with_a_trajectory_become_a_plan(photos, network, tmp_path, capsys):
    out = tmp_path / "plan"
    words = ["run", str(photos), "-o", str(out), "--model", str(network), "--trajectory-unit", "m"]
    assert main(words) == 0
    plan = read_plan(out / "plan.json")
    (room,) = plan.rooms
    assert np.ptp(room.polygon, axis=0) == pytest.approx([4, 3], abs=0.25)
    assert len(list((out / "scene" / "layouts_pred").iterdir())) == 6
    assert main([*words, "--quiet"]) == 0


def test_an_image_that_is_no_panorama_is_left_out_and_counted(photos, network, tmp_path, capsys):
    (photos / "images" / "02.jpg").write_bytes(b"no image")
    out = tmp_path / "plan"
    assert main(["run", str(photos), "-o", str(out), "--model", str(network)]) == 0
    skipped = json.loads((out / "plan.json").read_text())["skipped"]
    assert any("no readable image" in item["reason"] for item in skipped)
    assert "keyframes left out" in capsys.readouterr().out


def test_images_none_of_which_is_usable_end_in_one_line(photos, network, tmp_path, capsys):
    for path in (photos / "images").iterdir():
        path.write_bytes(b"no image")
    assert main(["run", str(photos), "-o", str(tmp_path / "x"), "--model", str(network)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "none usable" in error


def test_images_without_a_network_name_both_ways_out(photos, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("panoplan.intake.layouts.SHIPPED", tmp_path / "none.onnx")
    assert main(["run", str(photos), "-o", str(tmp_path / "x")]) == 2
    error = capsys.readouterr().err
    assert "--layouts" in error
    assert "panoplan[images]" in error
    assert not (tmp_path / "x").exists()


def test_layout_writes_the_files_of_a_sequence_folder(photos, network, tmp_path, capsys):
    (photos / "images" / "06.jpg").write_bytes(b"no image")
    words = ["layout", str(photos), "-o", str(tmp_path / "walk"), "--model", str(network)]
    assert main([*words, "--average", "flip,rotate"]) == 0
    told = capsys.readouterr().out
    assert "06: left out" in told
    assert "6 of 7 images" in told
    files = sorted(path.name for path in (tmp_path / "walk" / "layouts_pred").iterdir())
    assert files == [f"{k:02d}.npz" for k in range(6)]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["layout", "missing.jpg", "-o", "x"], "missing.jpg"),
        (["layout", ".", "-o", "x", "--average", "twist"], "twist"),
        (["layout", ".", "-o", "x", "--model", "missing.onnx"], "no image"),
    ],
)
def test_bad_arguments_of_layout_exit_with_2(words, told, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    try:
        code = main(words)
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "x").exists()
