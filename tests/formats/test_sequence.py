import json

import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.formats.layout_npz import read_layout_npz
from panoplan.formats.sequence import (
    SequenceEntry,
    read_sequence,
    read_true_plan,
    write_sequence,
    write_true_plan,
)
from panoplan.formats.tum import read_tum
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Pose, Trajectory
from panoplan.types.truth import GroundTruth, TrueLevels, TruePlan, TrueRoom

SQUARE = [[0, 0], [2, 0], [2, 2], [0, 2]]


def described(tmp_path, data):
    text = data if isinstance(data, str) else json.dumps(data)
    (tmp_path / "sequence.json").write_text(text)
    return tmp_path


def test_the_fields_a_run_may_know(tmp_path):
    sequence = read_sequence(
        described(
            tmp_path,
            {
                "name": "flat",
                "layout_size": [512, 1024],
                "camera_height": 1.5,
                "odometry_to_layout_scale": {"truth": "of any type"},
                "keyframes": [
                    {"id": "b", "image": "images/b.jpg", "order": 7, "room_complete": 5},
                    {"id": "a", "order": 2, "camera_height": "tall"},
                ],
            },
        )
    )
    assert sequence.name == "flat"
    assert sequence.layout_size == (512, 1024)
    assert sequence.camera_height_m == 1.5
    assert sequence.keyframes == (
        SequenceEntry("a", "", 2),
        SequenceEntry("b", "images/b.jpg", 7),
    )


def test_all_but_the_keyframes_may_be_left_out(tmp_path):
    sequence = read_sequence(described(tmp_path, {"keyframes": [{"id": "x"}, {"id": "y"}]}))
    assert sequence.name == tmp_path.name
    assert sequence.layout_size is None
    assert sequence.camera_height_m is None
    assert [(e.id, e.order) for e in sequence.keyframes] == [("x", 0), ("y", 1)]


@pytest.mark.parametrize(
    ("data", "told"),
    [
        ("", "an empty file"),
        ('{"name": "a",\n "keyframes": [', ":2: found broken JSON"),
        ("[]", "the file: found list"),
        ({"name": 3}, "name: found int"),
        ({"name": "a\nb"}, "name: .*printable"),
        ({"name": "a" * 201}, "name: .*printable"),
        ({"layout_size": [512]}, "layout_size"),
        ({"layout_size": [512.0, 1024]}, "layout_size"),
        ({"camera_height": "1.5"}, "camera_height"),
        ({"camera_height": -1}, "camera_height"),
        ({"camera_height": True}, "camera_height"),
        ('{"camera_height": NaN}', "camera_height"),
        ({"keyframes": {}}, "keyframes: found dict"),
        ({"keyframes": ["a"]}, r"keyframes\[0\]: found str"),
        ({"keyframes": [{"order": 1}]}, r"keyframes\[0\].id: found NoneType"),
        ({"keyframes": [{"id": ""}]}, r"keyframes\[0\].id: found ''"),
        ('{"keyframes": [{"id": "\\ud800"}]}', r"keyframes\[0\].id"),
        ({"keyframes": [{"id": "a", "order": 1.5}]}, r"keyframes\[0\].order: found float"),
        ({"keyframes": [{"id": "a"}, {"id": "a"}]}, "two keyframes of id a"),
        ({"keyframes": [{"id": "a", "order": 1}, {"id": "b"}]}, "two keyframes of order 1"),
    ],
)
def test_bad_descriptions(tmp_path, data, told):
    with pytest.raises(InputError, match=told) as caught:
        read_sequence(described(tmp_path, data))
    assert "\n" not in str(caught.value)


def test_missing_description(tmp_path):
    with pytest.raises(InputError, match=r"sequence\.json: found nothing"):
        read_sequence(tmp_path)


