"""What a camera truly sees: the floor-wall boundary by ray casting."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from panoplan.geometry.sphere import column_heading, heading_column
from panoplan.simulate.buildings import Building
from panoplan.simulate.walks import locate
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.layout import Layout, Spans

_EDGE_SLACK = 1e-9
_ASIDE_RAD = 1e-7
_NEAREST_M = 1e-3


class Surface(IntEnum):
    """What a column's floor boundary lies on."""

    WALL = 0
    DOOR = 1
    OPENING = 2
    WINDOW = 3
    MID_FLOOR = 4
    """The end of a leak, where there is nothing but floor."""


@dataclass(frozen=True, eq=False)
class View:
    """The exact layout seen from a level camera.

    Attributes:
        room: index of the room it is of.
        camera_height_m: above the floor.
        ceiling_height_m: of the room.
        range_m: (W,) horizontal distance to the floor boundary.
        closed_range_m: (W,) the same with all doors and openings closed; equal where no leak.
        surface: (W,) `Surface` the boundary lies on.
        closed_surface: (W,) `Surface` with all doors and openings closed.
        passage: (W,) index of the building's passage whose face the column meets first, or −1.
        leaked: (W,) whether the boundary lies beyond that passage.
        corners: (K,) columns of the visible corners, sorted, in [0, W).
    """

    room: int
    camera_height_m: float
    ceiling_height_m: float
    range_m: FloatArray
    closed_range_m: FloatArray
    surface: NDArray[np.int8]
    closed_surface: NDArray[np.int8]
    passage: IntArray
    leaked: BoolArray
    corners: FloatArray

    @property
    def floor_boundary(self) -> FloatArray:
        """(W,) elevation of the floor boundary, rad, negative."""
        return np.asarray(-np.arctan2(self.camera_height_m, self.range_m))

    @property
    def ceiling_boundary(self) -> FloatArray:
        """(W,) elevation of the ceiling boundary, rad; over leaks that of the lintel's wall."""
        rise = self.ceiling_height_m - self.camera_height_m
        return np.asarray(np.arctan2(rise, self.closed_range_m))

    @property
    def closed_layout(self) -> Layout:
        """The true layout of the room: doors and openings closed, no corners."""
        floor = -np.arctan2(self.camera_height_m, self.closed_range_m)
        return Layout(floor, self.ceiling_boundary)

    @property
    def layout(self) -> Layout:
        """The view as a perfect network would tell it."""
        return Layout(self.floor_boundary, self.ceiling_boundary, self.corners)


@dataclass(frozen=True, eq=False)
class _Faces:
    """Vertical faces: segments that stop rays."""

    a: FloatArray
    b: FloatArray
    surface: NDArray[np.int8]
    passage: IntArray

    def without(self, passage: int) -> _Faces:
        keep = self.passage != passage
        return _Faces(self.a[keep], self.b[keep], self.surface[keep], self.passage[keep])

    def plus(self, other: _Faces) -> _Faces:
        return _Faces(
            np.vstack([self.a, other.a]),
            np.vstack([self.b, other.b]),
            np.concatenate([self.surface, other.surface]),
            np.concatenate([self.passage, other.passage]),
        )


