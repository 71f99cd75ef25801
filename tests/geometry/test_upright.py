import numpy as np
import pytest

from panoplan.geometry.upright import FLOOR, WALL, Caps, evidence, pull, refine, vote

SIGMA = np.deg2rad(0.3)
CAP = 6.0
CAPS = Caps(np.deg2rad(12.0), CAP, 8.0)


def on_walls(matches):
    return np.full(len(matches), WALL)


def seen(points, heights, yaw=0.0, camera=(0.0, 0.0)):
    """(N, 2) headings and elevations of points as a level camera sees them."""
    away = np.asarray(points) - np.asarray(camera)
    return np.column_stack(
        [np.arctan2(away[:, 0], away[:, 1]) - yaw, np.arctan2(heights, np.hypot(*away.T))]
    )


def true_matches(count, yaw, direction, length, rng, noise_deg=0.2):
    points = rng.uniform(-3, 3, (count, 2))
    heights = rng.choice([-1.0, 0.7], count) * rng.uniform(0.4, 1, count)
    camera = length * np.array([np.sin(direction), np.cos(direction)])
    both = np.hstack([seen(points, heights), seen(points, heights, yaw, camera)])
    return both + np.deg2rad(noise_deg) * rng.standard_normal(both.shape)


def chance_matches(count, rng):
    headings = rng.uniform(-np.pi, np.pi, (count, 2))
    elevations = rng.choice([-1, 1], (count, 1)) * rng.uniform(0.03, 0.8, (count, 2))
    return np.column_stack([headings[:, 0], elevations[:, 0], headings[:, 1], elevations[:, 1]])


def best_cell(grid):
    y, d = np.unravel_index(np.argmax(grid), grid.shape)
    return 2 * np.pi * y / grid.shape[0], 2 * np.pi * d / grid.shape[1]


def test_one_point_tells_the_direction():
    # The second camera is 2 ahead of the first one and looks to the right; a point on the floor
    # ahead of both, 3 away from the first one and 1 from the second.
    match = np.array([[0.0, -np.arctan2(1, 3), -np.pi / 2, -np.arctan2(1, 1)]])
    at, _, inlier = evidence(match, np.ones(1), on_walls(match), np.pi / 2, 0.0, SIGMA, CAPS)
    behind, _, _ = evidence(match, np.ones(1), on_walls(match), np.pi / 2, np.pi, SIGMA, CAPS)
    aside, _, _ = evidence(match, np.ones(1), on_walls(match), np.pi / 2, 0.2, SIGMA, CAPS)
    # Errors of elevation lie along the direction: what is left is the heading's, of 1/sin² = 10
    # and 2 in units of 3² and 1, over the 2 between the cameras.
    sigma = SIGMA * np.sqrt(1 + 3**2 + 1 + 1) / 2
    assert at == pytest.approx(np.log(0.02 + 0.98 * np.sqrt(2 * np.pi) / sigma), abs=1e-6)
    assert inlier[0] > 0.99
    assert behind == aside == 0.0


def test_matches_at_the_horizon_are_no_evidence():
    rng = np.random.default_rng(0)
    flat = chance_matches(300, rng)
    flat[:, [1, 3]] = np.sign(flat[:, [1, 3]]) * np.deg2rad(0.2)
    for yaw in (0.0, 1.0, 2.0):
        assert evidence(flat, np.ones(300), on_walls(flat), yaw, 0.5, SIGMA, CAPS)[0] < 1.0


@pytest.mark.parametrize(("yaw", "direction"), [(0.0, 0.0), (1.0, 2.5), (-2.9, -1.2)])
def test_vote_and_refinement_find_one_inlier_among_seven(yaw, direction):
    rng = np.random.default_rng(1)
    matches = np.vstack([true_matches(60, yaw, direction, 2.0, rng), chance_matches(360, rng)])
    prior = np.ones(len(matches))
    grid = vote(matches, prior, np.zeros(240), prior, 120, SIGMA, 0.1)
    fit = refine(matches, prior, on_walls(matches), *best_cell(grid), SIGMA, CAPS)
    off = np.array([fit.yaw - yaw, fit.direction - direction])
    off = (off + np.pi) % (2 * np.pi) - np.pi
    # The normalised error of two unknowns; 13.8 at one in a thousand.
    assert off @ fit.information @ off < 13.8
    assert np.abs(np.rad2deg(off)).max() < 0.6
    assert fit.evidence > 60
    assert fit.share == pytest.approx(1 / 7, abs=0.04)


