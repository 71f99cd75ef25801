import json

import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.formats.horizonnet import (
    at_columns,
    corner_peaks,
    read_boundaries_npy,
    read_corners_json,
)


def boundaries(path, *rows):
    np.save(path, np.array(rows, dtype=np.float32))
    return path


def test_signs_of_the_rows_are_turned(tmp_path):
    path = boundaries(tmp_path / "a.npy", np.full(1024, -0.25), np.full(1024, 0.5))
    layout = read_boundaries_npy(path)
    np.testing.assert_array_equal(layout.floor_boundary, np.full(1024, -0.5))
    np.testing.assert_array_equal(layout.ceiling_boundary, np.full(1024, 0.25))
    assert layout.corners is None


def test_half_a_column_without_the_pixel_centre(tmp_path):
    floor = np.full(16, 0.5)
    floor[0], floor[1], floor[15], floor[6] = 0.6, 0.8, 0.4, np.nan
    path = boundaries(tmp_path / "a.npy", -floor, floor)
    # With the pixel centre at 0, our column u (heading at u + ½) lies between theirs u and u + 1.
    layout = read_boundaries_npy(path, pixel_centre=0.0)
    expected = np.full(16, -0.5)
    expected[0], expected[1], expected[14], expected[15] = -0.7, -0.65, -0.45, -0.5
    expected[5] = expected[6] = np.nan
    np.testing.assert_allclose(layout.floor_boundary, expected, atol=1e-6)
    np.testing.assert_allclose(layout.ceiling_boundary, -expected, atol=1e-6)
    np.testing.assert_allclose(read_boundaries_npy(path).floor_boundary, -floor, atol=1e-6)


def test_a_smooth_boundary_keeps_its_headings(tmp_path):
    theirs = 2 * np.pi * np.arange(1024) / 1024 - np.pi
    path = boundaries(tmp_path / "a.npy", np.full(1024, -0.3), 0.5 + 0.2 * np.sin(theirs))
    ours = 2 * np.pi * (np.arange(1024) + 0.5) / 1024 - np.pi
    layout = read_boundaries_npy(path, pixel_centre=0.0)
    np.testing.assert_allclose(layout.floor_boundary, -0.5 - 0.2 * np.sin(ours), atol=3e-6)


def test_corners_are_peaks_of_the_probability(tmp_path):
    p = np.zeros(1024)
    p[[0, 1023]], p[[1, 1022]] = 0.9, 0.6  # around the seam: between 1023 and 1024
    p[300] = 0.51
    p[400] = 0.49
    p[500], p[510] = 0.7, 0.8  # 3.5° apart: one corner
    p[700:703] = 0.95
    path = boundaries(tmp_path / "a.npy", np.full(1024, -0.3), np.full(1024, 0.5), p)
    np.testing.assert_array_equal(read_boundaries_npy(path).corners, [300.0, 510.0, 701.0, 1023.5])
    np.testing.assert_array_equal(
        read_boundaries_npy(path, pixel_centre=0.0).corners, [299.5, 509.5, 700.5, 1023.0]
    )


def test_no_peaks():
    assert len(corner_peaks(np.full(1024, 0.9))) == 0
    assert len(corner_peaks(np.full(1024, 0.1))) == 0
    wide = np.zeros(1024)
    wide[100:200] = 0.9
    assert len(corner_peaks(wide)) == 0
    two = np.zeros(1024)
    two[[3, 18]] = 0.9, 0.8  # 5.3° apart
    np.testing.assert_array_equal(corner_peaks(two), [3, 18])


def test_values_at_columns():
    values = np.array([0.0, 1.0, np.nan, 4.0])
    np.testing.assert_array_equal(
        at_columns(values, np.array([0.25, 1.0, 1.5, 3.0, 3.5, -0.5, 4.0])),
        [0.25, 1.0, np.nan, 4.0, 2.0, 2.0, 0.0],
    )


@pytest.mark.parametrize(
    ("array", "told"),
    [
        (np.zeros(1024), r"shape \(1024,\)"),
        (np.zeros((4, 1024)), r"shape \(4, 1024\)"),
        (np.zeros((2, 8)), "8 columns"),
        (np.stack([np.full(64, 0.3), np.full(64, -0.5)]), "above the horizon"),
        (np.stack([np.full(64, 100.0), np.full(64, 400.0)]), "an elevation of -400"),
        (np.stack([np.full(64, -0.3), np.full(64, 0.5), np.full(64, 7.0)]), "outside 0..1"),
        (np.array([[{}] * 64] * 2, dtype=object), "pickled"),
        (np.array([["a"] * 64] * 2), "type <U1"),
    ],
)
def test_bad_boundaries(tmp_path, array, told):
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(InputError, match=told):
        read_boundaries_npy(tmp_path / "a.npy")


def test_truncated_boundaries(tmp_path):
    path = boundaries(tmp_path / "a.npy", np.full(64, -0.3), np.full(64, 0.5))
    path.write_bytes(path.read_bytes()[:-7])
    with pytest.raises(InputError, match="cut short"):
        read_boundaries_npy(path)
    path.write_bytes(path.read_bytes()[:20])
    with pytest.raises(InputError, match="no array"):
        read_boundaries_npy(path)


