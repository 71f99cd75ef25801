import numpy as np
import pytest
import shapely
from tests.exporters.storeys import flat
from tests.metrics.plans import plan, square

from panoplan.exporters.bodies import OUTER_THICKNESS_M, body_of, wall_bodies
from panoplan.exporters.storeys import room_area, storeys
from panoplan.types.plan import Aperture, SharedWall


def bodies_of(made):
    (floor,) = storeys(made)
    return {body.id: body for body in wall_bodies(floor)}


def two_squares(solid=True, shift=0.5):
    """Squares of 2 m, 0.1 m apart, the second `shift` further up."""
    shared = SharedWall("shared_01", ("wall_01", "wall_13"), 0.1, True, solid)
    return plan((square(0, 0), square(2.1, shift)), shared_walls=(shared,))


def test_a_shared_wall_is_a_body_over_what_its_faces_have_in_common():
    body = bodies_of(two_squares())["shared_01"]
    assert body.footprint.area == pytest.approx(0.1 * 1.5)
    assert body.footprint.bounds == pytest.approx((2.0, 0.5, 2.1, 2.0))
    assert (body.length, body.thickness, body.outer) == (pytest.approx(1.5), 0.1, False)


def test_what_is_not_shared_is_outer_wall():
    found = bodies_of(two_squares())
    # 0.5 m of the face between the rooms look out; the rest is behind the shared wall.
    assert found["wall_01"].length == pytest.approx(0.5)
    assert found["wall_01"].outer
    # Around the corner at its end.
    whole = found["wall_00"]
    assert whole.footprint.area == pytest.approx((2.0 + OUTER_THICKNESS_M) * OUTER_THICKNESS_M)


def test_there_is_no_body_where_rooms_only_end():
    assert "shared_01" not in bodies_of(two_squares(solid=False))


def test_bodies_keep_out_of_rooms():
    made = flat()
    rooms = shapely.union_all([room_area(room) for room in made.rooms])
    for body in bodies_of(made).values():
        assert body.footprint.intersection(rooms).area < 1e-9
        assert body.footprint.area > 0


def test_a_door_is_in_the_nearest_body_of_its_walls():
    made = two_squares()
    found = bodies_of(made).values()
    walls = ("wall_01", "wall_13")
    door = Aperture("d", np.array([[2.05, 1.0], [2.05, 1.8]]), (), walls)
    low = Aperture("d", np.array([[2.0, 0.1], [2.0, 0.4]]), (), ("wall_01",))
    assert body_of(door, found).id == "shared_01"
    assert body_of(low, found).id == "wall_01"
    assert body_of(Aperture("d", door.segment), found) is None
