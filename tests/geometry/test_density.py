import numpy as np
import pytest

from panoplan.geometry.density import registered_entropy


def _entropy(
    offsets, positions, scales, *, sectors=None, n_sectors=1, smooth=False, cell=0.1, saturation=0.0
):
    shape = offsets.shape[:2]
    return registered_entropy(
        offsets,
        np.zeros(shape, dtype=np.int64) if sectors is None else sectors,
        np.ones(shape),
        positions,
        np.zeros(len(offsets)),
        np.asarray(scales, dtype=float),
        cell,
        n_sectors,
        smooth,
        saturation,
    )


def test_entropy_by_hand_does_not_depend_on_the_number_of_points():
    """Four cells with shares 1/2, 1/4, 1/8, 1/8."""
    shares = [4, 2, 1, 1]
    at = np.repeat(np.arange(4) + 0.05, shares)
    points = np.stack([at, np.full(8, 0.05)], axis=1)
    expected = 0.5 * np.log(2) + 0.25 * np.log(4) + 2 * 0.125 * np.log(8)
    once = _entropy(points[None], np.zeros((1, 2)), [1.0])
    thrice = _entropy(np.repeat(points, 3, axis=0)[None], np.zeros((1, 2)), [1.0])
    np.testing.assert_allclose([once[0], thrice[0]], expected)


def test_saturated_counts_by_hand():
    """Cells of 4, 2, 1 and 1 points, saturated at 2, count as 1, 1, 1/2 and 1/2."""
    at = np.repeat(np.arange(4) + 0.05, [4, 2, 1, 1])
    points = np.stack([at, np.full(8, 0.05)], axis=1)
    found = _entropy(points[None], np.zeros((1, 2)), [1.0], saturation=2.0)
    assert found[0] == pytest.approx(2 * 0.5 * np.log(2))


def test_height_scales_the_offsets():
    points = np.array([[[1.0, 0.0], [2.0, 0.0]]])
    args = (np.zeros((1, 2), np.int64), np.ones((1, 2)), np.zeros((1, 2)))
    flat = registered_entropy(points, *args, np.array([-0.99]), np.array([1.0]), 0.1, 1, False)
    assert flat[0] == pytest.approx(0.0)
    tall = registered_entropy(points, *args, np.array([0.0]), np.array([1.0]), 0.1, 1, False)
    assert tall[0] == pytest.approx(np.log(2))


def test_facings_keep_the_two_faces_of_a_wall_apart():
    """Two cameras 3 apart, each before its own face of a wall 0.1 thick."""
    y = np.linspace(-1, 1, 200)
    left = np.stack([np.full(200, 1.45), y], axis=1)
    right = np.stack([np.full(200, -1.45), y], axis=1)
    offsets, positions = np.array([left, right]), np.array([[0.0, 0.0], [3.0, 0.0]])
    merged, true = 2.9 / 3.0, 1.0
    plain = _entropy(offsets, positions, [merged, true], cell=0.03, smooth=True)
    assert plain[0] < plain[1] - 0.3
    sectors = np.array([np.zeros(200), np.full(200, 2)], dtype=np.int64)
    apart = _entropy(
        offsets, positions, [merged, true], sectors=sectors, n_sectors=4, cell=0.03, smooth=True
    )
    assert apart[0] == pytest.approx(apart[1], abs=0.1)


def test_smooth_histogram_has_a_continuous_entropy():
    rng = np.random.default_rng(0)
    offsets = rng.normal(size=(2, 100, 2))
    positions = np.array([[0.0, 0.0], [1.0, 0.0]])
    scales = np.linspace(1, 1.0001, 50)
    smooth = _entropy(offsets, positions, scales, smooth=True)
    assert np.abs(np.diff(smooth)).max() < 1e-3
