"""Walks with a camera through a building, and tours of still photos."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from scipy.ndimage import gaussian_filter1d
from shapely.geometry.polygon import orient

from panoplan.errors import InputError
from panoplan.simulate.buildings import Building, Passage, Stairs
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.pose import Trajectory

_CLEARANCES_M = (0.35, 0.3, 0.25, 0.2, 0.15, 0.1)
_WAYPOINT_CLEARANCES_M = (0.5, 0.4, 0.3, 0.2, 0.1)
_TURN_M = 0.3
_COMES_DOWN = 0.5
_HEADING_SMOOTHING_M = 0.35
PATH_SPACING_M = 0.02
"""Between the points of a path."""


@dataclass(frozen=True, eq=False)
class Walk:
    """Where the camera truly is at each keyframe.

    World: metres, (x, z) the building's plan, y down, y = 0 at the nominal camera height over the
    first storey's floor.

    Attributes:
        trajectory: world_from_cam of every keyframe; labels are zero-padded numbers from 0.
        rooms: (N,) index of the room each keyframe stands in or, in a doorway, looks into.
        camera_height_m: nominal height above the floor; a keyframe's over the first storey's is
            this less its y.
        path: (P, 2) plan, the way walked, densely; the camera's positions for stills.
        frames: world_from_cam of every frame of the video, labelled with its number from 1, or
            None where there is none.
    """

    trajectory: Trajectory
    rooms: IntArray
    camera_height_m: float
    path: FloatArray
    frames: Trajectory | None = None


def walk(
    building: Building,
    rng: np.random.Generator,
    *,
    step_m: float = 0.4,
    keyframes_per_room: int | None = None,
    start: int | None = None,
    camera_height_m: float | None = None,
    tilt_deg: float = 0.0,
) -> Walk:
    """A person walks every room, through the doors, and back through some of them.

    Rooms are visited depth first; each has a few waypoints ≥ 0.5 m from its walls where it is
    wide enough. Doors are crossed in their middle at a right angle. The camera looks where the
    person goes.

    Args:
        building: connected.
        rng: of all choices.
        step_m: mean way between keyframes, metres; single steps vary by ± 25 %.
        keyframes_per_room: at least about so many keyframes in each room; by its size where
            None.
        start: index of the first room, of the first storey; drawn where None.
        camera_height_m: nominal height; drawn from 1.4-1.7 m where None.
        tilt_deg: standard deviation of pitch and of roll, which change slowly.

    Returns:
        The walk.

    Raises:
        InputError: a room cannot be reached or is too narrow to walk in.
    """
    height = camera_height(rng, camera_height_m)
    first = first_room(building, rng, start)
    path = path_through(building, rng, first, step_m * (keyframes_per_room or 0))
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path[:, :2], axis=0).T))])
    at = _strides(rng, float(arc[-1]), step_m)
    headings = headings_along(path)
    wobble = np.deg2rad(8.0) * smooth_noise(rng, len(at), 12.0)
    beta = np.interp(at, arc, headings) + wobble
    places = np.stack([np.interp(at, arc, path[:, k]) for k in range(3)], axis=1)
    bob = 0.015 * smooth_noise(rng, len(at), 1.0)
    tilt = np.deg2rad(tilt_deg) * np.stack([smooth_noise(rng, len(at), 3.0) for _ in range(2)], 1)
    return _walk(building, places, bob, beta, tilt, height, path[:, :2])


def path_through(
    building: Building, rng: np.random.Generator, start: int, least_m: float = 0.0
) -> FloatArray:
    """The way of a person through all rooms, with rounded turns.

    The rooms of a storey are visited depth first, then those of the next, up its stairs; half of
    the people come down again at the end.

    Args:
        building: connected.
        rng: of all choices.
        start: index of the first room.
        least_m: shortest way in each room, metres.

    Returns:
        (P, 3) plan, and height of the floor below above the first storey's; points are
        `PATH_SPACING_M` apart in the plan.

    Raises:
        InputError: a room cannot be reached or is too narrow to walk in.
    """
    corners = np.array(_route(building, rng, start, least_m))
    return _resampled(_rounded(corners), PATH_SPACING_M)


def stills(
    building: Building,
    rng: np.random.Generator,
    *,
    per_room: tuple[int, int] = (1, 3),
    counts: Sequence[int] | None = None,
    doorways: int = 0,
    start: int | None = None,
    camera_height_m: float | None = None,
) -> Walk:
    """Sparse photos, a few in each room, in the order of a walk, looking anywhere.

    Args:
        building: connected.
        rng: of all choices.
        per_room: fewest and most photos a room.
        counts: photos of each room instead.
        doorways: how many more photos are taken at the end, each in a doorway or opening drawn.
        start: index of the first room; drawn where None.
        camera_height_m: nominal height; drawn from 1.4-1.7 m where None.

    Returns:
        The tour.

    Raises:
        InputError: a room cannot be reached or is too narrow to stand in, or there are fewer
            doorways.
    """
    if doorways > len(building.passages):
        raise InputError("doorways", str(doorways), f"at most {len(building.passages)}")
    height = camera_height(rng, camera_height_m)
    first = first_room(building, rng, start)
    order = _visits(building, rng, first)
    places: list[FloatArray] = []
    for room in dict.fromkeys(order):
        drawn = int(rng.integers(per_room[0], per_room[1] + 1))
        count = drawn if counts is None else counts[room]
        spots = _waypoints(_Footing(building, room), rng, count)
        places += [np.append(spot, building.floor_m(room)) for spot in spots]
    if doorways:
        for k in rng.permutation(len(building.passages))[:doorways]:
            passage = building.passages[k]
            places.append(np.append(passage.area.mean(axis=0), building.floor_m(passage.rooms[0])))
    standing = np.array(places)
    beta = rng.uniform(-np.pi, np.pi, len(standing))
    bob = 0.005 * rng.standard_normal(len(standing))
    tilt = np.zeros((len(standing), 2))
    return _walk(building, standing, bob, beta, tilt, height, standing[:, :2])


def locate(
    building: Building,
    positions: FloatArray,
    headings: FloatArray,
    eyes_m: FloatArray | None = None,
) -> IntArray:
    """The rooms that cameras' views are of.

    Args:
        building: where they are.
        positions: (N, 2) plan, metres.
        headings: (N,) rad, from z towards x.
        eyes_m: (N,) how high they are above the first storey's floor; all on that where None.

    Returns:
        (N,) index of the room each stands in; in a doorway, of the room it looks into; on stairs,
        of the lower room until it looks down on the upper one's floor.

    Raises:
        InputError: one stands in no room and no passage.
    """
    x, z = positions.T
    level = np.zeros(len(positions)) if eyes_m is None else building.levels_below(eyes_m)
    found = np.full(len(positions), -1)
    for passage in building.passages:
        inside = shapely.intersects_xy(shapely.Polygon(passage.area).buffer(1e-9), x, z)
        inside &= level == building.rooms[passage.rooms[0]].level
        ahead = np.sin(headings) * passage.outward[0] + np.cos(headings) * passage.outward[1] >= 0
        found[inside] = np.array(passage.rooms)[ahead[inside].astype(np.int64)]
    for k, room in enumerate(building.rooms):
        found[shapely.intersects_xy(room.floor, x, z) & (level == room.level)] = k
    if (found < 0).any():
        lost = positions[found < 0][0]
        raise InputError("camera", f"({lost[0]:.3f}, {lost[1]:.3f})", "a place inside a room")
    return found


def can_be_walked(building: Building) -> bool:
    """Whether a person can stand in every room and reach all its doors."""
    try:
        for k in range(len(building.rooms)):
            _Footing(building, k)
    except InputError:
        return False
    return True


class _Footing:
    """The floor of one room where one may walk, and the shortest ways over it."""

    def __init__(self, building: Building, room: int) -> None:
        stairs = [(k, s) for k, s in enumerate(building.stairs) if room in s.rooms]
        self.outline = building.rooms[room].floor
        for _, flight in stairs:
            self.outline = self.outline.difference(shapely.Polygon(flight.area))
        self.floor_m = building.floor_m(room)
        self.thresholds: dict[int, FloatArray] = {}
        self.landings: dict[int, FloatArray] = {}
        passages = [(k, building.passages[k]) for k, _ in building.neighbours(room)]
        for clearance in _CLEARANCES_M:
            floor = self.outline.buffer(-clearance, join_style="mitre")
            ends = {k: _threshold(p, room, clearance + 1e-4) for k, p in passages}
            landings = {k: _landing(s, s.rooms.index(room), clearance + 1e-4) for k, s in stairs}
            if isinstance(floor, shapely.Polygon) and not floor.is_empty:
                self.floor = floor.buffer(1e-6, join_style="mitre")
                places = (*ends.values(), *landings.values())
                if all(self.floor.covers(shapely.Point(end)) for end in places):
                    self.thresholds, self.landings = ends, landings
                    break
        else:
            raise InputError(f"room {room}", "too narrow to walk in", "0.2 m and reachable doors")
        floor = orient(floor)
        self.bends = np.vstack([_bends(ring) for ring in (floor.exterior, *floor.interiors)])

    def way(self, start: FloatArray, end: FloatArray) -> list[FloatArray]:
        """The shortest way from start to end over the walkable floor, without its start."""
        nodes = np.vstack([start, end, self.bends])
        distance = np.full(len(nodes), np.inf)
        distance[0] = 0.0
        before, todo = np.full(len(nodes), -1), set(range(len(nodes)))
        while todo:
            at = min(todo, key=lambda k: distance[k])
            todo.remove(at)
            if at == 1:
                break
            for k in todo:
                length = float(np.hypot(*(nodes[k] - nodes[at])))
                if distance[at] + length < distance[k] and self._free(nodes[at], nodes[k]):
                    distance[k], before[k] = distance[at] + length, at
        way, at = [], 1
        while at > 0:
            way.append(nodes[at])
            at = int(before[at])
        return way[::-1]

    def _free(self, a: FloatArray, b: FloatArray) -> bool:
        return bool(self.floor.covers(shapely.LineString([a, b])))


def _bends(ring: shapely.LinearRing) -> FloatArray:
    """(N, 2) the corners of a ring, the floor on its left, where the floor is concave."""
    points = np.asarray(ring.coords)[:-1]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    return np.asarray(points[before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < 0])


def _threshold(passage: Passage, room: int, distance: float) -> FloatArray:
    """The point of a room `distance` before the middle of one of its passages."""
    middle = passage.faces[passage.side(room)].mean(axis=0)
    return np.asarray(middle - distance * passage.outward_from(room))


def _landing(stairs: Stairs, end: int, distance: float) -> FloatArray:
    """The point `distance` before the foot (end 0) or beyond the head (1) of stairs."""
    return np.asarray(stairs.line[end] + (-distance, distance)[end] * stairs.along)


def _visits(building: Building, rng: np.random.Generator, start: int) -> list[int]:
    """Rooms in the order of a walk, each a neighbour of the last or up or down the stairs."""
    order = _storey_visits(building, rng, start)
    for lower, upper in (stairs.rooms for stairs in building.stairs):
        order += _rooms_between(building, order[-1], lower)
        order += _storey_visits(building, rng, upper)
    if building.stairs and rng.random() < _COMES_DOWN:
        for lower, upper in (stairs.rooms for stairs in building.stairs[::-1]):
            order += [*_rooms_between(building, order[-1], upper), lower]
        order += _rooms_between(building, order[-1], start)
    return order


def _rooms_between(building: Building, start: int, end: int) -> list[int]:
    """The rooms of one storey on the way from `start`, which is left out, to `end`."""
    ways = {start: [start]}
    todo = [start]
    for room in todo:
        for _, behind in building.neighbours(room):
            if behind not in ways:
                ways[behind] = [*ways[room], behind]
                todo.append(behind)
    return ways[end][1:]


def _storey_visits(building: Building, rng: np.random.Generator, start: int) -> list[int]:
    """Rooms of a storey in the order of a depth-first walk that ends in the last new room."""
    order, seen, last_new = [start], {start}, 0

    def visit(room: int) -> None:
        nonlocal last_new
        behind = [other for _, other in building.neighbours(room)]
        for other in (behind[k] for k in rng.permutation(len(behind))):
            if other in seen:
                continue
            seen.add(other)
            order.append(other)
            last_new = len(order)
            visit(other)
            order.append(room)

    visit(start)
    level = building.rooms[start].level
    if len(seen) < sum(room.level == level for room in building.rooms):
        raise InputError(building.name, "rooms that cannot be reached", "a connected building")
    return order[: max(last_new, 1)]


def _route(
    building: Building,
    rng: np.random.Generator,
    start: int,
    least_m: float,
) -> list[FloatArray]:
    """Corners of the way through all rooms: plan, and height of the floor."""
    footings = [_Footing(building, k) for k in range(len(building.rooms))]
    order = _visits(building, rng, start)
    route = _raised(_waypoints(footings[start], rng, 1), footings[start].floor_m)
    seen: set[int] = set()
    for k, room in enumerate(order):
        # Who has come down the stairs looks round once more.
        if room not in seen or k + 1 == len(order):
            seen.add(room)
            _tour(footings[room], rng, route, least_m)
        if k + 1 < len(order):
            _cross(building, footings, route, room, order[k + 1])
    return route


def _tour(
    footing: _Footing, rng: np.random.Generator, route: list[FloatArray], least_m: float
) -> None:
    """Appends a round over the room's waypoints, repeated until it is long enough."""
    walked = 0.0
    while True:
        count = int(np.clip(np.rint(footing.outline.area / 5.0), 2, 6))
        todo = _waypoints(footing, rng, count)
        while todo:
            here = route[-1][:2]
            gaps = [float(np.hypot(*(place - here))) for place in todo]
            way = footing.way(here, todo.pop(int(np.argmin(gaps))))
            walked += sum(float(np.hypot(*(b - a))) for a, b in pairwise([here, *way]))
            route += _raised(way, footing.floor_m)
        if walked >= least_m or walked < 0.1:
            return


