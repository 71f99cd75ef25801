import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from panoplan.poses.walk.features import sharpness
from panoplan.poses.walk.keyframes import (
    EVERY_IMAGE,
    KeyframeChooser,
    KeyframeSettings,
    parallax_deg,
)


def unit(rows):
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def test_turning_is_no_parallax():
    one = unit(np.random.default_rng(0).normal(size=(50, 3)))
    other = one @ Rotation.from_rotvec([0.1, 1.0, 0.0]).as_matrix().T
    assert parallax_deg(one, other) < 1e-4


def test_moving_is_parallax_whatever_the_turn_and_a_few_wrong_matches():
    rng = np.random.default_rng(1)
    points = 3 * unit(rng.normal(size=(200, 3)))
    other = unit(points - [0.15, 0, 0]) @ Rotation.from_rotvec([0, 0.6, 0]).as_matrix().T
    other[:30] = unit(rng.normal(size=(30, 3)))
    # 15 cm across at 3 m are 2.9°, less along the way.
    assert parallax_deg(unit(points), other) == pytest.approx(2.4, abs=0.5)


def chosen(features, sharp, settings):
    choose = KeyframeChooser(512, 256, settings)
    return [k for k, f in enumerate(features) if choose(f, sharp[k])]


def test_a_camera_that_stands_still_gives_one_keyframe(walk_features):
    still = [walk_features[0]] * 4 + [walk_features[2]] * 3
    assert chosen(still, [0.2] * 7, KeyframeSettings()) == [0, 4]
    assert chosen(still, [0.2] * 7, EVERY_IMAGE) == [0, 4]


def test_a_blurred_panorama_is_passed_over_unless_it_is_late(walk_features):
    sharp = [0.2, 0.2, 0.05, 0.2, 0.2]
    patient = KeyframeSettings(most_parallax_deg=60, least_overlap=0.0)
    assert chosen(walk_features[:5], sharp, patient) == [0, 1, 3, 4]
    hasty = KeyframeSettings(most_parallax_deg=0.5)
    assert chosen(walk_features[:5], sharp, hasty) == [0, 1, 2, 3, 4]


def test_pictures_of_one_walk_are_equally_sharp(walk_pictures):
    values = [sharpness(p[..., 0]) for p in walk_pictures]
    assert min(values) > 0.75 * np.median(values)