def test_covariance_holds():
    squares = []
    for seed in range(60):
        matches = true_matches(40, 0.7, -0.4, 1.5, np.random.default_rng(seed), noise_deg=0.3)
        fit = refine(matches, np.ones(40), on_walls(matches), 0.71, -0.42, SIGMA, CAPS)
        off = np.array([fit.yaw - 0.7, fit.direction + 0.4])
        squares.append(off @ fit.information @ off)
    assert 1.4 < np.mean(squares) < 2.8  # 2 where it holds


def test_chance_alone_gives_little():
    rng = np.random.default_rng(2)
    for _ in range(5):
        matches = chance_matches(400, rng)
        grid = vote(matches, np.ones(400), np.zeros(240), np.ones(400), 120, SIGMA, 0.1)
        fit = refine(matches, np.ones(400), on_walls(matches), *best_cell(grid), SIGMA, CAPS)
        assert fit.evidence < 12


def test_one_poster_is_capped():
    rng = np.random.default_rng(3)
    points = np.column_stack([rng.uniform(0.4, 0.5, 100), np.full(100, 3.0)])
    heights = rng.uniform(0.4, 0.5, 100)
    matches = np.hstack([seen(points, heights), seen(points, heights, 0.3, (0.5, 1.0))])
    direction = np.arctan2(0.5, 1)
    walls = on_walls(matches)
    total, _, _ = evidence(matches, np.ones(100), walls, 0.3, direction, SIGMA, CAPS)
    assert total <= 4 * CAP
    uncapped = CAPS._replace(a_cell=1e9)
    assert evidence(matches, np.ones(100), walls, 0.3, direction, SIGMA, uncapped)[0] > 200


def test_a_floor_is_capped_as_one():
    matches = true_matches(60, 0.5, 1.0, 2.0, np.random.default_rng(6))
    floor = np.where(matches[:, 1] < 0, FLOOR, WALL)
    args = (0.5, 1.0, SIGMA, CAPS)
    whole = evidence(matches, np.ones(60), on_walls(matches), *args)[0]
    upper = evidence(matches[floor == WALL], np.ones(np.sum(floor == WALL)),
                     floor[floor == WALL], *args)[0]  # fmt: skip
    assert whole > upper + 30
    assert evidence(matches, np.ones(60), floor, *args)[0] == pytest.approx(upper + 8.0, abs=2.0)


def test_the_pull_is_towards_the_optimum():
    matches = true_matches(80, 0.5, 1.0, 2.0, np.random.default_rng(7), noise_deg=0.01)
    information, gradient, inlier = pull(matches, np.ones(80), 0.505, 0.99, SIGMA)
    step = np.linalg.solve(information, gradient)
    assert step == pytest.approx([-0.005, 0.01], abs=1e-3)
    assert inlier.min() > 0.9


def test_a_turned_pair_is_the_same_pair():
    rng = np.random.default_rng(4)
    matches = np.vstack([true_matches(50, 0.5, 1.0, 2.0, rng), chance_matches(50, rng)])
    other = matches[:, [2, 3, 0, 1]]
    walls = on_walls(matches)
    here = evidence(matches, np.ones(100), walls, 0.5, 1.0, SIGMA, CAPS)[0]
    there = evidence(other, np.ones(100), walls, -0.5, 1.0 + np.pi - 0.5, SIGMA, CAPS)[0]
    assert here == pytest.approx(there, rel=1e-6)


def test_a_prior_of_yaws_decides_between_equals():
    match = np.array([[0.3, -0.4, 0.1, -0.5]])
    yaw_prior = np.zeros(240)
    yaw_prior[80] = 3.0
    grid = vote(match, np.ones(1), yaw_prior, np.ones(1), 120, SIGMA, 0.1)
    assert np.unravel_index(np.argmax(grid), grid.shape)[0] == 80
