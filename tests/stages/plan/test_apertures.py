"""Doors, openings and windows of hand-made rooms."""

from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import RECTANGLE, ranges, walk

from panoplan.config import Config
from panoplan.stages.plan.apertures import apertures, stretches
from panoplan.stages.plan.partition import partition
from panoplan.stages.registration import cast, register
from panoplan.types.layout import Spans
from panoplan.types.room import RoomShape

CONFIG = Config()
APART = np.array([4.1, 0.0])
"""The right room's left wall stands 0.1 behind the left room's right wall."""
DOOR = (-0.3, 0.3)
"""The door's sides along the second axis."""
SPOTS = [[-1.0, 0.2], [0.5, -0.7], [1.2, 0.8]]
NONE = np.empty((0, 2))


def _columns(view, low, high):
    """First and last column in which a wall's stretch between two points is seen."""
    offsets = view.boundary - view.camera
    heading = np.arctan2(offsets[:, 0], offsets[:, 1])
    ends = []
    for point in (low, high):
        to = np.asarray(point) - view.camera
        off = np.angle(np.exp(1j * (heading - np.arctan2(*to))))
        ends.append(int(np.argmin(np.abs(off))))
    first, last = ends
    if (last - first) % len(heading) > len(heading) / 2:
        first, last = last, first
    return float(first), float(last)


def _views(polygon, spots, told=(), first=0):
    """Views of a room; told: (kind, one end, other end) that all of them see."""
    out = []
    for i, keyframe in enumerate(walk(polygon, spots)):
        view = register(cast(keyframe, first + i, np.zeros(3), np.eye(2), CONFIG.registration), 1.0)
        spans = {
            kind: np.array([_columns(view, a, b) for k, a, b in told if k == kind] or NONE)
            for kind in ("doors", "openings", "windows")
        }
        out.append(replace(view, spans=Spans(**spans)))
    return out


def _shape(ring, sigma=0.01):
    return RoomShape(ring, None, sigmas=np.full(len(ring), sigma))


def _found(rooms, path=()):
    """Apertures of (shape, views) in turn."""
    shapes, faces = partition([shape for shape, _ in rooms], CONFIG.partition)
    seen = [stretches(shape, views, CONFIG.apertures) for shape, views in rooms]
    return apertures(shapes, seen, path, faces, CONFIG.apertures)


def _two(told_left=(), told_right=()):
    return [
        (_shape(RECTANGLE), _views(RECTANGLE, SPOTS, told_left)),
        (_shape(RECTANGLE + APART), _views(RECTANGLE + APART, SPOTS + APART, told_right, 3)),
    ]


def _on(x, ends=DOOR):
    return (x, ends[0]), (x, ends[1])


def test_a_door_that_all_views_show_lies_in_the_middle_of_the_wall():
    (door,) = _found(_two([("doors", *_on(2.0))], [("doors", *_on(2.1))]))
    assert door.kind == "door"
    assert door.walls == ((0, 1), (1, 3))
    assert door.sources == ("seen",)
    ends = door.segment[np.argsort(door.segment[:, 1])]
    assert ends == pytest.approx(np.array([[2.05, -0.3], [2.05, 0.3]]), abs=0.02)


def test_a_door_over_the_images_edge_is_one():
    """Some of the views have the door behind them, where their columns begin and end."""
    behind = walk(RECTANGLE, [[0.0, 0.0]], headings=[-np.pi / 2])
    view = register(cast(behind[0], 0, np.zeros(3), np.eye(2), CONFIG.registration), 1.0)
    assert _columns(view, *_on(2.0))[0] > 900
    first, last = _columns(view, *_on(2.0))
    halves = np.array([[0.0, last], [first, 1024.0]])
    view = replace(view, spans=Spans(halves, NONE, NONE))
    (stretch,) = stretches(_shape(RECTANGLE), [view], CONFIG.apertures)
    assert np.ptp(stretch.segment[:, 1]) == pytest.approx(0.6, abs=0.02)


