"""Grouping, fusion and outline on small scenes with known answers."""

from dataclasses import replace

import numpy as np
import pytest
from shapely import Polygon, box, unary_union
from tests.scenes import L_SHAPE, RECTANGLE, exact_layout, walk

from panoplan.config import Config
from panoplan.stages.plan import fusion, grouping
from panoplan.stages.plan import outline as outline_module
from panoplan.stages.plan.floorplan import plan_rooms
from panoplan.stages.plan.sight import sights
from panoplan.stages.registration import cast, register

CONFIG = Config()
NEXT = np.array([4.1, 0.0])
LEFT = [[-1.0, 0.2], [0.5, -0.7], [1.2, 0.8], [-0.4, 0.9]]


def _views(*parts):
    """Registered layouts of (polygon, cameras) in turn."""
    keyframes = [k for polygon, cameras in parts for k in walk(polygon, cameras)]
    return [
        register(cast(k, i, np.zeros(3), np.eye(2), CONFIG.registration), 1.0)
        for i, k in enumerate(keyframes)
    ]


def _iou(ring, polygon):
    one, other = Polygon(ring), Polygon(polygon)
    return one.intersection(other).area / one.union(other).area


def _moved(cameras):
    return [np.add(c, NEXT) for c in cameras]


def test_two_rooms_are_told_apart_and_exact():
    rooms = plan_rooms(_views((RECTANGLE, LEFT), (RECTANGLE + NEXT, _moved(LEFT))), CONFIG)
    assert [room.members for room in rooms] == [(0, 1, 2, 3), (4, 5, 6, 7)]
    assert _iou(rooms[0].shape.polygon, RECTANGLE) > 0.998
    assert _iou(rooms[1].shape.polygon, RECTANGLE + NEXT) > 0.998
    assert len(rooms[0].shape.polygon) == 4


def test_corners_do_not_depend_on_the_fields_cells():
    """Walls are fitted to the raw columns: corners are far finer than the cells of 0.035."""
    (room,) = plan_rooms(_views((RECTANGLE + 0.0123, LEFT)), CONFIG)
    away = np.abs(room.shape.polygon[:, None] - (RECTANGLE + 0.0123)).max(axis=2).min(axis=1)
    assert away.max() < 0.003


def test_a_skewed_wall_stays_skewed():
    skewed = RECTANGLE.copy()
    skewed[2] += [0.0, 0.35]
    (room,) = plan_rooms(_views((skewed, LEFT)), CONFIG)
    assert len(room.shape.polygon) == 4
    assert _iou(room.shape.polygon, skewed) > 0.998


def test_leaking_views_do_not_move_the_door_wall():
    """One view in four looks 2 m into the next room through a door 0.6 wide."""
    leak = np.array(
        [[-2, -1.5], [2, -1.5], [2, -0.3], [4, -0.6], [4, 0.6], [2, 0.3], [2, 1.5], [-2, 1.5]],
        dtype=float,
    )
    rooms = plan_rooms(
        _views((leak, LEFT[:1]), (RECTANGLE, LEFT[1:]), (RECTANGLE + NEXT, _moved(LEFT))), CONFIG
    )
    assert [len(room.members) for room in rooms] == [4, 4]
    assert _iou(rooms[0].shape.polygon, RECTANGLE) > 0.995
    assert _iou(rooms[1].shape.polygon, RECTANGLE + NEXT) > 0.995


def test_one_view_of_a_nearby_thing_does_not_outvote_those_that_see_past_it():
    blocked = np.array(
        [[-2, -1.5], [2, -1.5], [2, 1.5], [0.2, 1.5], [0.2, 0.9], [-0.6, 0.9], [-0.6, 1.5],
         [-2, 1.5]]
    )  # fmt: skip
    views = _views((blocked, [[-0.2, 0.5]]), (RECTANGLE, LEFT))
    (room,) = plan_rooms(views, CONFIG)
    assert _iou(room.shape.polygon, RECTANGLE) > 0.99


