import json

import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.formats.mp3d_fpe import (
    read_mp3d_fpe,
    read_mp3d_fpe_layout,
    read_mp3d_fpe_truth,
    write_mp3d_fpe,
)
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Pose, Trajectory
from panoplan.types.truth import GroundTruth, TrueLevels, TruePlan, TrueRoom

# Keyframes are listed out of order; the poses follow the sorted ids 2, 3, 5, 10.
KEYFRAMES = "10\n2\n5\n3\n"
POSES = """# odometry
2, 0.0, 0.0, 0.0, 0, 0, 0, 1
3, 9.0, 9.0, 9.0, 0, 0, 0, 0
5, 1.0, 0.0, 0.5, 0, 0.7071067811865476, 0, 0.7071067811865476
10, 2.0, -0.1, 1.0, 0, 0, 0, 1
"""
# Frame k is row k - 1, whatever the first field says. Frame 5 has no true pose.
TRUE_POSES = "".join(
    f"{100 + k} {'nan' if k == 5 else k / 10} 0 {k / 5} 0 0 0 1\n" for k in range(1, 12)
)
LABEL = {
    "room_corners": [
        [["0.0", "0.0"], ["0.0", "3.0"], ["2.0", "3.0"], ["2.0", "0.0"]],
        [[2, 0], [5, 0], [5, 3]],
    ],
    "axis_corners": [["1", "1"], ["4", "5"]],
    "version": "1.0",
}


@pytest.fixture
def version(tmp_path):
    """<root>/2azQ1b91cZZ/0 as the dataset has it."""
    folder = tmp_path / "2azQ1b91cZZ" / "0"
    (folder / "vo_final" / "hn_mp3d").mkdir(parents=True)
    (folder / "rgb").mkdir()
    (folder / "vo_final" / "keyframe_list.txt").write_text(KEYFRAMES)
    (folder / "vo_final" / "cam_pose_estimated.csv").write_text(POSES)
    (folder / "frm_ref.txt").write_text(TRUE_POSES)
    (folder / "label.json").write_text(json.dumps(LABEL))
    azimuth = 2 * np.pi * np.arange(1024) / 1024 - np.pi
    for frame in (2, 3, 5):
        rows = np.stack([np.full(1024, -0.4), 0.5 + 0.1 * np.cos(azimuth), np.full(1024, 0.01)])
        rows[2, [256, 257]] = 0.9
        np.save(folder / "vo_final" / "hn_mp3d" / f"{frame}.npy", rows)
    return folder


def test_poses_follow_the_sorted_ids_and_an_invalid_row_shifts_none(version):
    data = read_mp3d_fpe(version)
    assert data.name == "2azQ1b91cZZ_0"
    assert data.trajectory.labels == ("2", "5", "10")
    np.testing.assert_array_equal(
        data.trajectory.translations, [[0, 0, 0], [1, 0, 0.5], [2, -0.1, 1]]
    )
    np.testing.assert_allclose(data.trajectory.rotations[1] @ [0, 0, 1], [1, 0, 0], atol=1e-12)
    assert data.skipped == (("3", "no pose: all-zero quaternion"),)
    assert data.layouts == version / "vo_final" / "hn_mp3d"


def test_a_row_of_nan_is_invalid_too(version):
    path = version / "vo_final" / "cam_pose_estimated.csv"
    path.write_text(POSES.replace("2, 0.0, 0.0, 0.0", "2, 0.0, nan, 0.0"))
    data = read_mp3d_fpe(version)
    assert data.trajectory.labels == ("5", "10")
    assert data.skipped[0] == ("2", "no pose: NaN")


def test_spaces_and_tabs_are_separators_as_well(version):
    path = version / "vo_final" / "cam_pose_estimated.csv"
    expected = read_mp3d_fpe(version).trajectory.translations
    for separator in (" ", "\t"):
        path.write_text(POSES.replace(", ", separator))
        np.testing.assert_array_equal(read_mp3d_fpe(version).trajectory.translations, expected)


