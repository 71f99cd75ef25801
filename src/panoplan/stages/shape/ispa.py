"""Iterative shortest path: a room's mask and walls become its corners (Section III-F)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from shapely import Polygon

from panoplan.config import ShapeConfig
from panoplan.geometry.graph import EdgeLimits, EdgeWeights, build_graph, shortest_cycle
from panoplan.geometry.polygons import counter_clockwise
from panoplan.stages.shape.candidates import (
    Candidates,
    band_candidates,
    core_of,
    refined_candidates,
)
from panoplan.stages.shape.evidence import Grid, lay_grid, mask_on, wall_density
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.room import Orientation, RoomShape, WallPiece


@dataclass(frozen=True, eq=False)
class Round:
    """One round of iSPA.

    Attributes:
        grid: that it works on.
        mask: M_H, the room's cells.
        wall: M_P, how much wall there is in each cell, 0-1.
        candidates: where corners may be; None where the mask is empty.
        corners: (N, 2) of the shortest path in cells; None where there is no closed path.
    """

    grid: Grid
    mask: BoolArray
    wall: FloatArray
    candidates: Candidates | None
    corners: FloatArray | None


@dataclass(frozen=True, eq=False)
class RoomEvidence:
    """What a room's shape is found from.

    Attributes:
        density: (n, m) room density on the lattice of room identification.
        first_cell: lattice index of its first cell.
        cell: lattice cell in camera heights.
        threshold: density from which a cell is room.
        walls: the room's accepted wall pieces.
        orientations: its likely wall directions, best supported first; may be empty.
    """

    density: FloatArray
    first_cell: tuple[int, int]
    cell: float
    threshold: float
    walls: Sequence[WallPiece]
    orientations: Sequence[Orientation]


def room_shape(evidence: RoomEvidence, config: ShapeConfig) -> RoomShape:
    """The outline of a room.

    Args:
        evidence: of the room.
        config: settings.

    Returns:
        A simple counter-clockwise polygon in the walk frame, or a failure with its reason.

    Source: Section III-F.
    """
    outlines: list[FloatArray] = []
    for made in rounds(evidence, config):
        if made.candidates is None:
            return RoomShape(None, "the room's mask is empty on the grid", tuple(outlines))
        if made.corners is None:
            reason = f"no closed path in round {len(outlines) + 1}"
            return RoomShape(None, reason, tuple(outlines))
        outlines.append(made.grid.to_walk(made.corners))
    if not outlines:
        return RoomShape(None, "the room's mask is smaller than the smallest room")
    outline = counter_clockwise(outlines[-1])
    if not Polygon(outline).is_valid:
        return RoomShape(None, "the path crosses itself", tuple(outlines))
    return RoomShape(outline, None, tuple(outlines))


def rounds(evidence: RoomEvidence, config: ShapeConfig) -> Iterator[Round]:
    """The rounds of `room_shape`.

    Args:
        evidence: of the room.
        config: settings.

    Yields:
        Each round as it is done; a failed one is the last. None where the mask is too small.
    """
    density, first_cell, lattice_cell = evidence.density, evidence.first_cell, evidence.cell
    threshold, orientations = evidence.threshold, evidence.orientations
    cells = np.argwhere(density >= threshold)
    if len(cells) * lattice_cell**2 < config.min_area_ch2:
        return
    centres = (cells + np.asarray(first_cell) + 0.5) * lattice_cell
    direction = orientations[0].direction if orientations else 0.0
    core_ch: FloatArray | None = None
    earlier: FloatArray | None = None
    for count in config.grids:
        grid = lay_grid(centres, lattice_cell, direction, count, config)
        mask = mask_on(grid, density, first_cell, lattice_cell, threshold)
        wall = wall_density(grid, evidence.walls, config)
        if not mask.any():
            yield Round(grid, mask, wall, None, None)
            return
        if core_ch is None:
            core_ch = grid.to_walk(core_of(mask)[None])
        core = grid.to_grid(core_ch)[0]
        if earlier is None:
            candidates = band_candidates(mask, core, config.band_in_cells, config.band_out_cells)
        else:
            candidates = refined_candidates(grid.to_grid(earlier), core, config.refine_cells)
        corners = _shortest(
            grid, mask, wall, candidates, orientations, config, limited=earlier is None
        )
        yield Round(grid, mask, wall, candidates, corners)
        if corners is None:
            return
        earlier = grid.to_walk(corners)


def _shortest(
    grid: Grid,
    mask: BoolArray,
    wall: FloatArray,
    candidates: Candidates,
    orientations: Sequence[Orientation],
    config: ShapeConfig,
    *,
    limited: bool,
) -> FloatArray | None:
    limit = limited and config.limit_edges
    depth = ndimage.distance_transform_edt(mask) * grid.cell
    depth -= 0.5 * grid.cell
    inside = (depth > config.mask_margin_ch).astype(float)
    inside[depth > config.core_depth_ch] += config.core_factor
    turned = np.array([o.direction for o in orientations]) - np.arctan2(
        grid.axes[0, 1], grid.axes[0, 0]
    )
    per_cell = grid.cell if config.cost_unit == "camera_height" else 1.0
    graph = build_graph(
        candidates.nodes,
        candidates.order,
        candidates.lap,
        candidates.turn,
        1.0 - wall,
        inside,
        turned,
        EdgeWeights(
            orientation=config.weight_orientation,
            plane=config.weight_plane * per_cell,
            mask=config.weight_mask * per_cell,
            complexity=config.weight_complexity,
        ),
        EdgeLimits(
            advance=2.0 * config.max_edge_cells if limit else candidates.lap,
            length=config.max_edge_cells if limit else np.inf,
            manhattan=config.edge_length == "manhattan",
            angle=float(np.deg2rad(config.max_edge_angle_deg)),
        ),
    )
    cycle = shortest_cycle(graph)
    return None if cycle is None else candidates.nodes[cycle[0]]
