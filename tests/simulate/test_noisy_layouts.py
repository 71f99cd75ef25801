from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from panoplan.simulate.buildings import Building, InteriorRoom, Passage, rectangle, single_room
from panoplan.simulate.measured import MEASURED, gross
from panoplan.simulate.noise import (
    EXACT,
    HARD,
    MILD,
    TARGET_GROSS_SHARE,
    TARGET_SIGMA_DEG,
    NoiseModel,
)
from panoplan.simulate.noisy_layouts import noisy_corners, noisy_layout, scale_factor
from panoplan.simulate.views import View, ViewCaster

HEIGHT, WIDTH, VIEWS = 1.54, 1024, 1500
EDGES = (0.4, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0)
# The network alone: without what the hard grade adds to it.
NETWORK = replace(HARD, height_jitter=0.0, occluder_share=0.0)


def round_view(distance):
    """A view of a round room, so that the true distance is the same in all columns."""
    ranges = np.full(WIDTH, distance)
    return View(
        room=0,
        camera_height_m=HEIGHT,
        ceiling_height_m=2.5,
        range_m=ranges,
        closed_range_m=ranges,
        surface=np.zeros(WIDTH, dtype=np.int8),
        closed_surface=np.zeros(WIDTH, dtype=np.int8),
        passage=np.full(WIDTH, -1),
        leaked=np.zeros(WIDTH, dtype=bool),
        corners=np.empty(0),
    )


def errors(model, low, high, seed=0, views=VIEWS):
    """Errors of elevation (deg) and range (m) and the true ranges, (views, W // 8) each."""
    rng = np.random.default_rng(seed)
    distances = rng.uniform(low, high, views)
    told = np.array(
        [noisy_layout(round_view(d), model, rng).floor_boundary[::8] for d in distances]
    )
    true = np.broadcast_to(distances[:, None], told.shape)
    return np.rad2deg(told + np.arctan(HEIGHT / true)), HEIGHT / np.tan(-told) - true, true


def mad_sigma(values):
    return 1.4826 * np.median(np.abs(values - np.median(values)))


@pytest.mark.parametrize("bin_index", range(7))
def test_hard_reproduces_bias_sigma_and_gross_share_of_each_distance(bin_index):
    degrees, metres, true = errors(NETWORK, EDGES[bin_index], EDGES[bin_index + 1], bin_index)
    assert mad_sigma(degrees) == pytest.approx(TARGET_SIGMA_DEG[bin_index], rel=0.12)
    bias = (*MEASURED.bias_deg, MEASURED.bias_deg[-1])[bin_index]
    assert np.median(degrees) == pytest.approx(bias, abs=0.05)
    share = gross(true + metres, true).mean()
    assert share == pytest.approx(TARGET_GROSS_SHARE[bin_index], rel=0.2)
    if bin_index < 6:
        measured = MEASURED.percentile_90_m[bin_index]
        assert np.quantile(np.abs(metres), 0.9) == pytest.approx(measured, rel=0.3)


@pytest.mark.parametrize("bin_index", range(7))
def test_mild_has_the_sigma_of_each_distance_without_bias_and_few_gross_errors(bin_index):
    degrees, metres, true = errors(MILD, EDGES[bin_index], EDGES[bin_index + 1], bin_index)
    assert mad_sigma(degrees) == pytest.approx(TARGET_SIGMA_DEG[bin_index], rel=0.08)
    assert np.median(degrees) == pytest.approx(0.0, abs=0.05)
    if bin_index < 5:
        assert gross(true + metres, true).mean() == pytest.approx(0.02, abs=0.006)


def test_gross_errors_of_the_mild_grade_are_stretches():
    model = replace(EXACT, gross_share=0.02)
    rng = np.random.default_rng(0)
    wrong = np.array(
        [
            gross(HEIGHT / np.tan(-noisy_layout(round_view(2.0), model, rng).floor_boundary), 2.0)
            for _ in range(3000)
        ]
    )
    assert wrong.mean() == pytest.approx(0.02, abs=0.003)
    starts = (wrong & ~np.roll(wrong, 1, axis=1)).sum()
    assert wrong.sum() / starts == pytest.approx(30, rel=0.15)


def test_overall_spread_is_that_of_the_real_network():
    """RMSE 5.4° and inlier std 1.3° were measured over all distances; neither was fitted."""
    by_bin = [errors(NETWORK, a, b, 9, 300) for a, b in pairwise(EDGES[:-1])]
    degrees = np.concatenate([d.ravel() for d, _, _ in by_bin])
    right = np.concatenate([~gross(t + m, t).ravel() for _, m, t in by_bin])
    assert np.sqrt(np.mean(degrees**2)) == pytest.approx(5.4, rel=0.25)
    assert degrees[right].std() == pytest.approx(1.3, rel=0.25)