def test_the_first_odometry_folder_is_used(version):
    other = version / "vo_alpha"
    other.mkdir()
    assert read_mp3d_fpe(version).layouts.parent.name == "vo_final"  # it lists no keyframes
    (other / "keyframe_list.txt").write_text("4\n")
    (other / "cam_pose_estimated.csv").write_text("4 1 2 3 0 0 0 1\n")
    assert read_mp3d_fpe(version).trajectory.labels == ("4",)


def test_layouts_have_no_half_pixel_and_v_down(version):
    layout = read_mp3d_fpe_layout(version / "vo_final" / "hn_mp3d" / "2.npy")
    azimuth = 2 * np.pi * (np.arange(1024) + 0.5) / 1024 - np.pi
    np.testing.assert_allclose(layout.floor_boundary, -0.5 - 0.1 * np.cos(azimuth), atol=2e-6)
    np.testing.assert_allclose(layout.ceiling_boundary, np.full(1024, 0.4))
    # Their columns 256 and 257, middle 256.5, look along -90° + ½ column: ours is 256.
    np.testing.assert_array_equal(layout.corners, [256.0])


def test_frame_k_is_row_k_minus_1_of_the_truth(version):
    truth = read_mp3d_fpe_truth(version)
    assert truth.trajectory.labels == ("2", "3", "10")  # 5 has no true pose
    np.testing.assert_allclose(
        truth.trajectory.translations, [[0.2, 0, 0.4], [0.3, 0, 0.6], [1.0, 0, 2.0]]
    )


def test_rooms_of_numeric_strings_counter_clockwise(version):
    plan = read_mp3d_fpe_truth(version).plan
    np.testing.assert_array_equal(plan.rooms[0].polygon, [[2, 0], [2, 3], [0, 3], [0, 0]])
    np.testing.assert_array_equal(plan.rooms[1].polygon, [[2, 0], [5, 0], [5, 3]])
    np.testing.assert_allclose(plan.axis, [0.6, 0.8])


def test_truth_without_poses(version):
    (version / "frm_ref.txt").unlink()
    assert read_mp3d_fpe_truth(version).trajectory is None


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("keyframe_list.txt", "", "an empty file"),
        ("keyframe_list.txt", "# none\n", "no keyframe"),
        ("keyframe_list.txt", "2\n3\n2\n5\n", ":3: found the keyframe 2 twice"),
        ("keyframe_list.txt", "2\n3.5\n5\n10\n", ":2: found '3.5'"),
        ("keyframe_list.txt", "0\n2\n3\n5\n", ":1: found '0'"),
        ("keyframe_list.txt", "2\n3\n5\n10\n11\n", "4 poses; expected 5"),
        ("cam_pose_estimated.csv", None, "found nothing"),
        ("cam_pose_estimated.csv", "", "an empty file"),
        ("cam_pose_estimated.csv", POSES[:-30], ":5: found [0-9] fields"),
        ("cam_pose_estimated.csv", POSES.replace("2.0, -0.1", "2.0, x"), ":5: .*seven numbers"),
        ("cam_pose_estimated.csv", POSES.replace("0, 0, 0, 1\n", "0, 0, 0, 2\n"), "length 2"),
        ("cam_pose_estimated.csv", "1 0 0 0 0 0 0 0\n" * 4, "no valid pose"),
    ],
)
def test_bad_odometry(version, name, text, told):
    path = version / "vo_final" / name
    path.unlink()
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError, match=told) as caught:
        read_mp3d_fpe(version)
    assert name in str(caught.value)


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("label.json", "{", "broken JSON"),
        ("label.json", "{}", "no list room_corners"),
        ("label.json", '{"room_corners": [[["0", "x"]]]}', "expected numbers"),
        ("label.json", '{"room_corners": [[["0", "nan"], [0, 1], [1, 1]]]}', "NaN"),
        ("label.json", '{"room_corners": [[[0, 0], [0, 1]]]}', "2 corners"),
        ("label.json", '{"room_corners": ["abc"]}', r"room_corners\[0\]: found str"),
        ("label.json", '{"room_corners": [], "axis_corners": [[1, 1], [1, 1]]}', "two different"),
        ("frm_ref.txt", TRUE_POSES[: len(TRUE_POSES) // 2], "fields|frames"),
        ("frm_ref.txt", "1 0 0 0 0 0 0 1\n" * 9, "9 frames; expected at least 10"),
    ],
)
def test_bad_truth(version, name, text, told):
    (version / name).write_text(text)
    with pytest.raises(InputError, match=told) as caught:
        read_mp3d_fpe_truth(version)
    assert name in str(caught.value)


