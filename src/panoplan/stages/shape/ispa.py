"""Iterative shortest path: a room's mask and walls become its corners (Section III-F)."""

from __future__ import annotations

from collections.abc import Sequence

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
from panoplan.types.arrays import FloatArray
from panoplan.types.room import Orientation, RoomShape, WallPiece


def room_shape(
    density: FloatArray,
    first_cell: tuple[int, int],
    lattice_cell: float,
    threshold: float,
    walls: Sequence[WallPiece],
    orientations: Sequence[Orientation],
    config: ShapeConfig,
) -> RoomShape:
    """The outline of a room.

    Args:
        density: (n, m) room density on the lattice of room identification.
        first_cell: lattice index of its first cell.
        lattice_cell: lattice cell in camera heights.
        threshold: density from which a cell is room.
        walls: the room's accepted wall pieces.
        orientations: its likely wall directions, best supported first; may be empty.
        config: settings.

    Returns:
        A simple counter-clockwise polygon in the walk frame, or a failure with its reason.

    Source: Section III-F.
    """
    cells = np.argwhere(density >= threshold)
    if len(cells) * lattice_cell**2 < config.min_area_ch2:
        return RoomShape(None, "the room's mask is smaller than the smallest room")
    centres = (cells + np.asarray(first_cell) + 0.5) * lattice_cell
    direction = orientations[0].direction if orientations else 0.0
    rounds: list[FloatArray] = []
    core_ch: FloatArray | None = None
    for number, count in enumerate(config.grids):
        grid = lay_grid(centres, lattice_cell, direction, count, config)
        mask = mask_on(grid, density, first_cell, lattice_cell, threshold)
        if not mask.any():
            return RoomShape(None, "the room's mask is empty on the grid", tuple(rounds))
        if core_ch is None:
            core_ch = grid.to_walk(core_of(mask)[None])
        core = grid.to_grid(core_ch)[0]
        if number == 0:
            candidates = band_candidates(mask, core, config.band_in_cells, config.band_out_cells)
        else:
            candidates = refined_candidates(grid.to_grid(rounds[-1]), core, config.refine_cells)
        corners = _shortest(
            grid, mask, candidates, walls, orientations, config, limited=number == 0
        )
        if corners is None:
            return RoomShape(None, f"no closed path in round {number + 1}", tuple(rounds))
        rounds.append(grid.to_walk(corners))
    outline = counter_clockwise(rounds[-1])
    if not Polygon(outline).is_valid:
        return RoomShape(None, "the path crosses itself", tuple(rounds))
    return RoomShape(outline, None, tuple(rounds))


def _shortest(
    grid: Grid,
    mask: np.ndarray,
    candidates: Candidates,
    walls: Sequence[WallPiece],
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
        1.0 - wall_density(grid, walls, config),
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
