"""Where the camera stands in a home, and of which room its panorama is."""

from __future__ import annotations

import numpy as np
import shapely

from panoplan.simulate.render.scene import Scene
from panoplan.types.arrays import FloatArray

_AT_SMALL, _IN_SMALL, _IN_PASSAGE = 0.16, 0.10, 0.05
_SMALL_M2 = 6.0
_INTO_M = 0.3
_TRIES = 8
_FROM_FURNITURE_M = 0.12


def draw_stand(
    scene: Scene, rng: np.random.Generator, *, small: bool = True
) -> tuple[FloatArray, int]:
    """Somewhere on free floor: at the door of a small room, in one, in a doorway, or anywhere.

    Args:
        scene: the home.
        rng: of all choices.
        small: whether small rooms are sought out.

    Returns:
        (2,) plan, and the index of the room whose panorama it is: in a doorway the smaller room
        where that is a closet or as small, else the nearer one.
    """
    kind = rng.random()
    stand = None
    if kind < _AT_SMALL:
        stand = _at_small(scene, rng) if small else None
    elif kind < _AT_SMALL + _IN_SMALL:
        stand = _in_small(scene, rng) if small else None
    elif kind < _AT_SMALL + _IN_SMALL + _IN_PASSAGE:
        stand = _in_passage(scene, rng)
    return _anywhere(scene, rng) if stand is None else stand


def _at_small(scene: Scene, rng: np.random.Generator) -> tuple[FloatArray, int] | None:
    """On the threshold of a small room, or a step inside: it is photographed from there."""
    ways = [
        (k, room)
        for k, passage in enumerate(scene.building.passages)
        if k not in scene.shell.shut
        for room in [min(passage.rooms, key=lambda r: scene.building.rooms[r].area)]
        if scene.building.rooms[room].area < _SMALL_M2
    ]
    if not ways:
        return None
    k, room = ways[int(rng.integers(len(ways)))]
    passage = scene.building.passages[k]
    side = passage.side(room)
    inwards = passage.outward * (1.0 if side == 1 else -1.0)
    start, end = passage.faces[side]
    position = start + rng.uniform(0.25, 0.75) * (end - start)
    position = position + rng.uniform(-0.9 * passage.thickness, _INTO_M) * inwards
    return (position, room) if scene.stands_free(position, _FROM_FURNITURE_M / 2) else None


def _in_small(scene: Scene, rng: np.random.Generator) -> tuple[FloatArray, int] | None:
    """Anywhere in a small room."""
    small = [k for k, room in enumerate(scene.building.rooms) if room.area < _SMALL_M2]
    if not small:
        return None
    room = small[int(rng.integers(len(small)))]
    position = _free(scene, room, float(rng.uniform(0.05, 0.45)), rng)
    return None if position is None else (position, room)


def _in_passage(scene: Scene, rng: np.random.Generator) -> tuple[FloatArray, int] | None:
    """In a doorway or opening, of the room that is nearer."""
    passages = [p for k, p in enumerate(scene.building.passages) if k not in scene.shell.shut]
    if not passages:
        return None
    passage = passages[int(rng.integers(len(passages)))]
    along, across = rng.uniform(0.25, 0.75), rng.uniform(0.05, 0.95)
    near, far = (f[0] + along * (f[1] - f[0]) for f in passage.faces)
    areas = [scene.building.rooms[k].area for k in passage.rooms]
    side = int(np.argmin(areas)) if min(areas) < _SMALL_M2 else int(across > 0.5)
    return near + across * (far - near), passage.rooms[side]


def _anywhere(scene: Scene, rng: np.random.Generator) -> tuple[FloatArray, int]:
    """In any room, larger ones more often."""
    share = np.sqrt([room.area for room in scene.building.rooms])
    while True:
        room = int(rng.choice(len(share), p=share / share.sum()))
        position = _free(scene, room, float(rng.uniform(0.2, 0.7)), rng)
        if position is not None:
            return position, room


def _free(
    scene: Scene, room: int, clearance_m: float, rng: np.random.Generator
) -> FloatArray | None:
    """(2,) a place so far from the walls of a room and clear of its furniture, if one is found."""
    floor = scene.building.rooms[room].floor
    low, high = np.reshape(floor.bounds, (2, 2))
    for _ in range(_TRIES):
        position = rng.uniform(low, high)
        point = shapely.Point(position)
        clear = floor.contains(point) and floor.boundary.distance(point) > clearance_m
        if clear and scene.stands_free(position, _FROM_FURNITURE_M):
            return position
    return None
