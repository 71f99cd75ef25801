import numpy as np
import pytest
from tests.exporters.storeys import flat
from tests.metrics.plans import plan, square
from tests.scenes import T_SHAPE

from panoplan.editing.nudge import nudged
from panoplan.errors import InputError
from panoplan.geometry.polygons import signed_area


def consistent(made):
    for room in made.rooms:
        assert np.array([w.a for w in room.walls]) == pytest.approx(room.polygon)
        for one, other in zip(room.walls, (*room.walls[1:], room.walls[0]), strict=True):
            assert one.b == pytest.approx(other.a)


def test_a_wall_moves_out_and_its_neighbours_follow():
    made = nudged(plan((square(0, 0),)), "wall_01", 0.3)
    consistent(made)
    assert made.rooms[0].polygon == pytest.approx(np.array([[0, 0], [2.3, 0], [2.3, 2], [0, 2]]))
    back = nudged(made, "wall_01", -0.3)
    assert back.rooms[0].polygon == pytest.approx(square(0, 0))


def test_slanted_neighbours_are_followed_along_themselves():
    trapezium = np.array([[0.0, 0.0], [4.0, 0.0], [3.0, 1.0], [1.0, 1.0]])
    made = nudged(plan((trapezium,), shared_walls=()), "wall_02", 0.5)
    consistent(made)
    assert made.rooms[0].polygon[2:] == pytest.approx(np.array([[2.5, 1.5], [1.5, 1.5]]))


def test_a_neighbour_that_runs_on_leaves_a_step():
    ring = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    made = nudged(plan((ring,)), "wall_01", 0.2)
    consistent(made)
    (room,) = made.rooms
    assert signed_area(room.polygon) == pytest.approx(4.0 + 0.2)
    assert len(room.walls) == 6
    assert len({w.id for w in room.walls}) == 6


def test_a_shared_wall_becomes_thinner_and_its_door_moves_along():
    made = nudged(flat(), "wall_01", 0.1)
    assert made.shared_walls[0].thickness == pytest.approx(0.1)
    # Half as far: it stays in the middle.
    assert made.doors[0].segment[:, 0] == pytest.approx([4.15, 4.15])
    with pytest.raises(InputError, match=r"through the wall.*0\.200"):
        nudged(flat(), "wall_01", 0.21)


def test_a_window_moves_with_its_wall():
    from dataclasses import replace

    window = replace(flat().windows[0], walls=("wall_03",), rooms=("room_01",))
    made = nudged(flat(windows=(window,)), "wall_03", 0.25)
    assert made.windows[0].segment[:, 0] == pytest.approx([-0.25, -0.25])


def test_a_room_is_not_turned_inside_out():
    with pytest.raises(InputError, match="inside out"):
        nudged(plan((square(0, 0),)), "wall_01", -2.5)
    with pytest.raises(InputError, match="inside out"):
        nudged(plan((T_SHAPE,)), "wall_00", -8.0)
