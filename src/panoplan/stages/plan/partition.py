"""One planar partition: rooms that do not overlap, and walls that neighbours share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from panoplan.config import PartitionConfig
from panoplan.geometry.hits import edge_directions
from panoplan.geometry.polygons import signed_area
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.room import RoomShape


@dataclass(frozen=True, eq=False)
class Facing:
    """Two walls of two rooms that are the faces of one.

    Attributes:
        rooms: their indices, the smaller first.
        walls: index of the wall of each, by the corner that it begins at.
        along: (2, 2) first and last point of what faces, on the middle line, the first room on
            its left.
        thickness: camera heights.
        measured: whether the thickness was; else it is that of the other walls.
        solid: whether it stops the views; else the rooms only end here, as at an opening.
    """

    rooms: tuple[int, int]
    walls: tuple[int, int]
    along: FloatArray
    thickness: float
    measured: bool
    solid: bool


def partition(
    shapes: Sequence[RoomShape], config: PartitionConfig
) -> tuple[tuple[RoomShape, ...], tuple[Facing, ...]]:
    """Makes rooms' outlines one plan.

    Walls that face each other more closely than a wall is thick move apart, each by its share of
    the variance, to the thickness of the other walls; where no wall stops the views, the rooms
    meet on one line. What then still overlaps goes to the room whose walls there are surer.

    Args:
        shapes: of the rooms of one level; those without polygon stay as they are.
        config: settings.

    Returns:
        The rooms, disjoint, in the same order, and the walls that they share.

    Source: docs/deviations.md, "Past the paper".
    """
    edges = _edges(shapes)
    pairs = _facing(edges, config)
    typical, thin, met = _judged(pairs, edges, config)
    shifts = _shifts(edges, pairs, typical, thin, met, config)
    moved = [_moved(shape, shifts[edges.room == index]) for index, shape in enumerate(shapes)]
    apart = _apart(moved, config)
    assumed = _middles(pairs, edges)[thin]
    edges = _edges(apart)
    pairs = _facing(edges, config)
    return tuple(apart), _shared(pairs, edges, assumed, config)


def facing_walls(rings: Sequence[FloatArray], config: PartitionConfig) -> tuple[IntArray, IntArray]:
    """Walls of different rooms that may be the faces of one.

    Args:
        rings: (N, 2) outlines.
        config: settings.

    Returns:
        Indices of the first and of the second wall of each pair, all walls counted through, ring
        by ring.
    """
    pairs = _facing(_edges([RoomShape(ring, None) for ring in rings]), config)
    return pairs.one, pairs.other


@dataclass(frozen=True, eq=False)
class _Edges:
    """All walls of all rooms, array by array."""

    room: IntArray
    wall: IntArray
    start: FloatArray
    along: FloatArray
    length: FloatArray
    sigma: FloatArray

    @property
    def outward(self) -> FloatArray:
        return np.stack([self.along[:, 1], -self.along[:, 0]], axis=-1)


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Walls that face each other: indices, gap between them, and what part of the first faces."""

    one: IntArray
    other: IntArray
    gap: FloatArray
    low: FloatArray
    high: FloatArray


def _edges(shapes: Sequence[RoomShape]) -> _Edges:
    rooms: list[int] = []
    walls: list[int] = []
    starts: list[FloatArray] = []
    sides: list[tuple[FloatArray, FloatArray]] = []
    sigmas: list[FloatArray] = []
    for index, shape in enumerate(shapes):
        if shape.polygon is None:
            continue
        count = len(shape.polygon)
        rooms += [index] * count
        walls += range(count)
        starts.append(shape.polygon)
        sides.append(edge_directions(shape.polygon))
        sigmas.append(np.full(count, np.nan) if shape.sigmas is None else shape.sigmas)
    if not starts:
        none = np.empty((0, 2))
        return _Edges(
            np.empty(0, np.int64), np.empty(0, np.int64), none, none, np.empty(0), np.empty(0)
        )
    along, length = (np.concatenate(part) for part in zip(*sides, strict=True))
    return _Edges(
        np.array(rooms),
        np.array(walls),
        np.concatenate(starts),
        along,
        length,
        np.concatenate(sigmas),
    )


def _facing(edges: _Edges, config: PartitionConfig) -> _Pairs:
    opposite = edges.along @ edges.along.T < -np.cos(np.deg2rad(config.parallel_deg))
    one, other = np.nonzero(opposite & (edges.room[:, None] < edges.room[None]))
    # Where the other wall's ends lie along the first, and how far outward.
    far = edges.start[other] + edges.along[other] * edges.length[other, None] - edges.start[one]
    near = edges.start[other] - edges.start[one]
    along, outward = edges.along[one], edges.outward[one]
    at = np.stack([(far * along).sum(axis=1), (near * along).sum(axis=1)])
    off = np.stack([(far * outward).sum(axis=1), (near * outward).sum(axis=1)])
    low, high = np.maximum(at[0], 0.0), np.minimum(at[1], edges.length[one])
    share = ((low + high) / 2 - at[0]) / np.maximum(at[1] - at[0], 1e-12)
    gap = off[0] + share * (off[1] - off[0])
    chosen = np.flatnonzero(
        (high - low > config.min_facing_ch)
        & (gap > -config.max_overlap_ch)
        & (gap < config.max_thickness_ch)
    )
    return _Pairs(one[chosen], other[chosen], gap[chosen], low[chosen], high[chosen])


