from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import L_SHAPE, RECTANGLE, walk

from panoplan.config import RegistrationConfig, ScaleConfig, preset
from panoplan.stages.registration import cast
from panoplan.stages.scale import median_step, recover_scale, scale_sigma
from panoplan.types.layout import Layout

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


def test_the_public_codes_rule_finds_the_scale_within_its_range():
    views = _views(walk(RECTANGLE, PATH, factor=1.5))
    config = preset("released").scale
    found = recover_scale(views, config)
    assert found.ch_per_su == pytest.approx(1.5, rel=0.05)
    by_hand = [
        recover_scale(views[k : k + 10], replace(config, steps=config.steps[:n], combine="optimum"))
        for k in range(3)
        for n in (1, 2, 3, 4)
    ]
    assert found.ch_per_su == pytest.approx(np.mean([one.ch_per_su for one in by_hand]))


def test_sigma_of_exact_layouts_is_small_and_grows_with_their_noise():
    rng = np.random.default_rng(0)
    exact = walk(RECTANGLE, PATH)
    noisy = [
        replace(k, layout=Layout(k.layout.floor_boundary * (1 + 0.02 * rng.normal())))
        for k in exact
    ]
    small, large = (scale_sigma(_views(views), 1.0, CONFIG) for views in (exact, noisy))
    assert 0 <= small < 0.01
    assert 1.5 * small < large < 0.05


def test_sigma_needs_views_to_leave_out():
    views = _views(walk(RECTANGLE, PATH))
    assert scale_sigma(views[:3], 1.0, CONFIG) is None
    assert scale_sigma(views[:4], 1.0, CONFIG) is not None


def test_sigma_does_not_depend_on_the_unit():
    one = scale_sigma(_views(walk(RECTANGLE, PATH)), 1.0, CONFIG)
    hundred = scale_sigma(_views(walk(RECTANGLE, PATH, factor=100.0)), 100.0, CONFIG)
    assert hundred == pytest.approx(one, rel=1e-6)
