"""Doors, openings and windows: where layouts show them, where they leak, where the camera walks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from panoplan.config import AperturesConfig
from panoplan.geometry.hits import edge_directions, first_hits
from panoplan.geometry.sphere import column_heading
from panoplan.stages.plan.partition import Facing
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.plan import ApertureKind, ApertureSource
from panoplan.types.room import RoomShape, WallStretch
from panoplan.types.view import RegisteredLayout

Wall = tuple[int, int]
"""Index of a room, and of its wall by the corner that it begins at."""

_KINDS: tuple[ApertureKind, ...] = ("door", "opening", "window")


@dataclass(frozen=True, eq=False)
class WallAperture:
    """A door, opening or window.

    Attributes:
        kind: what it is.
        segment: (2, 2) from side to side, on the middle line of a shared wall, else on the wall;
            the first room on its left.
        walls: the wall of each room that it is in, one or two.
        sources: what speaks for it.
    """

    kind: ApertureKind
    segment: FloatArray
    walls: tuple[Wall, ...]
    sources: tuple[ApertureSource, ...]


def stretches(
    shape: RoomShape, views: Sequence[RegisteredLayout], config: AperturesConfig
) -> tuple[WallStretch, ...]:
    """Where a room's views show doors, openings and windows, or see through its walls.

    Args:
        shape: of the room.
        views: of the room; those whose camera stands elsewhere say nothing.
        config: settings.

    Returns:
        One for everything that at least one view shows, with the votes of all views.
    """
    if shape.polygon is None:
        return ()
    ring = shape.polygon
    gazes = [gaze for view in views if (gaze := _gaze(view, ring)) is not None]
    seen = [
        sighting
        for number, gaze in enumerate(gazes)
        for sighting in (*_told(gaze, ring, number, config), *_leaking(gaze, ring, number, config))
    ]
    order = sorted(seen, key=lambda s: (s.kind == "leak", -s.weight, s.gaze))
    clusters = _clustered([s.segment for s in order], [s.kind == "leak" for s in order], config)
    return tuple(_stretch([order[k] for k in cluster], gazes, ring, config) for cluster in clusters)


def apertures(
    shapes: Sequence[RoomShape],
    found: Sequence[Sequence[WallStretch]],
    path: Sequence[tuple[int, FloatArray]],
    shared: Sequence[Facing],
    config: AperturesConfig,
) -> tuple[WallAperture, ...]:
    """Finds doors, openings and windows.

    Args:
        shapes: of the rooms of one level.
        found: what each room's views show.
        path: index in the walk and (2,) place of each camera.
        shared: walls that rooms share.
        config: settings.

    Returns:
        What enough of the views that look at it show; doors also where the camera walks from room
        to room; openings also where rooms end without a wall between. No two overlap.

    Source: docs/deviations.md, "Past the paper".
    """
    clues = [
        _Clue(None, wall, stretch.segment, stretch)
        for room, own in enumerate(found)
        for stretch in own
        if (wall := _wall_at(shapes[room], room, stretch.segment)) is not None
    ]
    clues.sort(key=lambda clue: -clue.weight)
    clues += _borders(shared)
    clues += _walked(path, shared, config)
    clusters = _clustered(
        [clue.segment for clue in clues], [clue.source == "walked" for clue in clues], config
    )
    judged = [
        sure
        for cluster in clusters
        if (sure := _judged([clues[k] for k in cluster], shapes, shared, config)) is not None
    ]
    judged.sort(key=lambda item: -item[0])
    kept: list[WallAperture] = []
    for _, aperture in judged:
        if not any(_share(aperture.segment, other.segment, config) > 0 for other in kept):
            kept.append(aperture)
    return tuple(sorted(kept, key=lambda aperture: (aperture.walls, *aperture.segment[0])))


@dataclass(frozen=True, eq=False)
class _Gaze:
    """What each column of a view meets on the walls around its room.

    Attributes:
        view: the layout.
        rays: (W, 2) directions.
        wall: (W,) index of the wall.
        at: (W,) where along the wall.
        range: (W,) from the camera to the wall.
        facing: (W,) sine of the angle between ray and wall.
    """

    view: RegisteredLayout
    rays: FloatArray
    wall: IntArray
    at: FloatArray
    range: FloatArray
    facing: FloatArray


@dataclass(frozen=True, eq=False)
class _Sighting:
    """A stretch of wall where one view shows something.

    Attributes:
        kind: what, "leak" where its boundary goes on behind the wall.
        segment: (2, 2) along the wall.
        weight: inverse variance of its place, in arbitrary units.
        gaze: index of the view.
    """

    kind: ApertureKind | Literal["leak"]
    segment: FloatArray
    weight: float
    gaze: int


@dataclass(frozen=True, eq=False)
class _Clue:
    """A stretch of one room's wall that something speaks for; a point where it is walked."""

    source: ApertureSource | None
    wall: Wall
    segment: FloatArray
    stretch: WallStretch | None = None

    @property
    def weight(self) -> float:
        return 0.0 if self.stretch is None else sum(self.stretch.votes)


