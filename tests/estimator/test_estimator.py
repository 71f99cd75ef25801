import math
from dataclasses import replace

import numpy as np
import pytest
from shapely import Point, Polygon
from tests.scenes import L_SHAPE, RECTANGLE, T_SHAPE, exact_layout, walk, yaw

from panoplan.config import Config, override
from panoplan.errors import ConfigError, InputError
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.formats.plan_json import plan_to_text
from panoplan.formats.state import read_state, write_state
from panoplan.simulate.scene import simulate_flat
from panoplan.types.events import (
    CamerasMisplaced,
    KeyframeWaiting,
    RoomOpened,
    RoomShaped,
    RoomsJoined,
    RoomsRegrouped,
    ScaleFrozen,
)
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Pose

EARLY = override(Config(), {"scale": {"warmup": 8}})
NEXT = np.array([4.1, 0.0])
SHAPES = {"rectangle": RECTANGLE, "L": L_SHAPE, "T": T_SHAPE}


def _cameras(polygon, count=14):
    rng = np.random.default_rng(3)
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    inner = Polygon(polygon).buffer(-0.4)
    spots = []
    while len(spots) < count:
        spot = rng.uniform(low, high)
        if inner.contains(Point(spot)):
            spots.append(spot)
    return np.array(spots)


def _plan(keyframes, config=EARLY, walk_=None):
    estimator = FloorPlanEstimator(config, walk_)
    for keyframe in keyframes:
        estimator.update(keyframe)
    estimator.finish()
    return estimator.plan()


def _two_rooms(factor=1.0):
    left = walk(RECTANGLE, _cameras(RECTANGLE, 10), factor=factor)
    right = walk(RECTANGLE + NEXT, _cameras(RECTANGLE, 10) + NEXT, factor=factor)
    return left + [replace(k, id="r" + k.id) for k in right]


@pytest.mark.parametrize("name", SHAPES)
def test_exact_layouts_give_the_exact_shape(name):
    polygon = SHAPES[name]
    plan = _plan(walk(polygon, _cameras(polygon)))
    (room,) = plan.rooms
    found, true = Polygon(room.polygon), Polygon(polygon)
    assert len(room.polygon) == len(polygon)
    assert found.intersection(true).area / found.union(true).area > 0.96
    gaps = np.linalg.norm(room.polygon[:, None] - polygon[None], axis=2).min(axis=0)
    assert gaps.max() < 0.07


def test_events_of_a_walk_through_two_rooms():
    estimator = FloorPlanEstimator(EARLY)
    events = [event for k in _two_rooms() for event in estimator.update(k)]
    assert sum(isinstance(event, KeyframeWaiting) for event in events) == 8
    (frozen,) = (event for event in events if isinstance(event, ScaleFrozen))
    assert frozen.scale.ch_per_su == pytest.approx(1.0, rel=0.02)
    assert [e.room for e in events if isinstance(e, RoomOpened)] == ["room_01", "room_02"]
    assert [e.room for e in events if isinstance(e, RoomShaped)] == ["room_01"]
    plan = estimator.plan()
    assert plan.rooms[0].polygon is not None
    assert plan.rooms[1].failure == "the camera has not left it yet"
    assert [e.room for e in estimator.finish()] == ["room_02"]


def test_a_room_is_shaped_again_when_the_camera_returns():
    keyframes = _two_rooms()
    # What is seen at the second visit differs a little, so the outline does.
    back = [
        replace(k, id="b" + k.id, layout=Layout(k.layout.floor_boundary * 0.97))
        for k in keyframes[:3]
    ]
    again = [replace(k, id="c" + k.id) for k in keyframes[10:14]]
    estimator = FloorPlanEstimator(EARLY)
    shaped = [
        event.room
        for k in [*keyframes, *back, *again]
        for event in estimator.update(k)
        if isinstance(event, RoomShaped)
    ]
    assert shaped == ["room_01", "room_02", "room_01"]
    assert len(estimator.plan().rooms) == 2


def test_stream_batch_and_resume_give_the_same_bytes(tmp_path):
    keyframes = _two_rooms()
    whole = plan_to_text(_plan(keyframes))
    for cut in (0, 1, 7, 8, 13, 20):
        estimator = FloorPlanEstimator(EARLY)
        for keyframe in keyframes[:cut]:
            estimator.update(keyframe)
            estimator.plan()
        write_state(tmp_path / "state.npz", estimator.state, "same")
        state, fingerprint = read_state(tmp_path / "state.npz")
        assert fingerprint == "same"
        resumed = FloorPlanEstimator(EARLY, state=state)
        for keyframe in keyframes[cut:]:
            resumed.update(keyframe)
        resumed.finish()
        assert plan_to_text(resumed.plan()) == whole


@pytest.mark.parametrize("factor", [0.01, 0.1, 10.0, 100.0])
def test_the_plan_does_not_depend_on_the_unit_of_the_trajectory(factor):
    one, other = _plan(_two_rooms()), _plan(_two_rooms(factor))
    for a, b in zip(one.rooms, other.rooms, strict=True):
        np.testing.assert_allclose(a.polygon, b.polygon, rtol=1e-3, atol=1e-3)


