import numpy as np
import pytest
from tests.scenes import RECTANGLE, exact_layout, yaw

from panoplan.config import RegistrationConfig
from panoplan.stages.registration import cast, register
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Pose

CONFIG = RegistrationConfig()


def _cast(layout, rotation=None, translation=(0, 0, 0), config=CONFIG):
    pose = Pose(np.eye(3) if rotation is None else rotation, np.array(translation, dtype=float))
    return cast(Keyframe("a", pose, layout), 0, np.zeros(3), np.eye(2), config)


def test_depression_of_45_degrees_is_one_camera_height_away_along_the_heading():
    view = _cast(Layout(np.full(1024, -np.pi / 4)))
    np.testing.assert_allclose(np.linalg.norm(view.offsets, axis=1), 1.0)
    forward = view.offsets[[511, 512]].mean(axis=0)
    np.testing.assert_allclose(forward, [0, 1], atol=1e-4)
    right = view.offsets[[767, 768]].mean(axis=0)
    np.testing.assert_allclose(right, [1, 0], atol=1e-4)


def test_columns_at_or_above_the_horizon_are_unknown():
    boundary = np.full(64, -0.5)
    boundary[[3, 10, 20]] = [0.0, 0.3, np.nan]
    boundary[30] = -np.deg2rad(CONFIG.min_depression_deg / 2)
    unknown = np.isnan(_cast(Layout(boundary)).offsets[:, 0])
    assert np.flatnonzero(unknown).tolist() == [3, 10, 20, 30]


@pytest.mark.parametrize("tilt_deg", [0.0, 5.0, -10.0])
def test_a_tilted_camera_sees_the_same_floor(tilt_deg):
    t = np.deg2rad(tilt_deg)
    tilt = np.array([[1, 0, 0], [0, np.cos(t), -np.sin(t)], [0, np.sin(t), np.cos(t)]])
    rotation = yaw(0.8) @ tilt
    camera = np.array([0.4, -0.3])
    view = _cast(exact_layout(RECTANGLE, camera, rotation, width=2048), rotation)
    points = view.offsets + camera
    to_wall = np.minimum(np.abs(np.abs(points[:, 0]) - 2.0), np.abs(np.abs(points[:, 1]) - 1.5))
    assert np.quantile(to_wall, 0.98) < 2e-3


def test_height_follows_the_pose_and_scales_the_layout():
    view = _cast(Layout(np.full(64, -np.pi / 4)), translation=(2.0, -0.5, 1.0))
    layout = register(view, 0.4)
    assert layout.height == pytest.approx(1.2)
    np.testing.assert_allclose(layout.camera, [0.8, 0.4])
    np.testing.assert_allclose(np.linalg.norm(layout.boundary - layout.camera, axis=1), 1.2)


def test_the_paper_keeps_the_height():
    config = RegistrationConfig(height_from_pose=False)
    view = _cast(Layout(np.full(64, -0.5)), translation=(0, -0.5, 0), config=config)
    assert register(view, 0.4).height == 1.0


def test_the_ceiling_is_as_high_as_the_layout_says():
    """A ceiling 1.6 above the floor at a wall 1 away, the camera 1 above the floor."""
    floor, ceiling = np.full(64, -np.pi / 4), np.full(64, np.arctan(0.6))
    ceiling[10:20] = np.nan
    assert _cast(Layout(floor, ceiling)).ceiling == pytest.approx(1.6)
    assert np.isnan(_cast(Layout(floor)).ceiling)
    assert register(_cast(Layout(floor, ceiling)), 1.0).ceiling == pytest.approx(1.6)