def _cross(
    building: Building, footings: list[_Footing], route: list[FloatArray], room: int, to: int
) -> None:
    """Appends the way from the route's end through a passage or over stairs to another room."""
    here, there = footings[room], footings[to]
    if building.rooms[room].level == building.rooms[to].level:
        index = next(k for k, behind in building.neighbours(room) if behind == to)
        near, far = here.thresholds[index], there.thresholds[index]
        ends: list[FloatArray] = []
    else:
        index = next(k for k, s in enumerate(building.stairs) if {room, to} == set(s.rooms))
        near, far = here.landings[index], there.landings[index]
        stairs = building.stairs[index]
        up = [
            np.append(end, building.floor_m(k))
            for end, k in zip(stairs.line, stairs.rooms, strict=True)
        ]
        ends = up if room == stairs.rooms[0] else up[::-1]
    route += _raised(here.way(route[-1][:2], near), here.floor_m)
    route += [*ends, *_raised([far], there.floor_m)]


def _raised(points: list[FloatArray], floor_m: float) -> list[FloatArray]:
    """(2,) plan points with the height of their floor as a third coordinate."""
    return [np.append(point, floor_m) for point in points]


def _waypoints(footing: _Footing, rng: np.random.Generator, count: int) -> list[FloatArray]:
    """Places to go to, well away from the walls and from one another."""
    for clearance in _WAYPOINT_CLEARANCES_M:
        area = footing.outline.buffer(-clearance, join_style="mitre").intersection(footing.floor)
        if not area.is_empty and area.area > 0:
            break
    low_x, low_z, high_x, high_z = area.bounds
    drawn = rng.uniform([low_x, low_z], [high_x, high_z], (400, 2))
    inside = drawn[shapely.contains_xy(area, drawn[:, 0], drawn[:, 1])][:60]
    if len(inside) == 0:
        inside = np.array([area.representative_point().coords[0]])
    chosen = [inside[0]]
    gap = np.hypot(*(inside - chosen[0]).T)
    while len(chosen) < count and gap.max() > 0.3:
        chosen.append(inside[int(np.argmax(gap))])
        gap = np.minimum(gap, np.hypot(*(inside - chosen[-1]).T))
    return chosen


