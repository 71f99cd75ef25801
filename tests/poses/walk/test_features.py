import numpy as np

from panoplan.poses.walk.features import Features, Places, matches, sharpness


def features(descriptors):
    rows = np.asarray(descriptors, dtype=np.float32)
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    return Features(np.zeros((len(rows), 2)), rows, rows[:128])


def test_points_alike_are_matched_both_ways():
    rng = np.random.default_rng(0)
    one = rng.random((40, 128))
    order = rng.permutation(40)
    told = matches(features(one), features(one[order] + 0.01 * rng.random((40, 128))))
    assert len(told) == 40
    np.testing.assert_array_equal(order[told[:, 1]], told[:, 0])


def test_points_that_look_like_two_others_are_not_matched():
    one = np.eye(128)[:3]
    near = [np.eye(128)[0] + 0.1 * np.eye(128)[k] for k in (5, 6)]
    other = np.stack([*near, np.eye(128)[2]])
    told = matches(features(one), features(other))
    assert told.tolist() == [[2, 2]]


def test_too_few_points_give_no_match():
    empty = Features(np.zeros((0, 2)), np.zeros((0, 128), np.float32), np.zeros((0, 128)))
    assert matches(empty, features(np.eye(128)[:5])).shape == (0, 2)


def test_a_place_is_found_among_others():
    rng = np.random.default_rng(1)
    rooms = [rng.random((60, 128)) ** 4 for _ in range(5)]
    places = Places()
    for room in rooms:
        places.add(features(room))
    again = features(rooms[3] + 0.01 * rng.random((60, 128)))
    assert places.like(again, 5, 2)[0] == 3
    assert 3 not in places.like(again, 3, 2)
    assert places.like(again, 0, 2) == []


def test_blur_is_less_sharp_and_exposure_is_not():
    rng = np.random.default_rng(2)
    sharp = rng.integers(0, 200, (64, 128)).astype(np.uint8)
    blurred = (sharp / 4 + np.roll(sharp, 2, 0) / 4 + np.roll(sharp, 2, 1) / 2).astype(np.uint8)
    assert sharpness(blurred) < 0.95 * sharpness(sharp)
    np.testing.assert_allclose(sharpness(sharp // 2), sharpness(sharp), rtol=0.02)
    assert sharpness(np.full((64, 128), 7, np.uint8)) == 0