class ViewCaster:
    """Casts views inside one building.

    Args:
        building: its rooms, doors, openings and windows.
    """

    def __init__(self, building: Building) -> None:
        self.building = building
        self._rooms = [_room_faces(building, k) for k in range(len(building.rooms))]

    def view(
        self,
        position: FloatArray,
        heading: float,
        camera_height_m: float,
        *,
        width: int = 1024,
        leaks: Mapping[int, float] | None = None,
        room: int | None = None,
    ) -> View:
        """The view of a level camera.

        The boundary is that of the room the camera stands in, closed at doors and openings. In a
        doorway it is that of the passage and of the room the camera looks into, closed at the
        passage's other face.

        Args:
            position: (2,) camera, plan, metres.
            heading: of its z axis, rad from the plan's second axis towards its first.
            camera_height_m: above the floor.
            width: number of columns W.
            leaks: how far the boundary goes beyond a passage of this room, metres square to the
                wall's near face, by index of the passage; it stops earlier where it meets the
                walls behind.
            room: index of the room, where already known.

        Returns:
            The view.

        Raises:
            InputError: the camera stands in no room and no passage.
        """
        if room is None:
            room = int(locate(self.building, position[None], np.array([heading]))[0])
        near = self._around(position, room)
        beyond = {k: self._behind(room, k, depth) for k, depth in (leaks or {}).items()}
        angles = heading + column_heading(np.arange(width, dtype=np.float64), width)
        closed, first = _cast(position, angles, near)
        distance, surface, leaked = self._through(position, angles, near, beyond, closed, first)
        return View(
            room=room,
            camera_height_m=camera_height_m,
            ceiling_height_m=self.building.rooms[room].ceiling_height_m,
            range_m=distance,
            closed_range_m=closed,
            surface=surface,
            closed_surface=near.surface[first],
            passage=near.passage[first],
            leaked=leaked,
            corners=self._corners(position, heading, width, near, beyond),
        )

    def _around(self, position: FloatArray, room: int) -> _Faces:
        """The closed faces around a camera in a room or on one of its thresholds."""
        faces = self._rooms[room]
        for k, _ in self.building.neighbours(room):
            passage = self.building.passages[k]
            side = passage.side(room)
            outward = passage.outward_from(room)
            near, far = passage.faces[side], passage.faces[1 - side]
            along = near[1] - near[0]
            depth = float(outward @ (position - near[0]))
            share = float(along @ (position - near[0]) / (along @ along))
            if 0 < depth <= passage.thickness + 1e-9 and -1e-9 <= share <= 1 + 1e-9:
                jambs = _Faces(near, far, _label(Surface.WALL, 2), np.full(2, -1))
                end = _Faces(far[:1], far[1:], _label(_surface(passage.kind), 1), np.array([k]))
                return faces.without(k).plus(jambs).plus(end)
        return faces

    def _behind(self, room: int, index: int, depth: float) -> _Faces:
        """What stops the rays that leave a room through one of its passages."""
        passage = self.building.passages[index]
        side = passage.side(room)
        outward = passage.outward_from(room)
        near, far = passage.faces[side], passage.faces[1 - side]
        jambs = _Faces(near, far, _label(Surface.WALL, 2), np.full(2, -1))
        along = (near[1] - near[0]) / passage.width
        middle = near.mean(axis=0) + depth * outward
        reach = 1e3
        end = _Faces(
            (middle - reach * along)[None],
            (middle + reach * along)[None],
            _label(Surface.MID_FLOOR, 1),
            np.array([-1]),
        )
        return self._rooms[passage.rooms[1 - side]].without(index).plus(jambs).plus(end)

    def _through(
        self,
        position: FloatArray,
        angles: FloatArray,
        near: _Faces,
        beyond: Mapping[int, _Faces],
        closed: FloatArray,
        first: IntArray,
    ) -> tuple[FloatArray, NDArray[np.int8], BoolArray]:
        """Follows the rays that meet a leaking passage."""
        distance, surface = closed.copy(), near.surface[first]
        leaked = np.zeros(len(angles), dtype=np.bool_)
        for index, faces in beyond.items():
            through = near.passage[first] == index
            if through.any():
                ranges, hit = _cast(position, angles[through], faces, closed[through])
                distance[through], surface[through] = ranges, faces.surface[hit]
                leaked |= through
        return distance, surface, leaked

    def _corners(
        self,
        position: FloatArray,
        heading: float,
        width: int,
        near: _Faces,
        beyond: Mapping[int, _Faces],
    ) -> FloatArray:
        """Columns of the boundary's visible corners."""
        points = [_wall_ends(near)]
        for index, faces in beyond.items():
            leaking = near.passage == index
            points += [near.a[leaking], near.b[leaking], _wall_ends(faces), _end_points(faces)]
        corners = np.vstack(points)
        offsets = corners - position
        distance = np.hypot(*offsets.T)
        corners, offsets = corners[distance > 1e-6], offsets[distance > 1e-6]
        distance = distance[distance > 1e-6]
        angle = np.arctan2(offsets[:, 0], offsets[:, 1])
        seen = np.zeros(len(corners), dtype=np.bool_)
        for aside in (-_ASIDE_RAD, _ASIDE_RAD):
            closed, first = _cast(position, angle + aside, near)
            ranges, _, _ = self._through(position, angle + aside, near, beyond, closed, first)
            seen |= np.abs(ranges - distance) < 1e-4 * np.maximum(distance, 1.0)
        columns = np.sort(heading_column(angle[seen] - heading, width) % width)
        if len(columns) == 0:
            return columns
        gaps = np.diff(columns, append=columns[0] + width)
        return np.asarray(columns[gaps > 1e-3])


