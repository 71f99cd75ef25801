"""Accuracy floors on simulated flats; the benchmark runs more of them."""

import pytest

from panoplan.config import preset
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.metrics.report import evaluate
from panoplan.simulate.scene import simulate_flat


@pytest.mark.parametrize("seed", [100, 101, 102])
def test_floors_on_mild_flats(seed):
    scene = simulate_flat(seed, "mild", rooms=5, step_m=0.5)
    estimator = FloorPlanEstimator(preset("sound"), Walk(camera_height_m=scene.camera_height_m))
    for keyframe in scene.keyframes:
        estimator.update(keyframe)
    estimator.finish()
    report = evaluate(estimator.plan(), scene.truth, align="none")
    rooms = report.rooms
    assert rooms.scores[1].hits == rooms.true == rooms.predicted
    assert rooms.mean_iou >= 0.93
    assert report.corners.true_to_predicted.median_cm <= 10
