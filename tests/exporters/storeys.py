"""Metric plans for the tests of exports."""

from dataclasses import replace

import numpy as np
from tests.metrics.plans import FLAT, plan, square

from panoplan.types.plan import Aperture, SharedWall, Wall

ODD_NAMES = ("=1+1", "<script>alert(1)</script>", "%%c ^J \\U+0041 {\\b}", "x" * 10_000)


def flat(**fields):
    """The small flat with the shared wall as thick as it is, and the door in its middle."""
    faces = ("wall_01", "wall_15")
    door = Aperture("door_01", np.array([[4.1, 1.0], [4.1, 1.9]]), ("room_01", "room_02"), faces)
    known = {"shared_walls": (SharedWall("shared_01", faces, 0.2, True, True),), "doors": (door,)}
    return plan(**{**known, **fields})


def two_storeys():
    """The small flat, a square room with a hole over it, and one room without a shape."""
    made = plan((*FLAT, square(1, 0, 4.0), None), names=["Hall", "Küche", "Bath & WC", "客厅", "?"])
    rooms = list(made.rooms)
    rooms[3] = replace(rooms[3], level=1, holes=(square(2, 1)[::-1],))
    rooms[4] = replace(rooms[4], level=1)
    up = Aperture("door_02", np.array([[2.0, 0.0], [2.9, 0.0]]), ("room_04",), ("wall_30",))
    return replace(made, rooms=tuple(rooms), doors=(*made.doors, up))


def turned_plan(angle):
    """The small flat, turned about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.array([[c, -s], [s, c]])
    made = plan()

    def wall(item):
        return Wall(item.id, item.a @ rotation.T, item.b @ rotation.T, item.sigma)

    rooms = tuple(
        replace(r, polygon=r.polygon @ rotation.T, walls=tuple(wall(w) for w in r.walls))
        for r in made.rooms
    )
    apertures = {
        kind: tuple(replace(a, segment=a.segment @ rotation.T) for a in getattr(made, kind))
        for kind in ("doors", "openings", "windows")
    }
    cameras = tuple(replace(c, position=c.position @ rotation.T) for c in made.trajectory)
    return replace(made, rooms=rooms, trajectory=cameras, **apertures)
