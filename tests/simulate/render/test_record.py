"""Photographs of a simulated walk."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from panoplan.cli.main import main
from panoplan.formats.layout_npz import read_layout_npz
from panoplan.formats.sequence import read_sequence
from panoplan.formats.tum import read_tum
from panoplan.simulate.render.record import USUAL, Session, kept_clear, record
from panoplan.simulate.render.scene import PREVIEW, Scene
from panoplan.simulate.scene import simulate_flat

ARGUMENTS = ["simulate", "--seed", "4", "--rooms", "5", "--stills", "--quiet"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("walk") / "flat"
    wanted = ["--render", "preview", "--image-width", "256"]
    assert main([*ARGUMENTS, "-o", str(place), *wanted]) == 0
    return place


def test_every_keyframe_has_its_picture_depth_and_true_layout(folder):
    sequence = read_sequence(folder)
    assert len(sequence.keyframes) > 4
    for entry in sequence.keyframes:
        assert entry.image == f"images/{entry.id}.jpg"
        with Image.open(folder / entry.image) as picture:
            assert picture.size == (256, 128)
        layout = read_layout_npz(folder / "layouts_gt" / f"{entry.id}.npz")
        assert layout.width == 256


def test_depth_lies_on_the_floor_at_the_camera_height(folder):
    """Straight down it is the camera's height, which the true poses tell as well."""
    sequence = read_sequence(folder)
    truth = read_tum(folder / "trajectory_gt.tum")
    for k, entry in enumerate(sequence.keyframes):
        with Image.open(folder / "depth" / f"{entry.id}.png") as image:
            depth = np.asarray(image) / 1000
        height = sequence.camera_height_m - truth.translations[k, 1]
        down = np.pi / 2 - np.pi * 0.5 / 128
        assert np.median(depth[-1]) == pytest.approx(height / np.sin(down), abs=0.02)


def test_the_same_command_writes_the_same_bytes(folder, tmp_path):
    again = tmp_path / "again"
    wanted = ["--render", "preview", "--image-width", "256"]
    assert main([*ARGUMENTS, "-o", str(again), *wanted]) == 0
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            assert path.read_bytes() == (again / path.relative_to(folder)).read_bytes(), path


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (["--render", "still", "--format", "mp3d-fpe"], "--format sequence"),
        (["--render", "still", "--image-width", "7"], "even number"),
    ],
)
def test_wrong_wishes_are_told(tmp_path, capsys, wrong, told):
    assert main([*ARGUMENTS, "-o", str(tmp_path / "x"), *wrong]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "x").exists()


def test_two_processes_take_the_same_pictures(tmp_path):
    home = simulate_flat(4, "exact", rooms=5, stills=True)
    few = replace(home, keyframes=home.keyframes[:3])
    one, two = tmp_path / "one", tmp_path / "two"
    heard = []
    record(one, few, 4, PREVIEW, width=64)
    images = record(two, few, 4, PREVIEW, width=64, jobs=2, told=lambda *done: heard.append(done))
    assert list(images) == [keyframe.id for keyframe in few.keyframes]
    assert heard[-1] == (3, 3)
    paths = sorted(path.relative_to(one) for path in one.rglob("*") if path.is_file())
    assert paths == sorted(path.relative_to(two) for path in two.rglob("*") if path.is_file())
    assert all((one / path).read_bytes() == (two / path).read_bytes() for path in paths)


def test_who_opens_all_doors_finds_none_shut():
    home = simulate_flat(4, "exact", rooms=5, stills=True)
    shut = [
        Scene(home.building, 4, PREVIEW, furnished=0.0, clear=kept_clear(home, session)).shell.shut
        for session in (USUAL, Session(doors_open=True))
    ]
    assert shut[0]
    assert shut[1] == frozenset()


def test_a_sharp_camera_keeps_what_another_blurs(tmp_path):
    home = simulate_flat(4, "exact", rooms=5, stills=True)
    one = replace(home, keyframes=home.keyframes[:1])
    edges = []
    for name, session in (("any", Session(0.0)), ("sharp", Session(0.0, sharp=True))):
        record(tmp_path / name, one, 8, PREVIEW, width=512, session=session)
        (path,) = (tmp_path / name / "images").iterdir()
        with Image.open(path) as picture:
            grey = np.asarray(picture.convert("L"), dtype=float)
        edges.append(np.percentile(np.abs(np.diff(grey, axis=1)), 99))
    assert edges[1] > 1.2 * edges[0]
