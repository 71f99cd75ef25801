import numpy as np
import pytest

from panoplan.simulate.buildings import make_flat, rectangle, single_room
from panoplan.simulate.odometry import drifted, in_units
from panoplan.simulate.walks import stills, walk


def ways(count=20):
    for seed in range(count):
        yield seed, walk(make_flat(seed), np.random.default_rng(seed)).trajectory


def heading_errors(true, found):
    return np.array([(b @ a.T)[0, 2] for a, b in zip(true.rotations, found.rotations, strict=True)])


def test_drift_begins_at_nothing_and_reaches_what_was_asked():
    for seed, true in ways():
        found = drifted(true, 0.4, 1.0, np.random.default_rng(seed))
        off = np.hypot(*(found.translations - true.translations)[:, [0, 2]].T)
        assert off[0] == 0
        assert off.max() == pytest.approx(0.4, abs=1e-6)
        np.testing.assert_array_equal(found.translations[:, 1], true.translations[:, 1])


def test_drift_is_gradual():
    steps, early = [], []
    for seed, true in ways():
        found = drifted(true, 0.4, 1.0, np.random.default_rng(seed))
        off = (found.translations - true.translations)[:, [0, 2]]
        steps.append(np.hypot(*np.diff(off, axis=0).T).max())
        early.append(np.hypot(*off[len(off) // 20]))
    assert max(steps) < 0.06
    assert np.median(early) < 0.08


def test_heading_drifts_too_and_bends_the_way():
    errors = []
    for seed, true in ways():
        found = drifted(true, 0.4, 1.0, np.random.default_rng(seed))
        turn = heading_errors(true, found)
        assert turn[0] == pytest.approx(0, abs=1e-12)
        errors.append(np.abs(turn).max())
    assert 0.2 < np.rad2deg(np.median(errors)) < 2.5


def test_each_step_goes_the_way_the_heading_errs():
    across, slipped = [], []
    for seed, true in ways(40):
        found = drifted(true, 0.4, 1.0, np.random.default_rng(seed))
        turn = heading_errors(true, found)[:-1]
        step = np.diff(true.translations, axis=0)
        off = np.diff(found.translations, axis=0) - step
        across.append(np.stack([turn * step[:, 2], -turn * step[:, 0]], axis=1).ravel())
        slipped.append(off[:, [0, 2]].ravel())
    x, y = np.concatenate(across), np.concatenate(slipped)
    assert x @ y / (x @ x) == pytest.approx(1.0, abs=0.15)


def test_no_drift_is_the_truth():
    _, true = next(ways(1))
    assert drifted(true, 0.0, 0.0, np.random.default_rng(0)) is true


def test_units_scale_translations_only():
    _, true = next(ways(1))
    found = in_units(true, 0.25)
    np.testing.assert_allclose(found.translations, true.translations * 4)
    np.testing.assert_array_equal(found.rotations, true.rotations)


def test_a_single_photo_does_not_drift():
    tour = stills(single_room(rectangle(4, 3)), np.random.default_rng(0), per_room=(1, 1))
    assert drifted(tour.trajectory, 0.4, 1.0, np.random.default_rng(0)) is tour.trajectory
