import numpy as np
import pytest

from panoplan.bench.v1.differences import difference


def test_the_mean_is_over_scenes_that_have_both():
    made = difference([1.0, 0.5, None, 0.2], [0.5, 0.5, 0.9, None])
    assert (made.mean, made.scenes) == (0.25, 2)


def test_a_constant_gain_is_certain():
    made = difference([0.6] * 5, [0.5] * 5)
    assert made.low == pytest.approx(0.1) == made.high


def test_the_interval_is_that_of_a_mean():
    apart = np.random.default_rng(3).normal(0.02, 0.1, 400)
    made = difference(list(apart), [0.0] * 400)
    half = 1.96 * apart.std() / np.sqrt(400)
    assert made.low == pytest.approx(apart.mean() - half, abs=0.001)
    assert made.high == pytest.approx(apart.mean() + half, abs=0.001)


def test_pairing_counts_not_the_spread_of_scenes():
    scenes = np.linspace(0, 1, 20)
    made = difference(list(scenes + 0.01), list(scenes))
    assert made.low > 0.009


def test_the_same_seed_gives_the_same_interval():
    values = [0.1, 0.4, -0.2, 0.3]
    assert difference(values, [0.0] * 4, 7) == difference(values, [0.0] * 4, 7)


@pytest.mark.parametrize(
    ("this", "that", "expected"), [([None], [1.0], None), ([], [], None), ([1.0], [0.5], 0.5)]
)
def test_too_few_scenes_have_no_interval(this, that, expected):
    made = difference(this, that)
    if expected is None:
        assert made is None
    else:
        assert (made.mean, made.low, made.high) == (expected, None, None)
