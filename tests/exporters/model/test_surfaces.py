import numpy as np
import pytest
from tests.exporters.storeys import flat, turned_plan, two_storeys
from tests.metrics.plans import plan, square

from panoplan.exporters.heights import DOOR_HEAD_M
from panoplan.exporters.model.surfaces import plan_surfaces
from panoplan.exporters.storeys import room_area

AREAS = {"room_01": 12.0, "room_02": 11.4, "room_03": 10.44}


def by_id(made):
    return {surface.id: surface for surface in plan_surfaces(made)}


def meshed_area(surface):
    points, faces = surface.triangles()
    a, b, c = (surface.in_space(points)[faces[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


@pytest.mark.parametrize("made", [flat(), turned_plan(0.7)], ids=["flat", "turned"])
def test_floors_and_ceilings_have_the_rooms_areas(made):
    found = by_id(made)
    for room in made.rooms:
        for kind, height in (("floor", 0.0), ("ceiling", 2.5)):
            surface = found[f"{room.id}_{kind}"]
            assert meshed_area(surface) == pytest.approx(AREAS[room.id], rel=1e-6)
            corners = surface.in_space(surface.triangles()[0])
            assert corners[:, 1] == pytest.approx(height)
            # Over the room it belongs to, not its mirror image.
            low, high = room.polygon.min(axis=0), room.polygon.max(axis=0)
            assert corners[:, 0].min() == pytest.approx(low[0])
            assert (-corners[:, 2]).max() == pytest.approx(high[1])


@pytest.mark.parametrize("made", [flat(), turned_plan(0.7), two_storeys()])
def test_surfaces_look_into_their_rooms(made):
    inside = {}
    for room in made.rooms:
        if room.polygon is not None:
            x, y = room_area(room).representative_point().coords[0]
            inside[room.id] = np.array([x, 1.2 + 2.8 * room.level, -y])
    for surface in plan_surfaces(made):
        points, faces = surface.triangles()
        a, b, c = (surface.in_space(points)[faces[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        assert np.all(normals @ surface.normal > 0)
        if surface.kind in ("floor", "ceiling"):
            assert np.all(((inside[surface.room] - a) * normals).sum(axis=1) > 0)
        if surface.kind == "wall":
            assert surface.normal[1] == pytest.approx(0.0)
            room = next(r for r in made.rooms if r.id == surface.room)
            middle = surface.in_space(np.array([surface.region.representative_point().coords[0]]))[
                0
            ]
            step = middle + 0.05 * surface.normal
            from shapely import Point

            assert room_area(room).covers(Point(step[0], -step[2]))


def test_a_door_between_rooms_is_a_hole_in_both_faces_with_a_reveal():
    found = by_id(flat())
    for wall, length in (("wall_01", 3.0), ("wall_15", 3.0)):
        assert meshed_area(found[wall]) == pytest.approx(length * 2.5 - 0.9 * DOOR_HEAD_M)
    reveal = {name: s for name, s in found.items() if s.kind == "reveal"}
    assert len(reveal) == 4
    assert meshed_area(reveal["door_01_floor"]) == pytest.approx(0.2 * 0.9)
    assert meshed_area(reveal["door_01_head"]) == pytest.approx(0.2 * 0.9)
    sides = [s for name, s in reveal.items() if "side" in name]
    assert [meshed_area(s) for s in sides] == pytest.approx([0.2 * DOOR_HEAD_M] * 2)
    middle = np.array([4.1, 1.0, -1.45])
    for surface in reveal.values():
        assert (middle - surface.in_space(surface.triangles()[0])[0]) @ surface.normal > 0


def test_outer_doors_and_windows_are_no_holes():
    found = by_id(plan((square(0, 0, 3.0),), openings=(), doors=()))
    assert all(meshed_area(found[f"wall_0{k}"]) == pytest.approx(7.5) for k in range(4))
    assert not any(s.kind == "reveal" for s in found.values())


def test_storeys_stand_on_one_another():
    found = by_id(two_storeys())
    floor = found["room_04_floor"]
    assert floor.in_space(floor.triangles()[0])[:, 1] == pytest.approx(2.8)
    assert meshed_area(floor) == pytest.approx(12.0)
