import time

import numpy as np
import pytest
import shapely

from panoplan.errors import InputError
from panoplan.geometry.sphere import column_heading, heading_column
from panoplan.simulate.buildings import (
    Building,
    InteriorRoom,
    Passage,
    Window,
    l_shape,
    rectangle,
    single_room,
)
from panoplan.simulate.flats import make_flat
from panoplan.simulate.views import Surface, ViewCaster, tilted
from panoplan.simulate.walks import about_y, walk

WIDTH = 1024
COLUMNS = np.arange(WIDTH, dtype=np.float64)


def two_rooms(kind="door", depth=3.0):
    """A 4 × 3 m room and behind a 0.2 m wall at x = 4 another; passage at z = 1..2."""
    rooms = (
        InteriorRoom("a", rectangle(4, 3)),
        InteriorRoom("b", rectangle(depth, 3, (4.2, 0))),
    )
    faces = [[[4.0, 1.0], [4.0, 2.0]], [[4.2, 1.0], [4.2, 2.0]]]
    return Building("two", rooms, (Passage(kind, (0, 1), faces),))


def hits(view, position, heading):
    angle = heading + column_heading(COLUMNS, WIDTH)
    return position + view.range_m[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=1)


@pytest.mark.parametrize("heading", [0.0, 0.7, -2.5])
def test_view_of_a_rectangle_is_the_closed_form(heading):
    position = np.array([1.0, 2.0])
    view = ViewCaster(single_room(rectangle(4, 3), 2.6)).view(position, heading, 1.5)
    angle = heading + 2 * np.pi * (COLUMNS + 0.5) / WIDTH - np.pi
    with np.errstate(divide="ignore"):
        to_x = np.where(np.sin(angle) > 0, 3.0, -1.0) / np.sin(angle)
        to_z = np.where(np.cos(angle) > 0, 1.0, -2.0) / np.cos(angle)
    ranges = np.minimum(to_x, to_z)
    np.testing.assert_allclose(view.range_m, ranges, rtol=1e-9)
    np.testing.assert_allclose(view.floor_boundary, -np.arctan(1.5 / ranges), rtol=1e-9)
    np.testing.assert_allclose(view.ceiling_boundary, np.arctan(1.1 / ranges), rtol=1e-9)
    assert (view.surface == Surface.WALL).all()


def test_corners_of_a_rectangle_are_where_its_vertices_are():
    position, heading, room = np.array([1.0, 2.0]), 0.4, rectangle(4, 3)
    view = ViewCaster(single_room(room)).view(position, heading, 1.5)
    offset = room - position
    columns = heading_column(np.arctan2(offset[:, 0], offset[:, 1]) - heading, WIDTH) % WIDTH
    np.testing.assert_allclose(view.corners, np.sort(columns), atol=1e-6)


def test_an_l_hides_a_vertex_behind_its_bend():
    # The bend is at (3, 2.5); from (4.5, 0.5) the far arm's corners are partly hidden.
    caster = ViewCaster(single_room(l_shape(5, 4, 2, 1.5)))
    view = caster.view(np.array([4.5, 0.5]), 0.0, 1.5)
    assert len(view.corners) == 5
    jump = np.abs(np.diff(view.range_m)).max()
    assert jump > 0.3
    # From inside the bend every vertex is seen.
    assert len(caster.view(np.array([1.5, 1.0]), 0.0, 1.5).corners) == 6


def test_turning_the_camera_by_whole_columns_shifts_the_view():
    caster = ViewCaster(single_room(l_shape(5, 4, 2, 1.5)))
    position, step = np.array([1.2, 1.1]), 2 * np.pi / WIDTH
    first, turned = (caster.view(position, 100 * k * step, 1.5) for k in range(2))
    np.testing.assert_allclose(turned.range_m, np.roll(first.range_m, -100), rtol=1e-9)
    np.testing.assert_allclose(np.sort((turned.corners + 100) % WIDTH), first.corners, atol=1e-6)


