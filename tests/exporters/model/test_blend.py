import numpy as np
import pytest

from panoplan.exporters.model.blend import SurfaceView, blended, filled, low_pass


def test_one_view_is_shown_as_it_is():
    colours = np.random.default_rng(0).uniform(0, 255, (40, 60, 3))
    out, seen = blended([SurfaceView(colours, np.ones((40, 60)))])
    assert out == pytest.approx(colours)
    assert seen.all()


def test_views_of_other_exposure_meet_without_a_step():
    width = 200
    weights = np.linspace(0.1, 1.0, width) * np.ones((50, 1))
    dark, light = np.full((50, width, 3), 90.0), np.full((50, width, 3), 150.0)
    out, _ = blended([SurfaceView(dark, weights), SurfaceView(light, weights[:, ::-1])])
    assert np.abs(np.diff(out, axis=1)).max() < 1.5
    assert out[0, 0, 0] > out[0, -1, 0] + 20


def test_detail_is_of_the_best_view():
    rng = np.random.default_rng(1)
    one, other = (128 + rng.uniform(-50, 50, (64, 64, 3)) for _ in range(2))
    out, _ = blended(
        [SurfaceView(one, np.full((64, 64), 2.0)), SurfaceView(other, np.ones((64, 64)))]
    )
    assert np.corrcoef(out.ravel(), one.ravel())[0, 1] > 0.95


def test_what_no_view_shows_is_filled_from_around():
    colours = np.full((80, 80, 3), 100.0)
    known = np.ones((80, 80), dtype=bool)
    known[30:50, 30:50] = False
    colours[~known] = 0.0
    assert filled(colours, known) == pytest.approx(np.full((80, 80, 3), 100.0))
    assert low_pass(colours, known) == pytest.approx(np.full((80, 80, 3), 100.0))
