"""Made-up buildings: rooms, the walls between them, doors, openings, windows and stairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.geometry.polygons import counter_clockwise, signed_area
from panoplan.simulate.adjacency import SharedWall, shared_walls
from panoplan.simulate.partition import clip, cut, notch
from panoplan.types.arrays import FloatArray, IntArray, frozen_array

PassageKind = Literal["door", "opening"]
Seed = int | np.random.SeedSequence | np.random.Generator

_JAMB_MARGIN_M = 0.1
_LOWEST_EYE_M = 0.5
_SIZES_TRIED, _DRAWS_A_SIZE = 40, 30


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


def t_shape(width: float, depth: float, bar: float, stem: float) -> FloatArray:
    """(8, 2) T standing on its stem, counter-clockwise.

    Args:
        width: of the bar, along x, which begins at x = 0.
        depth: of the whole, along z, which begins at z = 0.
        bar: depth of the bar, which lies at the far end.
        stem: width of the stem, in the middle.

    Returns:
        The polygon, in the unit of its arguments.
    """
    left, right, shoulder = (width - stem) / 2, (width + stem) / 2, depth - bar
    return np.array(
        [
            [left, 0.0],
            [right, 0.0],
            [right, shoulder],
            [width, shoulder],
            [width, depth],
            [0.0, depth],
            [0.0, shoulder],
            [left, shoulder],
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


def building_from_rooms(
    name: str,
    rooms: Sequence[InteriorRoom],
    seed: Seed,
    *,
    opening_share: float = 0.0,
    extra_doors: float = 0.1,
    max_thickness_m: float = 0.35,
) -> Building:
    """Joins given rooms by doors into one connected whole and puts windows in outer walls.

    Doors go preferably to rooms labelled "corridor", then to "living".

    Args:
        name: what it is called.
        rooms: disjoint rooms, metres; neighbours have parallel walls.
        seed: of all choices.
        opening_share: probability that a pair is joined by an opening, where the wall is long
            enough for one.
        extra_doors: probability of a door between neighbours that are connected already.
        max_thickness_m: rooms farther apart are no neighbours.

    Returns:
        The building.

    Raises:
        InputError: the rooms cannot be joined into one whole.
    """
    rng = np.random.default_rng(seed)
    walls = shared_walls([r.polygon for r in rooms], max_thickness_m)
    passages = _passages(rooms, walls, rng, opening_share, extra_doors)
    building = Building(name, tuple(rooms), passages, outer_windows(rooms, walls, rng))
    if len(building.reachable()) < len(rooms):
        raise InputError(name, "rooms no door can lead to", "rooms that share long enough walls")
    return building


def make_flat(
    seed: int,
    *,
    rooms: int | None = None,
    area_m2: float | None = None,
    skewed: bool | None = None,
    opening_share: float = 0.1,
    extra_doors: float = 0.1,
) -> Building:
    """A flat of a real size: corridor, rooms on both sides, closets that leave L-shaped rooms.

    Args:
        seed: the same seed gives the same flat.
        rooms: how many, 5-9; drawn from 7 ± 2 where None.
        area_m2: of the footprint's inside, 55-220; drawn so that the rooms' sum is about
            105 ± 44 where None.
        skewed: whether walls stand at angles other than 90°; a third of the flats where None.
        opening_share: probability that two rooms are joined by an opening instead of a door.
        extra_doors: probability of a further door between neighbours.

    Returns:
        The flat, turned by a random angle, its centre within 3 m of the origin.

    Raises:
        InputError: `rooms` or `area_m2` out of range, or so many do not fit into so little.
    """
    if rooms is not None and not 5 <= rooms <= 9:
        raise InputError("rooms", str(rooms), "5-9")
    if area_m2 is not None and not 55 <= area_m2 <= 220:
        raise InputError("area_m2", str(area_m2), "55-220")
    rng = np.random.default_rng(seed)
    skew = bool(rng.random() < 1 / 3) if skewed is None else skewed
    for attempt in range(_SIZES_TRIED * _DRAWS_A_SIZE):
        if attempt % _DRAWS_A_SIZE == 0:
            count, area = _size(rng, rooms, area_m2)
        planned = _flat_rooms(rng, count, area, skew)
        if planned is None:
            continue
        try:
            flat = building_from_rooms(
                f"flat_{seed:04d}",
                planned,
                rng,
                opening_share=opening_share,
                extra_doors=extra_doors,
                max_thickness_m=0.26,
            )
        except InputError:
            continue
        centre = np.mean([r.polygon.mean(axis=0) for r in flat.rooms], axis=0)
        return flat.moved(0.0, -centre).moved(rng.uniform(-np.pi, np.pi), rng.uniform(-2, 2, 2))
    raise InputError("rooms, area_m2", f"{rooms}, {area_m2}", "rooms that fit into the area")


def make_corridor_building(n_rooms: int, seed: int, *, opening_share: float = 0.0) -> Building:
    """Rooms on both sides of a straight corridor, as in an office or hotel.

    Args:
        n_rooms: rooms beside the corridor, ≥ 2. The corridor is divided by doors into lengths
            of at most about 20 m, which are rooms as well and come first.
        seed: the same seed gives the same building.
        opening_share: probability that a room is joined by an opening instead of a door.

    Returns:
        The building, turned by a random angle.

    Raises:
        InputError: fewer than two rooms.
    """
    if n_rooms < 2:
        raise InputError("n_rooms", str(n_rooms), "at least 2")
    rng = np.random.default_rng(seed)
    wide, thick = rng.uniform(1.6, 2.2), rng.uniform(0.1, 0.2)
    above = _row(rng, (n_rooms + 1) // 2, wide + thick, upwards=True)
    below = _row(rng, n_rooms // 2, -thick, upwards=False)
    length = max(p[:, 0].max() for p in above + below)
    parts = int(np.ceil(length / 20))
    ends = np.linspace(0, length, parts + 1)
    corridor = [
        rectangle(b - a - thick * (k + 1 < parts), wide, (a, 0.0))
        for k, (a, b) in enumerate(pairwise(ends))
    ]
    ceiling = float(rng.uniform(2.4, 3.0))
    rooms = [InteriorRoom("corridor", p, ceiling) for p in corridor]
    rooms += [InteriorRoom("office", p, ceiling) for p in above + below]
    building = building_from_rooms(
        f"corridor_{n_rooms:02d}_{seed:04d}", rooms, rng, opening_share=opening_share
    )
    return building.moved(rng.uniform(-np.pi, np.pi), np.zeros(2))


def _row(rng: np.random.Generator, count: int, face: float, *, upwards: bool) -> list[FloatArray]:
    """Rooms side by side, their corridor wall's face at z = `face`."""
    depth = rng.uniform(3.0, 5.0)
    row, x = [], 0.0
    for _ in range(count):
        width = rng.uniform(2.6, 4.8)
        row.append(rectangle(width, depth, (x, face if upwards else face - depth)))
        x += width + rng.uniform(0.08, 0.25)
    return row