def _gaze(view: RegisteredLayout, ring: FloatArray) -> _Gaze | None:
    """None where the camera does not stand in the room."""
    offsets = view.boundary - view.camera
    width = len(offsets)
    told = np.arctan2(offsets[:, 0], offsets[:, 1])
    known = np.isfinite(told)
    if not known.any() or not shapely.contains_xy(shapely.Polygon(ring), *view.camera):
        return None
    # Unknown columns look where their neighbours' headings say.
    own = column_heading(np.arange(width, dtype=np.float64), width)
    turned = np.angle(np.exp(1j * (told[known] - own[known])).mean())
    heading = np.where(known, told, own + turned)
    rays = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
    hits = first_hits(view.camera, rays, ring)
    if not np.isfinite(hits.range).all():
        return None
    return _Gaze(view, rays, hits.edge, hits.at, hits.range, hits.sine)


_SLACK = 1e-9


def _on_wall(ring: FloatArray, wall: int, low: float, high: float) -> FloatArray:
    start, end = ring[wall], ring[(wall + 1) % len(ring)]
    return np.asarray(start + np.outer([low, high], (end - start) / np.hypot(*(end - start))))


def _sighting(
    gaze: _Gaze,
    ring: FloatArray,
    columns: IntArray,
    kind: ApertureKind | Literal["leak"],
    number: int,
) -> _Sighting:
    at = gaze.at[columns]
    error = gaze.range[columns] / gaze.facing[columns]
    segment = _on_wall(ring, int(gaze.wall[columns[0]]), float(at.min()), float(at.max()))
    return _Sighting(kind, segment, float(1.0 / np.median(error) ** 2), number)


def _told(
    gaze: _Gaze, ring: FloatArray, number: int, config: AperturesConfig
) -> Iterable[_Sighting]:
    """What the layout's source sees in the walls."""
    spans = gaze.view.spans
    if spans is None:
        return
    for kind, told in zip(_KINDS, (spans.doors, spans.openings, spans.windows), strict=True):
        for columns in _columns(told, len(gaze.wall)):
            walls = gaze.wall[columns]
            pieces = [columns[walls == wall] for wall in np.unique(walls)]
            extents = np.array([np.ptp(gaze.at[piece]) for piece in pieces])
            for piece, extent in zip(pieces, extents, strict=True):
                # Around a corner only the larger part counts.
                if extent < max(config.min_width_ch, config.min_part * extents.sum()):
                    continue
                if np.median(gaze.range[piece]) < config.nearest_ch:
                    continue
                yield _sighting(gaze, ring, piece, kind, number)


def _columns(spans: FloatArray, width: int) -> Iterable[IntArray]:
    """Columns of each span; two that meet at the image's edge are one."""
    parts = [(float(a), float(b if b > a else b + width)) for a, b in spans]
    first = next((s for s in parts if s[0] <= _SEAM_COLUMNS), None)
    last = next((s for s in parts if abs(s[1] - width) <= _SEAM_COLUMNS), None)
    if first is not None and last is not None and first is not last:
        parts = [s for s in parts if s is not first and s is not last]
        parts.append((last[0], first[1] + width))
    for low, high in parts:
        columns = np.arange(int(np.ceil(low)), int(np.floor(high)) + 1) % width
        if len(columns):
            yield columns


