"""Walls, floors, ceilings, doors and windows of a building as patches."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from panoplan.simulate.buildings import Building, Passage
from panoplan.simulate.render.looks import BARE, Look, tiled
from panoplan.simulate.render.materials import Material, Pattern
from panoplan.simulate.render.mesh import UP, MeshBuilder, Rectangle
from panoplan.types.arrays import FloatArray

_LEAF_THICK_M = 0.04
_IN_A_DOOR_M, _BEFORE_A_DOOR_M = 0.5, 1.0
_CLEAR_OF_A_LEAF_M = 0.15
_WIDE_M = 2.5


@dataclass(frozen=True, eq=False)
class Pane:
    """A window's glass: where daylight enters.

    Attributes:
        corner: (3,) scene frame.
        along: (3,) its level side.
        across: (3,) its upright side.
        inward: (3,) unit normal into the room.
    """

    corner: FloatArray
    along: FloatArray
    across: FloatArray
    inward: FloatArray


@dataclass(frozen=True, eq=False)
class Shell:
    """What the furniture and the labels must know of a finished building.

    Attributes:
        panes: of all windows.
        shut: indices of the passages whose door is closed.
        leaves: (K, 2, 2) plan: the open leaves, hinge to edge.
    """

    panes: tuple[Pane, ...]
    shut: frozenset[int]
    leaves: FloatArray


@dataclass(frozen=True)
class _Hole:
    start: float
    stop: float
    low: float
    high: float


def raise_shell(
    building: Building,
    look: Look,
    wet: frozenset[int],
    mesh: MeshBuilder,
    rng: np.random.Generator,
    walked: FloatArray | None = None,
    bare: frozenset[int] = frozenset(),
) -> Shell:
    """Adds a building's own surfaces.

    Args:
        building: what is built.
        look: its materials.
        wet: indices of the rooms with tiles: kitchens and baths.
        mesh: what they are added to.
        rng: of heights, frames, leaves and which paint goes where.
        walked: (N, 2) plan: where a camera is; doors there are open, and out of its way.
        bare: indices of the rooms whose floor, walls and ceiling are all of an even white.

    Returns:
        What the rest needs to know.
    """
    heights = [_passage_height(building, p, rng) for p in building.passages]
    windows = [_window_heights(building, w.room, rng) for w in building.windows]
    dry = look.floors
    paints = [look.walls[int(rng.integers(len(look.walls)))] for _ in building.rooms]
    floors = []
    for k, room in enumerate(building.rooms):
        floors.append(look.wet_floor if k in wet else dry[int(rng.integers(len(dry)))])
        if k in wet and rng.random() < 0.5:
            paints[k] = tiled(paints[k], rng, float(rng.choice([1.2, room.ceiling_height_m])))
        ceiling = look.ceiling
        if k in bare:
            floors[k] = paints[k] = ceiling = BARE
        mesh.level(room.polygon, 0.0, floors[k], facing_up=True)
        mesh.level(room.polygon, room.ceiling_height_m, ceiling, facing_up=False)
        _walls(building, k, heights, windows, paints[k], mesh)
    shut, leaves = set(), []
    frame = (float(rng.uniform(0.05, 0.1)), float(rng.uniform(0.008, 0.025)))
    for k, passage in enumerate(building.passages):
        framed = passage.kind == "door" or rng.random() < 0.3
        lining = look.trim if framed else paints[passage.rooms[0]]
        lowest = min(building.rooms[j].ceiling_height_m for j in passage.rooms)
        overhead = look.ceiling if heights[k] == lowest else replace(lining, detail=0.0)
        underfoot = floors[passage.rooms[0]] if passage.kind == "opening" else dry[0]
        _tunnel(passage, heights[k], lining, overhead, underfoot, mesh)
        if framed:
            for side in (0, 1):
                _frame(passage, side, heights[k], frame, look.trim, mesh)
        if passage.kind == "door":
            leaf = _leaf(passage, heights[k], look.leaf, mesh, rng, _through(passage, walked))
            if leaf is None:
                shut.add(k)
            else:
                leaves.append(leaf)
    panes = []
    bars = int(rng.integers(0, 4))
    for window, (low, high) in zip(building.windows, windows, strict=True):
        polygon = building.rooms[window.room].polygon
        panes.append(_window(window.segment, polygon, low, high, look, bars, mesh, rng))
    return Shell(tuple(panes), frozenset(shut), np.array(leaves).reshape(-1, 2, 2))


def _passage_height(building: Building, passage: Passage, rng: np.random.Generator) -> float:
    ceiling = min(building.rooms[k].ceiling_height_m for k in passage.rooms)
    if passage.kind == "door":
        return min(float(rng.uniform(1.95, 2.12)), ceiling - 0.05)
    # What is wide has seldom a lintel far below the ceiling.
    flush = 0.35 if passage.width < _WIDE_M else 0.6
    return ceiling if rng.random() < flush else min(float(rng.uniform(2.0, 2.5)), ceiling - 0.05)


def _window_heights(building: Building, room: int, rng: np.random.Generator) -> tuple[float, float]:
    ceiling = building.rooms[room].ceiling_height_m
    high = min(float(rng.uniform(1.95, 2.3)), ceiling - 0.1)
    low = 0.03 if rng.random() < 0.15 else float(rng.uniform(0.25, 1.25))
    return low, high


def _walls(
    building: Building,
    index: int,
    heights: list[float],
    windows: list[tuple[float, float]],
    paint: Material,
    mesh: MeshBuilder,
) -> None:
    room = building.rooms[index]
    marks = [
        (p.faces[p.side(index)], 0.0, heights[k])
        for k, p in enumerate(building.passages)
        if index in p.rooms
    ]
    marks += [(w.segment, *windows[k]) for k, w in enumerate(building.windows) if w.room == index]
    edges = [edge for ring in room.rings for edge in zip(ring, np.roll(ring, -1, 0), strict=True)]
    for start, end in edges:
        length = float(np.hypot(*(end - start)))
        along = (end - start) / length
        inward = np.array([-along[1], along[0]])
        holes = []
        for segment, low, high in marks:
            s = np.sort((segment - start) @ along)
            on_wall = np.abs((segment - start) @ inward).max() < 1e-6
            if on_wall and s[0] > -1e-6 and s[1] < length + 1e-6:
                holes.append(_Hole(float(s[0]), float(s[1]), low, high))
        parts = _around(holes, length, room.ceiling_height_m)
        mesh.rectangles(
            np.array([start[0], 0.0, start[1]]),
            np.array([along[0], 0.0, along[1]]),
            UP,
            np.array([inward[0], 0.0, inward[1]]),
            (length, room.ceiling_height_m),
            parts,
            paint,
        )


def _around(holes: list[_Hole], length: float, height: float) -> list[Rectangle]:
    """A wall less its holes."""
    parts: list[Rectangle] = []
    at = 0.0
    for hole in sorted(holes, key=lambda h: h.start):
        parts.append((at, hole.start, 0.0, height))
        parts.append((hole.start, hole.stop, 0.0, hole.low))
        parts.append((hole.start, hole.stop, hole.high, height))
        at = hole.stop
    parts.append((at, length, 0.0, height))
    return [p for p in parts if p[1] - p[0] > 1e-4 and p[3] - p[2] > 1e-4]


def _tunnel(
    passage: Passage,
    height: float,
    lining: Material,
    overhead: Material,
    underfoot: Material,
    mesh: MeshBuilder,
) -> None:
    """What is seen in the thickness of the wall: jambs, lintel, threshold."""
    near, far = passage.faces
    plain = replace(lining, detail=0.0)
    along = near[1] - near[0]
    along = along / np.hypot(*along)
    for k, sign in ((0, 1.0), (1, -1.0)):
        depth = far[k] - near[k]
        mesh.quad(
            np.array([near[k, 0], 0.0, near[k, 1]]),
            np.array([depth[0], 0.0, depth[1]]),
            height * UP,
            sign * np.array([along[0], 0.0, along[1]]),
            plain,
        )
    mesh.level(passage.area, height, overhead, facing_up=False)
    mesh.level(passage.area, 0.0, underfoot, facing_up=True)


def _frame(
    passage: Passage,
    side: int,
    height: float,
    frame: tuple[float, float],
    trim: Material,
    mesh: MeshBuilder,
) -> None:
    """Architraves around a passage on one face of its wall."""
    wide, thick = frame
    start, end = passage.faces[side]
    width = passage.width
    along = (end - start) / width
    into_room = -passage.outward if side == 0 else passage.outward
    for low, high in ((-wide, 0.0), (width, width + wide)):
        mesh.box(start, along, into_room, (low, 0, 0), (high, thick, height), trim)
    mesh.box(
        start, along, into_room, (-wide, 0, height), (width + wide, thick, height + wide), trim
    )


def _through(passage: Passage, walked: FloatArray | None) -> FloatArray:
    """The places of (N, 2) before a passage that somebody walks through; none if nobody does."""
    if walked is None or not len(walked):
        return np.empty((0, 2))
    away = shapely.distance(shapely.Polygon(passage.area), shapely.points(walked))
    return walked[away < (_BEFORE_A_DOOR_M if away.min() < _IN_A_DOOR_M else 0.0)]


def _leaf(
    passage: Passage,
    height: float,
    look: Material,
    mesh: MeshBuilder,
    rng: np.random.Generator,
    walked: FloatArray,
) -> FloatArray | None:
    """Hangs a door, or none; (2, 2) hinge and edge of an open leaf, None where it is shut."""
    side, hinge, angle = _hung(passage, walked, rng)
    start, across, into_room = _hinge(passage, side, hinge)
    if angle is None:
        return np.array([start, start])
    along = np.cos(angle) * across + np.sin(angle) * into_room
    inward = np.cos(angle) * into_room - np.sin(angle) * across
    origin = start + 0.01 * into_room * (angle > 0) - _LEAF_THICK_M * inward
    width = passage.width - 0.01
    mesh.box(
        origin,
        along,
        inward,
        (0.005, 0, 0.008),
        (width, _LEAF_THICK_M, height - 0.005),
        look,
        front=look,
    )
    knob = Material(Pattern.PLAIN, (0.35, 0.3, 0.22), gloss=0.3)
    mesh.box(
        origin,
        along,
        inward,
        (width - 0.12, -0.05, 0.97),
        (width - 0.05, _LEAF_THICK_M + 0.05, 1.03),
        knob,
    )
    return None if angle == 0.0 else np.array([start, start + passage.width * along])


def _hung(
    passage: Passage, walked: FloatArray, rng: np.random.Generator
) -> tuple[int, int, float | None]:
    """Side and hinge of a leaf and how far it is open, rad: 0 shut, None where there is none."""
    side, hinge = int(rng.integers(2)), int(rng.integers(2))
    kind = rng.random()
    if kind < 0.15:
        return side, hinge, None
    if len(walked):
        return _out_of_the_way(passage, walked, rng)
    if kind < 0.35:
        return side, hinge, 0.0
    return side, hinge, float(np.deg2rad(rng.uniform(*((70, 110) if kind < 0.85 else (15, 70)))))


def _hinge(passage: Passage, side: int, hinge: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A jamb of a passage, and the unit directions to the other one and into the room."""
    start, other = passage.faces[side, hinge], passage.faces[side, 1 - hinge]
    into_room = -passage.outward if side == 0 else passage.outward
    return start, (other - start) / passage.width, into_room