def _size(rng: np.random.Generator, rooms: int | None, area_m2: float | None) -> tuple[int, float]:
    """Number of rooms and inner area of the footprint, at 8-30 m² a room."""
    while True:
        count = rooms or int(np.clip(np.rint(rng.normal(7, 1.6)), 5, 9))
        area = area_m2 or float(rng.normal(97, 66))
        if (56 <= area <= 220 and 8 <= area / count <= 30) or (rooms and area_m2):
            return count, area


def _thickness(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.08, 0.25))


def _slant(rng: np.random.Generator, skewed: bool, max_deg: float) -> float:
    """Angle by which a wall departs from the square, rad; half of the walls of a skewed flat."""
    if not skewed or rng.random() < 0.5:
        return 0.0
    return float(np.deg2rad(rng.uniform(0.4, 1.0) * max_deg) * rng.choice([-1, 1]))


def _footprint(rng: np.random.Generator, area: float, skewed: bool) -> FloatArray:
    """Outer faces' inside: a rectangle along x, its short ends slanted where skewed."""
    depth = max(float(np.sqrt(area / rng.uniform(1.15, 1.9))), 6.6)
    width = area / depth
    footprint = rectangle(width, depth)
    for x, sign in ((0.0, -1.0), (width, 1.0)):
        slant = _slant(rng, skewed, 12)
        normal = sign * np.array([np.cos(slant), np.sin(slant)])
        inset = depth / 2 * abs(np.tan(slant)) * 0.5
        footprint = clip(footprint, normal, float(normal @ [x - sign * inset, depth / 2]))
    return footprint


