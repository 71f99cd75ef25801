"""Cameras of a tour that stand in a wrong place."""

from dataclasses import replace

import numpy as np
import pytest

from panoplan.config import Config
from panoplan.simulate.scene import simulate_flat
from panoplan.stages.plan.misplaced import is_tour, misplaced
from panoplan.stages.registration import cast, register
from panoplan.types.view import Correction

CONFIG = Config()


def _views(scene):
    first = scene.keyframes[0].pose.translation
    height = scene.camera_height_m
    return [
        register(cast(k, i, first, np.eye(2), CONFIG.registration), 1 / height)
        for i, k in enumerate(scene.keyframes)
    ]


def _tour(seed, **more):
    scene = simulate_flat(seed, "mild", stills=True, metres_per_su=1.0, **more)
    return _views(scene), np.array(scene.keyframe_rooms)


def _with_room_moved(views, rooms, room, shift):
    return [
        Correction(shift).apply(view) if rooms[k] == room else view for k, view in enumerate(views)
    ]


def _found(views):
    return misplaced(views, CONFIG.misplaced, CONFIG.grouping)


@pytest.mark.parametrize("seed", range(6))
def test_all_stand_right(seed):
    views, _ = _tour(seed)
    assert _found(views) == ()


@pytest.mark.parametrize("shift", [(1.2, 1.1), (-1.6, 0.3)])
def test_a_room_is_moved_back_to_its_doors(shift):
    views, rooms = _tour(12)
    # The corridor: with a door to every other room.
    room = int(np.bincount(rooms[[v.index for v in views for _ in v.spans.doors]]).argmax())
    (found,) = _found(_with_room_moved(views, rooms, room, shift))
    assert found.members == tuple(np.flatnonzero(rooms == room))
    assert found.shift == pytest.approx((-shift[0], -shift[1]), abs=0.12)


def test_without_doors_nothing_is_moved():
    """Walls alone tell that somebody stands wrong, not where they belong."""
    views, rooms = _tour(12)
    views = [replace(view, spans=None) for view in views]
    moved = (_with_room_moved(views, rooms, k, (1.2, 1.1)) for k in range(max(rooms) + 1))
    found = [item for views in moved for item in _found(views)]
    assert found
    assert all(item.shift is None for item in found)


def test_a_walk_is_not_examined():
    scene = simulate_flat(3, "mild", metres_per_su=1.0)
    views = _views(scene)
    rooms = np.array(scene.keyframe_rooms)
    assert _found(_with_room_moved(views, rooms, rooms[0], (1.2, 1.1))) == ()


def test_a_walk_through_large_halls_is_no_tour_however_far_its_keyframes_are_apart():
    def large(views, factor):
        return [
            replace(
                view,
                camera=factor * view.camera,
                boundary=factor * view.boundary,
            )
            for view in views
        ]

    walk, (tour, _) = _views(simulate_flat(3, "mild", metres_per_su=1.0)), _tour(3)
    for factor in (0.5, 1.0, 5.0):
        assert not is_tour(large(walk, factor), CONFIG.misplaced)
        assert is_tour(large(tour, factor), CONFIG.misplaced)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_views_say_nothing(count):
    views, _ = _tour(0)
    assert _found(views[:count]) == ()
