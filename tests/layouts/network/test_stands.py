"""Homes and stands of the training panoramas."""

import numpy as np
import shapely
from tests.simulate.test_views import two_rooms

from panoplan.layouts.network import stands
from panoplan.layouts.network.homes import draw_home
from panoplan.layouts.network.stands import draw_stand
from panoplan.simulate.buildings import Building, InteriorRoom, Passage, rectangle
from panoplan.simulate.render.scene import Scene


def _closet_scene():
    """A room, a closet of 1.5 m² and an open doorway between them."""
    rooms = (
        InteriorRoom("bedroom", rectangle(4, 3)),
        InteriorRoom("closet", rectangle(1, 1.5, (4.2, 0.7))),
    )
    faces = [[[4.0, 1.0], [4.0, 1.8]], [[4.2, 1.0], [4.2, 1.8]]]
    building = Building("closet", rooms, (Passage("opening", (0, 1), faces),))
    return Scene(building, 3, furnished=0.0)


def test_homes_are_whole_and_some_open_over_a_whole_wall():
    homes = [draw_home(np.random.default_rng(seed)) for seed in range(16)]
    assert all(len(home.reachable()) == len(home.rooms) for home in homes)
    ends = [
        min(np.hypot(*(home.rooms[k].polygon - end).T).min() for k in passage.rooms)
        for home in homes
        for passage in home.openings
        for end in passage.faces[0]
    ]
    assert min(ends) < 1e-6
    assert max(ends) > 0.05
    assert any(room.label == "closet" for home in homes for room in home.rooms)


def test_a_camera_stands_in_its_room_or_on_its_threshold(monkeypatch):
    scene, rng = _closet_scene(), np.random.default_rng(0)
    threshold = shapely.Polygon(scene.building.passages[0].area).buffer(1e-9)
    places = {"room": 0, "threshold": 0}
    for _ in range(200):
        position, room = draw_stand(scene, rng)
        point = shapely.Point(position)
        if threshold.covers(point):
            # Whoever stands on the threshold of a closet photographs the closet.
            assert room == 1
            places["threshold"] += 1
        else:
            assert scene.building.rooms[room].floor.covers(point)
            places["room"] += room
    assert places["threshold"] > 8
    assert places["room"] > 15


def test_nobody_stands_in_a_shut_door(monkeypatch):
    monkeypatch.setattr(stands, "_AT_SMALL", 0.0)
    monkeypatch.setattr(stands, "_IN_SMALL", 0.0)
    monkeypatch.setattr(stands, "_IN_PASSAGE", 1.0)
    scenes = [Scene(two_rooms("door"), seed, furnished=0.0) for seed in range(12)]
    assert {bool(scene.shell.shut) for scene in scenes} == {True, False}
    for scene in scenes:
        threshold = shapely.Polygon(scene.building.passages[0].area)
        stood = [draw_stand(scene, np.random.default_rng(k))[0] for k in range(4)]
        on_it = {threshold.covers(shapely.Point(position)) for position in stood}
        assert on_it == {not scene.shell.shut}
