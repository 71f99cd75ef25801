"""Accuracy floors on a real home: predicted layouts, true poses in an unknown unit."""

import pytest

from panoplan.config import preset
from panoplan.datasets.detect import open_scene, read_truth
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.metrics.report import evaluate


@pytest.mark.parametrize("name", ["sound", "default"])
def test_floors_on_the_real_home(name, zind_scene_folder, shared_data):
    scene = open_scene(zind_scene_folder)
    walk = Walk(camera_height_m=scene.camera_height_m, expected_keyframes=len(scene.keyframes))
    estimator = FloorPlanEstimator(preset(name), walk)
    for keyframe in scene.keyframes:
        estimator.update(keyframe)
    estimator.finish()
    truth = read_truth(shared_data / "zind_000")
    report = evaluate(estimator.plan(), truth, rooms="rooms_partial", align="none")
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
