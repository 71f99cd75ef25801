from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import L_SHAPE, RECTANGLE, walk

from panoplan.config import RegistrationConfig, ScaleConfig
from panoplan.stages.registration import cast
from panoplan.stages.scale import median_step, recover_scale

CONFIG = ScaleConfig()
PATH = np.stack([np.linspace(-1.2, 1.2, 12), 0.6 * np.sin(np.arange(12) / 2)], axis=1)


def _views(keyframes):
    origin = keyframes[0].pose.translation
    return [cast(k, i, origin, np.eye(2), RegistrationConfig()) for i, k in enumerate(keyframes)]


@pytest.mark.parametrize("factor", [0.01, 1.0, 37.0])
def test_scale_of_exact_layouts(factor):
    estimate = recover_scale(_views(walk(RECTANGLE, PATH, factor=factor)), CONFIG)
    assert estimate.ch_per_su == pytest.approx(factor, rel=0.01)
    assert not estimate.at_edge


def test_multiplying_the_trajectory_divides_the_scale():
    one = recover_scale(_views(walk(L_SHAPE, PATH - [1, 1])), CONFIG)
    four = recover_scale(_views(walk(L_SHAPE, PATH - [1, 1], factor=4.0)), CONFIG)
    assert four.ch_per_su == pytest.approx(4 * one.ch_per_su, rel=1e-6)


def test_the_curve_is_kept_and_lowest_at_the_scale():
    estimate = recover_scale(_views(walk(RECTANGLE, PATH)), CONFIG)
    assert estimate.curve is not None
    assert np.all(np.diff(estimate.curve[:, 0]) > 0)
    lowest = estimate.curve[np.argmin(estimate.curve[:, 1]), 0]
    assert lowest == pytest.approx(estimate.ch_per_su, rel=0.01)


def test_an_optimum_at_the_edge_is_told():
    config = replace(CONFIG, step_unit="absolute", absolute_range=(0.1, 0.99))
    assert recover_scale(_views(walk(RECTANGLE, PATH)), config).at_edge


def test_cameras_at_one_spot_have_no_scale():
    views = _views(walk(RECTANGLE, np.zeros((3, 2))))
    assert median_step(views) == 0
    assert recover_scale(views, CONFIG).ch_per_su is None
