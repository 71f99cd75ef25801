"""Made-up houses: wings with corridors and suites, rooms of many shapes, open plans."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from panoplan.errors import InputError
from panoplan.geometry.polygons import counter_clockwise
from panoplan.simulate.buildings import BlindDoor, Building, InteriorRoom
from panoplan.simulate.features import (
    Draft,
    alcove_closet,
    apse,
    bay,
    convex_corners,
    corner_closet,
    cut_corner,
    faces_outside,
    habitable,
    pillar,
)
from panoplan.simulate.joining import SERVANT, SHARED, WAYS, Joinery, join
from panoplan.simulate.partition import (
    clip,
    cut,
    upright_cut,
    wall_thickness,
    without_straight_corners,
)
from panoplan.simulate.storeys import stack
from panoplan.simulate.walks import can_be_walked
from panoplan.simulate.windows import outer_windows
from panoplan.simulate.wings import Shape, Wing, make_wings
from panoplan.types.arrays import FloatArray

_ATTEMPTS = 3000
_HOUSES_TRIED, _STOREYS_TRIED = 60, 30
_AREA_TOLERANCE = 0.04
_NARROWEST_BAND_M = 2.3
_DEPTHS_AT_LEAST_M = 2.6
_CORRIDOR_FROM = 4
"""Fewest rooms, the corridor included, that a corridor is worth."""


@dataclass(frozen=True)
class Style:
    """What the houses of a family have in common.

    Attributes:
        shapes: (fewest rooms, most rooms, footprint, weight).
        corridor_m: least and largest width of a corridor.
        widest_band_m: rooms beside a corridor are at most so deep.
        closet_share: about so many of all rooms are walled off others.
        closet_m: least and largest side of one.
        least_room_m2: smallest floor.
        spread: of the rooms' sizes within a house, as that of a logarithm.
        skewed_share: probability that a house has walls at other angles than 90°.
        feature_share: bays, round walls, breasts and cut corners a room.
        pillared_m2: only larger rooms have pillars.
        ceiling_m: least and largest usual height of the ceilings.
        doors: how rooms are joined.
    """

    shapes: tuple[tuple[int, int, Shape, float], ...]
    corridor_m: tuple[float, float]
    widest_band_m: float
    closet_share: float
    closet_m: tuple[float, float]
    least_room_m2: float
    spread: float
    skewed_share: float
    feature_share: float
    pillared_m2: float
    ceiling_m: tuple[float, float]
    doors: Joinery


def make_house(
    name: str, style: Style, rooms: int, area_m2: float, rng: np.random.Generator
) -> Building:
    """A house of given size.

    Args:
        name: what it is called.
        style: of its family.
        rooms: how many, corridors and closets included, ≥ 3.
        area_m2: of all rooms together; met within 4 %.
        rng: of everything else.

    Returns:
        The house, connected and walkable, turned by any angle, its middle near the origin.

    Raises:
        InputError: so many rooms do not fit into so little.
    """
    skewed = bool(rng.random() < style.skewed_share)
    return _somewhere(_storey(name, style, rooms, area_m2, skewed, rng)[0], rng)


def make_storeys(
    name: str, style: Style, rooms: int, area_m2: float, storeys: int, rng: np.random.Generator
) -> Building:
    """A house of several storeys upon the same wings, each divided anew, joined by stairs.

    Args:
        name: what it is called.
        style: of its family.
        rooms: how many on each storey, ≥ 3.
        area_m2: of the first storey's rooms; met within 4 %.
        storeys: how many, ≥ 2.
        rng: of everything else.

    Returns:
        The house, connected and walkable, turned by any angle, its middle near the origin.

    Raises:
        InputError: so many rooms do not fit into so little, or stairs fit nowhere.
    """
    skewed = bool(rng.random() < style.skewed_share)
    for _ in range(_HOUSES_TRIED):
        house, wings = _storey(name, style, rooms, area_m2, skewed, rng)
        for _ in range(_STOREYS_TRIED):
            upper, _ = _storey(name, style, rooms, area_m2, skewed, rng, wings)
            stacked = stack(house, upper, rng)
            if stacked is not None and can_be_walked(stacked):
                house = stacked
            if len(house.floors_m) == storeys:
                return _somewhere(house, rng)
    raise InputError(name, f"{storeys} storeys of {area_m2:.0f} m²", "rooms that stairs fit into")


def _storey(
    name: str,
    style: Style,
    rooms: int,
    area_m2: float,
    skewed: bool,
    rng: np.random.Generator,
    wings: list[Wing] | None = None,
) -> tuple[Building, list[Wing]]:
    """One storey, connected and walkable, and its wings, which are drawn where not given."""
    inner = area_m2 * 1.05
    for _ in range(_ATTEMPTS):
        planned = _drafts(style, rooms, inner, skewed, rng, wings)
        if planned is None:
            continue
        drafts, own = planned
        found = sum(draft.floor.area for draft in drafts)
        if wings is None and abs(found / area_m2 - 1) > _AREA_TOLERANCE:
            inner *= float(np.clip(area_m2 / found, 0.8, 1.25))
            continue
        house = _joined(name, style, drafts, rng)
        if len(house.reachable()) == len(drafts) and can_be_walked(house):
            return house, own
    raise InputError(name, f"{rooms} rooms in {area_m2:.0f} m²", "rooms that fit into the area")


def _somewhere(house: Building, rng: np.random.Generator) -> Building:
    centre = np.mean([r.polygon.mean(axis=0) for r in house.rooms], axis=0)
    return house.moved(0.0, -centre).moved(rng.uniform(-np.pi, np.pi), rng.uniform(-2, 2, 2))


def _drafts(
    style: Style,
    rooms: int,
    inner_m2: float,
    skewed: bool,
    rng: np.random.Generator,
    given: list[Wing] | None,
) -> tuple[list[Draft], list[Wing]] | None:
    """The rooms of a storey and its wings, or None where the draw does not fit."""
    closets = int(rng.binomial(rooms, style.closet_share)) if rooms > 3 else 0
    count = max(rooms - closets, 3)
    wings = _wings(style, count, inner_m2, skewed, rng) if given is None else given
    if wings is None or len(wings) > count:
        return None
    drafts: list[Draft] = []
    for wing, share in zip(wings, _shares(count, wings), strict=True):
        own = _wing_rooms(style, wing, share, skewed, rng)
        if own is None:
            return None
        drafts += [replace(d, polygon=wing.placed(d.polygon)) for d in own]
    if any(not habitable(draft, style.least_room_m2) for draft in drafts):
        return None
    for _ in range(rooms - count):
        if not _add_closet(style, drafts, rng):
            return None
    _add_features(style, drafts, skewed, rng)
    return drafts, wings


def _wings(
    style: Style, count: int, area: float, skewed: bool, rng: np.random.Generator
) -> list[Wing] | None:
    choices = [(shape, weight) for few, most, shape, weight in style.shapes if few <= count <= most]
    if not choices:
        return None
    weights = np.array([weight for _, weight in choices])
    shape = choices[int(rng.choice(len(choices), p=weights / weights.sum()))][0]
    # A house of one wing is no longer than about twice its depth, one of several no more slender
    # than its wings bear.
    squat = float(np.sqrt(area / rng.uniform(1.1, 2.2)))
    slender = {"I": 1.0, "L": 0.66, "T": 0.66}.get(shape, 0.5)
    if count < _CORRIDOR_FROM:
        return make_wings(rng, shape, area, slender * squat, skewed)
    band = float(np.sqrt(area / count)) * rng.uniform(0.75, 1.1)
    band = float(np.clip(band, _DEPTHS_AT_LEAST_M, style.widest_band_m))
    depth = 2 * band + rng.uniform(*style.corridor_m)
    return make_wings(rng, shape, area, max(depth, slender * squat), skewed)


def _shares(count: int, wings: list[Wing]) -> list[int]:
    """How many rooms each wing gets, by its area, at least one."""
    areas = np.array([wing.area for wing in wings])
    ideal = count * areas / areas.sum()
    shares = np.maximum(np.floor(ideal).astype(int), 1)
    while shares.sum() != count:
        step = 1 if shares.sum() < count else -1
        lack = step * (ideal - shares)
        lack[(shares == 1) & (step < 0)] = -np.inf
        shares[int(np.argmax(lack))] += step
    return [int(share) for share in shares]


def _wing_rooms(
    style: Style, wing: Wing, count: int, skewed: bool, rng: np.random.Generator
) -> list[Draft] | None:
    """The rooms of a wing in its own frame."""
    outline = wing.outline
    low, high = outline.min(axis=0), outline.max(axis=0)
    weights = list(rng.lognormal(0.0, style.spread, count))
    wide = float(rng.uniform(*style.corridor_m))
    depth = float(high[1] - low[1])
    if wing.gallery is not None and count >= 2 and depth > wide + _NARROWEST_BAND_M:
        return _with_gallery(outline, wing.gallery, wide, weights[1:], skewed, rng)
    if count < _CORRIDOR_FROM or depth < wide + 2 * _NARROWEST_BAND_M + 0.5:
        return _suite(outline, weights, skewed, rng)
    ends: list[Draft] = []
    if count >= 5 and rng.random() < 0.6:
        share = float(np.clip(rng.uniform(1.2, 2.4) / count, 0.12, 0.4))
        at_low = bool(rng.random() < 0.5)
        x = low[0] + (high[0] - low[0]) * (share if at_low else 1 - share)
        pieces = upright_cut(outline, x, _slant(skewed, 12, rng), rng)
        end, outline = pieces if at_low else pieces[::-1]
        ends, weights = [Draft("room", end)], weights[1:]
    rooms = _double_loaded(outline, wide, weights[1:], skewed, rng)
    return None if rooms is None else ends + rooms


def _suite(
    outline: FloatArray, weights: list[float], skewed: bool, rng: np.random.Generator
) -> list[Draft] | None:
    polygons = _divided(outline, weights, 1.0, skewed, rng)
    return None if polygons is None else [Draft("room", polygon) for polygon in polygons]


def _with_gallery(
    outline: FloatArray,
    side: str,
    wide: float,
    weights: list[float],
    skewed: bool,
    rng: np.random.Generator,
) -> list[Draft] | None:
    """A corridor along one long side, rooms along the other."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    thick = wall_thickness(rng)
    z = high[1] - wide - thick / 2 if side == "high" else low[1] + wide + thick / 2
    upper, lower = cut(outline, np.array([low[0], z]), np.array([1.0, 0.0]), thick)
    corridor, band = (upper, lower) if side == "high" else (lower, upper)
    rooms = _divided(band, weights, 0.75, skewed, rng)
    if rooms is None:
        return None
    return [Draft("corridor", corridor), *(Draft("room", polygon) for polygon in rooms)]