def test_the_arms_of_an_angle_are_one_room():
    """No view in one arm sees much of the other; both see the bend."""
    corridor = np.array([[0, 0], [5, 0], [5, 1], [1, 1], [1, 5], [0, 5]], dtype=float)
    cameras = [[4, 0.5], [3, 0.4], [2.2, 0.5], [0.5, 4], [0.4, 3], [0.5, 2.2], [0.5, 0.5]]
    views = sights(_views((corridor, cameras)))
    groups = grouping.linked(views.cameras, views.profiles, CONFIG.grouping)
    assert len(groups) > 1
    (room,) = plan_rooms(list(views.views), CONFIG)
    assert _iou(room.shape.polygon, corridor) > 0.99


def test_a_closet_seen_from_its_doorway_is_a_room():
    """The camera in the doorway sees the room before it and 0.8 × 1 behind."""
    both = np.array(
        [[-2, -1.5], [2, -1.5], [2, -0.3], [2.1, -0.3], [2.1, -0.5], [2.9, -0.5], [2.9, 0.5],
         [2.1, 0.5], [2.1, 0.3], [2, 0.3], [2, 1.5], [-2, 1.5]]
    )  # fmt: skip
    views = _views((RECTANGLE, LEFT), (both, [[2.03, 0.0]]))
    assert grouping.doorways(sights(views), CONFIG.grouping).tolist() == [False] * 4 + [True]
    rooms = plan_rooms(views, CONFIG)
    assert [room.members for room in rooms] == [(0, 1, 2, 3), (4,)]
    assert _iou(rooms[1].shape.polygon, box(2.1, -0.5, 2.9, 0.5).exterior.coords) > 0.85
    assert _iou(rooms[0].shape.polygon, RECTANGLE) > 0.995


def test_a_gross_view_inside_a_room_makes_none():
    elsewhere = np.array([[0.9, -0.2], [1.5, -0.2], [1.5, 4.0], [0.9, 4.0]])
    rooms = plan_rooms(_views((RECTANGLE, LEFT), (elsewhere, [[1.2, 0.0]])), CONFIG)
    assert [room.members for room in rooms] == [(0, 1, 2, 3, 4)]


def _beside(*boxes):
    """The floor beside a camera at (0, 0) whose view alone holds boxes of 0.1 wide cells."""
    total = np.full((60, 60), -1.0)
    for low_i, low_j, high_i, high_j in boxes:
        total[low_i + 30 : high_i + 30, low_j + 30 : high_j + 30] = 1.0
    evidence = fusion.Evidence((-30, -30), total, np.ones((60, 60)))
    settings = replace(CONFIG.fusion, cell_ch=0.1, opening_cells=2)
    floor = fusion.floor_beside(evidence, np.zeros((60, 60), bool), np.zeros(2), settings)
    return None if floor is None else (np.argwhere(floor.mask).min(axis=0) - 30).tolist()


def test_the_floor_beside_a_doorway_is_the_nearest_that_is_large_enough():
    closet, beyond, sliver = (1, -4, 9, 4), (-30, -30, -3, 30), (-2, -1, 0, 1)
    assert _beside(closet, beyond) == [1, -4]
    assert _beside(closet, beyond, sliver) == [1, -4]
    # Gross ranges show floor behind the far wall of the room.
    assert _beside((-30, -5, -10, 5)) is None
    assert _beside(sliver) is None
    assert _beside() is None


@pytest.mark.parametrize("width", [64, 512])
def test_layouts_of_few_columns_show_the_same_room_as_surely(width):
    def of(width):
        keyframes = [
            replace(k, layout=exact_layout(RECTANGLE, at, k.pose.rotation, width=width))
            for k, at in zip(walk(RECTANGLE, LEFT), LEFT, strict=True)
        ]
        views = [
            register(cast(k, i, np.zeros(3), np.eye(2), CONFIG.registration), 1.0)
            for i, k in enumerate(keyframes)
        ]
        (room,) = plan_rooms(views, CONFIG)
        return room.shape

    few, usual = of(width), of(1024)
    assert _iou(few.polygon, RECTANGLE) > 0.999
    # Between columns 6° apart corners may be cut; the walls themselves are as sure.
    assert np.sort(few.sigmas)[:4] == pytest.approx(np.sort(usual.sigmas), rel=0.1)


def test_no_floor_is_told():
    config = replace(CONFIG, fusion=replace(CONFIG.fusion, min_area_ch2=50.0))
    (room,) = plan_rooms(_views((RECTANGLE, LEFT)), config)
    assert room.shape.polygon is None
    assert room.shape.failure == "its floor is smaller than a room's"
    assert plan_rooms([], CONFIG) == ()


