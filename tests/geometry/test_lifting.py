import numpy as np
import pytest

from panoplan.geometry.lifting import coincidence, length_evidence, length_pull, triangulated

SIGMA = np.deg2rad(0.3)


def seen_twice(points, heights, yaw, camera):
    away = points - camera
    return np.column_stack(
        [
            np.arctan2(*points.T),
            np.arctan2(heights, np.hypot(*points.T)),
            np.arctan2(*away.T) - yaw,
            np.arctan2(heights, np.hypot(*away.T)),
        ]
    )


@pytest.fixture
def points():
    rng = np.random.default_rng(0)
    return rng.uniform(-3, 3, (40, 2)), rng.choice([-1.0, 0.6], 40) * rng.uniform(0.3, 1, 40)


def test_ranges_are_those_of_the_points_over_the_length(points):
    camera = 2.0 * np.array([np.sin(0.4), np.cos(0.4)])
    matches = seen_twice(*points, 1.1, camera)
    ranges, sigmas = triangulated(matches, 1.1, 0.4, SIGMA)
    assert ranges[:, 0] == pytest.approx(np.hypot(*points[0].T) / 2, rel=1e-6)
    assert ranges[:, 1] == pytest.approx(np.hypot(*(points[0] - camera).T) / 2, rel=1e-6)
    assert np.all(sigmas > 0)


def test_stated_errors_of_ranges_hold(points):
    camera = 2.0 * np.array([np.sin(0.4), np.cos(0.4)])
    matches = seen_twice(*points, 1.1, camera)
    rng = np.random.default_rng(1)
    off = []
    for _ in range(40):
        noisy = matches + 0.1 * SIGMA * rng.standard_normal(matches.shape)
        ranges, sigmas = triangulated(noisy, 1.1, 0.4, 0.1 * SIGMA)
        off.append((2 * ranges[:, 0] / np.hypot(*points[0].T) - 1) / sigmas[:, 0])
    # A heading's error is taken as one of the ray, 1/cos of the elevation larger.
    assert 0.6 < np.sqrt(np.nanmedian(np.square(off)) / 0.455) < 1.3


def test_the_length_at_which_points_lie_on_the_walls_is_told(points):
    logs = np.log(np.arange(0.5, 4.0, 0.02))
    ranges = np.log(np.column_stack([np.hypot(*points[0].T)] * 2) / 2.0)
    surfaces = np.log(np.column_stack([np.hypot(*points[0].T)] * 2))
    surfaces[:8] += 0.7  # furniture before the wall
    surfaces[8:14] -= 0.9  # seen through a door
    solid = np.zeros((40, 2), dtype=bool)
    args = (np.full((40, 2), 0.05), np.full(40, 0.9), solid, np.arange(40))
    wall = np.zeros(40, dtype=bool)
    told = length_evidence(logs, ranges, surfaces, *args, wall, 9.0, 4.0)
    assert np.exp(logs[np.argmax(told)]) == pytest.approx(2.0, rel=0.03)
    assert told.max() > 30
    # All on the floor is worth no more than one floor.
    assert length_evidence(logs, ranges, surfaces, *args, ~wall, 3.0, 4.0).max() == 4.0
    information, gradient = length_pull(ranges + np.log(1.94) - surfaces, *args[:3])
    assert gradient / information == pytest.approx(np.log(2.0 / 1.94), abs=0.01)


def test_points_beyond_a_door_do_not_pull_the_length_onto_its_leaf(points):
    """More than half of what both cameras see lies in one room, as far beyond the doors between."""
    logs = np.log(np.arange(0.5, 4.0, 0.02))
    ranges = np.log(np.column_stack([np.hypot(*points[0].T)] * 2) / 2.0)
    surfaces = ranges + np.log(2.0)
    doors = np.zeros((40, 2), dtype=bool)
    doors[:22] = True
    surfaces[:22] -= 1.2
    wall = np.zeros(40, dtype=bool)
    rest = (np.arange(40), wall, 9.0, 4.0)
    stated = (np.full((40, 2), 0.05), np.full(40, 0.9))
    blind = length_evidence(logs, ranges, surfaces, *stated, np.zeros_like(doors), *rest)
    told = length_evidence(logs, ranges, surfaces, *stated, doors, *rest)
    assert np.exp(logs[np.argmax(blind)]) == pytest.approx(2.0 * np.exp(-1.2), rel=0.03)
    assert np.exp(logs[np.argmax(told)]) == pytest.approx(2.0, rel=0.03)


def rectangle(width, depth, about, count=256):
    """Ranges to a rectangle's walls at even headings about a point inside."""
    heading = 2 * np.pi * (np.arange(count) + 0.5) / count - np.pi
    s, c = np.sin(heading), np.cos(heading)
    with np.errstate(divide="ignore"):
        ranges = np.minimum(
            np.where(s > 0, width - about[0], about[0]) / np.abs(s),
            np.where(c > 0, depth - about[1], about[1]) / np.abs(c),
        )
    return ranges, np.column_stack([ranges * s, ranges * c])


def test_one_room_seen_twice_fits_itself_where_it_is():
    a, b = np.array([1.0, 1.5]), np.array([2.6, 2.0])
    ranges, _ = rectangle(4, 3, a, 1024)
    _, walls = rectangle(4, 3, b)
    places = np.array([b - a, b - a + [0.8, 0.0], [9.0, 0.0]])
    same, other = coincidence(
        walls, np.full(256, 0.03), 0.0, places, np.log(ranges), np.full(1024, 0.03)
    ).T
    assert same[0] > 1.3
    assert same[0] > same[1] + 0.8
    assert other[0] > -0.2 or same[0] > 0
    # Far away nothing contradicts, and it is not the same room.
    assert other[2] == 0.0
    assert same[2] < -1.0


def test_walls_inside_free_space_contradict():
    ranges, _ = rectangle(6, 6, np.array([3.0, 3.0]), 1024)
    _, walls = rectangle(1, 1, np.array([0.5, 0.5]))
    same, other = coincidence(
        walls, np.full(256, 0.03), 0.0, np.array([[1.5, 0.0]]), np.log(ranges), np.full(1024, 0.03)
    )[0]
    assert same < -0.5
    assert other < -0.5