def _judged(
    pairs: _Pairs, edges: _Edges, config: PartitionConfig
) -> tuple[float, IntArray, IntArray]:
    """The typical thickness, the pairs that are too close, and those without a wall between."""
    unseen = np.isnan(edges.sigma[pairs.one]) & np.isnan(edges.sigma[pairs.other])
    met = unseen & (np.abs(pairs.gap) < config.min_thickness_ch)
    thick = pairs.gap[(pairs.gap >= config.min_thickness_ch) & ~unseen]
    typical = float(np.median(thick)) if len(thick) >= _FEWEST else config.thickness_ch
    thin = (pairs.gap < config.min_thickness_ch) & ~met
    return typical, np.flatnonzero(thin), np.flatnonzero(met)


_FEWEST = 3
"""A median of fewer walls tells less than what is usual in homes."""


def _shifts(
    edges: _Edges,
    pairs: _Pairs,
    typical: float,
    thin: IntArray,
    met: IntArray,
    config: PartitionConfig,
) -> FloatArray:
    """How far each wall moves outward: weighted least squares over all of them."""
    count = len(edges.room)
    sigma = np.where(np.isnan(edges.sigma), config.unfitted_sigma_ch, edges.sigma)
    involved = np.unique(
        np.concatenate([pairs.one[thin], pairs.other[thin], pairs.one[met], pairs.other[met]])
    )
    shifts = np.zeros(count)
    if len(involved) == 0:
        return shifts
    place = np.full(count, -1)
    place[involved] = np.arange(len(involved))
    normal = np.diag(1.0 / np.maximum(sigma[involved], _FINEST_CH) ** 2)
    right = np.zeros(len(involved))
    for chosen, target, spread in (
        (thin, typical, config.thickness_sigma_ch),
        (met, 0.0, _FINEST_CH),
    ):
        one, other = place[pairs.one[chosen]], place[pairs.other[chosen]]
        # gap − shift − shift of the other = target
        wanted = (pairs.gap[chosen] - target) / spread**2
        for a, b in ((one, one), (one, other), (other, one), (other, other)):
            np.add.at(normal, (a, b), 1.0 / spread**2)
        np.add.at(right, one, wanted)
        np.add.at(right, other, wanted)
    shifts[involved] = np.linalg.solve(normal, right)
    return shifts


_FINEST_CH = 0.004


def _moved(shape: RoomShape, shifts: FloatArray) -> RoomShape:
    """A room with its walls moved outward; as it was where they would no longer close."""
    if shape.polygon is None or not shifts.any():
        return shape
    ring = shape.polygon
    along, _ = edge_directions(ring)
    outward = np.stack([along[:, 1], -along[:, 0]], axis=-1)
    corners = np.empty_like(ring)
    for k in range(len(ring)):
        normals = np.stack([outward[k - 1], outward[k]])
        if abs(along[k - 1] @ outward[k]) > _MEETING_SINE:
            step = np.linalg.solve(normals, [shifts[k - 1], shifts[k]])
        else:
            step = (shifts[k - 1] * outward[k - 1] + shifts[k] * outward[k]) / 2
        corners[k] = ring[k] + step
    if signed_area(corners) <= 0 or not shapely.Polygon(corners, shape.holes).is_valid:
        return shape
    return replace(shape, polygon=corners)


_MEETING_SINE = 0.2


def _apart(shapes: Sequence[RoomShape], config: PartitionConfig) -> list[RoomShape]:
    """Takes what two rooms claim from the one whose walls there are less sure."""
    out = list(shapes)
    regions = [_floor(shape) for shape in shapes]
    tree = shapely.STRtree([region or shapely.Polygon() for region in regions])
    for one, region in enumerate(regions):
        if region is None:
            continue
        for other in sorted(int(k) for k in tree.query(region)):
            first, second = regions[one], regions[other]
            if other <= one or first is None or second is None:
                continue
            common = first.intersection(second)
            if common.area <= 0.0:
                continue
            loses, floors = other, (second, first)
            if _doubt(out[one], common) > _doubt(out[other], common):
                loses, floors = one, (first, second)
            out[loses] = _without(out[loses], *floors, config)
            regions[loses] = _floor(out[loses])
    return out


def _floor(shape: RoomShape) -> shapely.Geometry | None:
    """The area of a room, also of an outline that touches or crosses itself."""
    if shape.polygon is None:
        return None
    area = shapely.Polygon(shape.polygon, shape.holes)
    return area if area.is_valid else shapely.make_valid(area, method="structure")