def test_the_true_plan_by_hand(tmp_path):
    path = tmp_path / "floorplan_gt.json"
    path.write_text(
        json.dumps(
            {
                "rooms": [{"id": "r", "label": "hall", "polygon": SQUARE[::-1], "holes": [SQUARE]}],
                "doors": [[[0, 0], [1, 0]]],
                "openings": [],
                "segments_raw": {"openings": [[[0, 0], [0, 1]], [[1, 1], [2, 2]]]},
                "camera_height": 1.4,
            }
        )
    )
    plan = read_true_plan(path)
    assert plan.rooms[0].label == "hall"
    np.testing.assert_array_equal(plan.rooms[0].polygon, SQUARE)  # counter-clockwise
    assert len(plan.rooms[0].holes) == 1
    assert len(plan.doors) == 1
    assert len(plan.openings) == 2
    assert plan.rooms_partial == ()
    assert plan.camera_height_m == 1.4
    assert plan.axis is None


@pytest.mark.parametrize(
    ("data", "told"),
    [
        ({"rooms": [{"polygon": SQUARE[:2]}]}, "2 corners"),
        ({"rooms": [{"polygon": [[0, 0], [1]]}]}, "array of numbers"),
        ({"rooms": [{"polygon": [["0", "0"]] * 3}]}, "real numbers"),
        ({"rooms": [{"polygon": SQUARE, "holes": 3}]}, "holes: found int"),
        ({"rooms": 3}, "rooms: found int"),
        ({"doors": [[[0, 0]]]}, r"doors\[0\]: found shape \(1, 2\)"),
        ({"doors": [None]}, r"doors\[0\]"),
        ({"camera_height": "high"}, "camera_height"),
        ({"axis": [1]}, "axis"),
    ],
)
def test_bad_true_plans(tmp_path, data, told):
    path = tmp_path / "floorplan_gt.json"
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, match=told):
        read_true_plan(path)


def keyframe(name, x, layout=True):
    return Keyframe(
        name,
        Pose(np.eye(3), np.array([x, 0.0, 0.1])),
        Layout(np.full(32, -0.5)) if layout else None,
    )


def truth_of(count):
    room = TrueRoom("r1", "hall", np.array(SQUARE, dtype=float), (np.array(SQUARE) / 4.0,))
    plan = TruePlan(
        rooms=(room,),
        rooms_partial=(room, room),
        doors=(np.array([[0, 0], [0.1, 0.2]]),),
        openings=(np.array([[0, 0], [0.3, 0.2]]),),
        windows=(np.array([[0, 0], [0.4, 0.2]]),),
        axis=np.array([0.6, 0.8]),
        camera_height_m=1.5,
    )
    poses = Trajectory(
        tuple(f"kf{k}" for k in range(count)),
        np.broadcast_to(np.eye(3), (count, 3, 3)),
        np.arange(3.0 * count).reshape(count, 3),
    )
    return GroundTruth(plan, poses)


def test_a_written_folder(tmp_path):
    folder = tmp_path / "new" / "flat"
    frames = [keyframe("kf0", 0.0), keyframe("kf1", 0.5, layout=False)]
    write_sequence(folder, "a flat", frames, truth_of(2), 1.5)
    sequence = read_sequence(folder)
    assert sequence.name == "a flat"
    assert sequence.layout_size == (16, 32)
    assert sequence.camera_height_m == 1.5
    assert [(e.id, e.order) for e in sequence.keyframes] == [("kf0", 0), ("kf1", 1)]
    odometry = read_tum(folder / "trajectory.tum")
    assert odometry.labels == ("0", "1")
    np.testing.assert_array_equal(odometry.translations, [[0, 0, 0.1], [0.5, 0, 0.1]])
    assert sorted(p.name for p in (folder / "layouts_pred").iterdir()) == ["kf0.npz"]
    layout = read_layout_npz(folder / "layouts_pred" / "kf0.npz")
    np.testing.assert_array_equal(layout.floor_boundary, np.full(32, -0.5))
    true = read_tum(folder / "trajectory_gt.tum")
    np.testing.assert_array_equal(true.translations, [[0, 1, 2], [3, 4, 5]])
    assert (folder / "floorplan_gt.json").exists()