def _rounded(corners: FloatArray) -> FloatArray:
    """The way with its corners cut by parabolas that begin at most `_TURN_M` before them."""
    steps = np.hypot(*np.diff(corners[:, :2], axis=0).T)
    kept = corners[np.concatenate([[True], steps > 1e-6])]
    if len(kept) < 3:
        return np.asarray(kept)
    steps = np.hypot(*np.diff(kept[:, :2], axis=0).T)
    t = np.linspace(0, 1, 16)[:, None]
    pieces = [kept[:1]]
    for k in range(1, len(kept) - 1):
        reach = min(_TURN_M, steps[k - 1] / 2, steps[k] / 2)
        a = kept[k] + (kept[k - 1] - kept[k]) * (reach / steps[k - 1])
        b = kept[k] + (kept[k + 1] - kept[k]) * (reach / steps[k])
        pieces.append((1 - t) ** 2 * a + 2 * t * (1 - t) * kept[k] + t**2 * b)
    return np.vstack([*pieces, kept[-1:]])


def _resampled(path: FloatArray, spacing: float) -> FloatArray:
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path[:, :2], axis=0).T))])
    at = np.linspace(0, arc[-1], max(int(arc[-1] / spacing), 1) + 1)
    return np.stack([np.interp(at, arc, column) for column in path.T], axis=1)


