import numpy as np
import pytest

from panoplan.simulate.buildings import rectangle, single_room
from panoplan.simulate.flats import make_flat
from panoplan.simulate.odometry import (
    MEASURED_ODOMETRY,
    MEASURED_TOUR,
    OdometryErrors,
    drifted,
    in_units,
    toured,
    wandered,
)
from panoplan.simulate.walks import stills, walk
from panoplan.types.pose import Trajectory


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


def straight(length, step=0.5):
    """A level camera that goes along z and looks there."""
    n = int(length / step) + 1
    translations = np.zeros((n, 3))
    translations[:, 2] = step * np.arange(n)
    return Trajectory(tuple(map(str, range(n))), np.tile(np.eye(3), (n, 1, 1)), translations)


def ends(errors, count=600, length=100.0):
    true = straight(length)
    found = [wandered(true, errors, np.random.default_rng(k))[0] for k in range(count)]
    return np.array([f.translations[-1, [0, 2]] for f in found]) - [0, length], found


def test_errors_of_a_slam_grow_with_the_root_of_the_way():
    slip = OdometryErrors(slip_m=0.2)
    far, _ = ends(slip)
    near, _ = ends(slip, length=25.0)
    np.testing.assert_allclose(far.std(axis=0), 0.2, rtol=0.1)
    np.testing.assert_allclose(near.std(axis=0), 0.1, rtol=0.1)


def test_heading_bends_and_scale_stretches_what_follows():
    off, found = ends(OdometryErrors(heading_deg=2.0))
    turned = [np.arctan2(f.rotations[-1][0, 2], f.rotations[-1][2, 2]) for f in found]
    assert np.rad2deg(np.std(turned)) == pytest.approx(2.0, rel=0.1)
    # The integral of a Brownian motion over the way has a variance of a third.
    assert off[:, 0].std() == pytest.approx(100 * np.deg2rad(2) / np.sqrt(3), rel=0.12)
    off, _ = ends(OdometryErrors(scale=0.03))
    assert off[:, 1].std() == pytest.approx(100 * 0.03 / np.sqrt(3), rel=0.12)
    assert np.abs(off[:, 0]).max() < 1e-9


def test_a_jump_moves_all_that_follows_by_one_motion():
    true = straight(50.0)
    errors = OdometryErrors(jump_share=1.0, jump_m=0.5)
    for seed in range(20):
        found, kept = wandered(true, errors, np.random.default_rng(seed))
        assert kept.all()
        off = found.translations - true.translations
        steps = np.abs(np.diff(off, axis=0)).max(axis=1)
        assert (steps > 1e-9).sum() == 1
        assert 5.0 < true.translations[np.argmax(steps), 2] < 50.0


def test_a_lost_piece_has_the_length_asked_for():
    errors = OdometryErrors(lost_share=1.0, lost_m=(3.0, 5.0))
    for seed in range(20):
        _, kept = wandered(straight(60.0, 0.1), errors, np.random.default_rng(seed))
        gone = np.flatnonzero(~kept)
        assert 29 <= len(gone) <= 51
        assert np.ptp(gone) == len(gone) - 1
        assert kept[:60].all()


def test_measured_odometry_agrees_with_the_truth_at_first():
    jumps, losses = 0, 0
    for seed in range(200):
        found, kept = wandered(straight(30.0), MEASURED_ODOMETRY, np.random.default_rng(seed))
        np.testing.assert_array_equal(found.translations[0], 0.0)
        np.testing.assert_array_equal(found.rotations[0], np.eye(3))
        steps = np.hypot(*np.diff(found.translations[:, [0, 2]], axis=0).T)
        jumps += np.abs(steps - 0.5).max() > 0.05
        losses += not kept.all()
    assert 0.15 < jumps / 200 < 0.4
    assert losses / 200 == pytest.approx(0.25, abs=0.08)


def test_stills_err_as_an_aligner_of_photos_does():
    tour = stills(make_flat(1), np.random.default_rng(1))
    true, off, turns, astray = tour.trajectory, [], [], 0
    for seed in range(300):
        found = toured(true, tour.rooms, MEASURED_TOUR, np.random.default_rng(seed))
        gap = np.hypot(*(found.translations - true.translations)[:, [0, 2]].T)
        wrong = np.unique(tour.rooms[gap > 1.5])
        astray += len(wrong)
        assert tour.rooms[0] not in wrong
        off.append(gap[~np.isin(tour.rooms, wrong)])
        turns.append(np.abs(heading_errors(true, found)))
    assert np.sqrt(np.mean(np.concatenate(off) ** 2)) == pytest.approx(0.13, rel=0.05)
    assert np.rad2deg(np.median(turns)) == pytest.approx(0.45, rel=0.05)
    rooms = len(np.unique(tour.rooms)) - 1
    assert astray / 300 / rooms == pytest.approx(1 / 20, rel=0.3)