def uv_of(points, ceiling):
    """uv pairs, ceiling then floor, of plan points (right, forward) in camera heights."""
    uv = []
    for x, z in points:
        u = (np.arctan2(x, z) + np.pi) / (2 * np.pi)
        r = np.hypot(x, z)
        uv.append([u, 0.5 - np.arctan2(ceiling, r) / np.pi])
        uv.append([u, 0.5 + np.arctan2(1.0, r) / np.pi])
    return uv


def written(tmp_path, data):
    path = tmp_path / "a.json"
    path.write_text(data if isinstance(data, str) else json.dumps(data))
    return path


def test_straight_walls_between_corners(tmp_path):
    # Camera at the origin: walls at z = 2, x = 3, z = -1, x = -1; ceiling 0.5 above the camera.
    corners = [(-1, 2), (3, 2), (3, -1), (-1, -1)]
    layout = read_corners_json(
        written(tmp_path, {"z0": 50.0, "z1": -100.0, "uv": uv_of(corners, 0.5)})
    )
    heading = 2 * np.pi * (np.arange(1024) + 0.5) / 1024 - np.pi
    sides = np.stack(
        [
            np.where(np.cos(heading) > 0, 2, 1) / np.abs(np.cos(heading)),
            np.where(np.sin(heading) > 0, 3, 1) / np.abs(np.sin(heading)),
        ]
    )
    distance = sides.min(axis=0)
    np.testing.assert_allclose(1 / np.tan(-layout.floor_boundary), distance, rtol=1e-9)
    np.testing.assert_allclose(layout.ceiling_boundary, np.arctan(0.5 / distance), atol=1e-9)
    # The corner at (3, 2) is at heading atan2(3, 2) = 56.31°: column 1024·(0.5 + 0.15642) − ½.
    assert layout.corners == pytest.approx(
        sorted(1024 * (np.arctan2(x, z) / (2 * np.pi) + 0.5) - 0.5 for x, z in corners)
    )
    assert layout.corners[2] == pytest.approx(671.67, abs=0.01)


def test_walls_at_other_angles_are_not_squared(tmp_path):
    layout = read_corners_json(written(tmp_path, {"uv": uv_of([(-2, 1), (2, 3), (0, -2)], 1)}))
    # Straight ahead the wall from (-2, 1) to (2, 3) is at z = 2.
    ahead = np.interp(511.5, [511, 512], 1 / np.tan(-layout.floor_boundary[[511, 512]]))
    assert ahead == pytest.approx(2.0, abs=1e-4)


def test_the_nearest_wall_hides_those_behind(tmp_path):
    # An L seen from the short leg: the wall from (1, 1) to (4, 1) ends the view at the right.
    corners = [(-1, -1), (-1, 4), (4, 4), (4, 1), (1, 1), (1, -1)]
    layout = read_corners_json(written(tmp_path, {"uv": uv_of(corners, 1)}))
    heading = np.deg2rad(60.0)
    column = int(1024 * (heading + np.pi) / (2 * np.pi))
    assert 1 / np.tan(-layout.floor_boundary[column]) == pytest.approx(
        1 / np.sin(heading), rel=0.01
    )


def test_directions_without_a_wall_are_unknown(tmp_path):
    # The camera stands outside of the room that the file describes.
    layout = read_corners_json(written(tmp_path, {"uv": uv_of([(-1, 2), (1, 2), (0, 3)], 1)}))
    assert np.isnan(layout.floor_boundary[0])
    assert np.isfinite(layout.floor_boundary[512])


GOOD = uv_of([(-1, 2), (3, 2), (3, -1), (-1, -1)], 0.5)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        ("{", ":1: found broken JSON"),
        ("", "an empty file"),
        ("[]", "no list uv"),
        ({"layoutPoints": {}}, "no list uv"),
        ({"uv": GOOD[:-1]}, "7 points"),
        ({"uv": GOOD[:4]}, "4 points"),
        ({"uv": [[u, v, 0] for u, v in GOOD]}, r"shape \(8, 3\)"),
        ({"uv": [[str(u), v] for u, v in GOOD]}, "expected real numbers"),
        ({"uv": [*GOOD[:-1], [0.5]]}, "expected an array of numbers"),
        ({"uv": [*GOOD[:-1], [1.5, 0.7]]}, "within 0..1"),
        ({"uv": GOOD[1:] + GOOD[:1]}, "ceiling and floor corners in turns"),
        ('{"uv": [[NaN, 0.5]]}', "NaN"),
        ('{"uv": ' + "[" * 100000, "nested too deeply"),
        ('{"uv": ' + "9" * 5000 + "}", "a number too long"),
    ],
)
def test_bad_corners(tmp_path, data, told):
    with pytest.raises(InputError, match=told):
        read_corners_json(written(tmp_path, data))