def tilted(layout: Layout, level_from_cam: FloatArray) -> Layout:
    """The layout of a level camera as a tilted one at the same place sees it.

    Args:
        layout: of the level camera.
        level_from_cam: (3, 3) small rotation: the tilted camera's axes in the level camera.

    Returns:
        The layout in the tilted camera's columns, by interpolation between the level ones.
    """
    width = layout.width
    columns = np.arange(width, dtype=np.float64)
    floor = _tilted_boundary(layout.floor_boundary, columns, level_from_cam)
    ceiling = layout.ceiling_boundary
    corners = layout.corners
    if corners is not None and len(corners):
        at = np.interp(corners, columns, layout.floor_boundary, period=width)
        moved = _directions(at, column_heading(corners, width)) @ level_from_cam
        corners = heading_column(np.arctan2(moved[:, 0], moved[:, 2]), width) % width
    return Layout(
        floor,
        None if ceiling is None else _tilted_boundary(ceiling, columns, level_from_cam),
        corners,
        # A few degrees move it by less than it says itself.
        layout.floor_sigma,
        _tilted_spans(layout, level_from_cam),
    )


def _tilted_spans(layout: Layout, level_from_cam: FloatArray) -> Spans | None:
    """A tilt of a few degrees moves a span by less than networks err: its ends are rounded."""
    if layout.spans is None:
        return None
    width = layout.width
    columns = np.arange(width, dtype=np.float64)
    moved = _directions(layout.floor_boundary, column_heading(columns, width)) @ level_from_cam
    at = heading_column(np.arctan2(moved[:, 0], moved[:, 2]), width) % width

    def there(told: FloatArray) -> FloatArray:
        return np.asarray(at[np.round(told).astype(int) % width])

    return Spans(
        *(there(s) for s in (layout.spans.doors, layout.spans.openings, layout.spans.windows))
    )


def _tilted_boundary(
    elevation: FloatArray, columns: FloatArray, level_from_cam: FloatArray
) -> FloatArray:
    width = len(elevation)
    moved = _directions(elevation, column_heading(columns, width)) @ level_from_cam
    at = heading_column(np.arctan2(moved[:, 0], moved[:, 2]), width)
    order = np.argsort(at, kind="stable")
    values = np.arcsin(np.clip(-moved[order, 1], -1, 1))
    return np.asarray(np.interp(columns, at[order], values, period=width))


def _directions(elevation: FloatArray, heading: FloatArray) -> FloatArray:
    cos = np.cos(elevation)
    return np.stack([cos * np.sin(heading), -np.sin(elevation), cos * np.cos(heading)], axis=-1)


def _surface(kind: str) -> Surface:
    return Surface.DOOR if kind == "door" else Surface.OPENING


def _label(surface: Surface, count: int) -> NDArray[np.int8]:
    return np.full(count, surface, dtype=np.int8)