def test_moving_the_walk_moves_the_rooms():
    shift = np.array([3.217, -1.871])
    here = plan_rooms(_views((L_SHAPE, [[-1.0, -1.0], [-2.0, 1.0], [1.5, -1.2]])), CONFIG)
    there = plan_rooms(
        _views((L_SHAPE + shift, [[-1.0, -1.0] + shift, [-2.0, 1.0] + shift, [1.5, -1.2] + shift])),
        CONFIG,
    )
    assert _iou(here[0].shape.polygon + shift, there[0].shape.polygon) > 0.999


def test_more_views_make_a_wall_surer():
    few = plan_rooms(_views((RECTANGLE, LEFT[:2])), CONFIG)[0].shape.sigmas
    many = plan_rooms(_views((RECTANGLE, LEFT)), CONFIG)[0].shape.sigmas
    assert many.max() < few.max()


def test_contest_gives_a_cell_to_the_stronger():
    one = fusion.Evidence((0, 0), np.array([[1.0, 3.0]]), np.ones((1, 2)))
    other = fusion.Evidence((0, 1), np.array([[2.0, -1.0]]), np.ones((1, 2)))
    made = fusion.contest([one, other])
    assert made.owner.tolist() == [[0, 0, fusion.NOBODY]]
    assert made.best.tolist() == [[1.0, 3.0, 0.0]]
    assert made.second.tolist() == [[0.0, 2.0, 0.0]]
    assert made.owner_at(np.array([0.5, 1.5]), 1.0) == 0
    assert made.owner_at(np.array([9.5, 0.5]), 1.0) == fusion.NOBODY


@pytest.mark.parametrize("width", [0.6, 3.0])
def test_rooms_are_joined_across_a_wide_line_only(width):
    """Two rooms 4 × 3 side by side, every view sees both through a gap of some width."""
    half = width / 2
    both = np.array(
        [[-2, -1.5], [2, -1.5], [2, -half], [2.1, -half], [2.1, -1.5], [6.1, -1.5], [6.1, 1.5],
         [2.1, 1.5], [2.1, half], [2, half], [2, 1.5], [-2, 1.5]]
    )  # fmt: skip
    rooms = plan_rooms(_views((both, [*LEFT, *_moved(LEFT)])), CONFIG)
    assert len(rooms) == (2 if width < 1 else 1)


def test_an_outline_that_turns_back_on_itself_loses_the_spike():
    ring = np.array([[0, 0], [4, 0], [4, 3], [2.05, 3], [2.0, 2.0], [1.95, 3], [0, 3]], dtype=float)
    smooth, sigmas = outline_module._without_spikes(ring, np.arange(7.0))
    assert smooth.tolist() == np.delete(ring, 4, axis=0).tolist()
    assert np.isnan(sigmas[3])
    assert sigmas[[0, 1, 2, 4, 5]].tolist() == [0, 1, 2, 5, 6]
    # A right angle is none.
    assert len(outline_module._without_spikes(ring[:4], np.zeros(4))[0]) == 4


def test_several_open_doors_side_by_side_are_no_wide_passage():
    """Views of a corridor and of a hall along it, each through the nearest of three doors."""
    rooms = box(0.0, 0.0, 9.0, 1.1).union(box(0.0, 1.2, 9.0, 5.0))

    def through(x, y):
        door = min((1.0, 4.2, 7.4), key=lambda at: abs(at + 0.25 - x))
        seen = unary_union([rooms, box(door, 1.0, door + 0.5, 1.3)])
        return np.array(seen.exterior.coords)[:-1], [[x, y]]

    corridor = [through(x, 0.5) for x in np.linspace(0.5, 8.5, 9)]
    hall = [through(x, y) for x in np.linspace(0.8, 8.2, 7) for y in (2.0, 4.0)]
    found = plan_rooms(_views(*corridor, *hall), CONFIG)
    assert [len(room.members) for room in found] == [9, 14]
    areas = [Polygon(room.shape.polygon).area for room in found]
    assert areas == pytest.approx([9 * 1.1, 9 * 3.8], rel=0.08)