def test_every_hit_lies_on_a_wall_of_the_room():
    for seed in range(8):
        flat = make_flat(seed)
        way, caster = walk(flat, np.random.default_rng(seed)), ViewCaster(flat)
        for k in range(0, len(way.trajectory), 9):
            position = way.trajectory.translations[k, [0, 2]]
            room = shapely.Polygon(flat.rooms[way.rooms[k]].polygon)
            if not room.contains(shapely.Point(position)):
                continue
            points = hits(caster.view(position, 0.3, 1.5), position, 0.3)
            assert shapely.distance(room.exterior, shapely.points(points)).max() < 1e-6
            sight = shapely.linestrings(
                np.stack([np.broadcast_to(position, points.shape), points], 1)
            )
            assert room.buffer(1e-6).covers(sight).all()


@pytest.mark.parametrize(("kind", "surface"), [("door", 1), ("opening", 2)])
def test_passages_are_closed_and_labelled(kind, surface):
    position = np.array([2.0, 1.5])
    view = ViewCaster(two_rooms(kind)).view(position, 0.0, 1.5)
    points = hits(view, position, 0.0)
    on_passage = (np.abs(points[:, 0] - 4) < 1e-9) & (np.abs(points[:, 1] - 1.5) < 0.5)
    np.testing.assert_array_equal(view.surface == surface, on_passage)
    np.testing.assert_array_equal(view.passage == 0, on_passage)
    assert not view.leaked.any()
    assert len(view.corners) == 4


def test_windows_are_labelled():
    room = single_room(rectangle(4, 3))
    windowed = Building("w", room.rooms, (), (Window(0, [[1.0, 0.0], [2.0, 0.0]]),))
    view = ViewCaster(windowed).view(np.array([1.5, 1.0]), 0.0, 1.5)
    share = 2 * np.arctan(0.5) / (2 * np.pi)
    assert np.mean(view.surface == Surface.WINDOW) == pytest.approx(share, abs=2 / WIDTH)


def test_a_shallow_leak_ends_mid_floor_and_a_deep_one_at_the_walls():
    position, caster = np.array([2.0, 1.5]), ViewCaster(two_rooms())
    shallow = caster.view(position, 0.0, 1.5, leaks={0: 0.8})
    points = hits(shallow, position, 0.0)
    np.testing.assert_array_equal(shallow.leaked, shallow.passage == 0)
    assert shallow.leaked.any()
    # Seen past the wall's edges, the jambs take the first and the last of the leaking columns.
    free = shallow.leaked & (np.abs((points[:, 1] - 1.5) / (points[:, 0] - 2.0)) < 0.5 / 2.2)
    assert (shallow.surface[free] == Surface.MID_FLOOR).all()
    np.testing.assert_allclose(points[free, 0], 4.8)
    on_jamb = shallow.leaked & ~free
    np.testing.assert_allclose(np.abs(points[on_jamb, 1] - 1.5), 0.5)
    assert on_jamb.any()
    deep = caster.view(position, 0.0, 1.5, leaks={0: 50.0})
    points = hits(deep, position, 0.0)
    np.testing.assert_allclose(points[free, 0], 7.2)
    assert (deep.surface[deep.leaked] == Surface.WALL).all()
    np.testing.assert_array_equal(deep.range_m[~deep.leaked], deep.closed_range_m[~deep.leaked])
    assert (deep.closed_range_m[deep.leaked] < deep.range_m[deep.leaked]).all()


def test_a_slanting_leak_meets_the_jamb():
    position = np.array([3.8, 0.3])
    view = ViewCaster(two_rooms()).view(position, 0.0, 1.5, leaks={0: 3.0})
    points = hits(view, position, 0.0)
    jamb = view.leaked & (np.abs(points[:, 1] - 2.0) < 1e-9)
    assert jamb.any()
    assert (points[jamb, 0] <= 4.2 + 1e-9).all()


