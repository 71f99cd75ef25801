"""The truth of rendered panoramas: what doors close, what is seen through them."""

import numpy as np
import pytest
from tests.simulate.test_views import two_rooms

from panoplan.simulate.flats import make_flat
from panoplan.simulate.render.labels import Labeller
from panoplan.simulate.render.scene import Scene
from panoplan.simulate.walks import about_y

WIDTH = 512


def _labelled(kind, seed):
    scene = Scene(two_rooms(kind), seed, furnished=0.0)
    return scene, Labeller(scene).labels(np.array([2.0, 1.5]), 0.3, 1.5, width=WIDTH)


def _columns(spans):
    out = np.zeros(WIDTH, dtype=bool)
    for first, last in spans.astype(int):
        out[np.arange(first, first + (last - first) % WIDTH + 1) % WIDTH] = True
    return out


def test_the_boundary_through_an_opening_lies_behind_it_and_nowhere_else():
    _, labels = _labelled("opening", 1)
    closed, through = labels.closed.floor_boundary, labels.through.floor_boundary
    opening = _columns(labels.closed.spans.openings)
    assert opening.any()
    assert (through[opening] > closed[opening]).all()
    np.testing.assert_array_equal(through[~opening], closed[~opening])


def test_nothing_is_seen_through_a_shut_door():
    scenes = [_labelled("door", seed) for seed in range(12)]
    shut = [bool(scene.shell.shut) for scene, _ in scenes]
    assert any(shut)
    assert not all(shut)
    for (_, labels), is_shut in zip(scenes, shut, strict=True):
        assert labels.closed.spans.doors.size
        same = np.array_equal(labels.closed.floor_boundary, labels.through.floor_boundary)
        assert same == is_shut


@pytest.mark.parametrize("room", [0, 1])
def test_the_room_that_is_asked_for_is_told_from_its_doorway(room):
    """The camera on the threshold at x = 4.1 looks along z; rooms of 4 m and 3 m on its sides."""
    scene = Scene(two_rooms("opening"), 1, furnished=0.0)
    labels = Labeller(scene).labels(np.array([4.1, 1.5]), 0.0, 1.5, width=WIDTH, room=room)
    sides = 1.5 / np.tan(-labels.closed.floor_boundary[[WIDTH // 4, 3 * WIDTH // 4]])
    # Left is the room before the wall, right the one behind; the other's side ends at the wall.
    expected = [4.1, 0.1] if room == 0 else [0.1, 3.1]
    np.testing.assert_allclose(sides, expected, rtol=0.01)


def test_doors_that_lead_nowhere_are_told():
    found = 0
    for seed in range(6):
        scene = Scene(make_flat(seed), seed, furnished=0.0)
        labeller = Labeller(scene)
        for room, door in zip(scene.furniture.door_rooms, scene.furniture.doors, strict=True):
            polygon = scene.building.rooms[room].polygon
            along = (door[1] - door[0]) / np.hypot(*(door[1] - door[0]))
            camera = door.mean(axis=0) + 0.5 * np.array([-along[1], along[0]])
            towards = door.mean(axis=0) - camera
            heading = float(np.arctan2(*towards))
            labels = labeller.labels(camera, heading, 1.5, width=WIDTH)
            assert _columns(labels.closed.spans.doors)[WIDTH // 2], polygon
            found += 1
    assert found > 2


@pytest.mark.parametrize("columns", [64, 300])
def test_a_turned_camera_has_its_labels_turned(columns):
    scene, labels = _labelled("opening", 1)
    heading = 0.3 + 2 * np.pi * columns / WIDTH
    turned = Labeller(scene).labels(np.array([2.0, 1.5]), heading, 1.5, width=WIDTH)
    np.testing.assert_allclose(
        turned.through.floor_boundary, np.roll(labels.through.floor_boundary, -columns), atol=1e-6
    )


def test_a_tilted_camera_sees_the_boundary_rise_and_fall():
    scene, level = _labelled("opening", 1)
    tilt = about_y(np.array([0.0]))[0] @ np.array(
        [[1, 0, 0], [0, np.cos(0.05), -np.sin(0.05)], [0, np.sin(0.05), np.cos(0.05)]]
    )
    tilted = Labeller(scene).labels(
        np.array([2.0, 1.5]), 0.3, 1.5, width=WIDTH, level_from_cam=tilt
    )
    off = tilted.closed.floor_boundary - level.closed.floor_boundary
    assert np.abs(off[WIDTH // 2] + off[0]) < 0.02
    assert np.abs(off[WIDTH // 2]) == pytest.approx(0.05, abs=0.01)