_SEAM_COLUMNS = 2.0


def _leaking(
    gaze: _Gaze, ring: FloatArray, number: int, config: AperturesConfig
) -> Iterable[_Sighting]:
    """Where the boundary goes on behind a wall that the views together found."""
    told = np.hypot(*(gaze.view.boundary - gaze.view.camera).T)
    with np.errstate(invalid="ignore"):
        beyond = told > gaze.range + np.maximum(config.leak_ch, config.leak_share * gaze.range)
    beyond &= (config.nearest_ch < gaze.range) & (gaze.range < config.farthest_ch)
    for wall in np.unique(gaze.wall[beyond]):
        columns = np.flatnonzero(beyond & (gaze.wall == wall))
        order = columns[np.argsort(gaze.at[columns])]
        gaps = np.flatnonzero(np.diff(gaze.at[order]) > config.min_width_ch)
        for run in np.split(order, gaps + 1):
            if np.ptp(gaze.at[run]) >= config.min_width_ch:
                yield _sighting(gaze, ring, run, "leak", number)


def _stretch(
    cluster: Sequence[_Sighting],
    gazes: Sequence[_Gaze],
    ring: FloatArray,
    config: AperturesConfig,
) -> WallStretch:
    told = [s for s in cluster if s.kind != "leak"]
    segment = _placed([s.segment for s in told or cluster], [s.weight for s in told or cluster])
    looking = _looking(gazes, ring, segment.mean(axis=0), config)
    telling = {s.gaze for s in told}
    leaking = {s.gaze for s in cluster if s.kind == "leak"}
    return WallStretch(
        segment,
        _votes(told),
        len(telling),
        len(telling | {k for k in looking if gazes[k].view.spans is not None}),
        len(leaking),
        len(looking | leaking),
    )


def _votes(told: Sequence[_Sighting]) -> tuple[float, float, float]:
    door, opening, window = (sum(s.weight for s in told if s.kind == kind) for kind in _KINDS)
    return float(door), float(opening), float(window)


def _placed(segments: Sequence[FloatArray], weights: Sequence[float]) -> FloatArray:
    """The weighted median of stretches, on the line of the first of them."""
    start, end = segments[0]
    along = (end - start) / np.maximum(np.hypot(*(end - start)), 1e-12)
    ends = np.array([np.sort((segment - start) @ along) for segment in segments])
    weight = np.array(weights)
    low, high = (_weighted_median(ends[:, k], weight) for k in (0, 1))
    return np.asarray(start + np.outer([low, high], along))


def _weighted_median(values: FloatArray, weights: FloatArray) -> float:
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weights[order])
    centre = total - weights[order] / 2
    return float(np.interp(total[-1] / 2, centre, values[order]))


def _looking(
    gazes: Sequence[_Gaze], ring: FloatArray, point: FloatArray, config: AperturesConfig
) -> set[int]:
    """The views that would show something at a point of a wall."""
    wall = _nearest_wall(ring, point)
    out = set()
    for number, gaze in enumerate(gazes):
        offset = point - gaze.view.camera
        away = float(np.hypot(*offset))
        if not config.nearest_ch < away < config.farthest_ch:
            continue
        towards = gaze.rays @ offset / away
        column = int(np.argmax(towards))
        if gaze.wall[column] == wall and gaze.facing[column] > _GRAZING:
            out.add(number)
    return out


_GRAZING = np.sin(np.deg2rad(15.0))


def _nearest_wall(ring: FloatArray, point: FloatArray) -> int:
    along, length = edge_directions(ring)
    at = np.clip(((point - ring) * along).sum(axis=1), 0.0, length)
    off = np.hypot(*(point - ring - at[:, None] * along).T)
    return int(np.argmin(off))


