"""Storeys compared with storeys."""

from dataclasses import replace

import numpy as np
import pytest
from tests.metrics.plans import CAMERAS, FLAT, LEFT, plan, truth

from panoplan.geometry.polygons import signed_area
from panoplan.metrics.levels import UNKNOWN, aperture_level, camera_levels, true_levels
from panoplan.metrics.presentation import as_dict, as_table
from panoplan.metrics.report import evaluate
from panoplan.types.plan import Aperture
from panoplan.types.truth import GroundTruth, TrueLevels

UP_M = 3.0


def house(*, poses=True):
    """The small flat twice, one upon the other; cameras kf0... below and up0... above."""
    below = truth()
    rooms = below.plan.rooms
    above = tuple(replace(room, id=f"up_{room.id}", level=1) for room in rooms)
    doors = (np.array([[4.1, 1.0], [4.1, 1.9]]),) * 2
    levels = TrueLevels((0.0, UP_M), doors=(0, 1))
    both = replace(below.plan, rooms=(*rooms, *above), doors=doors, levels=levels)
    walked = below.trajectory
    translations = np.vstack([walked.translations, walked.translations - [0.0, UP_M, 0.0]])
    labels = (*walked.labels, *(f"up{k}" for k in range(len(walked))))
    rotations = np.concatenate([walked.rotations, walked.rotations])
    path = replace(walked, labels=labels, rotations=rotations, translations=translations)
    return GroundTruth(both, path if poses else None)


def storeys(low, high, *, numbers=(0, 1)):
    """A plan of some rooms below and some above, with the cameras in the first of each."""
    made = plan((*low, *high), np.vstack([CAMERAS, CAMERAS]))
    on = [numbers[0]] * len(low) + [numbers[1]] * len(high)
    rooms = tuple(replace(room, level=k) for room, k in zip(made.rooms, on, strict=True))
    first = (made.rooms[0].id, made.rooms[len(low)].id) if high else (made.rooms[0].id,) * 2
    n = len(CAMERAS)
    cameras = tuple(
        replace(
            camera,
            id=f"kf{k}" if k < n else f"up{k - n}",
            room=first[0] if k < n else first[1],
        )
        for k, camera in enumerate(made.trajectory)
    )
    return replace(made, rooms=rooms, trajectory=cameras, doors=(), openings=(), windows=())


def test_the_same_on_both_storeys_is_found():
    report = evaluate(storeys(FLAT, FLAT), house())
    assert report.rooms.scores[2].hits == 6
    assert report.rooms.floor_iou == pytest.approx(1.0)
    assert report.corners.paper.recall == report.corners.released.recall == 1.0
    assert (report.storeys.hits, report.storeys.true, report.storeys.predicted) == (2, 2, 2)
    assert "storeys" in as_table(report)
    assert as_dict(report)["storeys"]["recall"] == 1.0


def test_a_room_of_another_storey_is_no_match():
    report = evaluate(storeys((*FLAT, *FLAT[:1]), FLAT[1:]), house())
    score = report.rooms.scores[0]
    assert (score.hits, score.true, score.predicted) == (5, 6, 6)
    assert {pair.true for pair in report.rooms.pairs} == {
        "true_1", "true_2", "true_3", "up_true_2", "up_true_3"
    }  # fmt: skip
    corner = report.corners.within[0][1]
    assert corner.hits == corner.true - len(LEFT)
    whole, missed = (sum(signed_area(r) for r in rooms) for rooms in (FLAT, FLAT[:1]))
    assert report.rooms.floor_iou == pytest.approx((2 * whole - missed) / (2 * whole))


def test_cameras_tell_which_storey_is_which():
    turned = storeys(FLAT, FLAT[:2], numbers=(4, 1))
    assert true_levels(turned, house()) == {4: 0, 1: 1}
    assert evaluate(turned, house()).rooms.scores[2].hits == 5
    # Without them, the numbers.
    assert true_levels(turned, house(poses=False)) == {1: 1, 4: UNKNOWN}


def test_a_storey_that_is_none_counts_against():
    made = storeys(FLAT, FLAT)
    more = replace(made.rooms[0], id="room_99", level=2)
    report = evaluate(replace(made, rooms=(*made.rooms, more)), house())
    assert (report.storeys.hits, report.storeys.predicted) == (2, 3)
    assert report.rooms.scores[0].predicted == 7
    assert report.rooms.scores[0].hits == 6
    assert report.corners.paper.predicted == report.corners.paper.true + len(LEFT)
    assert report.rooms.floor_iou < 1.0


def test_a_truth_without_storeys_compares_all():
    upstairs = storeys(FLAT[:1], FLAT[1:])
    report = evaluate(upstairs, truth())
    assert report.rooms.scores[2].hits == 3
    assert report.storeys is None
    assert "storeys" not in as_table(report)


def test_only_cameras_of_its_storey_visit_a_room():
    below = house().trajectory.translations[:1]
    report = evaluate(storeys(FLAT, FLAT), house(), visited=below)
    assert report.rooms.visited == 1
    assert report.rooms.scores_visited[1].true == 1
    assert evaluate(storeys(FLAT, FLAT), house(), visited=below - [0, UP_M, 0]).rooms.visited == 1


def test_doors_above_one_another_are_two():
    made = storeys(FLAT, FLAT)
    segment = np.array([[4.1, 1.0], [4.1, 1.9]])
    low = Aperture("door_01", segment, ("room_01", "room_02"))
    high = Aperture("door_02", segment, ("room_04",))
    found = evaluate(replace(made, doors=(low, high)), house()).doors
    assert (found.hits, found.true, found.predicted) == (2, 2, 2)
    twice = replace(high, rooms=("room_01",))
    found = evaluate(replace(made, doors=(low, twice)), house()).doors
    assert (found.hits, found.true, found.predicted) == (1, 2, 2)


def test_an_aperture_is_on_the_storey_of_its_room_else_of_its_wall():
    rooms, walls = {"a": 1, "b": 0}, {"w": 1}
    line = np.zeros((2, 2))
    assert aperture_level(Aperture("d", line, ("a",), ("x",)), rooms, walls) == 1
    assert aperture_level(Aperture("d", line, (), ("w",)), rooms, walls) == 1
    assert aperture_level(Aperture("d", line), rooms, walls) == 0


def test_the_storey_of_a_camera_is_the_nearest_in_height():
    at = np.array([[0.0, 0.3, 0.0], [0.0, -1.4, 0.0], [0.0, -1.6, 0.0], [0.0, -9.0, 0.0]])
    assert camera_levels(at, TrueLevels((0.0, UP_M))).tolist() == [0, 0, 1, 1]
