import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.metrics.plans import CAMERAS, FLAT, LEFT, RIGHT, TOP, plan, square, truth, turned

from panoplan.errors import InputError
from panoplan.metrics.presentation import as_dict, as_table
from panoplan.metrics.report import evaluate


def _figures(report):
    """All numbers of a report but those of the alignment, which a motion may change."""
    data = as_dict(report)
    del data["alignment"]
    return json.loads(json.dumps(data, allow_nan=False), parse_float=lambda x: round(float(x), 5))


def test_a_plan_against_itself_is_perfect():
    report = evaluate(plan(), truth())
    for score in (*report.rooms.scores, *report.rooms.scores_visited):
        assert (score.recall, score.precision) == (1.0, 1.0)
    corner = report.corners
    for score in (
        corner.paper,
        corner.paper_visited,
        corner.released,
        *dict(corner.within).values(),
    ):
        assert (score.recall, score.precision) == (1.0, 1.0)
    assert report.rooms.floor_iou == pytest.approx(1.0)
    assert report.rooms.mean_iou == pytest.approx(1.0)
    assert report.rooms.area_error_mean_abs_percent == pytest.approx(0.0, abs=1e-9)
    assert report.rooms.outline_cm == pytest.approx(0.0, abs=1e-9)
    assert report.rooms.overlap_m2 == pytest.approx(0.0, abs=1e-9)
    assert report.rooms.matching_none == 0
    assert corner.true_to_predicted.median_cm == pytest.approx(0.0, abs=1e-9)
    assert report.trajectory.rmse_cm == pytest.approx(0.0, abs=1e-9)
    assert report.scale_error_percent == pytest.approx(0.0, abs=1e-9)


def test_rooms_no_camera_enters_are_told_apart():
    # The cameras stand in LEFT and RIGHT only; TOP is predicted as well.
    report = evaluate(plan(), truth())
    assert (report.rooms.true, report.rooms.visited) == (3, 2)
    visited = report.rooms.scores_visited[1]
    assert (visited.hits, visited.true, visited.predicted) == (2, 2, 2)
    assert report.corners.paper_visited.true == 10
    without = evaluate(plan((LEFT, RIGHT)), truth())
    assert without.rooms.scores[1].recall == pytest.approx(2 / 3)
    assert without.rooms.scores_visited[1].recall == 1.0
    given_cameras = evaluate(plan(), truth(), visited=np.array([[1.0, 0.0, 1.0]]))
    assert given_cameras.rooms.visited == 1


def test_hand_computed_figures_of_a_shifted_room():
    # Two squares of 2 m; the second is predicted 0.5 m to the right: IoU 3 / 5.
    true = (square(0, 0), square(4, 0))
    report = evaluate(plan((square(0, 0), square(4.5, 0))), truth(true), align="none")
    assert [score.recall for score in report.rooms.scores] == [1.0, 1.0, 0.5]
    assert report.rooms.mean_iou == pytest.approx(0.8)
    assert report.rooms.floor_iou == pytest.approx(7 / 9)
    assert [pair.iou for pair in report.rooms.pairs] == pytest.approx([1.0, 0.6])
    assert report.corners.true_to_predicted.median_cm == pytest.approx(25.0)
    assert dict(report.corners.true_to_predicted.within)[10.0] == 0.5
    assert dict(report.corners.within)[25.0].hits == 4
    # Along the 8 m of one outline: 2 m are 0.5 m off; of the side inside the other square 1 m is
    # 0.5 m off and 1 m is 0.25 m on average; two pieces of 0.5 m are 0.25 m off on average.
    assert report.rooms.pairs[1].outline_cm == pytest.approx(100 * (1 + 0.5 + 0.25 + 0.25) / 8)


@given(st.floats(-np.pi, np.pi), st.tuples(st.floats(-30, 30), st.floats(-30, 30)))
@settings(max_examples=15, deadline=None)
def test_moving_both_changes_nothing(angle, shift):
    rng = np.random.default_rng(5)
    axis = np.array([1.0, 0.2])
    ours = tuple(p + 0.05 * rng.normal(size=p.shape) for p in FLAT)
    still = evaluate(plan(ours), truth(axis=axis), align="none")
    moved = evaluate(
        plan(tuple(turned(p, angle, shift) for p in ours), turned(CAMERAS, angle, shift)),
        truth(
            tuple(turned(p, angle, shift) for p in FLAT),
            turned(CAMERAS, angle, shift),
            axis=turned(axis, angle),
        ),
        align="none",
    )
    a, b = _figures(still), _figures(moved)
    # Whole pixels of the released variant may round the other way.
    for figures in (a, b):
        del figures["corners"]["released"], figures["corners"]["released_visited"]
        for pair in figures["rooms"]["pairs"]:
            pair.update(
                {key: pytest.approx(v, abs=2e-3) for key, v in pair.items() if type(v) is float}
            )
    assert a["corners"] == b["corners"]
    assert a["rooms"]["scores"] == b["rooms"]["scores"]
    assert a["rooms"]["floor_iou"] == pytest.approx(b["rooms"]["floor_iou"], abs=2e-5)