def test_no_odometry_at_all(tmp_path):
    with pytest.raises(InputError, match="no keyframe list"):
        read_mp3d_fpe(tmp_path)


def written(folder):
    heading = 2 * np.pi * (np.arange(1024) + 0.5) / 1024 - np.pi
    floor = -0.6 + 0.1 * np.cos(heading)
    layouts = [Layout(floor, -floor, np.array([0.0, 300.0])), None, Layout(floor)]
    turned = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    keyframes = [
        Keyframe(str(frame), Pose(turned, np.array([k / 3, 0.01, -k])), layout)
        for k, (frame, layout) in enumerate(zip((4, 7, 12), layouts, strict=True))
    ]
    room = TrueRoom("r", "", np.array([[0.0, 0], [2, 0], [2, 1.5]]))
    poses = Trajectory(("4", "7", "12"), np.stack([turned] * 3), np.arange(9.0).reshape(3, 3))
    truth = GroundTruth(TruePlan((room,), axis=np.array([0.6, 0.8])), poses)
    write_mp3d_fpe(folder, keyframes, truth)
    return keyframes, truth


def test_read_of_write(tmp_path):
    folder = tmp_path / "scene" / "v1"
    keyframes, truth = written(folder)
    data = read_mp3d_fpe(folder)
    assert data.trajectory.labels == ("4", "7", "12")
    for k, keyframe in enumerate(keyframes):
        np.testing.assert_array_equal(data.trajectory.translations[k], keyframe.pose.translation)
        np.testing.assert_allclose(data.trajectory.rotations[k], keyframe.pose.rotation, atol=1e-12)
    assert sorted(p.name for p in data.layouts.iterdir()) == ["12.npy", "4.npy"]
    first = read_mp3d_fpe_layout(data.layouts / "4.npy")
    np.testing.assert_allclose(first.floor_boundary, keyframes[0].layout.floor_boundary, atol=3e-6)
    np.testing.assert_array_equal(first.corners, [0.0, 300.0])
    last = read_mp3d_fpe_layout(data.layouts / "12.npy")
    assert last.ceiling_boundary is None
    assert last.corners is None
    again = read_mp3d_fpe_truth(folder)
    assert again.trajectory.labels == ("4", "7", "12")
    np.testing.assert_array_equal(again.trajectory.translations, truth.trajectory.translations)
    np.testing.assert_array_equal(again.plan.rooms[0].polygon, truth.plan.rooms[0].polygon)
    np.testing.assert_allclose(again.plan.axis, [0.6, 0.8])


def test_storeys_are_ours_to_add(tmp_path):
    folder = tmp_path / "house" / "0"
    keyframes, truth = written(folder)
    assert "level" not in (folder / "label.json").read_text()
    ring = truth.plan.rooms[0].polygon
    rooms = (truth.plan.rooms[0], TrueRoom("up", "", ring, level=1))
    plan = TruePlan(rooms, levels=TrueLevels((0.0, 3.1)))
    write_mp3d_fpe(folder, keyframes, GroundTruth(plan, truth.trajectory))
    again = read_mp3d_fpe_truth(folder).plan
    assert [room.level for room in again.rooms] == [0, 1]
    assert again.levels == TrueLevels((0.0, 3.1))
    label = json.loads((folder / "label.json").read_text())
    for levels, told in (([0], "2 levels"), ([0, 2], "a level from 0 to 1"), (None, "2 levels")):
        (folder / "label.json").write_text(json.dumps(label | {"room_levels": levels}))
        with pytest.raises(InputError, match=told):
            read_mp3d_fpe_truth(folder)


@pytest.mark.parametrize("name", ["0", "007", "a", "-1", "99999999"])
def test_ids_that_are_no_frames_are_not_written(tmp_path, name):
    with pytest.raises(InputError, match="frame"):
        write_mp3d_fpe(tmp_path, [Keyframe(name, Pose(np.eye(3), np.zeros(3)), None)])
