"""A short walk through two painted rooms, its features found once."""

import numpy as np
import pytest
from tests.walks import path_poses, picture, two_rooms

WIDTH, HEIGHT = 512, 256
PATH = [(-2.6, -0.6), (-2.2, 0.5), (-1.0, 0.2), (1.0, -0.1), (2.2, 0.5)]


@pytest.fixture(scope="session")
def walk_poses():
    return path_poses(PATH, 0.26)


@pytest.fixture(scope="session")
def walk_pictures(walk_poses):
    rooms = two_rooms()
    return [
        picture(rooms, rotation, position, HEIGHT)
        for rotation, position in zip(walk_poses.rotations, walk_poses.translations, strict=True)
    ]


@pytest.fixture(scope="session")
def walk_features(walk_pictures):
    pytest.importorskip("pycolmap", reason="needs the extra images")
    from panoplan.poses.walk.features import Extractor

    extract = Extractor()
    return [extract(np.ascontiguousarray(p[..., 0])) for p in walk_pictures]