def _doubt(shape: RoomShape, common: shapely.Geometry) -> float:
    """Mean sigma of a room's walls in a region.

    Infinite where none of them was fitted; 0 where none runs there, deep inside the room.
    """
    assert shape.polygon is not None
    sigmas = np.full(len(shape.polygon), np.nan) if shape.sigmas is None else shape.sigmas
    ends = np.roll(shape.polygon, -1, axis=0)
    around = common.buffer(_NEAR_CH)
    lines = shapely.linestrings(np.stack([shape.polygon, ends], axis=1))
    inside = shapely.length(shapely.intersection(lines, around))
    if not inside.any():
        return 0.0
    inside[np.isnan(sigmas)] = 0.0
    if not inside.any():
        return float("inf")
    return float(inside @ np.nan_to_num(sigmas) / inside.sum())


_NEAR_CH = 0.01


def _without(
    shape: RoomShape, floor: shapely.Geometry, other: shapely.Geometry, config: PartitionConfig
) -> RoomShape:
    """A room, whose floor is given, less another and the thinnest wall around it."""
    grown = other.buffer(config.min_thickness_ch, join_style="mitre")
    left = floor.difference(grown)
    pieces = [p for p in shapely.get_parts(left) if isinstance(p, shapely.Polygon)]
    piece = max(pieces, key=lambda p: float(p.area), default=shapely.Polygon())
    # Without spikes thinner than any wall.
    piece = piece.buffer(-_SPIKE_CH, join_style="mitre").buffer(_SPIKE_CH, join_style="mitre")
    piece = piece.intersection(left)
    parts = [p for p in shapely.get_parts(piece) if isinstance(p, shapely.Polygon)]
    piece = max(parts, key=lambda p: float(p.area), default=shapely.Polygon()).normalize()
    if piece.area < config.min_area_ch2:
        return RoomShape(None, "what it claims belongs to other rooms")
    piece = piece.simplify(_SAME_CH)
    ring = np.asarray(piece.exterior.coords)[:-1]
    ring = ring if signed_area(ring) > 0 else ring[::-1]
    holes = tuple(np.asarray(hole.coords)[:-1] for hole in piece.interiors)
    holes = tuple(h if signed_area(h) < 0 else h[::-1] for h in holes)
    return RoomShape(ring, None, shape.rounds, _sigmas_of(ring, shape), holes)


_SPIKE_CH = 0.01
_SAME_CH = 1e-6


def _sigmas_of(ring: FloatArray, shape: RoomShape) -> FloatArray:
    """Sigmas of the walls of a cut outline, from the walls of the whole one on the same lines."""
    assert shape.polygon is not None
    sigmas = np.full(len(ring), np.nan)
    if shape.sigmas is None:
        return sigmas
    ends = np.roll(shape.polygon, -1, axis=0)
    lines = shapely.linestrings(np.stack([shape.polygon, ends], axis=1))
    for k, (a, b) in enumerate(zip(ring, np.roll(ring, -1, axis=0), strict=True)):
        off = np.maximum(
            shapely.distance(lines, shapely.Point(a)), shapely.distance(lines, shapely.Point(b))
        )
        nearest = int(np.argmin(off))
        if off[nearest] < _NEAR_CH:
            sigmas[k] = shape.sigmas[nearest]
    return sigmas


def _middles(pairs: _Pairs, edges: _Edges) -> FloatArray:
    """(P, 2) the middle of what faces, between the two walls."""
    at = (pairs.low + pairs.high) / 2
    along, outward = edges.along[pairs.one], edges.outward[pairs.one]
    return np.asarray(
        edges.start[pairs.one] + at[:, None] * along + pairs.gap[:, None] / 2 * outward
    )


def _shared(
    pairs: _Pairs, edges: _Edges, assumed: FloatArray, config: PartitionConfig
) -> tuple[Facing, ...]:
    """The walls that rooms share; `assumed` are places where a thickness was not measured."""
    out = []
    for one, other, gap, low, high in zip(
        pairs.one, pairs.other, pairs.gap, pairs.low, pairs.high, strict=True
    ):
        if gap < -_SPIKE_CH:
            continue
        start = edges.start[one] + edges.outward[one] * max(gap, 0.0) / 2
        along = start + np.outer([low, high], edges.along[one])
        away = shapely.distance(shapely.LineString(along), shapely.points(assumed))
        guessed = bool((away < config.max_overlap_ch).any())
        seen = ~np.isnan(edges.sigma[[one, other]])
        solid = bool(seen.any() or gap >= config.min_thickness_ch)
        out.append(
            Facing(
                (int(edges.room[one]), int(edges.room[other])),
                (int(edges.wall[one]), int(edges.wall[other])),
                along,
                float(max(gap, 0.0)),
                bool(seen.all()) and not guessed,
                solid,
            )
        )
    return tuple(out)