def test_scale_factors_have_the_spread_asked_for():
    rng = np.random.default_rng(0)
    hard = np.array([scale_factor(HARD, rng) for _ in range(30000)])
    assert hard.std() == pytest.approx(MEASURED.scale_std, rel=0.05)
    assert mad_sigma(hard) == pytest.approx(MEASURED.scale_mad_sigma, rel=0.05)
    mild = np.array([scale_factor(MILD, rng) for _ in range(30000)])
    assert mild.std() == pytest.approx(0.015, rel=0.03)
    assert np.median(hard) == pytest.approx(1.0, abs=1e-3)


def test_scale_error_moves_all_columns_of_a_view_alike():
    model = NoiseModel("scale only", scale_std=0.03)
    layout = noisy_layout(round_view(2.5), model, np.random.default_rng(4))
    ranges = HEIGHT / np.tan(-layout.floor_boundary)
    assert np.ptp(ranges) < 1e-9
    assert ranges[0] != pytest.approx(2.5, abs=1e-3)


def test_height_jitter_of_the_hard_grade_is_three_per_cent():
    model = NoiseModel("jitter only", height_jitter=HARD.height_jitter)
    rng = np.random.default_rng(0)
    told = np.array(
        [noisy_layout(round_view(2.5), model, rng).floor_boundary[0] for _ in range(2000)]
    )
    assert (HEIGHT / np.tan(-told) / 2.5).std() == pytest.approx(0.03, rel=0.08)


def test_no_noise_tells_the_truth():
    view = ViewCaster(single_room(rectangle(4, 3))).view(np.array([1.0, 2.0]), 0.3, 1.5)
    layout = noisy_layout(view, EXACT, np.random.default_rng(0))
    np.testing.assert_array_equal(layout.floor_boundary, view.floor_boundary)
    np.testing.assert_array_equal(layout.ceiling_boundary, view.ceiling_boundary)
    np.testing.assert_array_equal(layout.corners, view.corners)


def test_occluders_hide_a_stretch_of_a_third_of_the_views_and_only_shorten():
    model = NoiseModel("occluders only", occluder_share=HARD.occluder_share)
    rng = np.random.default_rng(0)
    told = np.array(
        [
            HEIGHT / np.tan(-noisy_layout(round_view(3.0), model, rng).floor_boundary)
            for _ in range(1500)
        ]
    )
    assert told.max() <= 3.0 + 1e-9
    hidden = told < 3.0 - 1e-6
    assert hidden.any(axis=1).mean() == pytest.approx(0.3, abs=0.04)
    assert 0.03 < hidden[hidden.any(axis=1)].mean() < 0.25
    assert told.min() >= 0.4


@pytest.mark.parametrize("model", [MILD, HARD])
def test_corners_are_found_with_the_measured_recall_and_precision(model):
    rng = np.random.default_rng(0)
    corners = np.array([50.0, 260.0, 480.0, 700.0, 900.0])
    hits, found, told = np.zeros(3), 0, 0
    tolerances = [tolerance for tolerance, _ in MEASURED.corner_recall]
    for _ in range(4000):
        seen = noisy_corners(corners, WIDTH, model, rng)
        assert np.all(np.diff(seen) >= 0)
        gap = np.abs((seen[:, None] - corners + 512) % 1024 - 512).min(axis=1)
        hits += [np.sum(gap <= t) for t in tolerances]
        found, told = found + len(corners), told + len(seen)
    recall = [share for _, share in MEASURED.corner_recall]
    precision = [share for _, share in MEASURED.corner_precision]
    np.testing.assert_allclose(hits / found, recall, atol=0.02)
    np.testing.assert_allclose(hits / told, precision, atol=0.02)


def test_noisy_boundaries_stay_below_the_horizon_and_finite():
    rng = np.random.default_rng(0)
    for distance in (0.15, 1.0, 5.0, 30.0):
        for _ in range(100):
            layout = noisy_layout(round_view(distance), HARD, rng)
            assert np.isfinite(layout.floor_boundary).all()
            assert layout.floor_boundary.max() < -0.02
            assert layout.floor_boundary.min() > -np.pi / 2


def test_noise_of_a_leaking_view_follows_the_leak():
    rooms = (InteriorRoom("a", rectangle(4, 3)), InteriorRoom("b", rectangle(4, 3, (4.2, 0))))
    faces = [[[4.0, 1.0], [4.0, 2.0]], [[4.2, 1.0], [4.2, 2.0]]]
    caster = ViewCaster(Building("two", rooms, (Passage("door", (0, 1), faces),)))
    view = caster.view(np.array([2.0, 1.5]), 0.0, 1.5, leaks={0: 2.0})
    layout = noisy_layout(view, MILD, np.random.default_rng(0))
    told = 1.5 / np.tan(-layout.floor_boundary)
    assert np.median(told[view.leaked]) == pytest.approx(
        np.median(view.range_m[view.leaked]), rel=0.1
    )