def _out_of_the_way(
    passage: Passage, walked: FloatArray, rng: np.random.Generator
) -> tuple[int, int, float | None]:
    """The way to hang an open leaf that is the farthest from a walk; none where all are near."""
    best: tuple[int, int, float | None] = (0, 0, None)
    farthest = _CLEAR_OF_A_LEAF_M
    for side, hinge in ((0, 0), (0, 1), (1, 0), (1, 1)):
        angle = float(np.deg2rad(rng.uniform(80, 110)))
        start, across, into_room = _hinge(passage, side, hinge)
        edge = start + passage.width * (np.cos(angle) * across + np.sin(angle) * into_room)
        away = shapely.MultiPoint(walked).distance(shapely.LineString([start, edge]))
        if away > farthest:
            best, farthest = (side, hinge, angle), away
    return best


def _window(
    segment: FloatArray,
    polygon: FloatArray,
    low: float,
    high: float,
    look: Look,
    bars: int,
    mesh: MeshBuilder,
    rng: np.random.Generator,
) -> Pane:
    """A window with its reveal, bars, frame and the world behind it."""
    start, end = _along_wall(segment, polygon)
    width = float(np.hypot(*(end - start)))
    along = (end - start) / width
    inward = np.array([-along[1], along[0]])
    deep = float(rng.uniform(0.06, 0.22))
    a3, in3 = (np.array([v[0], 0.0, v[1]]) for v in (along, inward))
    corner = np.array([start[0], -low, start[1]]) - deep * in3
    across, tall = (high - low) * UP, high - low
    white = replace(look.trim, detail=0.0)
    mesh.quad(corner, width * a3, across, in3, look.outside)
    mesh.quad(corner, deep * in3, across, a3, white)
    mesh.quad(corner + width * a3, deep * in3, across, -a3, white)
    mesh.quad(corner, width * a3, deep * in3, UP, white)
    mesh.quad(corner + across, width * a3, deep * in3, -UP, white)
    back = start - deep * inward
    bar = 0.045
    uprights = [0.0, width - bar] + [width * (k + 1) / (bars + 1) - bar / 2 for k in range(bars)]
    for x in uprights:
        mesh.box(back, along, inward, (x, 0.005, low), (x + bar, 0.045, high), white)
    for z in (low, high - bar) + ((low + tall / 2,) if bars == 1 else ()):
        mesh.box(back, along, inward, (0, 0.005, z), (width, 0.045, z + bar), white)
    if rng.random() < 0.5:
        blind = Material(
            Pattern.SLATS, (0.75, 0.75, 0.72), (0.3, 0.3, 0.3), a=0.025, contrast=0.5, emission=0.25
        )
        drop = float(rng.uniform(0.05, 0.9)) * tall * (rng.random() < 0.5)
        if drop > 0.05:
            mesh.box(back, along, inward, (0, 0.05, high - drop), (width, 0.06, high), blind)
    if rng.random() < 0.7:
        wide, thick = float(rng.uniform(0.05, 0.1)), 0.02
        for x0, x1, z0, z1 in (
            (-wide, 0.0, low, high),
            (width, width + wide, low, high),
            (-wide, width + wide, high, high + wide),
            (-wide, width + wide, max(low - wide, 0.0), low),
        ):
            mesh.box(start, along, inward, (x0, 0, z0), (x1, thick, z1), white)
    return Pane(corner + 0.05 * in3, width * a3, across, in3)


def _along_wall(segment: FloatArray, polygon: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The ends of a segment on a counter-clockwise room's wall, the room on its left."""
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        along = (end - start) / np.hypot(*(end - start))
        normal = np.array([-along[1], along[0]])
        if np.abs((segment - start) @ normal).max() < 1e-6:
            forward = (segment[1] - segment[0]) @ along > 0
            return (segment[0], segment[1]) if forward else (segment[1], segment[0])
    return segment[0], segment[1]
