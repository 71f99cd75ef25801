"""Plans of a walk whose poses were found in its images; what is told where none were found."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from panoplan.bench import odometry
from panoplan.config import Config
from panoplan.errors import InputError
from panoplan.formats.image import write_jpeg
from panoplan.formats.layout_npz import write_layout_npz
from panoplan.formats.sequence import write_sequence
from panoplan.layouts.onnx import SHIPPED, OnnxLayouts
from panoplan.simulate.flats import make_flat
from panoplan.simulate.scene import simulate
from panoplan.types.pose import Trajectory


def _quiet(done, total, what=""):
    pass


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    """A walk through a flat with its true layouts, its pictures noise."""
    folder: Path = tmp_path_factory.mktemp("walk")
    scene = simulate(make_flat(3, rooms=5, area_m2=60.0), 3, "exact", step_m=0.8)
    for part in ("images", "layouts_gt"):
        (folder / part).mkdir()
    images = {}
    noise = np.random.default_rng(0).integers(0, 255, (256, 512, 3)).astype(np.uint8)
    for keyframe in scene.keyframes:
        images[keyframe.id] = f"images/{keyframe.id}.jpg"
        write_jpeg(folder / images[keyframe.id], noise)
        write_layout_npz(folder / "layouts_gt" / f"{keyframe.id}.npz", keyframe.layout)
    write_sequence(folder, scene.name, scene.keyframes, scene.truth, scene.camera_height_m, images)
    return folder, scene


def test_plans_by_found_poses_are_compared_with_the_truth(walk, monkeypatch):
    folder, scene = walk
    monkeypatch.setattr(odometry, "predicted", lambda images, network, progress: {})
    true = scene.truth.trajectory
    # Found poses are in a world and a unit of their own.
    found = Trajectory(true.labels, true.rotations, 0.37 * true.translations + [1.0, 2.0, 3.0])
    network = OnnxLayouts(SHIPPED, threads=1)
    known = odometry._known(folder)
    plans = odometry._plans(folder, known, found, Config(), network, _quiet)
    assert set(plans) == {"network", *odometry.PLANS}
    for name in ("true_poses_true_layouts", "true_layouts"):
        (half,) = (s for s in plans[name]["rooms"]["scores"] if s["iou"] == 0.5)
        assert half["hits"] == half["true"] == 5
    assert plans["images_alone"]["rooms"]["scores"][0]["hits"] == 0


def test_a_walk_without_poses_has_found_nothing(walk):
    folder, _ = walk
    known = odometry._known(folder)
    plans = odometry._plans(folder, known, None, Config(), OnnxLayouts(SHIPPED), _quiet)
    assert plans["images_alone"]["rooms"]["scores"][1] == {
        "iou": 0.5,
        "hits": 0,
        "predicted": 0,
        "true": 5,
    }


def test_what_plans_are_compared_with_must_be_there(walk, tmp_path):
    folder, _ = walk
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    (tmp_path / "layouts_gt" / "0007.npz").unlink()
    with pytest.raises(InputError, match="found no true layout or no true pose"):
        odometry._known(tmp_path)
