import numpy as np
import pytest

from panoplan.datasets.mp3d_fpe import open_mp3d_fpe, read_truth, version_folder
from panoplan.errors import InputError


def test_a_scene(fpe):
    scene = open_mp3d_fpe(fpe / "v0")
    assert scene.name == "scene_v0"
    assert scene.kind == "MP3D-FPE scene"
    assert scene.camera_height_m is None
    assert [k.id for k in scene.keyframes] == ["2", "7", "12"]
    assert scene.skipped == (("3", "no pose: all-zero quaternion"),)
    assert scene.association == "3 of 3 poses matched by id"
    first, without, last = scene.keyframes
    np.testing.assert_allclose(first.layout.floor_boundary, -0.52)
    np.testing.assert_allclose(last.layout.floor_boundary, -0.62)
    np.testing.assert_array_equal(last.pose.translation, [2, 0, 1])
    assert without.layout is None
    assert without.missing == "no layout"


def test_its_truth(fpe):
    truth = read_truth(fpe / "v0")
    assert truth.trajectory.labels == ("2", "3", "7", "12")
    np.testing.assert_array_equal(truth.trajectory.translations[:, 0], [2, 3, 7, 12])
    assert len(truth.plan.rooms) == 1


def test_truth_makes_no_difference(fpe):
    whole = open_mp3d_fpe(fpe / "v0")
    (fpe / "v0" / "frm_ref.txt").unlink()
    (fpe / "v0" / "label.json").unlink()
    bare = open_mp3d_fpe(fpe / "v0")
    assert bare.skipped == whole.skipped
    for a, b in zip(whole.keyframes, bare.keyframes, strict=True):
        np.testing.assert_array_equal(a.pose.translation, b.pose.translation)


def test_another_trajectory_and_other_layouts(fpe, tmp_path):
    (tmp_path / "slam.tum").write_text("3 0 0 0 0 0 0 1\n2 5 0 0 0 0 0 1\n")
    (tmp_path / "net").mkdir()
    np.savez(tmp_path / "net" / "3.npz", floor_boundary=np.full(64, -0.25))
    scene = open_mp3d_fpe(fpe / "v0", trajectory=tmp_path / "slam.tum", layouts=tmp_path / "net")
    assert [k.id for k in scene.keyframes] == ["3", "2"]
    assert scene.keyframes[0].layout.width == 64
    assert scene.keyframes[1].layout is None
    assert scene.skipped == (("7", "no pose"), ("12", "no pose"))


def test_all_layouts_unreadable(fpe):
    for path in (fpe / "v0" / "vo_1" / "hn_mp3d").iterdir():
        path.write_bytes(b"broken")
    with pytest.raises(InputError, match=r"hn_mp3d: found no usable layout of 3 \(unreadable"):
        open_mp3d_fpe(fpe / "v0")


def test_versions(fpe):
    assert version_folder(fpe / "v0") == fpe / "v0"
    assert version_folder(fpe) == fpe / "v0"
    assert version_folder(fpe, "v0") == fpe / "v0"
    with pytest.raises(InputError, match="versions v0; expected version v1"):
        version_folder(fpe, "v1")
    with pytest.raises(InputError, match="version v0; expected version v1"):
        version_folder(fpe / "v0", "v1")
    (fpe / "v1" / "vo_final").mkdir(parents=True)
    (fpe / "v1" / "vo_final" / "keyframe_list.txt").write_text("1\n")
    assert version_folder(fpe, "v1") == fpe / "v1"
    with pytest.raises(InputError, match="versions v0, v1; expected one of them, by --version"):
        version_folder(fpe)
    assert version_folder(fpe / "v0" / "vo_1") is None
    assert version_folder(fpe / "none") is None
