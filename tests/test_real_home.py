"""Accuracy floors on a real home: predicted layouts, true poses in an unknown unit."""

import pytest

from panoplan.bench import misplaced
from panoplan.config import Config, preset
from panoplan.datasets.detect import open_scene, read_truth
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.metrics.report import evaluate


def _report(name, unit, scene, truth_folder):
    walk = Walk(unit, scene.camera_height_m, len(scene.keyframes))
    estimator = FloorPlanEstimator(preset(name), walk)
    for keyframe in scene.keyframes:
        estimator.update(keyframe)
    estimator.finish()
    truth = read_truth(truth_folder)
    return evaluate(estimator.plan(), truth, rooms="rooms_partial", align="none")


def test_floors_of_the_papers_method_made_sound(zind_scene_folder, shared_data):
    report = _report("sound", "unknown", open_scene(zind_scene_folder), shared_data / "zind_000")
    rooms, corners = report.rooms, report.corners
    _, half, seven = rooms.scores_visited
    assert (half.iou, seven.iou) == (0.5, 0.7)
    assert half.true == 13
    assert half.hits >= 11
    assert seven.hits >= 10
    assert half.hits >= 0.90 * half.predicted
    assert rooms.floor_iou >= 0.88
    assert abs(report.scale_error_percent) <= 1.0
    assert corners.true_to_predicted.median_cm <= 10
    assert corners.predicted_to_true.median_cm <= 10


@pytest.mark.parametrize(
    ("unit", "half", "seven", "iou", "corner_cm", "wall_cm", "scale_percent"),
    [("m", 17, 16, 0.92, 5.0, 2.0, 0.05), ("unknown", 16, 15, 0.89, 7.0, 3.0, 0.5)],
)
def test_floors_of_the_default(
    unit, half, seven, iou, corner_cm, wall_cm, scale_percent, zind_scene_folder, shared_data
):
    folder = zind_scene_folder if unit == "unknown" else shared_data / "zind_000"
    trajectory = folder / ("trajectory.tum" if unit == "unknown" else "trajectory_gt.tum")
    scene = open_scene(folder, trajectory=trajectory)
    report = _report("default", unit, scene, shared_data / "zind_000")
    rooms, corners = report.rooms, report.corners
    assert rooms.true == 19
    assert rooms.scores[1].hits >= half
    assert rooms.scores[2].hits >= seven
    assert rooms.matching_none <= 1
    assert rooms.mean_iou >= iou
    assert rooms.floor_iou >= 0.92
    assert rooms.overlap_m2 < 1e-9
    assert corners.true_to_predicted.median_cm <= corner_cm
    assert corners.predicted_to_true.median_cm <= corner_cm
    assert report.walls.median_cm <= wall_cm
    assert report.doors.recall >= 0.8
    assert report.doors.precision >= 0.8
    assert abs(report.scale_error_percent) <= scale_percent


def test_a_room_shifted_by_an_aligner_is_named(shared_data):
    figures = misplaced.measure_home(
        shared_data / "zind_000", Config(), 10, lambda done, total, title="": None
    )
    assert figures["found"] >= 8
    assert max(trial["innocent"] for trial in figures["outcome"]) <= 1
    assert figures["named_where_none_is_shifted"] == 0
