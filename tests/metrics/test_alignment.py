import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.metrics.plans import CAMERAS, FLAT, plan, truth, turned

from panoplan.errors import InputError
from panoplan.metrics.alignment import (
    Similarity,
    align,
    common_cameras,
    fit,
    transformed,
)

angles = st.floats(-np.pi, np.pi)
shifts = st.tuples(st.floats(-50, 50), st.floats(-50, 50))
scales = st.floats(0.05, 20.0)


@given(angles, shifts, scales)
@settings(max_examples=50, deadline=None)
def test_similarity_is_recovered(angle, shift, scale):
    moved = turned(CAMERAS, angle, shift, scale)
    found = fit(moved, CAMERAS, "similarity")
    assert found.apply(moved) == pytest.approx(CAMERAS, abs=1e-6)
    assert found.scale == pytest.approx(1 / scale)


@given(angles, shifts)
@settings(max_examples=50, deadline=None)
def test_rigid_motion_is_recovered_and_keeps_lengths(angle, shift):
    moved = turned(CAMERAS, angle, shift)
    found = fit(moved, CAMERAS, "rigid")
    assert found.apply(moved) == pytest.approx(CAMERAS, abs=1e-6)
    assert found.scale == 1.0


def test_scale_is_about_the_origin_of_the_plan_frame():
    assert fit(CAMERAS / 1.7, CAMERAS, "scale").scale == pytest.approx(1.7)
    # A shift cannot be undone by it: with p = (1, 0), (3, 0) and q = p + 1 along x the best
    # factor is (1·2 + 3·4) / (1 + 9).
    p = np.array([[1.0, 0.0], [3.0, 0.0]])
    assert fit(p, p + [1.0, 0.0], "scale").scale == pytest.approx(1.4)


def test_a_mirror_image_is_not_fitted():
    mirrored = CAMERAS * [-1.0, 1.0]
    found = fit(mirrored, CAMERAS, "similarity")
    assert np.linalg.det(found.matrix) > 0
    assert not np.allclose(found.apply(mirrored), CAMERAS, atol=0.1)


def test_too_little_to_align_is_refused():
    with pytest.raises(InputError, match="at least 2"):
        fit(CAMERAS[:1], CAMERAS[:1], "rigid")
    with pytest.raises(InputError, match="one place"):
        fit(np.ones((3, 2)), CAMERAS[:3], "similarity")
    with pytest.raises(InputError, match="positive"):
        fit(-CAMERAS, CAMERAS, "scale")
    with pytest.raises(InputError, match="one of none, scale"):
        align(plan(), truth(), "affine")
    with pytest.raises(InputError, match="no true trajectory"):
        align(plan(), truth(cameras=None), "scale")


def test_cameras_correspond_by_id():
    ours, true = common_cameras(plan(cameras=CAMERAS[:3] * 2), truth().trajectory)
    assert ours == pytest.approx(true * 2)
    assert true == pytest.approx(CAMERAS[:3])


def test_a_plan_in_camera_heights_is_made_metric_by_the_true_height():
    small = plan(tuple(p / 1.5 for p in FLAT), CAMERAS / 1.5, unit="ch")
    for freedom in ("none", "rigid"):
        found = align(small, truth(), freedom)
        assert found.true_from_plan.scale == pytest.approx(1.5)
        assert found.residual_rmse_m == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(InputError, match="no camera height"):
        align(small, truth(camera_height_m=None), "none")


def test_everything_of_a_plan_moves():
    quarter = Similarity(2.0, np.pi / 2, np.array([1.0, 0.0]))
    moved = transformed(plan(), quarter)
    # (4, 3) scaled to (8, 6), turned counter-clockwise to (-6, 8), shifted to (-5, 8).
    assert moved.rooms[0].polygon[2] == pytest.approx([-5.0, 8.0])
    assert moved.rooms[0].walls[1].b == pytest.approx([-5.0, 8.0])
    assert moved.rooms[0].walls[1].sigma == pytest.approx(0.04)
    assert moved.rooms[0].orientations == pytest.approx((np.pi / 2, 1.5 + np.pi / 2))
    assert moved.rooms[0].area_sigma == pytest.approx(0.8)
    assert moved.shared_walls[0].thickness == pytest.approx(0.24)
    assert moved.doors[0].segment[0] == pytest.approx([-1.0, 8.0])
    # A camera that looks along +z (heading 0) then looks along -x (heading -π/2).
    assert moved.trajectory[0].heading == pytest.approx(-np.pi / 2)
    assert moved.trajectory[0].position == pytest.approx([-1.0, 2.0])
