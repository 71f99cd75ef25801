import numpy as np
from scipy.spatial.transform import Rotation

from panoplan.geometry.similarity import fit_similarity


def test_a_known_similarity_is_found_again():
    rng = np.random.default_rng(0)
    source = rng.normal(size=(20, 3))
    rotation = Rotation.from_rotvec([0.3, -1.2, 2.0]).as_matrix()
    target = 2.5 * source @ rotation.T + [1, -2, 3]
    fit = fit_similarity(source, target)
    np.testing.assert_allclose(fit.scale, 2.5)
    np.testing.assert_allclose(fit.rotation, rotation, atol=1e-12)
    np.testing.assert_allclose(fit(source), target, atol=1e-12)


def test_a_mirror_image_is_not_reached_by_mirroring():
    rng = np.random.default_rng(1)
    source = rng.normal(size=(20, 3))
    fit = fit_similarity(source, source * [1, 1, -1])
    assert np.linalg.det(fit.rotation) > 0


def test_points_in_a_plane_leave_no_mirror():
    source = np.random.default_rng(2).normal(size=(20, 3)) * [1, 0, 1]
    rotation = Rotation.from_rotvec([0, 0.7, 0]).as_matrix()
    fit = fit_similarity(source, source @ rotation.T)
    np.testing.assert_allclose(fit.rotation, rotation, atol=1e-12)
