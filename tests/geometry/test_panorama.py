import numpy as np
from scipy.spatial.transform import Rotation

from panoplan.geometry.panorama import sampled, turned


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


def test_what_rays_meet_is_between_the_pixels_around_them():
    image = np.rint(directions(64)).astype(np.uint8)
    rays = np.random.default_rng(0).normal(size=(500, 3))
    own = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    np.testing.assert_allclose((sampled(image, 3 * rays) - 100) / 100, own, atol=0.03)


def test_rays_go_around_the_seam_and_stop_at_the_poles():
    image = np.zeros((4, 8, 1), dtype=np.uint8)
    image[:, 0], image[:, -1] = 100, 200
    image[0], image[-1] = 7, 9
    backwards, up, down = np.array([[0.0, 0, -1], [0, -1, 0], [0, 1, 0]])
    np.testing.assert_allclose(sampled(image, np.array([backwards, up, down])), [[150], [7], [9]])
