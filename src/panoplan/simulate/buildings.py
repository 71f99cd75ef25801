"""Made-up buildings: rooms, the walls between them, doors, openings, windows and stairs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.geometry.polygons import counter_clockwise, signed_area
from panoplan.types.arrays import FloatArray, IntArray, frozen_array

PassageKind = Literal["door", "opening"]

_LOWEST_EYE_M = 0.5


@dataclass(frozen=True, eq=False)
class InteriorRoom:
    """A room.

    Attributes:
        label: what it is called.
        polygon: (N, 2) interior faces of its walls, open, counter-clockwise in (x, z), metres.
        ceiling_height_m: floor to ceiling.
        holes: (M, 2) open rings, clockwise, of what stands free in it, such as pillars.
        level: storey that it is on, from 0.
    """

    label: str
    polygon: FloatArray
    ceiling_height_m: float = 2.5
    holes: tuple[FloatArray, ...] = ()
    level: int = 0

    def __post_init__(self) -> None:
        """Copies, checks and turns the polygon counter-clockwise."""
        polygon = counter_clockwise(frozen_array("polygon", self.polygon, (None, 2)))
        if len(polygon) < 3 or not shapely.Polygon(polygon).is_valid:
            raise InputError(
                f"room {self.label}", "a polygon that crosses itself", "a simple polygon"
            )
        object.__setattr__(self, "polygon", frozen_array("polygon", polygon, (None, 2)))
        rings = (counter_clockwise(frozen_array("hole", h, (None, 2)))[::-1] for h in self.holes)
        object.__setattr__(self, "holes", tuple(frozen_array("hole", r, (None, 2)) for r in rings))

    @property
    def floor(self) -> shapely.Polygon:
        """The floor without what stands on it."""
        return shapely.Polygon(self.polygon, self.holes)

    @property
    def rings(self) -> tuple[FloatArray, ...]:
        """Its walls' faces and those of what stands free, the room on the left of each."""
        return (self.polygon, *self.holes)

    @property
    def area(self) -> float:
        """Floor area in m², pillars not deducted."""
        return signed_area(self.polygon)


@dataclass(frozen=True, eq=False)
class Passage:
    """A door or an opening through the wall between two rooms.

    Attributes:
        kind: "door", or "opening": a wide passage without a door leaf.
        rooms: indices of the two rooms.
        faces: (2, 2, 2) metres: jamb to jamb on the wall of the first room, and opposite it, in
            the same order, on the wall of the second. The first room lies left of its face.
    """

    kind: PassageKind
    rooms: tuple[int, int]
    faces: FloatArray

    def __post_init__(self) -> None:
        """Copies and checks the faces."""
        object.__setattr__(self, "faces", frozen_array("faces", self.faces, (2, 2, 2)))

    @property
    def width(self) -> float:
        """Jamb to jamb, metres."""
        return float(np.hypot(*(self.faces[0, 1] - self.faces[0, 0])))

    @property
    def thickness(self) -> float:
        """Of the wall it goes through, metres."""
        return float(np.hypot(*(self.faces[1, 0] - self.faces[0, 0])))

    @property
    def outward(self) -> FloatArray:
        """(2,) unit normal from the first room to the second."""
        along = self.faces[0, 1] - self.faces[0, 0]
        return np.asarray(np.array([along[1], -along[0]]) / np.hypot(*along))

    def outward_from(self, room: int) -> FloatArray:
        """(2,) unit normal from one of its rooms to the other."""
        return self.outward if self.side(room) == 0 else -self.outward

    @property
    def area(self) -> FloatArray:
        """(4, 2) the floor between the jambs, counter-clockwise."""
        return np.array([self.faces[0, 0], self.faces[1, 0], self.faces[1, 1], self.faces[0, 1]])

    def side(self, room: int) -> int:
        """0 where `room` is its first room, 1 where it is its second."""
        return self.rooms.index(room)


@dataclass(frozen=True, eq=False)
class Window:
    """A window.

    Attributes:
        room: index of its room.
        segment: (2, 2) on the room's wall, metres.
    """

    room: int
    segment: FloatArray

    def __post_init__(self) -> None:
        """Copies and checks the segment."""
        object.__setattr__(self, "segment", frozen_array("segment", self.segment, (2, 2)))


@dataclass(frozen=True, eq=False)
class BlindDoor:
    """A door or an opening with nothing of the building behind it: to the street, to a cupboard.

    Attributes:
        kind: "door" or "opening".
        room: index of its room.
        segment: (2, 2) on the room's wall, metres.
    """

    kind: PassageKind
    room: int
    segment: FloatArray

    def __post_init__(self) -> None:
        """Copies and checks the segment."""
        object.__setattr__(self, "segment", frozen_array("segment", self.segment, (2, 2)))


@dataclass(frozen=True, eq=False)
class Stairs:
    """A straight flight from a room to one of the next storey, through a hole in its floor.

    Attributes:
        rooms: indices of the lower and of the upper room.
        line: (2, 2) plan, its middle from foot to head, metres.
        width: metres.
    """

    rooms: tuple[int, int]
    line: FloatArray
    width: float

    def __post_init__(self) -> None:
        """Copies and checks the line."""
        object.__setattr__(self, "line", frozen_array("line", self.line, (2, 2)))

    @property
    def along(self) -> FloatArray:
        """(2,) unit vector from foot to head."""
        run = self.line[1] - self.line[0]
        return np.asarray(run / np.hypot(*run))

    @property
    def area(self) -> FloatArray:
        """(4, 2) what it takes of the lower floor and leaves out of the upper."""
        side = self.width / 2 * np.array([-self.along[1], self.along[0]])
        foot, head = self.line
        return np.array([foot - side, head - side, head + side, foot + side])