def test_corners_of_a_leak_are_where_the_boundary_bends_or_jumps():
    position = np.array([2.0, 1.5])
    view = ViewCaster(two_rooms()).view(position, 0.0, 1.5, leaks={0: 0.8})
    offset = np.array([[2.0, -0.5], [2.0, 0.5], [2.2, -0.5], [2.2, 0.5]])
    jambs = heading_column(np.arctan2(offset[:, 0], offset[:, 1]), WIDTH)
    gaps = np.abs(view.corners[:, None] - jambs).min(axis=0)
    assert gaps.max() < 1e-3
    assert len(view.corners) == 4 + 4


def test_view_from_a_doorway_is_of_the_passage_and_the_room_ahead():
    position, building = np.array([4.1, 1.5]), two_rooms()
    into_b = ViewCaster(building).view(position, np.pi / 2, 1.5)
    assert into_b.room == 1
    points = hits(into_b, position, np.pi / 2)
    assert points[:, 0].max() == pytest.approx(7.2)
    # Behind: closed at the face of the room it comes from.
    assert points[:, 0].min() == pytest.approx(4.0)
    assert (into_b.surface == Surface.DOOR).any()
    into_a = ViewCaster(building).view(position, -np.pi / 2, 1.5)
    assert into_a.room == 0
    assert hits(into_a, position, -np.pi / 2)[:, 0].max() == pytest.approx(4.2)


def test_every_ray_meets_something_all_along_a_walk():
    for seed in range(12):
        flat = make_flat(seed, opening_share=0.3)
        way, caster = walk(flat, np.random.default_rng(seed)), ViewCaster(flat)
        for k in range(0, len(way.trajectory), 3):
            room = int(way.rooms[k])
            leaks = {passage: 1.0 for passage, _ in flat.neighbours(room)}
            position = way.trajectory.translations[k, [0, 2]]
            view = caster.view(position, 0.1 * k, 1.5, room=room, leaks=leaks)
            assert np.isfinite(view.range_m).all()
            assert (view.range_m >= view.closed_range_m - 1e-9).all()


def test_a_tilted_camera_sees_the_same_floor():
    room, height = rectangle(4, 3), 1.5
    position = np.array([1.7, 1.2])
    layout = ViewCaster(single_room(room)).view(position, 0.0, height).layout
    pitch, roll = np.deg2rad([2.0, -1.5])
    tilt = np.array(
        [[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]]
    ) @ np.array([[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
    seen = tilted(layout, tilt)
    theta, phi = column_heading(COLUMNS, WIDTH), seen.floor_boundary
    rays = np.stack([np.cos(phi) * np.sin(theta), -np.sin(phi), np.cos(phi) * np.cos(theta)], 1)
    level = rays @ tilt.T
    floor = position + height * level[:, [0, 2]] / level[:, 1:2]
    ring = shapely.Polygon(room).exterior
    assert shapely.distance(ring, shapely.points(floor)).max() < 0.005
    assert np.abs(phi - layout.floor_boundary).max() > np.deg2rad(1.0)
    assert len(seen.corners) == 4
    same = tilted(layout, about_y(np.zeros(1))[0])
    np.testing.assert_allclose(same.floor_boundary, layout.floor_boundary, atol=1e-12)


def test_a_camera_outside_is_refused():
    with pytest.raises(InputError, match="inside a room"):
        ViewCaster(single_room(rectangle(4, 3))).view(np.array([9.0, 9.0]), 0.0, 1.5)


def test_a_view_takes_a_few_milliseconds_at_most():
    flat = make_flat(1, rooms=9)
    caster, way = ViewCaster(flat), walk(flat, np.random.default_rng(0))
    took = []
    for k in range(60):
        started = time.perf_counter()
        caster.view(way.trajectory.translations[k, [0, 2]], 0.0, 1.5, room=int(way.rooms[k]))
        took.append(time.perf_counter() - started)
    assert np.median(took) < 0.004
