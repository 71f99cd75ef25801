import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from panoplan.poses.level import gravity, level
from panoplan.types.pose import Trajectory


def level_walk(count=12, seed=0):
    """Upright cameras that turn and move."""
    rng = np.random.default_rng(seed)
    headings = rng.uniform(-np.pi, np.pi, count)
    rotations = Rotation.from_euler("y", headings[:, None]).as_matrix()
    return Trajectory(tuple(str(k) for k in range(count)), rotations, rng.normal(size=(count, 3)))


def wobbly_walk(degrees, seed=0):
    """Cameras of a person: up to so many degrees off the vertical."""
    walk = level_walk(seed=seed)
    rng = np.random.default_rng(seed + 1)
    off = Rotation.from_rotvec(np.deg2rad(rng.uniform(-degrees, degrees, (len(walk), 3))))
    return Trajectory(walk.labels, walk.rotations @ off.as_matrix(), walk.translations)


def in_world(turn, walk):
    return Trajectory(walk.labels, turn @ walk.rotations, walk.translations @ turn.T)


def about(axis, degrees):
    return Rotation.from_rotvec(np.deg2rad(degrees) * np.asarray(axis, dtype=float)).as_matrix()


def test_a_level_world_stays_as_it_is():
    walk = level_walk()
    levelled, turn = level(walk)
    np.testing.assert_array_equal(turn, np.eye(3))
    np.testing.assert_array_equal(levelled.translations, walk.translations)
    assert levelled.labels == walk.labels


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 0, 1), (0.6, 0, -0.8)])
@pytest.mark.parametrize("degrees", [10, -10, 90, 170, 179.999])
def test_a_tilted_world_comes_back_as_it_was(axis, degrees):
    walk, tilt = level_walk(), about(axis, degrees)
    levelled, turn = level(in_world(tilt, walk))
    np.testing.assert_allclose(turn, tilt.T, atol=1e-10)
    np.testing.assert_allclose(levelled.translations, walk.translations, atol=1e-10)
    np.testing.assert_allclose(levelled.rotations, walk.rotations, atol=1e-10)


def test_by_hand_a_world_tilted_by_ten_degrees():
    # One upright camera in a world turned 10° about x: its down axis is (0, cos 10°, sin 10°).
    tilt = about((1, 0, 0), 10)
    _, turn = level(Trajectory(("0",), tilt[None], np.zeros((1, 3))))
    c, s = np.cos(np.deg2rad(10)), np.sin(np.deg2rad(10))
    np.testing.assert_allclose(turn, [[1, 0, 0], [0, c, s], [0, -s, c]], atol=1e-12)


@pytest.mark.parametrize("wobble", [0.0, 1e-7, 3.0])
def test_a_world_with_y_up_is_turned_over(wobble):
    walk = wobbly_walk(wobble)
    up = in_world(np.diag([1.0, -1.0, -1.0]), walk)
    assert np.all(up.rotations[:, 1, 1] < 0)
    levelled, turn = level(up)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(gravity(levelled), [0, 1, 0], atol=1e-12)
    assert np.all(levelled.rotations[:, 1, 1] > 0.98)


@pytest.mark.parametrize("seed", range(5))
def test_any_turn_of_the_world_changes_the_level_one_by_a_heading_only(seed):
    walk = wobbly_walk(5.0, seed)
    here, _ = level(walk)
    there, _ = level(in_world(Rotation.random(random_state=seed).as_matrix(), walk))
    change = there.rotations[0] @ here.rotations[0].T
    np.testing.assert_allclose(change[1], [0, 1, 0], atol=1e-10)
    np.testing.assert_allclose(change[:, 1], [0, 1, 0], atol=1e-10)
    np.testing.assert_allclose(there.rotations, change @ here.rotations, atol=1e-10)
    np.testing.assert_allclose(there.translations, here.translations @ change.T, atol=1e-10)


def test_a_third_of_tilted_cameras_moves_gravity_little():
    rotations = np.stack([np.eye(3)] * 20 + [about((1, 0, 0), 60)] * 9)
    # 20 of 29 agree exactly: the median is theirs, the mean would be 18° off.
    down = gravity(Trajectory(tuple(map(str, range(29))), rotations, np.zeros((29, 3))))
    assert np.rad2deg(np.arccos(down[1])) < 0.01


def test_as_many_up_as_down():
    rotations = np.stack([np.eye(3), np.diag([1.0, -1.0, -1.0])])
    levelled, _ = level(Trajectory(("0", "1"), rotations, np.zeros((2, 3))))
    np.testing.assert_allclose(levelled.rotations[0], np.eye(3), atol=1e-12)
