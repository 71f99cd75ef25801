"""What is known when one thing is known, and nothing else."""

import numpy as np
import pytest
from tests.bench.v1.small import Small, runner

from panoplan.bench.v1 import ablation
from panoplan.bench.v1.ablation import KNOWN, Ablated, ablated
from panoplan.bench.v1.predict import Row


@pytest.fixture(scope="module")
def source():
    return Small("flat", 3)


@pytest.fixture(scope="module")
def scene(source):
    return source.simulated()


def positions(recording):
    return np.array([k.pose.translation for k in recording.keyframes])


def test_knowing_nothing_is_the_walk_as_it_is(source, scene):
    made = ablation._knowing(source, "nothing")
    assert np.array_equal(positions(made), scene.odometry.translations)
    assert made.trajectory_unit == "unknown"


def test_known_poses_are_true_in_the_trajectorys_unit(source, scene):
    made = ablation._knowing(source, "poses")
    assert np.allclose(0.25 * positions(made), scene.truth.trajectory.translations)
    assert not np.allclose(positions(made), scene.odometry.translations)
    assert made.trajectory_unit == "unknown"


def test_a_known_scale_is_in_metres_and_drifts_as_before(source, scene):
    made = ablation._knowing(source, "scale")
    assert made.trajectory_unit == "m"
    assert np.allclose(positions(made), 0.25 * scene.odometry.translations)
    nothing = ablation._knowing(source, "nothing")
    assert made.true_ch_per_su == pytest.approx(nothing.true_ch_per_su / 0.25)


def test_known_layouts_end_at_the_room_and_the_odometry_drifts_as_before(source, scene):
    made = ablation._knowing(source, "layouts")
    assert np.array_equal(positions(made), scene.odometry.translations)
    told, true = (
        [1.0 / np.tan(-k.layout.floor_boundary) for k in keyframes]
        for keyframes in (made.keyframes, scene.keyframes)
    )
    walls = [room.polygon for room in scene.truth.plan.rooms]
    longest = max(np.hypot(*np.ptp(wall, axis=0)) for wall in walls) / scene.camera_height_m
    assert max(np.nanmax(ranges) for ranges in told) <= 1.1 * longest
    assert not np.allclose(told[0], true[0])


def test_the_true_room_of_a_camera_is_the_nearest(scene):
    rooms = ablation._true_rooms(scene.truth)
    assert np.mean(rooms == np.array(scene.keyframe_rooms)) > 0.9


def test_every_piece_of_knowledge_is_measured_and_kept(source, tmp_path, monkeypatch):
    row = Row("default", 0.3)
    monkeypatch.setattr(ablation, "KNOWN", ("nothing", "grouping"))
    told = []
    figures = ablated([source], runner(tmp_path, lambda *now: told.append(now)), row)
    assert told == [(1, 2, "ablation"), (2, 2, "ablation")]
    grouped = figures["known"]["grouping"]
    assert grouped["summary"]["scenes"] == 1
    # One room a true room that holds a view, but for closets that are seen from a doorway.
    assert grouped["scenes"][0]["failure"] is None
    assert grouped["scenes"][0]["aligned"]["rooms_30"][0] >= 3
    again = ablated([source], runner(tmp_path, lambda *_: pytest.fail("made again")), row)
    assert again == figures


def test_keys_tell_apart_what_is_known(source):
    keys = {Ablated(source, Row("default", share), known).key() for known in KNOWN
            for share in (0.2, 1.0)}  # fmt: skip
    assert len(keys) == 2 * len(KNOWN)
