import numpy as np

from panoplan.types.view import CorrectedLayouts, Correction, RegisteredLayout, picked


def layout(index):
    camera = np.array([3.0 * index, 0.0])
    boundary = camera + np.array([[0.0, 2.0], [1.0, 0.0], [0.0, -2.0], [-1.0, 0.0]])
    return RegisteredLayout(f"kf{index}", index, camera, 1.0, boundary, np.full(4, 0.1), None, 1.6)


def test_a_correction_by_hand():
    moved = Correction((0.5, -1.0), np.pi / 2, 1.1).apply(layout(1))
    np.testing.assert_allclose(moved.camera, [3.5, -1.0])
    # A quarter turn from the first axis to the second takes (0, 2) to (−2, 0).
    expected = [[-2.2, 0.0], [0.0, 1.1], [2.2, 0.0], [0.0, -1.1]]
    np.testing.assert_allclose(moved.boundary - moved.camera, expected, atol=1e-12)
    np.testing.assert_allclose(moved.sigmas, 0.11)
    assert np.isclose(moved.ceiling, 1.76)


def test_corrected_layouts_are_those_that_were_corrected_one_by_one():
    layouts = [layout(k) for k in range(4)]
    corrections = [Correction((0.1 * k, 0.0), 0.2 * k) for k in range(4)]
    made = [c.apply(v) for c, v in zip(corrections, layouts, strict=True)]
    lazy = CorrectedLayouts(layouts, corrections)
    assert len(lazy) == 4
    for some, expected in (
        (list(lazy), made),
        (list(lazy[1:3]), made[1:3]),
        (list(picked(lazy, [3, 0])), [made[3], made[0]]),
        (list(picked(made, [3, 0])), [made[3], made[0]]),
    ):
        assert [v.keyframe for v in some] == [v.keyframe for v in expected]
        for one, other in zip(some, expected, strict=True):
            np.testing.assert_array_equal(one.boundary, other.boundary)
    assert isinstance(picked(lazy, [1]), CorrectedLayouts)
