"""Storeys, told apart by the height of the cameras."""

import numpy as np
import pytest
from shapely import Polygon
from tests.scenes import L_SHAPE, RECTANGLE, exact_layout, yaw

from panoplan.config import Config, override
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.types.events import LevelReached
from panoplan.types.keyframe import Keyframe
from panoplan.types.pose import Pose

CONFIG = override(Config(), {"scale": {"warmup": 8}})
STOREY = 1.8


def _spots(polygon, count, seed):
    rng = np.random.default_rng(seed)
    inner = Polygon(polygon).buffer(-0.4)
    spots = []
    while len(spots) < count:
        spot = rng.uniform(polygon.min(axis=0), polygon.max(axis=0))
        if inner.contains(Polygon([spot, spot + 1e-6, spot + [0, 1e-6]])):
            spots.append(spot)
    return spots


def _keyframes(polygon, spots, rises, first, height=1.0):
    """Cameras `rises` above the first one; the floor is `height` below each."""
    return [
        Keyframe(
            f"kf{first + k:03d}",
            Pose(yaw(0.3 * k), [spot[0], -rise, spot[1]]),
            exact_layout(polygon, np.asarray(spot), yaw(0.3 * k), height=height),
        )
        for k, (spot, rise) in enumerate(zip(spots, rises, strict=True))
    ]


def _house():
    below = _keyframes(RECTANGLE, _spots(RECTANGLE, 14, 1), [0.0] * 14, 0)
    stairs = _keyframes(RECTANGLE, [[1.0, 0.5]] * 3, [0.5, 0.95, 1.4], 14)
    above = _keyframes(
        L_SHAPE, _spots(L_SHAPE, 14, 2), [STOREY + 0.02 * (-1) ** k for k in range(14)], 17
    )
    return below, stairs, above


def _fed(keyframes, config=CONFIG):
    estimator = FloorPlanEstimator(config)
    events = [event for k in keyframes for event in estimator.update(k)]
    events += estimator.finish()
    return estimator.plan(), [e.level for e in events if isinstance(e, LevelReached)]


@pytest.mark.parametrize("preset", ["fusion", "ispa"])
def test_rooms_above_one_another_share_no_map(preset):
    below, stairs, above = _house()
    config = override(CONFIG, {"shape": {"method": preset}})
    plan, reached = _fed([*below, *stairs, *above], config)
    assert reached == [1]
    assert [room.level for room in plan.rooms] == [0, 1]
    one, other = (Polygon(room.polygon).area for room in plan.rooms)
    assert one == pytest.approx(Polygon(RECTANGLE).area, rel=0.05)
    assert other == pytest.approx(Polygon(L_SHAPE).area, rel=0.05)
    left_out = {s.keyframe for s in plan.skipped if "stairs" in s.reason}
    assert left_out == {k.id for k in stairs}


def test_who_comes_back_down_is_on_the_first_level_again():
    below, stairs, above = _house()
    down = _keyframes(RECTANGLE, _spots(RECTANGLE, 6, 3), [0.0] * 6, 40)
    plan, reached = _fed([*below, *stairs, *above, *down])
    assert reached == [1, 0]
    assert [room.level for room in plan.rooms] == [0, 1]
    assert {k.id for k in down} <= set(plan.rooms[0].keyframes)


def test_a_camera_held_high_for_a_moment_starts_no_level():
    below, _, _ = _house()
    spots = _spots(RECTANGLE, 2, 4)
    lifted = _keyframes(RECTANGLE, spots, [0.5, 0.5], 50, height=1.5)
    plan, reached = _fed([*below[:10], *lifted, *below[10:]])
    assert reached == []
    assert len(plan.rooms) == 1
    assert {k.id for k in lifted} <= set(plan.rooms[0].keyframes)


def test_a_height_that_drifts_starts_no_level():
    spots = _spots(RECTANGLE, 60, 5)
    rises = np.linspace(0.0, 0.6, 60)
    _, reached = _fed(_keyframes(RECTANGLE, spots, rises, 0))
    assert reached == []


def test_stairs_during_the_warm_up_do_not_spoil_the_scale():
    below, stairs, above = _house()
    config = override(CONFIG, {"scale": {"warmup": 31}})
    plan, _ = _fed([*below, *stairs, *above], config)
    assert plan.scale.ch_per_su == pytest.approx(1.0, rel=0.01)
    assert [room.level for room in plan.rooms] == [0, 1]


def _told(plan, keyframes):
    """Those of the keyframes that were left out as on stairs."""
    out = {s.keyframe for s in plan.skipped if "stairs" in s.reason}
    return [k.id for k in keyframes if k.id in out]


def test_a_walk_that_ends_on_stairs_has_no_storey_there():
    below, stairs, _ = _house()
    plan, reached = _fed([*below, *stairs])
    assert reached == []
    assert [room.level for room in plan.rooms] == [0]
    assert _told(plan, stairs) == [k.id for k in stairs]


def test_a_walk_that_ends_at_the_foot_of_the_stairs_is_back_where_it_was():
    below, stairs, above = _house()
    down = _keyframes(RECTANGLE, [[1.0, 0.5]] * 3, [1.1, 0.6, 0.1], 40)
    plan, reached = _fed([*below, *stairs, *above, *down])
    assert reached == [1, 0]
    assert [room.level for room in plan.rooms] == [0, 1]
    assert _told(plan, down) == [k.id for k in down[:2]]
    assert down[2].id in plan.rooms[0].keyframes


def test_photos_of_a_storey_that_the_walk_ends_on_make_it():
    below, _, above = _house()
    plan, reached = _fed([*below, *above[:2]])
    assert reached == [1]
    assert {k.id for k in above[:2]} == set(plan.rooms[1].keyframes)
