"""Made-up buildings of few kinds of rooms: plain flats, and rooms along a corridor."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.geometry.polygons import counter_clockwise, signed_area
from panoplan.simulate.adjacency import SharedWall, longest_walls, shared_walls
from panoplan.simulate.buildings import Building, InteriorRoom, Passage, PassageKind, rectangle
from panoplan.simulate.partition import (
    clip,
    cut,
    notch,
    upright_cut,
    wall_thickness,
    without_straight_corners,
)
from panoplan.simulate.windows import outer_windows
from panoplan.types.arrays import FloatArray

Seed = int | np.random.SeedSequence | np.random.Generator

_JAMB_MARGIN_M = 0.1
_SIZES_TRIED, _DRAWS_A_SIZE = 40, 30


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
    walls = longest_walls(shared_walls([r.polygon for r in rooms], max_thickness_m))
    passages = _passages(rooms, walls, rng, opening_share, extra_doors)
    building = Building(name, tuple(rooms), passages, outer_windows(rooms, rng))
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
    left, right = upright_cut(footprint, x, _slant(rng, skewed, 12), rng)
    return (left, right) if at_left else (right, left)


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
    lower, upper = wall_thickness(rng), wall_thickness(rng)
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
    corridor = counter_clockwise(without_straight_corners(ring))
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
            thickness = wall_thickness(rng)
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
    thickness = wall_thickness(rng)
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


def _passages(
    rooms: Sequence[InteriorRoom],
    walls: Sequence[SharedWall],
    rng: np.random.Generator,
    opening_share: float,
    extra_doors: float,
) -> tuple[Passage, ...]:
    """Passages that connect as many rooms as the walls allow, and some more."""
    ranked = []
    for wall in walls:
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