def _strides(rng: np.random.Generator, length: float, step_m: float) -> FloatArray:
    """Ways along the path at which keyframes are taken, from 0."""
    steps = step_m * rng.uniform(0.75, 1.25, int(length / (0.75 * step_m)) + 1)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(at[at <= length])


def headings_along(path: FloatArray) -> FloatArray:
    """Unwrapped heading of the motion at each path point, smoothed along the way."""
    if len(path) < 3:
        return np.zeros(len(path))
    moved = np.diff(path, axis=0)
    raw = np.unwrap(np.arctan2(moved[:, 0], moved[:, 1]))
    raw = np.append(raw, raw[-1])
    return np.asarray(gaussian_filter1d(raw, _HEADING_SMOOTHING_M / PATH_SPACING_M, mode="nearest"))


def smooth_noise(rng: np.random.Generator, count: int, smoothing: float) -> FloatArray:
    """Gaussian noise of unit variance.

    Args:
        rng: of the noise.
        count: of the samples.
        smoothing: over about so many samples it is correlated.
    """
    margin = int(4 * smoothing) + 1
    white = rng.standard_normal(count + 2 * margin)
    gain = np.sqrt(2 * np.sqrt(np.pi) * smoothing)
    return np.asarray(gaussian_filter1d(white, smoothing)[margin : margin + count] * gain)


