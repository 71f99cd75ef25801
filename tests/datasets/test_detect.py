import numpy as np
import pytest

from panoplan.datasets.detect import open_scene, read_truth
from panoplan.errors import InputError
from panoplan.formats.sequence import write_sequence
from panoplan.simulate.scene import simulate_flat


def test_what_a_folder_is_told_by_its_content(flat, fpe):
    assert open_scene(flat).kind == "sequence folder"
    assert open_scene(fpe).kind == "MP3D-FPE scene"
    assert open_scene(fpe, version="v0").kind == "MP3D-FPE scene"
    assert open_scene(fpe / "v0").kind == "MP3D-FPE scene"
    trajectory = flat / "trajectory.tum"
    bare = open_scene(flat / "layouts_pred", trajectory=trajectory)
    assert bare.kind == "trajectory and layouts"
    assert [k.id for k in bare.keyframes] == ["pano_4", "pano_9", "pano_10"]
    anywhere = open_scene(flat.parent, trajectory=trajectory, layouts=flat / "layouts_pred")
    assert anywhere.kind == "trajectory and layouts"


def test_what_is_no_scene(flat, tmp_path):
    with pytest.raises(InputError, match="nothing; expected a folder"):
        open_scene(tmp_path / "none")
    with pytest.raises(InputError, match="a file; expected a folder"):
        open_scene(flat / "sequence.json")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="none of the files of a scene; expected a sequence fold"):
        open_scene(tmp_path / "empty")
    with pytest.raises(InputError, match="none of the files of a scene"):
        open_scene(tmp_path / "empty", trajectory=flat / "trajectory.tum")
    with pytest.raises(InputError, match="no MP3D-FPE scene"):
        open_scene(flat, version="v0")


def test_truth_of_either_kind(flat, fpe, tmp_path):
    assert read_truth(flat).trajectory.labels[0] == "pano_4"
    assert read_truth(fpe).trajectory.labels[0] == "2"
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no truth"):
        read_truth(tmp_path / "empty")


def test_a_simulated_scene_written_and_opened(tmp_path):
    made = simulate_flat(0, "mild", stills=True)
    write_sequence(tmp_path / "sim", made.name, made.keyframes, made.truth, made.camera_height_m)
    scene = open_scene(tmp_path / "sim")
    assert scene.name == made.name
    assert scene.camera_height_m == made.camera_height_m
    for a, b in zip(scene.keyframes, made.keyframes, strict=True):
        assert a.id == b.id
        np.testing.assert_allclose(
            a.pose.translation, scene.level_rotation @ b.pose.translation, atol=1e-12
        )
        np.testing.assert_allclose(a.layout.floor_boundary, b.layout.floor_boundary, atol=1e-6)
    truth = read_truth(tmp_path / "sim")
    assert truth.trajectory.labels == tuple(k.id for k in made.keyframes)
    np.testing.assert_array_equal(truth.trajectory.translations, made.truth.trajectory.translations)
    assert len(truth.plan.rooms) == len(made.truth.plan.rooms)
