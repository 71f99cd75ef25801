import numpy as np
import pytest
from tests.exporters.storeys import flat, two_storeys
from tests.metrics.plans import FLAT, plan, square

from panoplan.exporters.storeys import bounds, inner_walls, spread, storeys


def test_what_is_of_which_storey():
    low, high = storeys(two_storeys())
    assert ([r.id for r in low.rooms], [r.id for r in high.rooms]) == (
        ["room_01", "room_02", "room_03"],
        ["room_04"],
    )
    assert ([d.id for d in low.doors], [d.id for d in high.doors]) == (["door_01"], ["door_02"])
    # An opening that names neither rooms nor walls is of the lowest.
    assert (len(low.openings), len(high.openings)) == (1, 0)
    assert (len(low.shared_walls), len(high.shared_walls)) == (1, 0)
    assert set(high.walls) == {"wall_30", "wall_31", "wall_32", "wall_33"}


def test_a_plan_without_rooms_has_no_storey():
    assert storeys(plan((), ())) == ()


def test_inner_walls_fill_what_lies_between_rooms():
    # 0.2 m between the rooms over their common 3 m, and around the corners.
    (floor,) = storeys(plan((square(0, 0), square(2.1, 0)), openings=()))
    solid = inner_walls(floor)
    assert solid.area == pytest.approx(0.1 * 2.0, rel=0.02)
    assert solid.bounds == pytest.approx((2.0, 0.0, 2.1, 2.0), abs=1e-3)
    (whole,) = storeys(plan(FLAT, openings=()))
    (open_floor,) = storeys(plan(FLAT))
    gone = inner_walls(whole).area - inner_walls(open_floor).area
    assert gone >= 0.0
    assert np.isfinite(gone)


def test_a_drawing_has_storeys_beside_one_another():
    made = two_storeys()
    drawn = spread(made, 40.0)
    assert [room.id for room in drawn.rooms] == [room.id for room in made.rooms]
    for room, before in zip(drawn.rooms, made.rooms, strict=True):
        if before.polygon is None:
            assert room.polygon is None
            continue
        shift = [40.0 * before.level, 0.0]
        assert room.polygon == pytest.approx(before.polygon + shift)
        assert all(
            wall.a == pytest.approx(old.a + shift)
            for wall, old in zip(room.walls, before.walls, strict=True)
        )
    up = next(door for door in drawn.doors if door.rooms == ("room_04",))
    assert up.segment[:, 0] == pytest.approx([42.0, 42.9])
    low, high = (bounds(storey, np.eye(2)) for storey in storeys(spread(made)))
    assert low[1][0] < high[0][0]


def test_one_storey_is_drawn_where_it_is():
    same = flat()
    assert spread(same) is same
