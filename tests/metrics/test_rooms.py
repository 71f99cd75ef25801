import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.metrics.plans import LEFT, RIGHT, square

from panoplan.metrics.rooms import (
    Score,
    area_errors,
    floor_iou,
    iou,
    iou_matrix,
    matching,
    of_unvisited,
    outline_distance,
    overlap_area,
    region,
    room_score,
    visited_rooms,
)


def _regions(*polygons):
    return [region(polygon) for polygon in polygons]


def test_iou_of_a_shifted_square():
    # 2 x 2 squares half a metre apart: 1.5 x 2 in common, 5 in all.
    assert iou(*_regions(square(0, 0), square(0.5, 0))) == pytest.approx(3 / 5)


def test_holes_are_no_room():
    holed = region(square(0, 0), (square(0.5, 0.5, 1.0)[::-1],))
    assert holed.area == pytest.approx(3.0)
    assert iou(holed, region(square(0, 0))) == pytest.approx(3 / 4)


def test_a_ring_that_crosses_itself_has_the_area_it_encloses():
    bow = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])
    assert region(bow).area == pytest.approx(2.0)


def test_matching_takes_more_hits_over_a_better_one():
    # The best pair (0, 0) has more IoU than the two others together, but is one hit only.
    overlap = np.array([[0.9, 0.4], [0.4, 0.0]])
    assert [(m.true, m.predicted) for m in matching(overlap, 0.3)] == [(0, 1), (1, 0)]
    assert [(m.true, m.predicted) for m in matching(overlap, 0.5)] == [(0, 0)]


def test_among_equal_hits_the_larger_overlap_is_taken():
    overlap = np.array([[0.5, 0.9], [0.6, 0.5]])
    assert [(m.true, m.predicted) for m in matching(overlap, 0.3)] == [(0, 1), (1, 0)]


def test_a_prediction_stands_for_one_room_only():
    score = room_score(np.array([[0.5], [0.5]]), 0.5)
    assert (score.hits, score.true, score.predicted) == (1, 2, 1)
    assert (score.recall, score.precision) == (0.5, 1.0)


@given(st.integers(0, 5), st.integers(0, 5), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_no_other_matching_has_more_hits(true, predicted, seed):
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching

    overlap = np.random.default_rng(seed).uniform(size=(true, predicted))
    found = matching(overlap, 0.6)
    assert len({m.true for m in found}) == len({m.predicted for m in found}) == len(found)
    most = 0
    if overlap.size:
        most = int((maximum_bipartite_matching(csr_array(overlap >= 0.6)) >= 0).sum())
    assert len(found) == most


def test_nothing_predicted_is_a_score():
    score = room_score(np.zeros((3, 0)), 0.3)
    assert (score.recall, score.precision) == (0.0, 0.0)
    assert Score(0, 0, 2).recall is None


def test_unvisited_rooms_count_neither_for_nor_against():
    # True 0 visited, true 1 not; prediction 1 shows the unvisited one, 2 shows it again.
    overlap = np.array([[0.8, 0.0, 0.0], [0.0, 0.6, 0.4]])
    visited = np.array([True, False])
    assert of_unvisited(overlap, visited) == (1,)
    for threshold in (0.3, 0.7):
        score = room_score(overlap, threshold, visited)
        assert (score.hits, score.true, score.predicted) == (1, 1, 2)


def test_a_prediction_of_both_kinds_of_room_belongs_to_the_better_one():
    visited = np.array([True, False])
    assert of_unvisited(np.array([[0.5], [0.4]]), visited) == ()
    assert of_unvisited(np.array([[0.4], [0.5]]), visited) == (0,)
    assert of_unvisited(np.array([[0.1], [0.2]]), visited) == ()


def test_visited_is_where_a_camera_stands():
    rooms = _regions(LEFT, RIGHT)
    assert visited_rooms(rooms, np.array([[1.0, 1.0], [9.0, 9.0]])).tolist() == [True, False]
    # A corner of the L's bounding box is not in it.
    assert visited_rooms(rooms, np.array([[5.0, 4.5]])).tolist() == [False, False]
    assert visited_rooms(rooms, np.empty((0, 2))).tolist() == [False, False]


def test_area_error_is_positive_where_too_large():
    true, ours = _regions(square(0, 0)), _regions(square(0, 0, 2.2))
    found = matching(iou_matrix(true, ours), 0.5)
    assert area_errors(true, ours, found) == pytest.approx([0.21])


def test_overlap_counts_what_is_claimed_twice():
    assert overlap_area(_regions(square(0, 0), square(1.5, 0))) == pytest.approx(1.0)
    assert overlap_area(_regions(square(0, 0), square(2, 0))) == pytest.approx(0.0)
    assert overlap_area([]) == 0.0


def test_floor_is_the_union():
    halves = _regions(square(0, 0), square(2, 0))
    whole = _regions(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
    assert floor_iou([(halves, whole)]) == pytest.approx(1.0)
    assert floor_iou([(halves, [])]) == 0.0


def test_floors_of_two_storeys_add_up():
    low, high = _regions(square(0, 0)), _regions(square(0, 0, 4.0))
    assert floor_iou([(low, low), (high, high)]) == pytest.approx(1.0)
    assert floor_iou([(low, high), (high, low)]) == pytest.approx(8.0 / 32.0)


def test_outline_distance_of_a_square_in_a_square():
    # A square 0.5 m inside another: each of its points is 0.5 m from the outer outline.
    outer, inner = _regions(square(0, 0, 4.0), square(0.5, 0.5, 3.0))
    assert outline_distance(inner, outer) == pytest.approx(0.5)
    # From the outer: 12 m of edge at 0.5 m and eight pieces of 0.5 m that face a corner,
    # where sqrt(x² + ¼) has the mean (sqrt 2 + asinh 1) / 4 over 0..½.
    facing = (np.sqrt(2) + np.arcsinh(1)) / 4
    expected = (12 * 0.5 + 8 * 0.5 * facing) / 16
    assert outline_distance(outer, inner) == pytest.approx(expected, rel=1e-3)


def test_a_coordinate_of_nearly_nothing_is_nothing():
    """A denormal number in one corner once moved the IoU of a floor by half a per cent."""
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
    nearly = square.copy()
    nearly[0, 1] = 5e-324
    assert region(nearly).equals_exact(region(square), 0.0)
