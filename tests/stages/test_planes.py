from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import L_SHAPE, RECTANGLE, walk

from panoplan.config import PlanesConfig, RegistrationConfig
from panoplan.geometry.angles import line_difference
from panoplan.stages.planes import merged_corners, split, wall_pieces
from panoplan.stages.registration import cast, register
from panoplan.types.layout import Layout

CONFIG = PlanesConfig()


def _view(polygon, camera, *, corners=None, boundary=None):
    keyframe = walk(polygon, [camera], headings=[0.0])[0]
    floor = keyframe.layout.floor_boundary if boundary is None else boundary
    keyframe = replace(keyframe, layout=Layout(floor, corners=corners))
    return register(cast(keyframe, 0, np.zeros(3), np.eye(2), RegistrationConfig()), 1.0)


def _columns_of(polygon, camera):
    heading = np.arctan2(*(polygon - camera).T)
    return np.sort(np.mod((heading + np.pi) * 1024 / (2 * np.pi) - 0.5, 1024))


def _walls(view, config=CONFIG):
    return wall_pieces(view, config, np.random.default_rng(0))


@pytest.mark.parametrize("known_corners", [True, False])
def test_a_rectangle_has_four_walls_with_their_direction_and_distance(known_corners):
    camera = np.array([0.5, -0.2])
    corners = _columns_of(RECTANGLE, camera) if known_corners else None
    walls, _ = _walls(_view(RECTANGLE, camera, corners=corners))
    long = [wall for wall in walls if np.linalg.norm(wall.ends[1] - wall.ends[0]) > 1.0]
    assert len(long) == 4
    found = sorted((round(wall.distance, 2), wall.direction) for wall in long)
    assert [distance for distance, _ in found] == pytest.approx([1.3, 1.5, 1.7, 2.5], abs=0.01)
    for (_, direction), expected in zip(found, [0, np.pi / 2, 0, np.pi / 2], strict=True):
        assert line_difference(direction, expected) == pytest.approx(0, abs=0.01)


def test_a_missed_corner_is_found_where_the_piece_bends():
    camera = np.array([0.0, 0.0])
    corners = np.delete(_columns_of(RECTANGLE, camera), 1)
    view = _view(RECTANGLE, camera, corners=corners)
    printed, rejected = _walls(view, replace(CONFIG, resplit=False))
    assert len(printed) == 2
    assert [piece.reason for piece in rejected] == ["no plane fits"]
    mended, _ = _walls(view)
    assert sum(np.linalg.norm(w.ends[1] - w.ends[0]) > 1 for w in mended) == 4


def test_an_occlusion_edge_is_no_wall():
    walls, rejected = _walls(_view(L_SHAPE, np.array([-2.5, 1.5])))
    for wall in walls:
        outward = np.array([-np.sin(wall.direction), np.cos(wall.direction)])
        assert np.abs(np.abs(outward) - [0, 1]).max() < 0.05 or (
            np.abs(np.abs(outward) - [1, 0]).max() < 0.05
        )
    assert {piece.reason for piece in rejected} <= {
        "too few columns", "seen edge-on", "no plane fits",
    }  # fmt: skip


def test_noise_beyond_the_residual_is_rejected():
    rng = np.random.default_rng(0)
    layout = walk(RECTANGLE, [[0.0, 0.0]])[0].layout
    noisy = layout.floor_boundary + rng.normal(0, 0.06, 1024)
    corners = _columns_of(RECTANGLE, np.zeros(2))
    config = replace(CONFIG, resplit=False)
    walls, rejected = _walls(_view(RECTANGLE, [0, 0], corners=corners, boundary=noisy), config)
    reasons = [piece.reason for piece in rejected]
    assert reasons.count("no plane fits") >= 4
    assert all(np.linalg.norm(wall.ends[1] - wall.ends[0]) < 1 for wall in walls)


def test_far_walls_and_short_pieces_are_rejected_with_the_reason():
    far = RECTANGLE * 5
    _, rejected = _walls(_view(far, [0, 0], corners=_columns_of(far, np.zeros(2))))
    assert {piece.reason for piece in rejected} == {"too far"}
    corners = np.sort(np.append(_columns_of(RECTANGLE, np.zeros(2)), [300.0, 303.0]))
    _, rejected = _walls(_view(RECTANGLE, [0, 0], corners=corners))
    assert [piece.reason for piece in rejected] == ["too few columns"]


def test_unknown_columns_split_a_wall():
    layout = walk(RECTANGLE, [[0.0, 0.0]], headings=[0.0])[0].layout
    boundary = layout.floor_boundary.copy()
    boundary[500:524] = np.nan
    corners = _columns_of(RECTANGLE, np.zeros(2))
    runs = split(_view(RECTANGLE, [0, 0], corners=corners, boundary=boundary), CONFIG)
    assert len(runs) == 5
    assert sum(map(len, runs)) == 1000


@pytest.mark.parametrize(
    ("corners", "merged"),
    [
        ([100.0, 500.0], [100.0, 500.0]),
        ([100.0, 130.0, 170.0, 600.0], [400.0 / 3, 600.0]),
        ([10.0, 500.0, 1000.0], [500.0, 1017.0]),
        ([5.0], [5.0]),
    ],
)
def test_near_corners_are_merged_across_the_images_edge_too(corners, merged):
    np.testing.assert_allclose(merged_corners(np.array(corners), 50.0, 1024), merged)


def test_no_corner_is_merged_unless_asked():
    corners = np.array([1.0, 1.5, 2.0])
    np.testing.assert_array_equal(merged_corners(corners, 0.0, 1024), corners)
