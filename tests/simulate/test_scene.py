import numpy as np
import pytest

from panoplan.simulate.scene import simulate_flat


def test_the_same_seed_gives_the_same_scene():
    first, second = simulate_flat(3, "hard"), simulate_flat(3, "hard")
    assert first.metres_per_su == second.metres_per_su
    for a, b in zip(first.keyframes, second.keyframes, strict=True):
        np.testing.assert_array_equal(a.pose.translation, b.pose.translation)
        np.testing.assert_array_equal(a.layout.floor_boundary, b.layout.floor_boundary)


@pytest.mark.parametrize(("grade", "drift"), [("exact", 0.0), ("mild", 0.05), ("hard", 0.4)])
def test_odometry_drifts_from_the_first_keyframe_on(grade, drift):
    scene = simulate_flat(5, grade)
    off = scene.odometry.translations * scene.metres_per_su - scene.truth.trajectory.translations
    distance = np.hypot(off[:, 0], off[:, 2])
    assert distance[0] == pytest.approx(0.0, abs=1e-12)
    assert distance.max() == pytest.approx(drift, abs=1e-6)