def _flat_rooms(
    rng: np.random.Generator, count: int, area: float, skewed: bool
) -> list[InteriorRoom] | None:
    """The rooms of a flat, or None where the draw does not fit."""
    footprint = _footprint(rng, area, skewed)
    rest, left = footprint, count - 1
    polygons: list[tuple[str, FloatArray]] = []
    if rng.random() < 0.65 or left < 4:
        share = float(np.clip(rng.uniform(1.2, 2.2) / count, 0.15, 0.4))
        living, rest = _end_room(rng, rest, share, skewed)
        polygons.append(("living", living))
        left -= 1
    closets = min(int(rng.integers(0, 3)), left - 2)
    blocks = _corridor_and_bands(rng, rest, left - closets, skewed)
    if blocks is None:
        return None
    polygons += blocks
    for _ in range(closets):
        if not _add_closet(rng, polygons):
            return None
    if rng.random() < 0.3:
        _recess(rng, polygons, footprint)
    if any(not _habitable(polygon) for _, polygon in polygons):
        return None
    ceiling = float(rng.uniform(2.35, 2.9))
    return [InteriorRoom(label, polygon, ceiling) for label, polygon in polygons]


def _end_room(
    rng: np.random.Generator, footprint: FloatArray, share: float, skewed: bool
) -> tuple[FloatArray, FloatArray]:
    """A room over the whole depth at one end of the footprint, and what is left."""
    low, high = footprint.min(axis=0), footprint.max(axis=0)
    width = high[0] - low[0]
    at_left = bool(rng.random() < 0.5)
    x = low[0] + width * share if at_left else high[0] - width * share
    left, right = _upright_cut(rng, footprint, x, _slant(rng, skewed, 12))
    return (left, right) if at_left else (right, left)


def _upright_cut(
    rng: np.random.Generator, polygon: FloatArray, x: float, slant: float
) -> tuple[FloatArray, FloatArray]:
    """A wall across the depth: what lies at lower x, and at higher x."""
    middle = np.array([x, (polygon[:, 1].min() + polygon[:, 1].max()) / 2])
    return cut(polygon, middle, np.array([np.sin(slant), np.cos(slant)]), _thickness(rng))