def _wall_at(shape: RoomShape, room: int, segment: FloatArray) -> Wall | None:
    """The wall that a stretch of a room's outline lies on."""
    if shape.polygon is None:
        return None
    return room, _nearest_wall(shape.polygon, segment.mean(axis=0))


def _borders(shared: Sequence[Facing]) -> list[_Clue]:
    """Where rooms end without a wall between."""
    return [
        _Clue("border", (face.rooms[0], face.walls[0]), face.along)
        for face in shared
        if not face.solid
    ]


def _walked(
    path: Sequence[tuple[int, FloatArray]], shared: Sequence[Facing], config: AperturesConfig
) -> list[_Clue]:
    """Where the camera goes from room to room through a wall that they share."""
    if len(path) < 2 or not shared:
        return []
    order = sorted(range(len(path)), key=lambda k: path[k][0])
    index = np.array([path[k][0] for k in order])
    place = np.array([path[k][1] for k in order])
    step = np.diff(place, axis=0)
    near = (np.diff(index) <= _NEXT) & (np.hypot(*step.T) < config.longest_step_ch)
    if not near.any():
        return []
    steps = shapely.linestrings(np.stack([place[:-1], place[1:]], axis=1)[near])
    tree = shapely.STRtree(steps)
    faces = shapely.linestrings(np.array([face.along for face in shared]))
    out = []
    for k, j in sorted(zip(*tree.query(faces, predicate="intersects"), strict=True)):
        point = faces[k].intersection(steps[j])
        if isinstance(point, shapely.Point):
            at = np.array([[point.x, point.y]] * 2)
            out.append(_Clue("walked", (shared[k].rooms[0], shared[k].walls[0]), at))
    return out


_NEXT = 2
"""Keyframes that follow one another; one between may have no layout."""


def _share(one: FloatArray, other: FloatArray, config: AperturesConfig) -> float:
    """How much of the shorter of two stretches of wall the other covers; 0 on other walls."""
    length = float(np.hypot(*(one[1] - one[0]))), float(np.hypot(*(other[1] - other[0])))
    longer, shorter = (one, other) if length[0] >= length[1] else (other, one)
    least, most = sorted(length)
    if most < _SLACK:
        return float(np.hypot(*(one[0] - other[0])) < config.min_width_ch)
    along = (longer[1] - longer[0]) / most
    off = (shorter[0] + shorter[1]) / 2 - longer[0]
    if abs(off[0] * along[1] - off[1] * along[0]) > config.same_wall_ch:
        return 0.0
    if least <= _SLACK:
        margin = config.min_width_ch
        return float(-margin <= off @ along <= most + margin)
    if abs((shorter[1] - shorter[0]) @ along) < _PARALLEL * least:
        return 0.0
    low, high = sorted(float(at) for at in (shorter - longer[0]) @ along)
    return max(0.0, min(high, most) - max(low, 0.0)) / (high - low)


_PARALLEL = 0.9


def _clustered(
    segments: Sequence[FloatArray], partial: Sequence[bool], config: AperturesConfig
) -> list[list[int]]:
    """Indices of stretches of wall that are the same thing; the first of each is its best.

    Of two stretches of very different length the longer is no sight of the shorter, unless the
    shorter is known to be `partial`.
    """
    if not segments:
        return []
    ends = np.array(segments)
    middle, length = ends.mean(axis=1), np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    reach = max(config.same_wall_ch, config.min_width_ch)
    clusters: dict[int, list[int]] = {}
    for index, segment in enumerate(segments):
        firsts = np.fromiter(clusters, dtype=np.int64, count=len(clusters))
        away = np.hypot(*(middle[firsts] - middle[index]).T)
        best, into = config.same_share, index
        for first in firsts[away <= (length[firsts] + length[index]) / 2 + reach].tolist():
            share = _share(segments[first], segment, config)
            if share > 0 and not partial[index]:
                least, most = sorted((length[index], length[first]))
                share *= least / max(most, _SLACK)
            if share > best:
                best, into = share, first
        clusters.setdefault(into, []).append(index)
    return list(clusters.values())