def camera_height(rng: np.random.Generator, given: float | None) -> float:
    """Nominal height of the camera in metres: as given, else 1.4 to 1.7 m."""
    drawn = float(rng.uniform(1.4, 1.7))
    return drawn if given is None else given


def first_room(building: Building, rng: np.random.Generator, given: int | None) -> int:
    """Index of the room a walk begins in: as given, else any of the first storey."""
    ground = [k for k, room in enumerate(building.rooms) if room.level == 0]
    return ground[int(rng.integers(len(ground)))] if given is None else given


def _walk(
    building: Building,
    places: FloatArray,
    bob: FloatArray,
    beta: FloatArray,
    tilt: FloatArray,
    height: float,
    path: FloatArray,
) -> Walk:
    n, floors_m = len(places), places[:, 2]
    translations = np.stack([places[:, 0], bob - floors_m, places[:, 1]], axis=1)
    rotations = about_y(beta) @ about_x(tilt[:, 0]) @ about_z(tilt[:, 1])
    labels = tuple(f"{k:04d}" for k in range(n))
    trajectory = Trajectory(labels, rotations, translations)
    rooms = locate(building, places[:, :2], beta, height + floors_m)
    return Walk(trajectory, rooms, height, path)


def about_y(angle: FloatArray) -> FloatArray:
    """(N, 3, 3) rotations about the vertical by (N,) rad, turning z towards x."""
    return _rotations(angle, 2, 0)


def about_x(angle: FloatArray) -> FloatArray:
    """(N, 3, 3) rotations about the x axis by (N,) rad, turning y towards z."""
    return _rotations(angle, 1, 2)


def about_z(angle: FloatArray) -> FloatArray:
    """(N, 3, 3) rotations about the z axis by (N,) rad, turning x towards y."""
    return _rotations(angle, 0, 1)


def _rotations(angle: FloatArray, i: int, j: int) -> FloatArray:
    """(N, 3, 3) rotations that turn axis i towards axis j."""
    out = np.tile(np.eye(3), (len(angle), 1, 1))
    out[:, i, i] = out[:, j, j] = np.cos(angle)
    out[:, j, i], out[:, i, j] = np.sin(angle), -np.sin(angle)
    return out
