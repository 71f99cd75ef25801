from dataclasses import replace

import numpy as np
import pytest

from panoplan.config import OrientationConfig
from panoplan.stages.orientation import accepted, observe
from panoplan.types.room import Orientation, WallPiece

CONFIG = OrientationConfig()


def _wall(degrees, distance=1.0, length=2.0):
    a = np.deg2rad(degrees)
    ends = np.array([[0.0, 0.0], [length * np.cos(a), length * np.sin(a)]])
    return WallPiece("k", ends, a % np.pi, distance, ends)


def _after(walls, config=CONFIG):
    orientations = ()
    for wall in walls:
        orientations = observe(orientations, wall, config)
    return orientations


def test_product_of_two_normal_distributions_by_hand():
    config = replace(CONFIG, sigma0_deg=3.0, sigma_per_ch_deg=2.0, initial_sigma_deg=5.0)
    (one,) = _after([_wall(10), _wall(20)], config)
    # sigma = 3 + 2·1 = 5: equal precisions.
    assert np.rad2deg(one.direction) == pytest.approx(15)
    assert np.rad2deg(one.sigma) == pytest.approx(5 / np.sqrt(2))


def test_period_is_pi():
    config = replace(CONFIG, initial_sigma_deg=8.0)
    (one,) = _after([_wall(178), _wall(2)], config)
    assert np.rad2deg(one.direction) % 180 == pytest.approx(0, abs=1e-6) or np.rad2deg(
        one.direction
    ) == pytest.approx(180, abs=1e-6)


def test_beyond_the_gate_a_new_direction_starts():
    assert len(_after([_wall(0), _wall(59)])) == 1
    assert len(_after([_wall(0), _wall(61)])) == 2


def test_far_walls_and_short_ones_count_less():
    near = _after([_wall(0), _wall(0, distance=0.5)])[0].sigma
    assert _after([_wall(0), _wall(0, distance=4.0)])[0].sigma > near
    assert _after([_wall(0), _wall(0, distance=0.5, length=0.25)])[0].sigma > near


def test_final_test_keeps_the_best_supported_and_flags_it():
    weak = (Orientation(0.1, 1.0, 1), Orientation(1.5, 0.9, 3))
    kept, flagged = accepted(weak, CONFIG)
    assert flagged
    assert kept == (weak[1],)
    sure = (*weak, Orientation(0.8, np.deg2rad(17.9), 2), Orientation(0.9, np.deg2rad(18.1), 9))
    assert accepted(sure, CONFIG) == ((sure[2],), False)
    assert accepted((), CONFIG) == ((), False)
