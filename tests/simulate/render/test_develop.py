"""From radiance to pictures."""

from dataclasses import replace

import numpy as np
import pytest

from panoplan.simulate.render.develop import Development, develop, draw_development

PLAIN = Development(flattening=0.0, blur_px=0.0, noise=0.0)


def _scene(seed=0):
    rng = np.random.default_rng(seed)
    return np.exp(rng.normal(0, 0.7, (64, 128, 3))).astype(np.float32)


def _developed(radiance, development, seed=0):
    return develop(radiance, development, np.random.default_rng(seed))


@pytest.mark.parametrize("factor", [0.01, 1.0, 30.0])
def test_exposure_puts_the_median_where_it_is_wanted(factor):
    grey = np.repeat(_scene()[..., :1], 3, axis=2) * np.float32(factor)
    picture = _developed(grey, replace(PLAIN, exposure=0.6))
    assert np.median(picture) == pytest.approx(0.6 * 255, abs=4)


def test_brighter_stays_brighter():
    ramp = np.repeat(np.geomspace(0.05, 20, 128)[None, :, None], 64, axis=0).repeat(3, axis=2)
    row = _developed(ramp.astype(np.float32), PLAIN)[32, :, 0].astype(int)
    assert (np.diff(row) >= 0).all()
    assert np.ptp(row) > 150


def test_flattening_evens_out_light_and_dark_halves():
    halves = np.full((64, 128, 3), 0.2, dtype=np.float32)
    halves[:, 64:] = 2.0
    spread = [
        np.ptp(_developed(halves, replace(PLAIN, flattening=f))[32, [32, 96], 0].astype(int))
        for f in (0.0, 0.6)
    ]
    assert spread[1] < 0.7 * spread[0]


def test_blur_wraps_at_the_sides():
    dot = np.full((64, 128, 3), 0.1, dtype=np.float32)
    dot[32, 0] = 1.0
    picture = _developed(dot, replace(PLAIN, blur_px=8.0)).astype(int)
    np.testing.assert_array_equal(picture[32, 127], picture[32, 1])
    assert picture[32, 127, 0] > picture[32, 64, 0]


@pytest.mark.parametrize("cover", ["dark", "blur", "disc"])
def test_the_nadir_is_covered_and_nothing_else(cover):
    radiance = _scene()
    bare = _developed(radiance, PLAIN)
    covered = _developed(radiance, replace(PLAIN, nadir=cover, nadir_rad=0.3))
    np.testing.assert_array_equal(bare[:50], covered[:50])
    assert (bare[-2:] != covered[-2:]).any()


def test_developments_are_drawn_and_repeated_by_the_seed():
    drawn = [draw_development(np.random.default_rng(k)) for k in range(40)]
    assert len({d.nadir for d in drawn}) == 4
    for k, development in enumerate(drawn):
        one, two = (_developed(_scene(k), development, k) for _ in range(2))
        np.testing.assert_array_equal(one, two)
        assert one.std() > 5