def test_turning_and_shifting_the_world_turns_and_shifts_the_plan():
    keyframes = _two_rooms()
    plan = _plan(keyframes)
    turn, shift = yaw(0.83), np.array([12.0, -0.7, 31.0])
    moved = [
        replace(k, pose=Pose(turn @ k.pose.rotation, turn @ k.pose.translation + shift))
        for k in keyframes
    ]
    other = _plan(moved)
    s = plan.scale.ch_per_su
    for a, b in zip(plan.rooms, other.rooms, strict=True):
        expected = a.polygon @ turn[np.ix_([0, 2], [0, 2])].T + s * shift[[0, 2]]
        np.testing.assert_allclose(b.polygon, expected, atol=1e-3)


def test_the_plan_is_metric_where_the_camera_height_is_known():
    keyframes = _two_rooms(factor=3.0)
    ch = _plan(keyframes)
    metric = _plan(keyframes, walk_=Walk(camera_height_m=1.6))
    assert (ch.unit, metric.unit) == ("ch", "m")
    np.testing.assert_allclose(metric.rooms[0].polygon, 1.6 * ch.rooms[0].polygon)
    assert metric.camera_height_m == pytest.approx(1.6)


def test_a_metric_trajectory_gives_the_camera_height_for_free():
    cameras = _cameras(RECTANGLE)
    keyframes = walk(RECTANGLE, cameras, factor=1 / 1.5)
    plan = _plan(keyframes, walk_=Walk(trajectory_unit="m"))
    assert plan.unit == "m"
    assert plan.camera_height_m == pytest.approx(1.5, rel=0.01)


def test_bobbing_cameras_do_not_change_the_rooms():
    cameras = _cameras(RECTANGLE)
    rises = 0.05 * np.sin(np.arange(len(cameras)))
    flat, bobbing = (_plan(walk(RECTANGLE, cameras, rises=r)) for r in (None, rises))
    np.testing.assert_allclose(flat.rooms[0].polygon, bobbing.rooms[0].polygon, atol=0.03)


def test_one_keyframe_is_a_plan_of_one_room_in_camera_heights():
    plan = _plan(walk(RECTANGLE, [[0.3, 0.2]]))
    assert plan.unit == "ch"
    assert plan.scale.ch_per_su is None
    (room,) = plan.rooms
    assert Polygon(room.polygon).area == pytest.approx(12.0, rel=0.03)


def test_no_keyframe_is_a_plan_without_rooms():
    assert _plan([]).rooms == ()


def test_keyframes_without_layout_are_placed_and_counted():
    keyframes = walk(RECTANGLE, _cameras(RECTANGLE))
    keyframes[3] = replace(keyframes[3], layout=None, missing="it is gone")
    plan = _plan(keyframes)
    assert len(plan.trajectory) == len(keyframes)
    assert plan.trajectory[3].room is None
    assert [s.reason for s in plan.skipped if s.what == "keyframe"] == ["it is gone"]


def test_an_id_given_twice_is_refused_and_changes_nothing():
    estimator = FloorPlanEstimator()
    (keyframe,) = walk(RECTANGLE, [[0.0, 0.0]])
    estimator.update(keyframe)
    before = estimator.state
    with pytest.raises(InputError, match="given before"):
        estimator.update(keyframe)
    assert estimator.state is before


@pytest.mark.parametrize("rooms", [(0,) * 20, (4,) * 10 + (1,) * 10, (0,) * 5 + (1,) * 15])
def test_rooms_that_are_known_are_not_told_apart_otherwise(rooms):
    plan = _plan(_two_rooms(), EARLY, Walk("m", 1.5, 20, rooms))
    told = [pose.room for pose in plan.trajectory]
    pairs = set(zip(told, rooms, strict=True))
    assert len(pairs) == len(set(told)) == len(set(rooms))


def test_known_rooms_of_fewer_keyframes_are_refused():
    keyframes = _two_rooms()
    estimator = FloorPlanEstimator(EARLY, Walk("m", 1.5, rooms=(0, 0)))
    for keyframe in keyframes[:2]:
        estimator.update(keyframe)
    with pytest.raises(InputError, match="one for each keyframe"):
        estimator.update(keyframes[2])


def test_a_fraction_needs_the_length_of_the_walk():
    config = override(Config(), {"scale": {"warmup": 0.2}})
    (keyframe,) = walk(RECTANGLE, [[0.0, 0.0]])
    with pytest.raises(ConfigError, match="known length"):
        FloorPlanEstimator(config).update(keyframe)
    plan = _plan(_two_rooms(), config, Walk(expected_keyframes=20))
    assert plan.scale.keyframes_used == 4


