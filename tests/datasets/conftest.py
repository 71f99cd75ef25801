"""A small sequence folder and a small MP3D-FPE scene, written by hand."""

import json

import numpy as np
import pytest

FLOOR = np.full(64, -0.5, dtype=np.float32)


@pytest.fixture
def flat(tmp_path):
    """A sequence folder of three keyframes, with truth beside them."""
    folder = tmp_path / "flat"
    (folder / "layouts_pred").mkdir(parents=True)
    (folder / "layouts_gt").mkdir()
    keyframes = [
        {"id": f"pano_{k}", "image": f"images/pano_{k}.jpg", "order": n, "label": "truth"}
        for n, k in enumerate((4, 9, 10))
    ]
    description = {
        "name": "a flat",
        "layout_size": [32, 64],
        "camera_height": 1.5,
        "odometry_to_layout_scale": 0.7,
        "keyframes": keyframes,
    }
    (folder / "sequence.json").write_text(json.dumps(description))
    (folder / "trajectory.tum").write_text("0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 1 0 2 0 0 0 1\n")
    (folder / "trajectory_gt.tum").write_text("2 3 0 6 0 0 0 1\n0 0 0 0 0 0 0 1\n1 3 0 0 0 0 0 1\n")
    (folder / "floorplan_gt.json").write_text(
        json.dumps({"rooms": [{"id": "r", "polygon": [[0, 0], [4, 0], [4, 7]]}]})
    )
    for k in (4, 9, 10):
        np.savez(folder / "layouts_pred" / f"pano_{k}.npz", floor_boundary=FLOOR - k / 100)
        np.savez(folder / "layouts_gt" / f"pano_{k}.npz", floor_boundary=FLOOR)
    return folder


@pytest.fixture
def fpe(tmp_path):
    """An MP3D-FPE scene folder with one version, "v0"; keyframe 3 has no pose, 7 no layout."""
    folder = tmp_path / "scene" / "v0"
    (folder / "vo_1" / "hn_mp3d").mkdir(parents=True)
    (folder / "vo_1" / "keyframe_list.txt").write_text("7\n3\n2\n12\n")
    (folder / "vo_1" / "cam_pose_estimated.csv").write_text(
        "0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 0\n0 1 0 0 0 0 0 1\n0 2 0 1 0 0 0 1\n"
    )
    for frame in (2, 3, 12):
        rows = np.stack([np.full(1024, -0.25), np.full(1024, 0.5 + frame / 100), np.zeros(1024)])
        np.save(folder / "vo_1" / "hn_mp3d" / f"{frame}.npy", rows)
    (folder / "frm_ref.txt").write_text("".join(f"{k} {k} 0 0 0 0 0 1\n" for k in range(1, 13)))
    (folder / "label.json").write_text('{"room_corners": [[["0", "0"], [4, 0], [4, 7]]]}')
    return folder.parent
