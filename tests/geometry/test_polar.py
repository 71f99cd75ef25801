import numpy as np
import pytest

from panoplan.geometry.polar import (
    PROFILE_BINS,
    at_boundaries,
    intruding_shares,
    intrusions,
    mutual_overlaps,
    passing_votes,
    profile_rays,
    range_profile,
    signed_distance_sums,
    star_evidence,
)
from panoplan.geometry.sphere import column_heading


def _circle(radius, width=720):
    heading = column_heading(np.arange(width), width)
    return radius * np.stack([np.sin(heading), np.cos(heading)], axis=1)


def test_profile_of_a_circle_and_of_a_gap():
    points = _circle(2.0)
    points[90:270] = np.nan
    profile = range_profile(points)
    known = np.isfinite(profile)
    np.testing.assert_allclose(profile[known], 2.0, rtol=1e-6)
    # A quarter of the columns.
    assert (~known).sum() == pytest.approx(PROFILE_BINS / 4, abs=2)


@pytest.mark.parametrize("width", [16, 64, 200, 256])
def test_profile_of_few_columns_is_known_between_neighbours_only(width):
    points = _circle(2.0, width)
    np.testing.assert_allclose(range_profile(points), 2.0, rtol=1e-6)
    points[width // 2] = np.nan
    assert np.isnan(range_profile(points)).sum() == pytest.approx(2 * PROFILE_BINS / width, abs=1)


def test_cells_inside_are_free_and_those_beyond_speak_against():
    profile = np.full(360, 1.0)
    free, against = star_evidence(np.zeros(2), profile, 2.0, 0.3, 0.1, 0.1, (-25, -25), (50, 50))
    at = (np.arange(50) - 25 + 0.5) * 0.1
    distance = np.hypot(at[:, None], at[None, :])
    np.testing.assert_array_equal(free == 1, distance < 1.0)
    np.testing.assert_array_equal(against == 1, (distance >= 1.0) & (distance < 1.3))
    np.testing.assert_array_equal(np.isclose(against, 0.1), (distance >= 1.3) & (distance <= 2.0))
    assert free.sum() * 0.01 == pytest.approx(np.pi, rel=0.02)


def test_the_first_axis_lies_a_quarter_turn_clockwise_of_the_second():
    profile = np.full(360, 1.0)
    heading = column_heading(np.arange(360), 360)
    profile[np.abs(heading - np.pi / 2) < 0.3] = 2.0
    free, _ = star_evidence(np.zeros(2), profile, 3.0, 0.0, 0.0, 0.1, (-30, -30), (60, 60))
    assert free[45, 30] == 1
    assert free[30, 45] == 0
    assert free[15, 30] == 0


def _square_profile(camera, half, bins=1024):
    """Ranges from a camera to the square [-half, half]²."""
    angle = 2 * np.pi * (np.arange(bins) + 0.5) / bins - np.pi
    ahead = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    with np.errstate(divide="ignore"):
        to_wall = np.where(ahead > 0, half - camera, -half - camera) / ahead
    return to_wall.min(axis=1)


def test_signed_distance_along_the_ray_is_truncated_and_weighted():
    camera = np.array([0.05, 0.05])
    profile = _square_profile(camera, 1.0)
    total, weight = signed_distance_sums(
        camera[None],
        profile[None],
        np.full((1, 1024), 0.3),
        0.2,
        0.4,
        0.5,
        1.3,
        0.1,
        (0, 0),
        (15, 1),
    )
    distance = total[:14, 0] / weight[:14, 0]
    # Cell (i, 0) lies (i + ½)/10 - 0.05 = i/10 in front of the camera, the wall at 0.95.
    assert distance[[0, 7]] == pytest.approx([0.2, 0.2])
    assert distance[[8, 9, 10, 11]] == pytest.approx([0.15, 0.05, -0.05, -0.15], abs=1e-4)
    assert distance[12] == pytest.approx(-0.2)
    assert weight[[0, 11], 0] == pytest.approx([4.0, 4.0])
    assert weight[12, 0] == pytest.approx(2.0)
    assert weight[[13, 14], 0] == pytest.approx([2.0, 0.0])


def test_unknown_headings_say_nothing():
    profile = np.full((1, 64), np.nan)
    profile[0, :32] = 1.0
    total, weight = signed_distance_sums(
        np.zeros((1, 2)), profile, np.ones((1, 64)), 0.2, 0.0, 0.1, 9.0, 0.1, (-8, -8), (16, 16)
    )
    # The first half of the headings, from -π to 0, has x < 0.
    assert (weight[:7] > 0).all()
    assert (weight[9:] == 0).all()
    assert (total[9:] == 0).all()


def test_votes_of_views_that_pass_and_that_end():
    cameras = np.array([[0.0, 0.0], [0.5, 0.0]])
    profiles = np.stack([_square_profile(c, 1.0) for c in cameras])
    points = np.array([[-0.5, 0.0], [1.05, 0.0], [1.3, 0.0]])
    through, ending = passing_votes(cameras, profiles, points, 0.1)
    assert through.tolist() == [2, 0, 0]
    assert ending.tolist() == [0, 2, 0]


def test_cameras_near_a_boundary_and_deep_inside_none():
    spots = np.array([[0.0, 0.0], [0.7, 0.0], [0.93, 0.0], [1.05, 0.0], [1.4, 0.0]])
    profiles = np.stack([_square_profile(np.zeros(2), 1.0)] + [np.full(1024, 1e-3)] * 4)
    # The second is deep inside the first view, the last one far outside of all.
    assert at_boundaries(spots, profiles, 10.0, 0.1).tolist() == [False, False, True, True, False]
    assert not at_boundaries(spots, profiles, 0.01, 0.1).any()
    # Deep inside one view and near another's boundary is no doorway.
    inside = np.array([[0.0, 0.0], [0.93, 0.0], [0.9, 0.0]])
    both = np.stack([_square_profile(np.zeros(2), half) for half in (1.0, 1e-3, 3.0)])
    assert not at_boundaries(inside, both, 10.0, 0.1)[1]
    assert at_boundaries(inside[:2], both[:2], 10.0, 0.1)[1]


def test_share_of_points_that_another_view_sees_through():
    circle = 2.0 * profile_rays(64)
    offsets = np.stack([circle, 0.5 * circle])
    profiles = np.array([range_profile(ring) for ring in offsets])
    scales = np.array([0.0, 0.5, 0.7, 1.0])

    def shares(positions, rises=(0.0, 0.0), seen=offsets):
        where = np.array(positions, dtype=float)
        return intruding_shares(seen, profiles, where, np.array(rises), scales, 0.3, 0.1)

    # The small circle moves out of the large one: of 128 points, those lie inside the other that
    # are nearer to its centre than 1.7, or than 0.7.
    found = shares([[0, 0], [3, 0]])
    assert found[0] == 0.5
    assert found[0] > found[1] > found[2] > found[3] == 0.0
    heading = (np.arange(64) + 0.5) * 2 * np.pi / 64
    of_small = np.hypot(1.5 + np.sin(heading), np.cos(heading))
    of_large = np.hypot(1.5 - 2 * np.sin(heading), 2 * np.cos(heading))
    assert found[1] == (np.sum(of_small < 1.7) + np.sum(of_large < 0.7)) / 128
    # A raised camera's circle grows with the scale, until it holds the other one.
    grown = shares([[0, 0], [0, 0]], (0.0, 1.5))
    assert list(grown > 0) == [True, False, False, True]
    # Unknown columns count on neither side.
    half = offsets.copy()
    half[1, ::2] = np.nan
    assert shares([[0, 0], [0, 0]], seen=half)[0] == pytest.approx(32 / 96)
    assert not shares([[0, 0], [0, 0]], seen=np.full_like(offsets, np.nan)).any()


def test_overlap_of_two_squares_over_the_smaller():
    cameras = np.array([[0.0, 0.0], [0.0, 0.0], [5.0, 0.0]])
    profiles = np.stack([_square_profile(np.zeros(2), half) for half in (1.0, 0.5, 1.0)])
    common = mutual_overlaps(cameras, profiles, 10.0, 0.02)
    assert common[0, 1] == pytest.approx(1.0, abs=0.01)
    assert common[0, 2] == 0.0
    moved = np.array([[0.0, 0.0], [1.0, 0.3], [5.0, 0.0]])
    half_off = mutual_overlaps(moved, profiles[[0, 0, 0]], 10.0, 0.02)
    assert half_off[0, 1] == pytest.approx(0.5 * 0.85, abs=0.02)
    assert (common == common.T).all()


def test_a_view_that_knows_nothing_overlaps_none_and_half_a_view_half():
    square = _square_profile(np.zeros(2), 1.0)
    half = np.where(np.arange(1024) < 512, square, np.nan)
    profiles = np.stack([square, np.full(1024, np.nan), half])
    common = mutual_overlaps(np.zeros((3, 2)), profiles, 10.0, 0.02)
    assert common[1].tolist() == [0.0, 1.0, 0.0]
    assert common[0, 2] == pytest.approx(1.0, abs=0.01)
    shifted = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    # The half that it sees is then the right half of the whole, all of it.
    assert mutual_overlaps(shifted, profiles, 10.0, 0.02)[0, 2] == pytest.approx(1.0, abs=0.01)


def test_intrusion_of_one_circle_into_another():
    """Of the unit circle, what lies within 0.75 of (1.5, 0): cos θ > (3.25 − 0.5625) / 3."""
    cameras = np.array([[0.0, 0.0], [1.5, 0.0]])
    profiles = np.ones((2, 1024))
    sigmas = np.full((2, 1024), 0.01)
    there = (cameras, profiles, sigmas)
    shares = intrusions(*there, *there, 0.25, 4.0)
    expected = np.arccos((3.25 - 0.75**2) / 3) / np.pi
    np.testing.assert_allclose(shares, [[0, expected], [expected, 0]], atol=2e-3)
    # Not where it may be the ranges' error, nor where they say nothing.
    assert intrusions(cameras, profiles, 10 * sigmas, *there, 0.25, 4.0)[0, 1] < expected
    assert not intrusions(cameras, profiles, 50 * sigmas, *there, 0.25, 4.0).any()
    assert not intrusions(*there, *there, 0.25, 0.9).any()
