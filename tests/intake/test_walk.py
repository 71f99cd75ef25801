import json
import shutil
import wave

import numpy as np
import pytest
from PIL import Image
from tests.networks import brightness_network
from tests.scenes import exact_layout, yaw
from tests.walks import box_room, path_poses, picture

from panoplan.cli.main import main
from panoplan.formats.image import write_jpeg
from panoplan.formats.layout_npz import write_layout_npz
from panoplan.formats.plan_json import read_plan
from panoplan.layouts.onnx import OnnxLayouts

pytest.importorskip("pycolmap", reason="needs the extra images")

ROOM = np.array([[-2.0, -1.5], [2.0, -1.5], [2.0, 1.5], [-2.0, 1.5]])


@pytest.fixture(autouse=True)
def cache(monkeypatch, tmp_path_factory):
    folder = tmp_path_factory.getbasetemp() / "walk_cache"
    monkeypatch.setenv("PANOPLAN_CACHE", str(folder))


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    """Twelve panoramas of a room of 4 m × 3 m with their layouts and no poses."""
    folder = tmp_path_factory.mktemp("photos") / "room"
    (folder / "images").mkdir(parents=True)
    (folder / "layouts_pred").mkdir()
    walls = box_room(-2, 2, -1.5, 1.5, np.random.default_rng(3))
    walk = path_poses([(-1.2, -0.6), (-0.9, 0.6), (0.6, 0.5), (1.0, -0.2)], 0.3)
    for name, rotation, position in zip(
        walk.labels, walk.rotations, walk.translations, strict=True
    ):
        write_jpeg(folder / "images" / f"p{name}.jpg", picture(walls, rotation, position, 512))
        layout = exact_layout(ROOM, position[[0, 2]], rotation, height=1.5)
        write_layout_npz(folder / "layouts_pred" / f"p{name}.npz", layout)
    return folder


def room_size(plan):
    """Sides of the only room, shorter first, from its area and perimeter."""
    (room,) = plan.rooms
    edges = np.linalg.norm(np.roll(room.polygon, -1, axis=0) - room.polygon, axis=1)
    return np.sort(edges)[[0, -1]]


def test_photos_alone_become_the_room_in_metres(photos, tmp_path, capsys):
    out = tmp_path / "plan"
    words = ["run", str(photos), "-o", str(out), "--camera-height", "1.5"]
    assert main(words) == 0
    told = capsys.readouterr().out
    count = len(list((photos / "images").iterdir()))
    assert f"{count} of {count} keyframes have poses" in told
    assert "horizon levelled" in told
    plan = read_plan(out / "plan.json")
    assert plan.unit == "m"
    np.testing.assert_allclose(room_size(plan), [3, 4], rtol=0.05)
    # The folder that was made is a scene of its own, and gives the same plan.
    again = tmp_path / "again"
    layouts = ["--layouts", str(photos / "layouts_pred")]
    scene = ["run", str(out / "scene"), "-o", str(again), "--camera-height", "1.5", "--quiet"]
    assert main([*scene, *layouts]) == 0
    np.testing.assert_array_equal(
        read_plan(again / "plan.json").rooms[0].polygon, plan.rooms[0].polygon
    )


def test_what_is_no_panorama_is_left_out_and_counted(photos, tmp_path, capsys):
    folder = tmp_path / "mixed"
    shutil.copytree(photos, folder)
    images = folder / "images"
    for path in sorted(images.iterdir())[6:]:
        path.unlink()
    shutil.copy(images / "p1.jpg", images / "p1b.jpg")
    Image.new("RGB", (1024, 512)).save(images / "q_black.png")
    Image.new("RGB", (800, 600)).save(images / "q_small.png")
    (images / "q_broken.jpg").write_bytes(b"\xff\xd8")
    out = tmp_path / "plan"
    assert main(["run", str(folder), "-o", str(out), "--camera-height", "1.5"]) in (0, 3)
    told = capsys.readouterr().out
    assert "1 panoramas passed over" in told
    assert "3 images left out" in told
    reasons = {
        s["keyframe"]: s["reason"] for s in json.loads((out / "plan.json").read_text())["skipped"]
    }
    assert "800×600" in reasons["q_small"]
    assert "one colour" in reasons["q_black"]
    assert "no readable image" in reasons["q_broken"]