def _double_loaded(
    outline: FloatArray, wide: float, weights: list[float], skewed: bool, rng: np.random.Generator
) -> list[Draft] | None:
    """A corridor along the middle, at times with a branch to an outer wall, rooms on both sides."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    slack = high[1] - low[1] - wide - 0.5 - 2 * _NARROWEST_BAND_M
    if slack < 0 or len(weights) < 2:
        return None
    z = low[1] + 0.25 + _NARROWEST_BAND_M + slack * rng.uniform(0.25, 0.75) + wide / 2
    tilt = _slant(skewed, 4, rng)
    along, up = np.array([np.cos(tilt), np.sin(tilt)]), np.array([-np.sin(tilt), np.cos(tilt)])
    middle = np.array([(low[0] + high[0]) / 2, z])
    above, below = wall_thickness(rng), wall_thickness(rng)
    corridor = clip(outline, up, float(up @ middle) + wide / 2)
    corridor = clip(corridor, -up, -float(up @ middle) + wide / 2)
    upper = cut(outline, middle + up * (wide + above) / 2, along, above)[0]
    lower = cut(outline, middle - up * (wide + below) / 2, along, below)[1]
    bands = [upper, lower]
    if rng.random() < 0.4:
        k = int(rng.integers(2))
        side = up if k == 0 else -up
        through = clip(outline, -side, -float(side @ middle))
        branched = _branch(corridor, bands[k], through, wide, rng)
        if branched is None:
            return None
        corridor = branched[0]
        bands[k : k + 1] = branched[1]
    areas = np.array([shapely.Polygon(band).area for band in bands])
    order = rng.permutation(len(weights))
    shares = _counts(len(weights), areas)
    if shares is None:
        return None
    rooms: list[Draft] = []
    for band, share in zip(bands, shares, strict=True):
        own, order = order[:share], order[share:]
        polygons = _divided(band, [weights[k] for k in own], 0.75, skewed, rng)
        if polygons is None:
            return None
        rooms += [Draft("room", polygon) for polygon in polygons]
    return [Draft("corridor", corridor), *rooms]


def _counts(count: int, areas: FloatArray) -> list[int] | None:
    """How many rooms each band gets, at least one; None where there are too few."""
    if count < len(areas):
        return None
    shares = np.ones(len(areas), dtype=int)
    for _ in range(count - len(areas)):
        shares[int(np.argmax(areas / (shares + 0.5)))] += 1
    return shares.tolist()


def _branch(
    corridor: FloatArray,
    band: FloatArray,
    through: FloatArray,
    wide: float,
    rng: np.random.Generator,
) -> tuple[FloatArray, list[FloatArray]] | None:
    """A branch of the corridor through a band; what is left of the band on its sides."""
    low, high = band[:, 0].min(), band[:, 0].max()
    width = min(wide, 1.6)
    if high - low < width + 2 * 2.6:
        return None
    x = rng.uniform(low + 2.6, high - 2.6 - width)
    at_low, rest = upright_cut(band, x, 0.0, rng)
    _, through_rest = upright_cut(through, x, 0.0, rng)
    start = float(rest[:, 0].min())
    branch = clip(through_rest, np.array([1.0, 0.0]), start + width)
    branch = clip(branch, np.array([-1.0, 0.0]), -start)
    thick = wall_thickness(rng)
    at_high = clip(band, np.array([-1.0, 0.0]), -(start + width + thick))
    whole = shapely.union(shapely.Polygon(corridor), shapely.Polygon(branch))
    if not isinstance(whole, shapely.Polygon) or min(len(at_low), len(at_high)) < 3:
        return None
    ring = counter_clockwise(np.asarray(whole.simplify(1e-6).exterior.coords)[:-1])
    return without_straight_corners(ring), [at_low, at_high]


def _divided(
    area: FloatArray,
    weights: list[float],
    upright: float,
    skewed: bool,
    rng: np.random.Generator,
) -> list[FloatArray] | None:
    """Cuts a convex area into rooms whose sizes are as the weights.

    Args:
        area: convex, along x.
        weights: one a room.
        upright: an area is cut across x where it is wider than so many depths.
        skewed: whether walls may be slanted.
        rng: of places and walls.

    Returns:
        The rooms, or None where nothing is left of one.
    """
    if len(area) < 3:
        return None
    if len(weights) == 1:
        return [area]
    sums = np.cumsum(weights)
    k = int(np.clip(np.searchsorted(sums, sums[-1] / 2) + 1, 1, len(weights) - 1))
    share = float(sums[k - 1] / sums[-1])
    low, high = area.min(axis=0), area.max(axis=0)
    width, depth = high - low
    if width > upright * depth * rng.uniform(0.85, 1.2):
        first, second = upright_cut(area, low[0] + share * width, _slant(skewed, 12, rng), rng)
    else:
        tilt = _slant(skewed, 8, rng)
        point = np.array([(low[0] + high[0]) / 2, low[1] + share * depth])
        along = np.array([np.cos(tilt), np.sin(tilt)])
        second, first = cut(area, point, along, wall_thickness(rng))
    parts = [
        _divided(first, weights[:k], upright, skewed, rng),
        _divided(second, weights[k:], upright, skewed, rng),
    ]
    return None if parts[0] is None or parts[1] is None else parts[0] + parts[1]


def _slant(skewed: bool, most_deg: float, rng: np.random.Generator) -> float:
    """Angle by which a wall leaves the square, rad; some of the walls of a skewed house."""
    if not skewed or rng.random() < 0.6:
        return 0.0
    return float(np.deg2rad(rng.uniform(0.4, 1.0) * most_deg) * rng.choice([-1, 1]))


def _add_closet(style: Style, drafts: list[Draft], rng: np.random.Generator) -> bool:
    """Walls a closet off one of the larger rooms, in place; whether it could."""
    small, large = style.closet_m
    floors = np.array([d.floor.area if d.label == "room" else 0.0 for d in drafts])
    for _ in range(12):
        if floors.sum() == 0:
            return False
        k = int(rng.choice(len(drafts), p=floors / floors.sum()))
        sizes, wall = rng.uniform(small, large, 2), wall_thickness(rng)
        if rng.random() < 0.75:
            corners = convex_corners(drafts[k].polygon)
            if not corners:
                continue
            pair = corner_closet(drafts[k], int(rng.choice(corners)), (sizes[0], sizes[1]), wall)
        else:
            edge = int(rng.integers(len(drafts[k].polygon)))
            spare = drafts[k].lengths[edge] - sizes[0] - 2 * wall - 1.6
            if spare < 0:
                continue
            start = 0.8 + wall + spare * rng.random()
            pair = alcove_closet(drafts[k], edge, start, sizes[0], sizes[1], wall)
        closet, rest = pair
        if (
            habitable(closet, 1.2)
            and habitable(rest, style.least_room_m2)
            and drafts[k].floor.buffer(1e-6).covers(closet.floor)
            and closet.floor.distance(rest.floor) > wall - 1e-6
        ):
            drafts[k] = rest
            drafts.append(closet)
            return True
    return False


def _add_features(
    style: Style, drafts: list[Draft], skewed: bool, rng: np.random.Generator
) -> None:
    """Bays, round walls, recesses, cut corners, chimney breasts and pillars, in place."""
    for _ in range(int(rng.binomial(2 * len(drafts), style.feature_share / 2))):
        k = int(rng.integers(len(drafts)))
        others = shapely.union_all([d.floor for n, d in enumerate(drafts) if n != k])
        changed = _changed(drafts[k], shapely.union(others, drafts[k].floor), skewed, rng)
        if (
            changed is not None
            and habitable(changed, style.least_room_m2)
            and changed.floor.distance(others) > 0.079
        ):
            drafts[k] = changed
    for k, draft in enumerate(drafts):
        if draft.floor.area > style.pillared_m2 and rng.random() < 0.3:
            drafts[k] = _pillared(draft, style.least_room_m2, rng)


def _changed(
    room: Draft, house: shapely.Geometry, skewed: bool, rng: np.random.Generator
) -> Draft | None:
    """A room with one more feature, or None where the draw does not fit."""
    kinds = ("bay", "apse", "recess", "round corner", "slanted corner", "breast")
    what = str(rng.choice(kinds, p=[0.24, 0.16, 0.16, 0.12, 0.08, 0.24]))
    if what in ("bay", "apse", "breast"):
        edge = int(rng.integers(len(room.polygon)))
        length = float(room.lengths[edge])
        outside = faces_outside(room, edge, 1.6, house)
        if what == "breast":
            if length < 2.6 or room.label != "room":
                return None
            width, depth = rng.uniform(0.6, min(1.8, length - 1.6)), -rng.uniform(0.3, 0.6)
            return bay(room, edge, _start(length, width, 0.6, rng), width, depth, 0.0)
        if not outside or length < 2.6:
            return None
        width = float(rng.uniform(1.8, min(4.2, length - 0.6)))
        start = _start(length, width, 0.3, rng)
        depth = float(rng.uniform(0.5, min(1.5, width / 2)))
        if what == "bay":
            slant = 0.0 if rng.random() < 0.3 else min(depth, 0.3 * width)
            return bay(room, edge, start, width, depth, slant)
        parts = int(np.clip(np.pi * width / 2 / 0.5, 5, 9))
        return apse(room, edge, start, width, depth, parts)
    corners = convex_corners(room.polygon)
    if not corners:
        return None
    corner = int(rng.choice(corners))
    sides = room.lengths[[corner - 1, corner]]
    if what == "recess":
        if room.label != "room" or not all(
            faces_outside(room, edge, 0.2, house) for edge in (corner - 1, corner)
        ):
            return None
        sizes = rng.uniform(0.6, 2.0, 2)
        if (sizes > sides - 1.2).any():
            return None
        return corner_closet(room, corner, (sizes[1], sizes[0]), 0.0)[1]
    radius = float(rng.uniform(0.7, 2.0))
    if radius > sides.min() - 1.0 or (what == "slanted corner" and not skewed):
        return None
    parts = int(np.clip(1.6 * radius / 0.4, 3, 6)) if what == "round corner" else 1
    return cut_corner(room, corner, radius, parts)


def _start(length: float, width: float, margin: float, rng: np.random.Generator) -> float:
    return float(margin + (length - width - 2 * margin) * rng.random())


def _pillared(room: Draft, least_m2: float, rng: np.random.Generator) -> Draft:
    """A room with one to four pillars well away from its walls, as many as fit."""
    inner = room.floor.buffer(-1.6)
    size, corners = float(rng.uniform(0.3, 0.6)), int(rng.choice([4, 4, 8]))
    edge = room.polygon[1] - room.polygon[0]
    angle = float(np.arctan2(edge[1], edge[0]))
    standing = room
    for _ in range(int(rng.integers(1, 5))):
        if inner.is_empty:
            break
        low_x, low_z, high_x, high_z = inner.bounds
        place = rng.uniform([low_x, low_z], [high_x, high_z])
        if not inner.covers(shapely.Point(place)):
            continue
        more = pillar(standing, place, size, angle, corners)
        if habitable(more, least_m2):
            standing = more
            inner = inner.difference(shapely.Point(place).buffer(1.6 + size))
    return standing


def _joined(name: str, style: Style, drafts: list[Draft], rng: np.random.Generator) -> Building:
    usual = float(rng.uniform(*style.ceiling_m))
    rooms = tuple(
        InteriorRoom(
            label, draft.polygon, _ceiling(label, draft.floor.area, usual, rng), draft.holes
        )
        for label, draft in zip(_labels(drafts, rng), drafts, strict=True)
    )
    passages = join(rooms, style.doors, rng)
    front = _front_door(drafts, rooms, style.doors, rng)
    windows = outer_windows(rooms, rng)
    if front is None:
        return Building(name, rooms, passages, windows)
    door = shapely.LineString(front.segment).buffer(0.2)
    clear = tuple(w for w in windows if not door.intersects(shapely.LineString(w.segment)))
    return Building(name, rooms, passages, clear, (front,))


def _front_door(
    drafts: list[Draft], rooms: tuple[InteriorRoom, ...], doors: Joinery, rng: np.random.Generator
) -> BlindDoor | None:
    """A door to the street in an outer wall of a way or a shared room, if one has such."""
    house = shapely.union_all([room.floor for room in rooms])
    for k in sorted(range(len(rooms)), key=lambda k: (rooms[k].label not in WAYS, k)):
        if rooms[k].label not in WAYS | SHARED:
            continue
        lengths = drafts[k].lengths
        outer = [
            edge
            for edge in range(len(lengths))
            if lengths[edge] > 1.15 and faces_outside(drafts[k], edge, 1.0, house)
        ]
        if outer:
            edge = int(rng.choice(outer))
            a, b = rooms[k].polygon[edge], np.roll(rooms[k].polygon, -1, axis=0)[edge]
            along = (b - a) / lengths[edge]
            width = float(rng.uniform(doors.door_m[0] + 0.1, 1.0))
            start = _start(float(lengths[edge]), width, 0.05, rng)
            segment = a + np.array([[start], [start + width]]) * along
            return BlindDoor("door", k, segment)
    return None


def _ceiling(label: str, area: float, usual: float, rng: np.random.Generator) -> float:
    """Most ceilings of a house have one height; large rooms may be higher, servant ones lower."""
    if rng.random() < 0.6:
        return usual
    if label in SERVANT or label == "corridor":
        return max(usual - float(rng.uniform(0.05, 0.35)), 2.2)
    return usual + float(rng.uniform(0.05, 0.3 + min(area, 120.0) / 60.0))


def _labels(drafts: list[Draft], rng: np.random.Generator) -> list[str]:
    """What the rooms are, by their size and place."""
    labels = [d.label for d in drafts]
    by_size = sorted(
        (k for k, d in enumerate(drafts) if d.label == "room"), key=lambda k: -drafts[k].floor.area
    )
    for k, label in enumerate(labels):
        if label == "closet" and rng.random() < 0.5:
            labels[k] = "bathroom"
    shared = ["living", "kitchen"]
    shared += ["dining"] if len(by_size) >= 5 else []
    shared += ["family"] if len(by_size) >= 9 else []
    placed: list[int] = []
    for label in shared[: max(len(by_size) - 1, 1)]:
        near = [
            k
            for k in by_size
            if not placed or min(drafts[k].floor.distance(drafts[p].floor) for p in placed) < 0.3
        ]
        if near:
            k = near[0]
            labels[k] = label
            by_size.remove(k)
            placed.append(k)
    for k in by_size:
        if drafts[k].floor.area < 7.5 and rng.random() < 0.6:
            labels[k] = "bathroom"
        else:
            labels[k] = "office" if rng.random() < 0.25 else "bedroom"
    return labels
