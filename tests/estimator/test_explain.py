"""What is told of a walk through two rooms, with two cameras in the door between them."""

from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import RECTANGLE, walk

from panoplan.config import Config, override
from panoplan.estimator.explain import SCALE_FACTORS, explain
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.types.explain import Raster

SPOTS = np.array([[-1.2, 0.3], [0.4, -0.8], [1.3, 0.7], [-0.5, 0.9], [0.9, -0.2], [0.1, 0.1]])
NEXT = np.array([4.2, 0.0])
FACTOR = 2.0
DOOR = 4
"""Number of a keyframe that stands 0.1 from a wall."""


def keyframes():
    spots = SPOTS.copy()
    spots[DOOR] = [1.9, -0.2]
    left = walk(RECTANGLE, spots, factor=FACTOR)
    right = walk(RECTANGLE + NEXT, SPOTS + NEXT, factor=FACTOR)
    return left + [replace(k, id="r" + k.id) for k in right]


def explained(method, walked=None, known=None):
    config = override(Config(), {"scale": {"warmup": 6}, "shape": {"method": method}})
    walked = keyframes() if walked is None else walked
    estimator = FloorPlanEstimator(config, known)
    for keyframe in walked:
        estimator.update(keyframe)
    estimator.finish()
    return explain(estimator.state, walked, config), estimator.plan()


@pytest.fixture(scope="module")
def fused():
    return explained("fusion")


@pytest.fixture(scope="module")
def by_ispa():
    return explained("ispa")


def off_walls(points):
    """Distance from the nearest wall of the two rooms."""
    across = np.abs(points[:, :1] - np.array([-2.0, 2.0, 2.2, 6.2])).min(axis=1)
    return np.minimum(across, np.abs(np.abs(points[:, 1]) - 1.5))


def test_a_raster_turns_with_its_axes():
    raster = Raster(
        np.array([1.0, 2.0]), 0.5 * np.array([[0.0, 1.0], [-1.0, 0.0]]), np.ones((4, 3))
    )
    assert raster.cell == 0.5
    np.testing.assert_allclose(raster.at(np.array([[2.0, 0.0], [0.0, 2.0]])), [[1, 3], [0, 2]])


@pytest.mark.parametrize("method", ["fused", "by_ispa"])
def test_clouds_at_the_scale_used_lie_on_the_walls_and_others_do_not(method, request):
    found, plan = request.getfixturevalue(method)
    used = found.scale.used.ch_per_su
    clouds = [cloud for cloud in found.scale.clouds if not cloud.adjusted]
    assert [cloud.ch_per_su for cloud in clouds] == [factor * used for factor in SCALE_FACTORS]
    assert all(cloud.points.shape == (12 * 1024, 2) for cloud in clouds)
    off = [float(np.quantile(off_walls(cloud.points), 0.9)) for cloud in clouds]
    assert off[1] < 0.05
    assert min(off[0], off[2]) > 2 * off[1]
    assert found.scale.searched is found.scale.used
    assert found.unit == plan.unit == "ch"


def test_a_given_scale_is_compared_with_what_the_layouts_say():
    found, plan = explained("ispa", known=Walk("m", 1.0 / FACTOR))
    assert found.unit == plan.unit == "m"
    assert found.scale.used.method == "given"
    assert found.scale.searched.curve is not None
    assert found.scale.searched.ch_per_su == pytest.approx(found.scale.used.ch_per_su, rel=0.01)
    # Metres here are the trajectory's unit: half as long as the scene's.
    assert off_walls(FACTOR * found.scale.clouds[1].points).max() < 0.1


