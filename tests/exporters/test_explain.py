"""Pictures of the stages, of a walk through two rooms."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from tests.scenes import RECTANGLE, walk

from panoplan.config import Config, override
from panoplan.estimator.explain import SCALE_FACTORS, explain
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.exporters.explain.pictures import write_explanation

SPOTS = np.array([[-1.2, 0.3], [0.4, -0.8], [1.3, 0.7], [-0.5, 0.9], [0.9, -0.2], [0.1, 0.1]])
NEXT = np.array([4.1, 0.0])


def _keyframes():
    left, right = walk(RECTANGLE, SPOTS), walk(RECTANGLE + NEXT, SPOTS + NEXT)
    return left + [replace(k, id="r" + k.id) for k in right]


def _explained(method, keyframes=None):
    config = override(Config(), {"scale": {"warmup": 6}, "shape": {"method": method}})
    keyframes = _keyframes() if keyframes is None else keyframes
    estimator = FloorPlanEstimator(config)
    for keyframe in keyframes:
        estimator.update(keyframe)
    estimator.finish()
    return explain(estimator.state, keyframes, config)


@pytest.fixture(scope="module", params=["fusion", "ispa"])
def explained(request):
    return request.param, _explained(request.param)


def test_clouds_are_registered_at_each_scale(explained):
    _, found = explained
    assert [factor for factor, _ in found.clouds] == list(SCALE_FACTORS)
    assert all(len(points) == 12 * 1024 for _, points in found.clouds)
    # At the scale found, all points lie on the walls of the two rooms.
    origin = SPOTS[0]
    points = next(points for factor, points in found.clouds if factor == 1.0) + origin
    off = np.abs(np.abs(points[:, 1]) - 1.5)
    sides = np.abs(points[:, :1] - np.array([-2.0, 2.0, 2.1, 6.1])).min(axis=1)
    assert np.minimum(off, sides).max() < 0.1


def test_rooms_tell_how_they_came_about(explained):
    method, found = explained
    assert [room.id for room in found.rooms] == ["room_01", "room_02"]
    for room in found.rooms:
        assert len(room.cameras) == 6
        assert room.failure is None
        assert np.nanmax(room.density.values) == 1.0
        if method == "ispa":
            assert len(room.rounds) == 3
            assert len(room.kept) >= 6 * 3
            assert room.distance is None
        else:
            assert not room.rounds
            assert room.distance.values.max() > 0
            assert len(room.columns) == 6 * 1024
            assert len(room.sigmas) == len(room.outline) == 4


def test_a_picture_a_stage_none_of_them_blank(explained, tmp_path):
    _, found = explained
    files = write_explanation(tmp_path / "explain", found)
    assert [file.name for file in files] == ["scale.png", "rooms.png", "walls.png", "shapes.png"]
    for file in files:
        with Image.open(file) as image:
            assert max(image.size) == 2400
            assert len(np.unique(np.asarray(image.convert("L")))) > 50


def test_a_walk_without_rooms_is_explained_too(tmp_path):
    one = walk(RECTANGLE, SPOTS[:1])
    blind = [replace(one[0], layout=None)]
    assert len(write_explanation(tmp_path, _explained("fusion", blind))) == 1
    assert len(write_explanation(tmp_path, _explained("fusion", one))) == 4