def test_a_camera_that_stands_below_the_floor_is_left_out():
    keyframes = walk(RECTANGLE, _cameras(RECTANGLE))
    sunk = Pose(np.eye(3), [0.0, 1.5, 0.0])
    layout = exact_layout(RECTANGLE, np.zeros(2), np.eye(3))
    plan = _plan([*keyframes, Keyframe("sunk", sunk, layout)])
    assert plan.skipped[-1].reason == "its pose lies below the floor"


def _with_a_gross_view():
    """A gross layout from the doorway, half in each room, between those of the two rooms."""
    keyframes = _two_rooms()
    half = np.array([[1.2, -1.4], [2.9, -1.4], [2.9, 2.6], [1.2, 2.6]])
    (gross,) = walk(half, [[2.05, 0.0]])
    return [*keyframes[:10], replace(gross, id="gross"), *keyframes[10:]]


@pytest.mark.parametrize(("method", "event"), [("ispa", RoomsJoined), ("fusion", RoomsRegrouped)])
def test_a_view_of_parts_of_two_rooms_is_no_third_room(method, event):
    # However far its cameras are apart, it is a walk.
    config = override(EARLY, {"shape": {"method": method}, "misplaced": {"min_step": 10.0}})
    estimator = FloorPlanEstimator(config)
    events = [e for keyframe in _with_a_gross_view() for e in estimator.update(keyframe)]
    assert len([e for e in events if isinstance(e, RoomOpened)]) == 3
    events += estimator.finish()
    assert [e for e in events if isinstance(e, event)]
    plan = estimator.plan()
    assert len(plan.rooms) == 2
    left_out = [s.keyframe for s in plan.skipped if s.what == "keyframe"]
    assert set(left_out) <= {"gross"}
    in_rooms = [k for room in plan.rooms for k in room.keyframes]
    assert sorted([*in_rooms, *left_out]) == sorted(pose.id for pose in plan.trajectory)


def test_of_a_room_with_many_views_some_spread_over_it_are_looked_at_when_it_is_left():
    keyframes = _two_rooms()
    config = override(EARLY, {"grouping": {"around_views": 4}})
    estimator = FloorPlanEstimator(config)
    events = [e for keyframe in keyframes for e in estimator.update(keyframe)]
    assert [e for e in events if isinstance(e, RoomShaped)]
    left = estimator.state.rooms[0]
    # All its views stay with it, and move as those that were looked at.
    assert [view.index for view in left.views] == list(range(10))
    corrections = [estimator.state.cameras[k].correction for k in range(10)]
    assert len(set(corrections)) <= 4
    every = _plan(keyframes)
    estimator.finish()
    for some, all_ in zip(estimator.plan().rooms, every.rooms, strict=True):
        np.testing.assert_allclose(some.polygon, all_.polygon, atol=0.01)


def test_a_walls_sigma_and_a_pillar_reach_the_plan():
    pillar = np.array([[0.2, -0.3], [0.2, 0.3], [0.6, 0.3], [0.6, -0.3]])
    free = Polygon(RECTANGLE, [pillar]).buffer(-0.3)
    cameras = [c for c in _cameras(RECTANGLE, 24) if free.contains(Point(c))]
    (room,) = _plan(walk([RECTANGLE, pillar], cameras)).rooms
    (hole,) = room.holes
    assert Polygon(hole).symmetric_difference(Polygon(pillar)).area < 0.02
    assert not Polygon(hole).exterior.is_ccw
    assert all(wall.sigma is not None and 0.001 < wall.sigma < 0.05 for wall in room.walls)


def test_misplaced_stills_are_moved_in_the_plan_and_told():
    scene = simulate_flat(12, "mild", stills=True, metres_per_su=1.0)
    corridor = {k for k, room in enumerate(scene.keyframe_rooms) if room == 0}
    moved = [
        replace(k, pose=Pose(k.pose.rotation, k.pose.translation + [1.9, 0, 1.8]))
        if n in corridor
        else k
        for n, k in enumerate(scene.keyframes)
    ]
    walk_of = Walk("m", scene.camera_height_m, len(moved))
    estimator = FloorPlanEstimator(Config(), walk_of)
    for keyframe in moved:
        estimator.update(keyframe)
    (event,) = (e for e in estimator.finish() if isinstance(e, CamerasMisplaced))
    names = {scene.keyframes[k].id for k in corridor}
    assert set(event.keyframes) == names
    plan = estimator.plan()
    assert {s.keyframe for s in plan.skipped if s.what == "pose"} == names
    for pose, keyframe in zip(plan.trajectory, scene.keyframes, strict=True):
        assert math.dist(pose.position, keyframe.pose.translation[[0, 2]]) < 0.2
    # The rooms' densities have moved with their cameras.
    cell = Config().rooms.cell_ch
    for room in estimator.state.rooms:
        at = np.floor(np.array([view.camera for view in room.views]) / cell).astype(int)
        # But for those in doorways.
        assert room.density.mask[tuple((at - room.density.first_cell).T)].mean() > 0.5
    # Nothing is left to be found.
    assert not estimator.finish()