@pytest.mark.parametrize("method", ["fused", "by_ispa"])
def test_rooms_and_views_are_those_of_the_plan(method, request):
    found, plan = request.getfixturevalue(method)
    assert [room.id for room in found.rooms] == [room.id for room in plan.rooms]
    for room, planned in zip(found.rooms, plan.rooms, strict=True):
        assert room.failure == planned.failure
        if planned.polygon is not None:
            assert {tuple(p) for p in np.round(room.polygon, 9)} == {
                tuple(p) for p in np.round(planned.polygon, 9)
            }
        # The mask's middle lies in the room.
        mask = np.argwhere(room.density.values >= 0.5) + 0.5
        middle = room.density.at(mask).mean(axis=0)
        np.testing.assert_allclose(middle, planned.polygon.mean(axis=0), atol=0.15)
    placed = [pose for pose in plan.trajectory if pose.room is not None]
    assert [view.keyframe for view in found.views] == [pose.id for pose in placed]
    assert [view.room for view in found.views] == [pose.room for pose in placed]
    np.testing.assert_allclose(
        [view.camera for view in found.views], [pose.position for pose in placed], atol=1e-9
    )


def test_views_are_grouped_room_by_room_and_doorways_marked(fused):
    found, _ = fused
    (grouping,) = found.groupings
    rooms = [found.views[k].room for k in grouping.views]
    assert rooms == sorted(rooms)
    same = np.array(rooms)[:, None] == np.array(rooms)
    assert grouping.overlaps[same].min() > 0.8
    assert grouping.overlaps[~same].max() < 0.1
    assert [k for k, view in enumerate(found.views) if view.doorway] == [DOOR]


def test_fused_floors_tell_the_field_the_cut_and_the_fit(fused):
    found, _ = fused
    for room in found.rooms:
        assert room.walls is None
        floor = room.floor
        assert len(floor.pieces) == len(floor.fitted) == len(floor.sigmas) == 4
        assert off_walls(np.concatenate(floor.pieces)).max() < 0.1
        assert off_walls(floor.fitted).max() < 0.02
        # The field is the distance from the wall, up to its truncation.
        cells = np.argwhere(floor.distance.values > -0.15)
        off = off_walls(floor.distance.at(cells + 0.5))
        told = np.abs(floor.distance.values[tuple(cells.T)])
        assert np.median(np.abs(np.minimum(off, 0.2) - told)) < 0.02


def test_ispa_tells_planes_and_rounds(by_ispa):
    found, _ = by_ispa
    assert found.groupings == ()
    grids = found.config.shape.grids
    for room in found.rooms:
        assert room.floor is None
        assert len(room.walls.kept) >= 6 * 4
        assert off_walls(np.concatenate(room.walls.kept)).max() < 0.05
        assert [max(r.wall.values.shape) for r in room.walls.rounds] == list(grids)
        for made in room.walls.rounds:
            assert made.mask.shape == made.wall.values.shape
            on = np.argwhere(made.wall.values > 0.9) + 0.5
            assert np.median(off_walls(made.wall.at(on))) < 0.05
            # Corners are some of the candidates.
            gap = np.linalg.norm(made.corners[:, None] - made.candidates, axis=2).min(axis=1)
            np.testing.assert_allclose(gap, 0, atol=1e-9)
        np.testing.assert_allclose(
            sorted(map(tuple, room.walls.rounds[-1].corners)), sorted(map(tuple, room.polygon))
        )


def test_rejected_pieces_keep_their_reason():
    far = walk(8 * RECTANGLE, SPOTS, factor=FACTOR)
    found, _ = explained("ispa", [*keyframes(), replace(far[0], id="far")])
    told = {why for room in found.rooms for why, _ in room.walls.rejected}
    assert "too far" in told


def test_a_walk_without_rooms_is_explained_too():
    (one,) = walk(RECTANGLE, SPOTS[:1])
    found, _ = explained("fusion", [replace(one, layout=None)])
    assert (found.rooms, found.views, found.scale.clouds) == ((), (), ())
    found, _ = explained("fusion", [one])
    assert len(found.rooms) == len(found.scale.clouds) == 1
    assert found.scale.searched is None
