import numpy as np
import pytest

from panoplan.simulate.buildings import Building, InteriorRoom, Passage, rectangle
from panoplan.simulate.leaks import Leak, draw_leaks, partly_closed
from panoplan.simulate.measured import MEASURED
from panoplan.simulate.noise import HARD, MILD, REAL
from panoplan.simulate.views import ViewCaster


def test_leaks_are_as_frequent_and_deep_as_asked():
    rng = np.random.default_rng(0)
    draws = [draw_leaks([0, 1], [2], HARD, rng) for _ in range(20000)]
    doors = np.mean([[k in d for k in (0, 1)] for d in draws])
    assert doors == pytest.approx(0.08, abs=0.005)
    assert np.mean([2 in d for d in draws]) == pytest.approx(0.38, abs=0.01)
    depths = np.array([leak.depth_m for d in draws for leak in d.values()])
    assert not any(leak.partly for d in draws for leak in d.values())
    assert np.median(depths) == pytest.approx(MEASURED.leak_median_m, rel=0.05)
    assert np.quantile(depths, 0.9) == pytest.approx(MEASURED.leak_percentile_90_m, rel=0.08)
    assert not any(draw_leaks([0, 1], [2], MILD, rng) for _ in range(200))


def test_before_a_camera_passages_leak_more_and_some_leak_in_part():
    rng = np.random.default_rng(0)
    draws = [draw_leaks([0, 1], [2], REAL, rng, near=[1]) for _ in range(20000)]
    whole = [np.mean([k in d and not d[k].partly for d in draws]) for k in range(3)]
    partly = [np.mean([k in d and d[k].partly for d in draws]) for k in range(3)]
    np.testing.assert_allclose(whole, [0.035, 0.5, 0.28], atol=0.012)
    np.testing.assert_allclose(partly, [0.045, 0.045, 0.14], atol=0.008)


def test_a_leak_in_part_is_closed_in_the_rest():
    rooms = [InteriorRoom("a", rectangle(4, 4)), InteriorRoom("b", rectangle(4, 4, (4.1, 0)))]
    faces = [[[4.0, 1.0], [4.0, 3.0]], [[4.1, 1.0], [4.1, 3.0]]]
    caster = ViewCaster(Building("two", tuple(rooms), (Passage("opening", (0, 1), faces),)))
    rng = np.random.default_rng(0)
    for heading in (0.0, np.pi / 2, -np.pi / 2):
        view = caster.view(np.array([2.0, 2.0]), heading, 1.5, leaks={0: 1.0})
        assert partly_closed(view, {0: Leak(1.0)}, rng) is view
        part = partly_closed(view, {0: Leak(1.0, partly=True)}, rng)
        assert 0.15 < part.leaked.sum() / view.leaked.sum() < 0.85
        np.testing.assert_array_equal(part.range_m[part.leaked], view.range_m[part.leaked])
        np.testing.assert_array_equal(part.range_m[~part.leaked], view.closed_range_m[~part.leaked])
        # What stays open is one stretch.
        assert (part.leaked & ~np.roll(part.leaked, 1)).sum() == 1
