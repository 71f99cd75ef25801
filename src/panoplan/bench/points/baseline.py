"""A plan from a scan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from shapely import Polygon

from panoplan import __version__
from panoplan.bench.points.maps import Maps, maps
from panoplan.bench.points.segmentation import segmented
from panoplan.geometry.graph import EdgeLimits, EdgeWeights, build_graph, shortest_cycle
from panoplan.geometry.polygons import counter_clockwise
from panoplan.stages.shape.candidates import band_candidates, core_of
from panoplan.stages.shape.evidence import largest_part
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.plan import FloorPlan, PlanPose, Room, ScaleEstimate, Wall


@dataclass(frozen=True)
class PointsConfig:
    """Settings of the baseline, tuned on ten scenes that no figure is reported of.

    Attributes:
        cell_m: of the maps.
        wall_share: share of the height from which a cell is wall.
        neck: of the smaller basin's radius, from which a pass joins two.
        min_area_m2: smaller rooms are none.
        shape_cells: cells along the longer side of a room where its shape is found, at most.
        band_in: corner candidates lie so many cells inside the room's mask at most,
        band_out: and outside.
        wall_beside: how much wall there is in the cell beside one.
        weight_orientation: cost of an edge that is off the scene's directions, a radian.
        weight_plane: cost of a cell that is no wall.
        weight_mask: cost of a cell inside the mask.
        weight_complexity: cost of a corner.
    """

    cell_m: float = 0.05
    wall_share: float = 0.4
    neck: float = 0.8
    min_area_m2: float = 1.0
    shape_cells: int = 96
    band_in: float = 1.0
    band_out: float = 3.0
    wall_beside: float = 0.5
    weight_orientation: float = 20.0
    weight_plane: float = 1.0
    weight_mask: float = 2.0
    weight_complexity: float = 4.0


def plan_from_points(
    points_m: FloatArray, cameras: Sequence[PlanPose], config: PointsConfig
) -> FloorPlan:
    """The baseline's plan.

    Args:
        points_m: (N, 3) scan, x right, y down, z forward.
        cameras: where it was taken from, as the plan is to tell them.
        config: settings.

    Returns:
        The plan in metres, in the frame of the scan. A room whose mask no path goes round has no
        polygon and says so.

    Raises:
        InputError: as `maps`.
    """
    found = maps(points_m, config.cell_m)
    directions = wall_directions(found)
    rooms: list[Room] = []
    masks = segmented(found, config.wall_share, config.neck, config.min_area_m2)
    for number, mask in enumerate(masks, start=1):
        ring = outline(found, mask, directions, config)
        failure = "no closed path around it" if ring is None else None
        walls = () if ring is None else _walls(ring, sum(len(room.walls) for room in rooms))
        rooms.append(Room(f"room_{number:02d}", f"Room {number}", ring, failure, (), walls))
    return FloorPlan(
        unit="m",
        level_rotation=np.eye(3),
        scale=ScaleEstimate(None, "given"),
        camera_height_m=None,
        rooms=tuple(rooms),
        trajectory=tuple(cameras),
        version=__version__,
    )


def wall_directions(found: Maps) -> FloatArray:
    """(2,) the two directions square to one another that most walls have, in rad.

    Args:
        found: maps of the scene.
    """
    cells = np.argwhere(found.walls > 0)
    weights = found.walls[found.walls > 0]
    angles = np.deg2rad(np.arange(0.0, 90.0, _ANGLE_STEP_DEG))
    main = max(angles, key=lambda angle: _sharpness(cells, weights, angle))
    return np.array([main, main + np.pi / 2])


_ANGLE_STEP_DEG = 0.25


def _sharpness(cells: IntArray, weights: FloatArray, angle: float) -> float:
    """How much of the walls lies on few lines of a direction or square to it."""
    c, s = np.cos(angle), np.sin(angle)
    total = 0.0
    for axis in ((c, s), (-s, c)):
        along = cells @ np.array(axis)
        places = np.floor(along - along.min()).astype(np.int64)
        total += float(np.sum(np.bincount(places, weights) ** 2))
    return total


def outline(
    found: Maps, mask: BoolArray, directions: FloatArray, config: PointsConfig
) -> FloatArray | None:
    """(N, 2) a room's outline in metres, counter-clockwise; None where no path goes round it.

    Args:
        found: maps of the scene.
        mask: (n, m) the room's cells.
        directions: likely directions of walls, rad.
        config: settings.

    Source: Chen et al., Floor-SP, ICCV 2019, and Eq. 8-11 of the paper, one round.
    """
    inside, walls, first, step = _around(found, mask, config)
    if not inside.any():
        return None
    core = core_of(inside)
    near = band_candidates(inside, core, config.band_in, config.band_out)
    graph = build_graph(
        near.nodes,
        near.order,
        near.lap,
        near.turn,
        1.0 - walls,
        inside.astype(np.float64),
        directions,
        EdgeWeights(
            config.weight_orientation,
            config.weight_plane,
            config.weight_mask,
            config.weight_complexity,
        ),
        EdgeLimits(advance=near.lap),
    )
    cycle = shortest_cycle(graph)
    if cycle is None:
        return None
    ring = found.metres(first + step * near.nodes[cycle[0]])
    return counter_clockwise(ring) if Polygon(ring).is_valid else None


def _around(
    found: Maps, mask: BoolArray, config: PointsConfig
) -> tuple[BoolArray, FloatArray, FloatArray, int]:
    """Mask and walls around a room on its own grid; its first cell and step in the scene's."""
    rim = int(config.band_out) + 3
    where = np.argwhere(mask)
    low, high = where.min(axis=0), where.max(axis=0) + 1
    step = max(1, int(np.ceil((high - low).max() / (config.shape_cells - 2 * rim))))
    first = low - rim * step
    count = np.ceil((high - low) / step).astype(int) + 2 * rim
    padded = [np.pad(values, rim * step) for values in (mask.astype(float), found.walls)]
    box = tuple(slice(a, a + n * step) for a, n in zip(low, count, strict=True))
    blocks = []
    for values in padded:
        part = np.zeros(count * step)
        cut = values[box]
        part[: cut.shape[0], : cut.shape[1]] = cut
        blocks.append(part.reshape(count[0], step, count[1], step))
    inside = largest_part(blocks[0].mean(axis=(1, 3)) >= 0.5)
    there = np.minimum(blocks[1].max(axis=(1, 3)) / config.wall_share, 1.0)
    # One cell off a wall is not as bad as no wall at all.
    walls = np.maximum(there, ndimage.grey_dilation(there, size=(3, 3)) * config.wall_beside)
    return inside, walls, first.astype(np.float64), step


def _walls(ring: FloatArray, before: int) -> tuple[Wall, ...]:
    ends = np.roll(ring, -1, axis=0)
    return tuple(Wall(f"wall_{before + k + 1:02d}", ring[k], ends[k]) for k in range(len(ring)))