def test_one_photo_is_one_room(photos, tmp_path):
    folder = tmp_path / "one"
    (folder / "images").mkdir(parents=True)
    shutil.copy(photos / "images" / "p3.jpg", folder / "images")
    words = ["run", str(folder), "--layouts", str(photos / "layouts_pred"), "--quiet"]
    assert main([*words, "-o", str(tmp_path / "a"), "--camera-height", "1.5"]) == 0
    np.testing.assert_allclose(
        room_size(read_plan(tmp_path / "a" / "plan.json")), [3, 4], rtol=0.05
    )
    assert main([*words, "-o", str(tmp_path / "b")]) == 0
    plan = read_plan(tmp_path / "b" / "plan.json")
    assert plan.unit == "ch"
    np.testing.assert_allclose(room_size(plan), [2, 8 / 3], rtol=0.05)


def sound(path):
    with wave.open(str(path), "wb") as stream:
        stream.setparams((1, 2, 8000, 0, "NONE", ""))
        stream.writeframes(bytes(16000))


def wrong_aspect(path):
    path.mkdir()
    for k in range(3):
        Image.new("RGB", (800, 600)).save(path / f"{k}.png")


@pytest.mark.parametrize(
    ("name", "make", "told"),
    [
        ("a.mp4", sound, "sound without pictures"),
        ("a.mp4", lambda p: p.write_bytes(b"\0" * 4096), "no readable video"),
        ("photos", wrong_aspect, "800×600"),
    ],
)
def test_what_holds_no_panorama_is_one_line_and_exit_2(name, make, told, photos, tmp_path, capsys):
    make(tmp_path / name)
    layouts = ["--layouts", str(photos / "layouts_pred")]
    assert main(["run", str(tmp_path / name), "-o", str(tmp_path / "out"), *layouts]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_pictures_without_a_trajectory_have_no_unit_to_be_given(photos, tmp_path, capsys):
    words = ["--layouts", str(photos / "layouts_pred"), "--trajectory-unit", "m"]
    assert main(["run", str(photos / "images"), "-o", str(tmp_path / "out"), *words]) == 2
    assert "--trajectory-unit m: found no trajectory" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_photos_of_two_homes_are_two_groups_and_told(photos, tmp_path, capsys):
    folder = tmp_path / "two"
    (folder / "images").mkdir(parents=True)
    shutil.copy(photos / "images" / "p3.jpg", folder / "images" / "p3.jpg")
    other = box_room(-2, 2, -1.5, 1.5, np.random.default_rng(9))
    write_jpeg(folder / "images" / "p4.jpg", picture(other, yaw(0.3), np.array([0.4, 0, 0.3]), 512))
    with Image.open(folder / "images" / "p3.jpg") as first:
        first.save(folder / "images" / "p5.jpg", quality=80)
    words = ["run", str(folder), "--layouts", str(photos / "layouts_pred")]
    assert main([*words, "-o", str(tmp_path / "out"), "--camera-height", "1.5"]) == 0
    told = capsys.readouterr().out
    assert "1 of 2 photos have poses in one frame" in told
    assert "1 other groups of 1 photos could not be joined" in told
    assert "1 images left out" in told
    skipped = json.loads((tmp_path / "out" / "plan.json").read_text())["skipped"]
    assert {s["keyframe"]: s["reason"] for s in skipped}["p5"] == "a copy of p3"
    plan = read_plan(tmp_path / "out" / "plan.json")
    assert plan.unit == "m"
    np.testing.assert_allclose(room_size(plan), [3, 4], rtol=0.05)


def test_the_network_is_not_asked_twice_of_one_picture(photos, tmp_path, monkeypatch):
    pytest.importorskip("onnxruntime", reason="needs the extra images")
    folder, asked = tmp_path / "alone", []
    shutil.copytree(photos / "images", folder)
    network = brightness_network(tmp_path / "network.onnx")
    answer = OnnxLayouts.__call__

    def counted(self, pixels):
        asked.append(pixels)
        return answer(self, pixels)

    monkeypatch.setattr(OnnxLayouts, "__call__", counted)
    monkeypatch.setenv("PANOPLAN_CACHE", str(tmp_path / "cache"))
    words = ["run", str(folder), "--model", str(network), "--camera-height", "1.5", "--quiet"]
    first = main([*words, "-o", str(tmp_path / "a")])
    count = len(json.loads((tmp_path / "a" / "scene" / "sequence.json").read_text())["keyframes"])
    # A few are turned otherwise in the end, those of the beginning.
    assert count <= len(asked) < 1.4 * count
    times = len(asked)
    # From what was kept, the second run has the same pictures.
    assert main([*words, "-o", str(tmp_path / "b")]) == first
    assert len(asked) == times
    for path in sorted((tmp_path / "a" / "scene" / "images").iterdir()):
        again = tmp_path / "b" / "scene" / "images" / path.name
        assert path.read_bytes() == again.read_bytes()