def _corridor_and_bands(
    rng: np.random.Generator, block: FloatArray, count: int, skewed: bool
) -> list[tuple[str, FloatArray]] | None:
    """A corridor along x through the block, `count` rooms in the bands on both sides of it."""
    low, high = block.min(axis=0), block.max(axis=0)
    wide = rng.uniform(1.15, 1.6)
    slack = high[1] - low[1] - wide - 0.5 - 2 * 2.3
    if slack < 0 or high[0] - low[0] < 3.5:
        return None
    middle = np.array(
        [(low[0] + high[0]) / 2, low[1] + 2.55 + slack * rng.uniform(0.1, 0.9) + wide / 2]
    )
    slant = _slant(rng, skewed, 4)
    along = np.array([np.cos(slant), np.sin(slant)])
    up = np.array([-along[1], along[0]])
    lower, upper = _thickness(rng), _thickness(rng)
    corridor = clip(block, up, float(up @ middle) + wide / 2)
    corridor = clip(corridor, -up, -float(up @ middle) + wide / 2)
    above = cut(block, middle + up * (wide + upper) / 2, along, upper)[0]
    below = cut(block, middle - up * (wide + lower) / 2, along, lower)[1]
    half_above = clip(block, -up, -float(up @ middle))
    first = int(np.clip(rng.integers(count // 2, (count + 1) // 2 + 1), 1, count - 1))
    hall = bool(rng.random() < 0.4)
    rooms_above = _band(rng, above, half_above if hall else None, first, skewed)
    rooms_below = _band(rng, below, None, count - first, skewed)
    if rooms_above is None or rooms_below is None:
        return None
    whole = shapely.union_all([shapely.Polygon(corridor), *map(shapely.Polygon, rooms_above[1])])
    if not isinstance(whole, shapely.Polygon):
        return None
    ring = np.asarray(whole.simplify(1e-6).exterior.coords)[:-1]
    corridor = counter_clockwise(_without_straight_vertices(ring))
    return [("corridor", corridor), *(("room", p) for p in rooms_above[0] + rooms_below[0])]


def _band(
    rng: np.random.Generator,
    band: FloatArray,
    through: FloatArray | None,
    count: int,
    skewed: bool,
) -> tuple[list[FloatArray], list[FloatArray]] | None:
    """Splits a band into rooms side by side.

    Args:
        rng: of the widths.
        band: convex, along x.
        through: the band and half of the corridor beside it; where given, a branch of the
            corridor is cut out of it between two rooms or at an end.
        count: number of rooms.
        skewed: whether the walls between them may be slanted.

    Returns:
        The rooms and the branch, if any; None where they would be too narrow.
    """
    low, high = band[:, 0].min(), band[:, 0].max()
    branch = int(rng.integers(0, count + 1)) if through is not None else -1
    branch_width = rng.uniform(1.15, 1.5) if through is not None else 0.0
    spare = high - low - 0.25 * (count - 1) - 2.0 * count
    spare -= branch_width + 0.25 if through is not None else 0.0
    if spare < 0:
        return None
    widths = list(2.0 + spare * rng.dirichlet(np.full(count, 3.0)))
    if through is not None:
        widths.insert(branch, branch_width)
    rooms: list[FloatArray] = []
    branches: list[FloatArray] = []
    x = low
    rest, rest_through = band, band if through is None else through
    for k, width in enumerate(widths):
        piece, piece_through = rest, rest_through
        if k + 1 < len(widths):
            x += width + 0.25
            slant = _slant(rng, skewed and branch not in (k, k + 1), 12)
            thickness = _thickness(rng)
            point = np.array([x - 0.125, (band[:, 1].min() + band[:, 1].max()) / 2])
            along = np.array([np.sin(slant), np.cos(slant)])
            piece, rest = cut(rest, point, along, thickness)
            piece_through, rest_through = cut(rest_through, point, along, thickness)
        (branches if k == branch else rooms).append(piece_through if k == branch else piece)
    return rooms, branches


def _add_closet(rng: np.random.Generator, polygons: list[tuple[str, FloatArray]]) -> bool:
    """Walls a closet or bath off a corner of a large convex room, in place; whether it could."""
    large = [
        k
        for k, (label, p) in enumerate(polygons)
        if label != "corridor" and len(p) == 4 and signed_area(p) > 10
    ]
    if not large:
        return False
    k = int(rng.choice(large))
    label, polygon = polygons[k]
    corner = int(rng.integers(4))
    back = np.hypot(*(polygon[corner - 1] - polygon[corner]))
    ahead = np.hypot(*(polygon[(corner + 1) % 4] - polygon[corner]))
    sizes = (
        float(rng.uniform(1.4, max(1.45, min(2.6, 0.55 * ahead)))),
        float(rng.uniform(1.4, max(1.45, min(2.6, 0.55 * back)))),
    )
    thickness = _thickness(rng)
    if min(ahead - sizes[0], back - sizes[1]) - thickness < 1.5:
        return False
    small, rest = notch(polygon, corner, sizes, thickness)
    polygons[k] = (label, rest)
    polygons.append(("closet", small))
    return True


def _recess(
    rng: np.random.Generator, polygons: list[tuple[str, FloatArray]], footprint: FloatArray
) -> None:
    """Cuts a corner of the footprint out of the room that lies there, in place, if one may."""
    for k in rng.permutation(len(polygons)):
        label, polygon = polygons[k]
        if label == "corridor" or len(polygon) != 4 or signed_area(polygon) < 12:
            continue
        for corner in range(4):
            if np.hypot(*(footprint - polygon[corner]).T).min() > 1e-6:
                continue
            sizes = (float(rng.uniform(0.8, 1.6)), float(rng.uniform(0.8, 1.6)))
            polygons[k] = (label, notch(polygon, corner, sizes, 0.0)[1])
            return


def _habitable(polygon: FloatArray) -> bool:
    """Whether a room is big and wide enough to walk in, and its walls are no slivers."""
    if len(polygon) < 4 or signed_area(polygon) < 2.0:
        return False
    edges = np.hypot(*(np.roll(polygon, -1, axis=0) - polygon).T)
    inner = shapely.Polygon(polygon).buffer(-0.52, join_style="mitre")
    return bool(edges.min() > 0.45 and isinstance(inner, shapely.Polygon) and inner.area > 0.02)


def _without_straight_vertices(ring: FloatArray) -> FloatArray:
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    lengths = np.hypot(*before.T) * np.hypot(*after.T)
    return np.asarray(ring[np.abs(cross) > 1e-6 * lengths])


def _passages(
    rooms: Sequence[InteriorRoom],
    walls: Sequence[SharedWall],
    rng: np.random.Generator,
    opening_share: float,
    extra_doors: float,
) -> tuple[Passage, ...]:
    """Passages that connect as many rooms as the walls allow, and some more."""
    longest: dict[tuple[int, int], SharedWall] = {}
    for wall in walls:
        longest[wall.rooms] = max(wall, longest.get(wall.rooms, wall), key=lambda w: w.length)
    ranked = []
    for wall in longest.values():
        labels = {rooms[i].label for i in wall.rooms}
        rank = 0.0 if "corridor" in labels else 1.0 if "living" in labels else 2.0
        ranked.append((rank + 0.9 * rng.random(), wall))
    group = list(range(len(rooms)))
    passages = []
    for _, wall in sorted(ranked, key=lambda pair: pair[0]):
        i, j = (group[k] for k in wall.rooms)
        if i == j and rng.random() >= extra_doors:
            continue
        passage = _passage(wall, rng, opening_share)
        if passage is not None:
            passages.append(passage)
            group = [i if g == j else g for g in group]
    return tuple(passages)


def _passage(wall: SharedWall, rng: np.random.Generator, opening_share: float) -> Passage | None:
    """A door or an opening in a shared wall, or None where the wall is too short."""
    room = wall.length - 2 * _JAMB_MARGIN_M
    wants_opening, door_width = rng.random() < opening_share, float(rng.uniform(0.7, 0.95))
    kind: PassageKind = "opening" if wants_opening and room >= 1.2 else "door"
    width = float(rng.uniform(1.2, min(3.0, room))) if kind == "opening" else door_width
    if width > room:
        return None
    start = _JAMB_MARGIN_M + float(rng.beta(0.6, 0.6)) * (room - width)
    return Passage(kind, wall.rooms, wall.faces(start, start + width))


def outer_windows(
    rooms: Sequence[InteriorRoom], walls: Sequence[SharedWall], rng: np.random.Generator
) -> tuple[Window, ...]:
    """A window in most of the longer walls that face no other room.

    Args:
        rooms: of one storey.
        walls: between them.
        rng: of all choices.
    """
    areas = [shapely.Polygon(r.polygon) for r in rooms]
    windows = []
    for k, room in enumerate(rooms):
        for a, b in zip(room.polygon, np.roll(room.polygon, -1, axis=0), strict=True):
            length = float(np.hypot(*(b - a)))
            along = (b - a) / length
            outward = np.array([along[1], -along[0]])
            outside = shapely.LineString([a + 0.4 * outward, b + 0.4 * outward])
            if length < 1.5 or rng.random() < 0.3 or shapely.intersects(outside, areas).any():
                continue
            width = min(length - 0.5, float(rng.uniform(0.9, 1.9)))
            start = float(rng.uniform(0.25, length - 0.25 - width))
            segment = a + np.array([[start], [start + width]]) * along
            windows.append(Window(k, segment))
    return tuple(windows)
