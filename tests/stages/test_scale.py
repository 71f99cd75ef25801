from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import L_SHAPE, RECTANGLE, walk

from panoplan.config import RegistrationConfig, ScaleConfig, preset
from panoplan.geometry.rigid import heading_of, turn
from panoplan.simulate.families import simulate_scene
from panoplan.stages.registration import cast
from panoplan.stages.scale import median_step, recover_scale, scale_sigma
from panoplan.types.layout import Layout

CONFIG = ScaleConfig()
UNTURNED = np.eye(2)
PATH = np.stack([np.linspace(-1.2, 1.2, 12), 0.6 * np.sin(np.arange(12) / 2)], axis=1)


def _views(keyframes, turned=UNTURNED):
    origin = keyframes[0].pose.translation
    return [cast(k, i, origin, turned, RegistrationConfig()) for i, k in enumerate(keyframes)]


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
    small, large = (_sigma(_views(views)) for views in (exact, noisy))
    assert 0 <= small < 0.01
    assert 1.5 * small < large < 0.05


def test_sigma_needs_views_to_leave_out():
    views = _views(walk(RECTANGLE, PATH))
    assert _sigma(views[:3]) is None
    assert _sigma(views[:4]) is not None


def test_sigma_does_not_depend_on_the_unit():
    one, hundred = (_sigma(_views(walk(RECTANGLE, PATH, factor=f))) for f in (1.0, 100.0))
    assert hundred == pytest.approx(one, rel=1e-6)


def _sigma(views):
    return scale_sigma(views, recover_scale(views, CONFIG), CONFIG)


@pytest.mark.parametrize(("seed", "photos"), [(3, 11), (24, 14), (35, 16)])
def test_rooms_of_a_few_photos_are_not_laid_on_one_another(seed, photos):
    views, true = _photos(seed)
    assert len(views) == photos
    estimate = recover_scale(views, CONFIG)
    assert estimate.ch_per_su == pytest.approx(true, rel=0.05)
    assert estimate.curve[:, 0].min() <= estimate.ch_per_su <= estimate.curve[:, 0].max()
    alone = recover_scale(views, replace(CONFIG, intrusion=0.0))
    assert alone.ch_per_su < 0.5 * true


@pytest.mark.parametrize("seed", [7, 14, 22])
def test_a_scale_that_few_photos_do_not_tell_is_uncertain(seed):
    views, true = _photos(seed)
    estimate = recover_scale(views, CONFIG)
    off = abs(estimate.ch_per_su / true - 1)
    assert scale_sigma(views, estimate, CONFIG) > max(0.1, off / 3)


def test_of_a_walk_only_the_entropy_tells_the_scale():
    views = _views(walk(L_SHAPE, PATH - [1, 1]))
    found = [recover_scale(views, replace(CONFIG, intrusion=w)).ch_per_su for w in (0.0, 0.2)]
    assert found[1] == pytest.approx(found[0], rel=1e-3)


def _photos(seed):
    scene = simulate_scene("flat", seed, as_stills=True, metres_per_su=1.0)
    along = turn(-heading_of(scene.keyframes[0].pose.rotation))
    return _views(scene.keyframes, along), scene.ch_per_su