def _room_faces(building: Building, room: int) -> _Faces:
    """The walls of a room, split where doors, openings and windows begin and end."""
    walls = [
        pair
        for ring in building.rooms[room].rings
        for pair in zip(ring, np.roll(ring, -1, axis=0), strict=True)
    ]
    marks = [
        (p.faces[p.side(room)], _surface(p.kind), k)
        for k, p in enumerate(building.passages)
        if room in p.rooms
    ]
    marks += [(w.segment, Surface.WINDOW, -1) for w in building.windows if w.room == room]
    marks += [(d.segment, _surface(d.kind), -1) for d in building.blind_doors if d.room == room]
    a: list[FloatArray] = []
    b: list[FloatArray] = []
    surfaces: list[int] = []
    passages: list[int] = []
    for start, end in walls:
        length = float(np.hypot(*(end - start)))
        along = (end - start) / length
        spans = []
        for segment, surface, index in marks:
            off = np.abs((segment - start) @ np.array([along[1], -along[0]])).max()
            low, high = sorted((segment - start) @ along)
            if off < 1e-6 and low > -1e-6 and high < length + 1e-6:
                spans.append((float(low), float(high), surface, index))
        at = 0.0
        for low, high, surface, index in [*sorted(spans), (length, length, Surface.WALL, -1)]:
            for begin, stop, what, which in (
                (at, low, Surface.WALL, -1),
                (low, high, surface, index),
            ):
                if stop - begin > _EDGE_SLACK:
                    a.append(start + begin * along)
                    b.append(start + stop * along)
                    surfaces.append(what)
                    passages.append(which)
            at = high
    return _Faces(np.array(a), np.array(b), np.array(surfaces, dtype=np.int8), np.array(passages))


def _cast(
    position: FloatArray,
    angles: FloatArray,
    faces: _Faces,
    beyond: FloatArray | None = None,
) -> tuple[FloatArray, IntArray]:
    """First face that each ray meets.

    Args:
        position: (2,) camera.
        angles: (N,) rad from the plan's second axis towards its first.
        faces: what may be met.
        beyond: (N,) distance from which on a face counts; 0 where None.

    Returns:
        Distances (N,) and indices of the faces (N,).
    """
    dx, dy = np.sin(angles)[:, None], np.cos(angles)[:, None]
    ax, ay = (faces.a - position).T
    ex, ey = (faces.b - faces.a).T
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (dx * ey - dy * ex)
        distance = (ax * ey - ay * ex) * inverse
        share = (ax * dy - ay * dx) * inverse
    slack = _EDGE_SLACK / np.hypot(ex, ey)
    least = _NEAREST_M * 1e-3 if beyond is None else beyond[:, None] - 1e-9
    met = (distance > least) & (share >= -slack) & (share <= 1 + slack)
    distance = np.where(met, distance, np.inf)
    first = np.argmin(distance, axis=1)
    return distance[np.arange(len(angles)), first], first


def _wall_ends(faces: _Faces) -> FloatArray:
    """Points where two faces meet at an angle."""
    real = faces.surface != Surface.MID_FLOOR
    a, b = faces.a[real], faces.b[real]
    towards = (b - a) / np.hypot(*(b - a).T)[:, None]
    ends = np.vstack([a, b])
    lines = np.vstack([towards, towards])
    same = np.abs(ends[:, None] - ends[None]).max(axis=2) < 1e-6
    turn = np.abs(lines[:, None, 0] * lines[None, :, 1] - lines[:, None, 1] * lines[None, :, 0])
    return np.asarray(ends[(same & (turn > 1e-3)).any(axis=1)])


def _end_points(faces: _Faces) -> FloatArray:
    """Points where the end of a leak meets walls."""
    k = int(np.flatnonzero(faces.surface == Surface.MID_FLOOR)[0])
    others = np.arange(len(faces.a)) != k
    origin, along = faces.a[k], faces.b[k] - faces.a[k]
    normal = np.array([-along[1], along[0]]) / np.hypot(*along)
    da, db = ((p[others] - origin) @ normal for p in (faces.a, faces.b))
    crossing = da * db < 0
    a, b = faces.a[others][crossing], faces.b[others][crossing]
    share = (da / np.where(crossing, da - db, 1.0))[crossing]
    return np.asarray(a + (b - a) * share[:, None])
