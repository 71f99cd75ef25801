import numpy as np
import pytest
from tests.metrics.plans import FLAT, square, turned

from panoplan.errors import InputError
from panoplan.metrics.corners import (
    all_corners,
    both_ways,
    corner_distances,
    corner_grid,
    merged,
    paper_score,
    released_score,
    score_within,
)
from panoplan.metrics.rooms import Match

# A scene of 10 m by 4 m: the grid is 11 m wide, so that a pixel is 11/256 m.
SCENE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [0.0, 4.0]])
PX = 11.0 / 256


def test_the_grid_is_square_and_centred():
    grid = corner_grid(SCENE)
    assert grid.metres_per_px == pytest.approx(PX)
    assert grid.pixels(np.array([[5.0, 2.0]])) == pytest.approx(np.array([[128.0, 128.0]]))
    low = grid.pixels(SCENE).min(axis=0)
    assert low[0] == pytest.approx(0.5 / PX)


def test_a_turned_scene_has_the_same_grid_once_its_axis_is_known():
    angle = 0.4
    grid = corner_grid(turned(SCENE, angle), np.array([np.cos(angle), np.sin(angle)]) * 3.0)
    expected = corner_grid(SCENE).pixels(SCENE)
    assert grid.pixels(turned(SCENE, angle)) == pytest.approx(expected)
    tilted = corner_grid(turned(SCENE, angle))
    assert tilted.metres_per_px != pytest.approx(PX)


@pytest.mark.parametrize(("distance", "hits"), [(9.9, 1), (10.1, 0)])
@pytest.mark.parametrize("direction", [0.0, 0.7, 2.0])
def test_a_corner_is_found_within_ten_pixels(distance, hits, direction):
    shift = distance * PX * np.array([np.cos(direction), np.sin(direction)])
    score = paper_score(SCENE, SCENE[:1] + shift, corner_grid(SCENE))
    assert (score.hits, score.true, score.predicted) == (hits, 4, 1)


def test_of_several_predictions_one_counts():
    predicted = SCENE[0] + PX * np.array([[1.0, 0.0], [2.0, 0.0], [0.0, 3.0]])
    score = paper_score(SCENE, predicted, corner_grid(SCENE))
    assert score.recall == pytest.approx(1 / 4)
    assert score.precision == pytest.approx(1 / 3)


def test_corners_of_two_rooms_at_one_place_are_two():
    both = np.concatenate([SCENE, SCENE[:1] + 0.1])
    assert paper_score(both, both, corner_grid(both)).recall == 1.0
    # One prediction cannot stand for both of them.
    assert paper_score(both, SCENE[:1], corner_grid(both)).hits == 1


def test_chains_of_near_corners_are_merged_into_their_mean():
    chain = np.array([[0.0, 0.0], [0.4, 0.0], [5.0, 5.0], [0.8, 0.0]])
    assert merged(chain, 0.5) == pytest.approx(np.array([[0.4, 0.0], [5.0, 5.0]]))
    assert merged(np.array([[0.0, 0.0], [0.5, 0.0]]), 0.5).shape == (2, 2)
    assert merged(np.empty((0, 2)), 0.5).shape == (0, 2)


def test_released_variant_measures_by_the_larger_coordinate():
    # 9 px in both directions is 12.7 px apart, but 9 in the released measure.
    shifted = SCENE[:1] + 9 * PX
    assert paper_score(SCENE, shifted, corner_grid(SCENE)).hits == 0
    assert released_score(SCENE, shifted, corner_grid(SCENE)).hits == 1


def test_released_variant_names_recall_and_precision_rightly():
    score = released_score(SCENE, SCENE[:1], corner_grid(SCENE))
    assert (score.recall, score.precision) == (0.25, 1.0)


def test_released_variant_merges_before_it_counts():
    doubled = np.concatenate([SCENE, SCENE + [0.2, 0.0]])
    score = released_score(doubled, doubled, corner_grid(doubled))
    assert (score.hits, score.true, score.predicted) == (4, 4, 4)


def test_released_variant_looks_at_the_closest_only():
    # Both true corners are closest to the first prediction; the second is left alone.
    true = np.array([[0.0, 0.0], [0.6, 0.0], [10.0, 4.0]])
    predicted = np.array([[0.25, 0.0], [0.25, 0.51]])
    grid = corner_grid(true)
    shift = PX * 100
    assert released_score(true + shift, predicted + shift, corner_grid(true + shift)).hits == 1
    assert paper_score(true, np.array([[0.25, 0.0], [0.6, 0.3]]), grid).hits == 2


def test_nothing_predicted():
    grid, nothing = corner_grid(SCENE), np.empty((0, 2))
    for score in (paper_score(SCENE, nothing, grid), released_score(SCENE, nothing, grid)):
        assert (score.recall, score.precision) == (0.0, 0.0)
    assert score_within(SCENE, nothing, 0.1).recall == 0.0


def test_recall_within_a_distance_is_one_to_one():
    predicted = SCENE + [0.0, 0.09]
    assert score_within(SCENE, predicted, 0.1).hits == 4
    assert score_within(SCENE, predicted, 0.08).hits == 0
    # The best matching pairs 0-1 and 1-0 where greedy would stop after 0-0.
    true = np.array([[0.0, 0.0], [0.2, 0.0]])
    ours = np.array([[0.05, 0.0], [-0.2, 0.0]])
    assert score_within(true, ours, 0.21).hits == 2


def test_corner_distances_are_told_both_ways():
    # The prediction has one corner more, 0.5 m from the nearest true one.
    true = [square(0, 0)]
    ours = [np.insert(square(0, 0) + [0.0, 0.03], 1, [0.5, 0.0], axis=0)]
    there, back = both_ways(true, ours, [Match(0, 0, 0.9)])
    assert (there.count, back.count) == (4, 5)
    assert there.median_cm == pytest.approx(3.0)
    assert dict(there.within)[5.0] == 1.0
    assert dict(back.within)[25.0] == pytest.approx(4 / 5)
    assert dict(back.within)[50.0] == 1.0


def test_no_matched_room_has_no_corner_distance():
    assert corner_distances([], []).median_cm is None


def test_a_scene_without_extent_is_refused():
    with pytest.raises(InputError, match="at least one room"):
        corner_grid(np.empty((0, 2)))
    with pytest.raises(InputError, match="extent"):
        corner_grid(np.zeros((3, 2)))
    with pytest.raises(InputError, match="direction"):
        corner_grid(SCENE, np.zeros(2))


def test_all_corners():
    assert len(all_corners(FLAT)) == 14
    assert all_corners([]).shape == (0, 2)