def test_no_truth_no_truth_files(tmp_path):
    write_sequence(tmp_path / "a", "a", [keyframe("k", 0)])
    assert sorted(p.name for p in (tmp_path / "a").iterdir()) == [
        "layouts_pred",
        "sequence.json",
        "trajectory.tum",
    ]


def test_true_plan_read_of_write(tmp_path):
    plan = truth_of(1).plan
    write_true_plan(tmp_path / "p.json", plan)
    again = read_true_plan(tmp_path / "p.json")
    assert [r.id for r in again.rooms_partial] == ["r1", "r1"]
    assert again.camera_height_m == 1.5
    for name in ("doors", "openings", "windows"):
        np.testing.assert_array_equal(getattr(again, name), getattr(plan, name))
    np.testing.assert_array_equal(again.axis, plan.axis)
    np.testing.assert_array_equal(again.rooms[0].polygon, plan.rooms[0].polygon)
    np.testing.assert_array_equal(again.rooms[0].holes, plan.rooms[0].holes)


@pytest.mark.parametrize("name", ["../a", "", ".hidden", "a/b", "a b", "a\n"])
def test_ids_that_are_no_file_names(tmp_path, name):
    with pytest.raises(InputError, match="keyframe id"):
        write_sequence(tmp_path / "a", "a", [keyframe(name, 0)])
    assert not (tmp_path / "a").exists()


def test_what_is_not_written(tmp_path):
    with pytest.raises(InputError, match="no keyframe"):
        write_sequence(tmp_path, "a", [])
    with pytest.raises(InputError, match="two keyframes named k"):
        write_sequence(tmp_path, "a", [keyframe("k", 0), keyframe("k", 1)])
    with pytest.raises(InputError, match="3 true poses of 1 keyframes"):
        write_sequence(tmp_path, "a", [keyframe("k", 0)], truth_of(3))
    (tmp_path / "f").write_text("x")
    with pytest.raises(InputError, match="folder to write to"):
        write_sequence(tmp_path / "f", "a", [keyframe("k", 0)])


def two_storeys():
    square = np.array(SQUARE, dtype=float)
    door = np.array([[0.5, 0.0], [1.4, 0.0]])
    rooms = (TrueRoom("hall", "hall", square), TrueRoom("bed", "bed", square, level=1))
    return TruePlan(rooms, doors=(door, door), levels=TrueLevels((0.0, 2.9), doors=(0, 1)))


def test_storeys_are_read_as_written(tmp_path):
    path = tmp_path / "floorplan_gt.json"
    write_true_plan(path, two_storeys())
    again = read_true_plan(path)
    assert [room.level for room in again.rooms] == [0, 1]
    assert again.levels == TrueLevels((0.0, 2.9), doors=(0, 1))
    one = TruePlan(two_storeys().rooms[:1])
    write_true_plan(path, one)
    assert "level" not in path.read_text()
    assert read_true_plan(path).levels is None


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (lambda data: data["levels"].update(doors=[0]), "levels.doors: found 1 levels"),
        (lambda data: data["levels"].update(doors=[0, 2]), "a level from 0 to 1"),
        (lambda data: data["levels"].update(doors=[0, "1"]), "a level from 0 to 1"),
        (lambda data: data["levels"].update(floors=["high"]), "levels.floors"),
        (lambda data: data["rooms"][1].update(level=7), "level of bed"),
        (lambda data: data.update(levels=[]), "levels"),
    ],
)
def test_bad_storeys(tmp_path, changed, told):
    path = tmp_path / "floorplan_gt.json"
    write_true_plan(path, two_storeys())
    data = json.loads(path.read_text())
    changed(data)
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, match=told):
        read_true_plan(path)
