import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.formats.ply import read_ply_points

plyfile = pytest.importorskip("plyfile", reason="the extra points is not installed")
POINTS = np.array([[0.5, -1.25, 2.0], [3.0, 0.0, -7.5]])


@pytest.mark.parametrize("text", [True, False])
def test_points_are_read_as_another_library_wrote_them(tmp_path, text):
    rows = np.zeros(2, dtype=[(n, "f4") for n in "xyz"] + [(n, "u1") for n in ("red", "green")])
    for k, axis in enumerate("xyz"):
        rows[axis] = POINTS[:, k]
    element = plyfile.PlyElement.describe(rows, "vertex")
    plyfile.PlyData([element], text=text).write(tmp_path / "pcl.ply")
    assert np.array_equal(read_ply_points(tmp_path / "pcl.ply"), POINTS)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no ply at all",
        b"\xff\xfe\x00",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
        b"ply\nformat ascii 1.0\nelement face 0\nproperty float x\nend_header\n",
        b"ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\n"
        b"property float y\nproperty float z\nend_header\n\0\0",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        b"property float z\nend_header\n1 nan 2\n",
    ],
)
def test_what_is_no_cloud_is_one_line(tmp_path, content):
    (tmp_path / "pcl.ply").write_bytes(content)
    with pytest.raises(InputError) as told:
        read_ply_points(tmp_path / "pcl.ply")
    assert "\n" not in str(told.value)


def test_a_missing_file(tmp_path):
    with pytest.raises(InputError, match="found nothing"):
        read_ply_points(tmp_path / "pcl.ply")
