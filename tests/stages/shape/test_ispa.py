from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely import Polygon
from tests.scenes import L_SHAPE, RECTANGLE, T_SHAPE

from panoplan.config import ShapeConfig
from panoplan.geometry.polygons import signed_area
from panoplan.stages.shape.ispa import RoomEvidence, room_shape
from panoplan.types.room import Orientation, WallPiece

CONFIG = ShapeConfig()
CELL = 0.05
BAY = np.array([[-2, -1.5], [2, -1.5], [2, 1.5], [0.9, 1.5], [0.4, 2.1], [-0.9, 2.1], [-2, 1.5]])
SHAPES = {"rectangle": RECTANGLE, "L": L_SHAPE, "T": T_SHAPE, "bay": BAY}


def _density(polygon):
    low, high = polygon.min(axis=0) - 0.5, polygon.max(axis=0) + 0.5
    first = np.floor(low / CELL).astype(int)
    i, j = (np.arange(n) for n in np.ceil((high - low) / CELL).astype(int))
    x, y = np.meshgrid((i + first[0] + 0.5) * CELL, (j + first[1] + 0.5) * CELL, indexing="ij")
    inside = shapely.contains_xy(Polygon(polygon), x.ravel(), y.ravel()).reshape(x.shape)
    return inside.astype(float), (int(first[0]), int(first[1]))


def _walls(polygon):
    walls = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        angle = float(np.arctan2(*(b - a)[::-1]) % np.pi)
        walls.append(WallPiece("k", np.array([a, b]), angle, 1.0, np.array([a, b])))
    return walls


def _orientations(*degrees):
    return tuple(Orientation(np.deg2rad(d), 0.05, 9) for d in degrees)


def _shape(polygon, config=CONFIG, walls=None, turn=0.0):
    walls = _walls(polygon) if walls is None else walls
    orientations = _orientations(turn, turn + 90)
    return room_shape(RoomEvidence(*_density(polygon), CELL, 0.5, walls, orientations), config)


def _turned(polygon, degrees):
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return polygon @ np.array([[c, s], [-s, c]])


@pytest.mark.parametrize("degrees", [0, 17])
@pytest.mark.parametrize("name", SHAPES)
def test_perfect_evidence_gives_the_shape(name, degrees):
    polygon = _turned(SHAPES[name], degrees)
    shape = _shape(polygon, turn=degrees)
    assert shape.failure is None
    assert len(shape.polygon) == len(polygon)
    assert signed_area(shape.polygon) > 0
    gaps = np.linalg.norm(shape.polygon[:, None] - polygon[None], axis=2).min(axis=0)
    assert gaps.max() < 0.07


ROWS = {
    "1x, fixed cell": replace(CONFIG, grids=(64,), fixed_cell_ch=0.05, limit_edges=False),
    "1x": replace(CONFIG, grids=(64,), limit_edges=False),
    "1x, limited": replace(CONFIG, grids=(64,)),
    "3x": CONFIG,
    "5x": replace(CONFIG, grids=(64, 96, 96, 128, 128)),
}


@pytest.mark.parametrize("row", ROWS)
def test_every_row_of_table_iii_runs(row):
    shape = _shape(RECTANGLE, ROWS[row])
    assert len(shape.rounds) == len(ROWS[row].grids)
    found, true = Polygon(shape.polygon), Polygon(RECTANGLE)
    assert found.intersection(true).area / found.union(true).area > 0.94


def test_limited_edges_leave_corners_that_later_rounds_remove():
    shape = _shape(RECTANGLE)
    assert len(shape.rounds[0]) > 4
    assert len(shape.rounds[-1]) == 4


def test_walls_place_the_outline_where_the_mask_is_a_little_small():
    density, first = _density(RECTANGLE * 0.97)
    walls, orientations = _walls(RECTANGLE), _orientations(0, 90)
    evidence = RoomEvidence(density, first, CELL, 0.5, walls, orientations)
    shape = room_shape(evidence, CONFIG)
    gaps = np.linalg.norm(shape.polygon[:, None] - RECTANGLE[None], axis=2).min(axis=0)
    assert gaps.max() < 0.07


def test_a_mask_too_small_is_a_failure_with_its_reason():
    shape = _shape(RECTANGLE * 0.05)
    assert shape.polygon is None
    assert "smaller" in shape.failure


def test_a_room_without_walls_keeps_the_outline_of_its_mask():
    shape = _shape(RECTANGLE, walls=[])
    found, true = Polygon(shape.polygon), Polygon(RECTANGLE)
    assert found.intersection(true).area / found.union(true).area > 0.9