def _judged(
    cluster: Sequence[_Clue],
    shapes: Sequence[RoomShape],
    shared: Sequence[Facing],
    config: AperturesConfig,
) -> tuple[float, WallAperture] | None:
    """How sure a cluster is, and what it is of; None where too little speaks for it."""
    stretches = [clue.stretch for clue in cluster if clue.stretch is not None]
    told = [s for s in stretches if s.telling] or stretches
    first = cluster[0]
    ring = shapes[first.wall[0]].polygon
    assert ring is not None
    sources: set[ApertureSource] = {clue.source for clue in cluster if clue.source is not None}
    if any(s.telling for s in stretches):
        sources.add("seen")
    if any(s.leaking for s in stretches):
        sources.add("leak")
    if told:
        weights = [sum(s.votes) or float(s.leaking) for s in told]
        segment = _placed([s.segment for s in told], weights)
    else:
        wide = [c.segment for c in cluster if c.source == "border"]
        segment = _placed(wide or [c.segment for c in cluster], [1.0] * len(wide or cluster))
    width = float(np.hypot(*(segment[1] - segment[0])))
    if width < config.min_width_ch:
        half = config.door_width_ch / 2
        along = _on_wall(ring, first.wall[1], -half, half) - ring[first.wall[1]]
        segment, width = segment.mean(axis=0) + along, 2 * half
        sources.add("assumed width")
    face = _behind(first.wall, segment.mean(axis=0), shared)
    kind = _kind(stretches, sources, width, config)
    if (kind == "window" and face is not None and face.solid) or (
        kind == "opening" and face is None
    ):
        return None
    support = _support(stretches)
    least = config.min_support_opening if kind == "opening" else config.min_support
    proved = len(sources & {"walked", "border"})
    if support < least and not proved:
        return None
    walls: tuple[Wall, ...] = (first.wall,)
    if face is not None:
        one, other = zip(face.rooms, face.walls, strict=True)
        walls = (one, other)
        along = (segment[1] - segment[0]) / width
        outward = np.array([along[1], -along[0]])
        segment = segment + ((face.along[0] - segment[0]) @ outward) * outward
        if one != first.wall:
            segment = segment[::-1]
    sure = support + proved + 1e-3 * sum(s.telling for s in stretches)
    return sure, WallAperture(kind, segment, walls, tuple(sorted(sources)))


def _support(found: Sequence[WallStretch]) -> float:
    """Share of the views that look at something and show it."""
    telling, able = sum(s.telling for s in found), sum(s.able for s in found)
    if able:
        return telling / able
    # Where layouts tell no doors, a leak may be one; a single leak may as well be an error.
    leaking, looking = sum(s.leaking for s in found), sum(s.looking for s in found)
    return leaking / looking if leaking > 1 else 0.0


def _kind(
    found: Sequence[WallStretch],
    sources: set[ApertureSource],
    width: float,
    config: AperturesConfig,
) -> ApertureKind:
    """What most of the weight says; where nobody says, a wide one is an opening."""
    votes = np.sum([s.votes for s in found], axis=0) if found else np.zeros(len(_KINDS))
    if "border" in sources and votes[0] == 0.0:
        return "opening"
    if votes.any():
        return _KINDS[int(np.argmax(votes))]
    return "opening" if width > config.widest_door_ch else "door"


def _behind(wall: Wall, point: FloatArray, shared: Sequence[Facing]) -> Facing | None:
    """The wall of another room at a point of a wall."""
    best, found = np.inf, None
    for face in shared:
        if wall not in zip(face.rooms, face.walls, strict=True):
            continue
        along = face.along[1] - face.along[0]
        length = float(np.hypot(*along))
        at = float((point - face.along[0]) @ along) / length
        off = max(-at, at - length, 0.0)
        if off < best:
            best, found = off, face
    return found if best < _BESIDE_CH else None


_BESIDE_CH = 0.1