@pytest.mark.parametrize("factor", [0.3, 1.0, 4.0])
def test_alignment_takes_out_a_wrong_scale(factor):
    wrong = plan(tuple(factor * p for p in FLAT), factor * CAMERAS)
    report = evaluate(wrong, truth(), align="scale")
    assert report.rooms.mean_iou == pytest.approx(1.0)
    assert report.alignment.true_from_plan.scale == pytest.approx(1 / factor)
    assert report.scale_error_percent == pytest.approx(100 * (factor - 1))


def test_alignment_takes_out_a_similarity():
    wrong = plan(
        tuple(turned(p, 1.0, (3, 4), 0.4) for p in FLAT), turned(CAMERAS, 1.0, (3, 4), 0.4)
    )
    assert evaluate(wrong, truth(), align="similarity").rooms.mean_iou == pytest.approx(1.0)
    assert evaluate(wrong, truth(), align="scale").rooms.scores[1].hits == 0


def test_scale_error_by_a_given_scale():
    report = evaluate(plan(), truth(), true_ch_per_su=0.4)
    assert report.scale_error_percent == pytest.approx(25.0)


@pytest.mark.parametrize("rooms", [(), (None, None)])
def test_no_room_is_a_score(rooms):
    report = evaluate(plan(rooms), truth())
    for score in (*report.rooms.scores, report.corners.paper, report.corners.released):
        assert (score.recall, score.precision) == (0.0, 0.0)
    assert report.rooms.without_polygon == len(rooms)
    assert report.rooms.predicted == 0
    assert (report.rooms.floor_iou, report.rooms.overlap_m2) == (0.0, 0.0)
    assert report.rooms.mean_iou is None
    assert report.corners.true_to_predicted.median_cm is None
    json.dumps(as_dict(report), allow_nan=False)
    assert "recall 0.000" in as_table(report)


def test_phantoms_and_overlap_are_counted():
    report = evaluate(plan((*FLAT, square(0.5, 0.5, 1.0), square(20, 20))), truth())
    assert report.rooms.matching_none == 2
    assert report.rooms.overlap_m2 == pytest.approx(1.0)
    assert report.rooms.scores[1].precision == pytest.approx(3 / 5)


def test_rooms_of_two_storeys_do_not_overlap():
    two = plan((LEFT, LEFT))
    upstairs = replace(two, rooms=(two.rooms[0], replace(two.rooms[1], level=1)))
    assert evaluate(two, truth()).rooms.overlap_m2 == pytest.approx(12.0)
    assert evaluate(upstairs, truth()).rooms.overlap_m2 == 0.0


def test_partial_rooms_are_another_truth():
    split = truth((np.concatenate([LEFT[:2], TOP[2:] * [4 / 5.8, 1]]),), partial=(LEFT,))
    report = evaluate(plan((LEFT,)), split, rooms="rooms_partial")
    assert report.truth == "rooms_partial"
    assert report.rooms.scores[2].recall == 1.0
    with pytest.raises(InputError, match="true rooms_partial"):
        evaluate(plan(), truth(), rooms="rooms_partial")
    with pytest.raises(InputError, match="'rooms' or"):
        evaluate(plan(), truth(), rooms="labels")


def test_without_true_cameras_nothing_is_visited():
    report = evaluate(plan(), truth(cameras=None), align="none")
    assert (report.rooms.visited, report.rooms.scores_visited) == (None, None)
    assert (report.trajectory, report.scale_error_percent) == (None, None)
    json.dumps(as_dict(report), allow_nan=False)
    assert "visited" not in as_table(report)


def test_dict_has_the_figures_of_the_report():
    report = evaluate(plan((LEFT, RIGHT)), truth())
    data = as_dict(report)
    assert data["rooms"]["scores"][1] == {
        "hits": 2,
        "true": 3,
        "predicted": 2,
        "iou": 0.5,
        "recall": pytest.approx(2 / 3),
        "precision": 1.0,
    }
    assert data["corners"]["within"][0]["cm"] == 10.0
    assert data["alignment"]["freedom"] == "scale"
    assert json.loads(json.dumps(data, allow_nan=False)) == data


def test_table_names_what_it_tells():
    lines = as_table(evaluate(plan((*FLAT[:2], None)), truth())).splitlines()
    assert any("1 without shape" in line for line in lines)
    assert any(line.startswith("rooms, IoU 0.5") and "0.667" in line for line in lines)
    assert any(line.startswith("corners, released") for line in lines)