@dataclass(frozen=True, eq=False)
class Building:
    """A building, in metres, plan frame (x, z).

    Attributes:
        name: what it is called.
        rooms: storey by storey; those of one are disjoint.
        passages: doors and openings between them.
        windows: in outer walls.
        blind_doors: doors and openings to what is no part of the building.
        floors_m: how high the floor of each storey lies above that of the first.
        stairs: from each storey to the next, in their order.
    """

    name: str
    rooms: tuple[InteriorRoom, ...]
    passages: tuple[Passage, ...] = ()
    windows: tuple[Window, ...] = ()
    blind_doors: tuple[BlindDoor, ...] = ()
    floors_m: tuple[float, ...] = (0.0,)
    stairs: tuple[Stairs, ...] = ()

    @property
    def doors(self) -> tuple[Passage, ...]:
        """The passages that are doors."""
        return tuple(p for p in self.passages if p.kind == "door")

    @property
    def openings(self) -> tuple[Passage, ...]:
        """The passages that are openings."""
        return tuple(p for p in self.passages if p.kind == "opening")

    @property
    def area(self) -> float:
        """Floor area of all rooms, m²."""
        return sum(room.area for room in self.rooms)

    def neighbours(self, room: int) -> list[tuple[int, int]]:
        """Where one gets to from a room: (index of the passage, index of the room behind it)."""
        return [
            (k, p.rooms[1 - p.side(room)]) for k, p in enumerate(self.passages) if room in p.rooms
        ]

    def floor_m(self, room: int) -> float:
        """How high a room's floor lies above that of the first storey, metres."""
        return self.floors_m[self.rooms[room].level]

    def levels_below(self, eyes_m: FloatArray) -> IntArray:
        """The storey whose floor a camera looks down on.

        Args:
            eyes_m: (N,) heights of cameras above the first storey's floor.

        Returns:
            (N,) the highest storey whose floor lies at least half a metre lower; 0 below that.
        """
        over = np.searchsorted(np.array(self.floors_m) + _LOWEST_EYE_M, eyes_m, side="right")
        return np.asarray(np.maximum(over - 1, 0))

    def storey(self, level: int) -> tuple[int, Building]:
        """One storey as a building of its own.

        Args:
            level: of it.

        Returns:
            Index of its first room here, whose index there is 0; and the storey without stairs.
        """
        there = [k for k, room in enumerate(self.rooms) if room.level == level]
        first = there[0]
        return first, replace(
            self,
            rooms=tuple(replace(self.rooms[k], level=0) for k in there),
            passages=tuple(
                replace(p, rooms=(p.rooms[0] - first, p.rooms[1] - first))
                for p in self.passages
                if p.rooms[0] in there
            ),
            windows=tuple(replace(w, room=w.room - first) for w in self.windows if w.room in there),
            blind_doors=tuple(
                replace(d, room=d.room - first) for d in self.blind_doors if d.room in there
            ),
            floors_m=(0.0,),
            stairs=(),
        )

    def reachable(self, start: int = 0) -> set[int]:
        """Indices of the rooms of its storey that can be walked to from `start`."""
        seen, todo = {start}, [start]
        while todo:
            for _, behind in self.neighbours(todo.pop()):
                if behind not in seen:
                    seen.add(behind)
                    todo.append(behind)
        return seen

    def moved(self, angle: float, shift: FloatArray) -> Building:
        """The building turned about the origin, then shifted.

        Args:
            angle: rad, from x towards z.
            shift: (2,) metres.

        Returns:
            The moved building.
        """
        c, s = np.cos(angle), np.sin(angle)
        rotation = np.array([[c, -s], [s, c]])
        return replace(
            self,
            rooms=tuple(
                replace(
                    r,
                    polygon=r.polygon @ rotation.T + shift,
                    holes=tuple(hole @ rotation.T + shift for hole in r.holes),
                )
                for r in self.rooms
            ),
            passages=tuple(replace(p, faces=p.faces @ rotation.T + shift) for p in self.passages),
            windows=tuple(replace(w, segment=w.segment @ rotation.T + shift) for w in self.windows),
            blind_doors=tuple(
                replace(d, segment=d.segment @ rotation.T + shift) for d in self.blind_doors
            ),
            stairs=tuple(replace(s, line=s.line @ rotation.T + shift) for s in self.stairs),
        )


def rectangle(width: float, depth: float, corner: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
    """(4, 2) rectangle, counter-clockwise: `width` along x and `depth` along z from `corner`."""
    x, z = corner
    return np.array([[x, z], [x + width, z], [x + width, z + depth], [x, z + depth]])


def l_shape(width: float, depth: float, cut_width: float, cut_depth: float) -> FloatArray:
    """(6, 2) rectangle at the origin less its far right corner, counter-clockwise."""
    return np.array(
        [
            [0.0, 0.0],
            [width, 0.0],
            [width, depth - cut_depth],
            [width - cut_width, depth - cut_depth],
            [width - cut_width, depth],
            [0.0, depth],
        ]
    )


def single_room(polygon: FloatArray, ceiling_height_m: float = 2.5) -> Building:
    """A building of one room without doors.

    Args:
        polygon: (N, 2) simple polygon, either way round, metres.
        ceiling_height_m: floor to ceiling.

    Returns:
        The building.
    """
    return Building("room", (InteriorRoom("room", polygon, ceiling_height_m),))