def test_what_a_minority_shows_is_none():
    rooms = _two()
    liar = _views(RECTANGLE, SPOTS[:1], [("doors", *_on(2.0))])
    rooms[0] = (rooms[0][0], [*liar, *rooms[0][1][1:]])
    assert _found(rooms) == ()


def test_a_door_outside_leads_nowhere_and_a_window_stays():
    outside = [
        ("doors", (-0.4, -1.5), (0.4, -1.5)),
        ("windows", (-0.5, 1.5), (0.5, 1.5)),
    ]
    door, window = _found([(_shape(RECTANGLE), _views(RECTANGLE, SPOTS, outside))])
    assert (door.kind, door.walls) == ("door", ((0, 0),))
    assert (window.kind, window.walls) == ("window", ((0, 2),))
    assert window.segment[:, 1] == pytest.approx([1.5, 1.5])


def test_no_window_in_a_wall_between_rooms():
    assert _found(_two([("windows", *_on(2.0))])) == ()


def test_the_walk_through_a_wall_is_a_door_of_assumed_width():
    path = [(0, np.array([1.6, 0.1])), (1, np.array([2.4, 0.1])), (7, np.array([0.0, 0.0]))]
    (door,) = _found(_two(), path)
    assert door.sources == ("assumed width", "walked")
    assert door.segment.mean(axis=0) == pytest.approx([2.05, 0.1], abs=0.02)
    width = np.hypot(*np.diff(door.segment, axis=0)[0])
    assert width == pytest.approx(CONFIG.apertures.door_width_ch)


def test_stills_far_apart_are_no_walk():
    path = [(0, np.array([0.0, 0.0])), (1, np.array([4.0, 0.0]))]
    assert _found(_two(), path) == ()


def test_rooms_that_end_without_a_wall_have_an_opening():
    left = RoomShape(RECTANGLE, None, sigmas=np.array([0.01, np.nan, 0.01, 0.01]))
    right = RoomShape(RECTANGLE + [4.0, 0.0], None, sigmas=np.array([0.01, 0.01, 0.01, np.nan]))
    (opening,) = _found([(left, []), (right, [])])
    assert (opening.kind, opening.sources) == ("opening", ("border",))
    assert np.sort(opening.segment[:, 1]) == pytest.approx([-1.5, 1.5])


def test_leaks_of_layouts_that_tell_no_doors_are_a_door():
    views = _leaking_views(SPOTS)
    other = (_shape(RECTANGLE + APART), [])
    (door,) = _found([(_shape(RECTANGLE), views), other])
    assert (door.kind, door.sources) == ("door", ("leak",))
    assert np.sort(door.segment[:, 1]) == pytest.approx([-0.3, 0.3], abs=0.12)


def test_a_leak_far_away_is_an_error():
    far = [[-1.5, 0.2], [-1.2, 0.0]]
    other = (_shape(RECTANGLE + APART), [])
    assert _found([(_shape(RECTANGLE), _leaking_views(far)), other]) == ()


def _leaking_views(spots):
    """Views that tell no doors; a closet behind the door makes the boundary leak by 0.6."""
    closet = np.array([[2.0, -0.3], [2.6, -0.3], [2.6, 0.3], [2.0, 0.3]])
    ring = np.concatenate([RECTANGLE[[0, 1]], closet, RECTANGLE[[2, 3]]])
    return [replace(view, spans=None) for view in _views(ring, spots)]


def test_a_camera_elsewhere_says_nothing():
    views = _views(RECTANGLE + [10.0, 0.0], [[10.0, 0.0]])
    assert stretches(_shape(RECTANGLE), views, CONFIG.apertures) == ()


def test_ranges_of_the_scenes_are_those_of_the_walls():
    """What the tests above take for granted."""
    assert ranges(RECTANGLE, np.zeros(2), np.array([[1.0, 0.0]])) == pytest.approx([2.0])
