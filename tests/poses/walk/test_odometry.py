import subprocess
import sys

import numpy as np
import pytest

from panoplan.geometry.similarity import fit_similarity
from panoplan.poses.walk.features import Extractor
from panoplan.poses.walk.odometry import Odometry, OdometrySettings

WIDTH, HEIGHT = 512, 256


def errors(poses, truth):
    """Position errors in metres and turn errors in degrees after the best similarity."""
    numbers = sorted(poses)
    positions = np.array([poses[n].translation for n in numbers])
    true = truth.translations[numbers]
    fit = fit_similarity(positions, true)
    moved = fit(positions)
    turns = [
        np.degrees(
            np.arccos(
                np.clip((np.trace(truth.rotations[n].T @ fit.rotation @ p.rotation) - 1) / 2, -1, 1)
            )
        )
        for n, p in poses.items()
    ]
    return np.linalg.norm(moved - true, axis=1), np.array(turns)


@pytest.fixture(scope="module")
def followed(walk_features):
    odometry = Odometry(WIDTH, HEIGHT)
    placed = [told for features in walk_features for told in odometry.add(features)]
    return odometry, placed


def test_every_panorama_of_a_walk_gets_its_pose(followed, walk_poses):
    odometry, placed = followed
    assert odometry.lost == ()
    assert sorted(told.number for told in placed) == list(range(len(walk_poses)))
    (poses,) = odometry.poses()
    off, turned = errors(poses, walk_poses)
    assert off.max() < 0.03
    assert turned.max() < 0.5


def test_poses_at_the_time_they_are_given_are_near_the_truth(followed, walk_poses):
    _, placed = followed
    off, turned = errors({told.number: told.pose for told in placed}, walk_poses)
    assert off.max() < 0.06
    assert turned.max() < 1


def test_the_same_panoramas_give_the_same_poses(followed, walk_features):
    odometry = Odometry(WIDTH, HEIGHT)
    for features in walk_features:
        odometry.add(features)
    ((one,), (other,)) = odometry.poses(), followed[0].poses()
    for number in one:
        np.testing.assert_array_equal(one[number].translation, other[number].translation)


@pytest.mark.parametrize("least", [25, 20])
def test_walks_in_two_places_are_two_maps(walk_features, walk_pictures, walk_poses, least):
    # The second place is the first one in a mirror, where nothing but chance looks alike: 20
    # points do, so that joining is tried and undone.
    extract, last = Extractor(), range(len(walk_pictures) - 6, len(walk_pictures))
    odometry = Odometry(WIDTH, HEIGHT, OdometrySettings(least_pair_inliers=least))
    for features in walk_features[:10]:
        odometry.add(features)
    for number in last:
        odometry.add(extract(np.ascontiguousarray(walk_pictures[number][:, ::-1, 0])))
    odometry.finish()
    first, second = odometry.poses()
    assert max(first) < 10 <= min(second)
    assert len(second) == 6
    off, _ = errors(first, walk_poses)
    assert off.max() < 0.05


def test_two_maps_of_one_place_are_joined_at_the_end(walk_features, walk_poses):
    # From both ends to the middle: the ends have nothing in common before.
    count = len(walk_features)
    order = [*range(6), *range(count - 1, 5, -1)]
    odometry = Odometry(WIDTH, HEIGHT)
    begun = {told.map for n in order for told in odometry.add(walk_features[n])}
    assert len(begun) == 2
    odometry.finish()
    (poses,) = odometry.poses()
    assert len(poses) == count
    off, _ = errors({order[n]: pose for n, pose in poses.items()}, walk_poses)
    assert off.max() < 0.03


def test_a_lost_camera_finds_its_place_again(walk_features, walk_poses):
    blank = type(walk_features[0])(
        np.zeros((0, 2)), np.zeros((0, 128), np.float32), np.zeros((0, 128), np.float32)
    )
    odometry = Odometry(WIDTH, HEIGHT)
    for features in walk_features[:8]:
        odometry.add(features)
    for _ in range(3):
        assert odometry.add(blank) == []
    (told,) = odometry.add(walk_features[4])
    assert told.map == 0
    assert odometry.lost == (8, 9, 10)
    (poses,) = odometry.poses()
    off = np.linalg.norm(poses[11].translation - poses[4].translation)
    step = np.linalg.norm(poses[4].translation - poses[3].translation)
    assert off < 0.1 * step


def test_without_pycolmap_the_extra_is_named():
    code = (
        "import sys; sys.modules['pycolmap'] = None\n"
        "from panoplan.poses.walk.odometry import Odometry\nOdometry(512, 256)"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "pip install 'panoplan[images]'" in ran.stderr
