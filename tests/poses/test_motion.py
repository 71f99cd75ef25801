import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.poses.motion import check_moving
from panoplan.types.pose import Trajectory


def at(*positions):
    n = len(positions)
    return Trajectory(tuple(map(str, range(n))), np.stack([np.eye(3)] * n), np.array(positions))


@pytest.mark.parametrize("spot", [[0.0, 0, 0], [3.0, 1, -2], [1e-7, 0, 0]])
def test_several_cameras_at_one_spot(spot):
    with pytest.raises(InputError, match=r"walk\.tum: found 4 cameras at one spot"):
        check_moving(at(*[spot] * 4), "walk.tum")


def test_one_camera_or_any_movement_will_do():
    check_moving(at([3.0, 1, -2]), "walk.tum")
    check_moving(at([3.0, 1, -2], [3.0, 1, -2], [3.0, 1, -2.001]), "walk.tum")
    # Trajectory units are arbitrary: a walk in light years moves too.
    check_moving(at([0.0, 0, 0], [1e-16, 0, 0]), "walk.tum")
