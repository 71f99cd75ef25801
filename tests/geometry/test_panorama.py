import numpy as np
from scipy.spatial.transform import Rotation

from panoplan.geometry.panorama import turned


def directions(height):
    """A panorama whose colour is the direction that it shows."""
    heading = 2 * np.pi * (np.arange(2 * height) + 0.5) / (2 * height) - np.pi
    elevation = (np.pi / 2 - np.pi * (np.arange(height) + 0.5) / height)[:, None]
    cos = np.cos(elevation)
    x, y, z = cos * np.sin(heading), -np.sin(elevation) + 0 * heading, cos * np.cos(heading)
    return 100 + 100 * np.stack([x, y, z], axis=-1)


def test_a_turned_camera_sees_the_same_directions_elsewhere():
    image = directions(128)
    cam_from_new = Rotation.from_euler("xyz", [12, 40, -7], degrees=True).as_matrix()
    seen = (turned(image, cam_from_new) - 100) / 100
    # In the new image, a pixel's own direction turned into the old camera is what it shows.
    own = (image - 100) / 100
    np.testing.assert_allclose(seen, own @ cam_from_new.T, atol=0.01)


def test_no_turn_changes_nothing():
    image = directions(64)
    np.testing.assert_allclose(turned(image, np.eye(3)), image, atol=1e-9)
