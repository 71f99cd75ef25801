import io
import zipfile

import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.formats.layout_npz import read_layout_npz, write_layout_npz
from panoplan.formats.npy import parse_npy
from panoplan.types.layout import Layout

FLOOR = np.full(32, -0.5)


def test_known_members_are_read_and_others_are_not(tmp_path):
    path = tmp_path / "a.npz"
    floor = FLOOR.copy()
    floor[3], floor[4] = np.nan, 0.01
    np.savez(
        path,
        floor_boundary=floor.astype(np.float32),
        ceiling_boundary=np.full(32, 0.25),
        corners=np.array([20, 4]),
        floor_sigma=np.full(32, 0.125),
        kind=np.array(["predicted"]),
        secrets=np.array([{}], dtype=object),
    )
    layout = read_layout_npz(path)
    np.testing.assert_array_equal(layout.floor_boundary, floor.astype(np.float32))
    np.testing.assert_array_equal(layout.ceiling_boundary, np.full(32, 0.25))
    np.testing.assert_array_equal(layout.corners, [4, 20])
    np.testing.assert_array_equal(layout.floor_sigma, np.full(32, 0.125))


def test_a_layout_without_corners_is_fine(tmp_path):
    np.savez(tmp_path / "a.npz", floor_boundary=FLOOR)
    layout = read_layout_npz(tmp_path / "a.npz")
    assert layout.corners is None
    assert layout.ceiling_boundary is None


def test_read_of_write_and_same_bytes(tmp_path):
    floor = np.linspace(-1.2, -0.1, 64)
    floor[10] = np.nan
    layout = Layout(floor, -floor, np.array([1.5, 40.0]), np.full(64, 0.01))
    write_layout_npz(tmp_path / "a.npz", layout)
    write_layout_npz(tmp_path / "b.npz", layout)
    again = read_layout_npz(tmp_path / "a.npz")
    for name in ("floor_boundary", "ceiling_boundary", "corners", "floor_sigma"):
        np.testing.assert_allclose(getattr(again, name), getattr(layout, name), atol=1e-7)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def saved(array, **options):
    buffer = io.BytesIO()
    np.save(buffer, array, **options)
    return buffer.getvalue()


def header_claiming(shape):
    buffer = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        buffer, {"descr": "<f8", "fortran_order": False, "shape": shape}
    )
    return buffer.getvalue() + b"\0" * 64


@pytest.mark.parametrize(
    ("members", "told"),
    [
        ({"corners": saved(np.zeros(2))}, "no floor_boundary"),
        ({"floor_boundary": saved(np.array([{}] * 32), allow_pickle=True)}, "pickled objects"),
        ({"floor_boundary": saved(np.array(["a"] * 32))}, "type <U1"),
        ({"floor_boundary": saved(FLOOR.astype(complex))}, "type complex128"),
        ({"floor_boundary": saved(FLOOR.reshape(2, 16))}, r"shape \(2, 16\)"),
        ({"floor_boundary": saved(FLOOR[:8])}, "8 columns"),
        ({"floor_boundary": saved(FLOOR * 100)}, "an elevation of -50"),
        ({"floor_boundary": saved(np.full(32, -np.inf))}, "an elevation of -inf"),
        ({"floor_boundary": saved(FLOOR), "floor_sigma": saved(FLOOR[:31])}, r"shape \(31,\)"),
        ({"floor_boundary": saved(FLOOR), "corners": saved(np.array([33.0]))}, "outside"),
        ({"floor_boundary": saved(FLOOR), "corners": saved(np.array([np.nan]))}, "NaN"),
        ({"floor_boundary": saved(FLOOR)[:-40]}, "cut short"),
        ({"floor_boundary": b"no array at all"}, "no array"),
        ({"floor_boundary": header_claiming((10**13,))}, "cut short"),
        ({"floor_boundary": header_claiming((10**30,))}, "cut short"),
        ({"floor_boundary": b"\0" * (16 * 2**20 + 1)}, "16777217 bytes"),
    ],
)
def test_bad_members(tmp_path, members, told):
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    with pytest.raises(InputError, match=told) as caught:
        read_layout_npz(path)
    assert str(path) in str(caught.value)


def test_a_member_that_declares_less_than_it_holds(tmp_path):
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("floor_boundary.npy", saved(FLOOR) + b"\0" * 10**6)
    data = path.read_bytes()
    size = len(saved(FLOOR)) + 10**6
    path.write_bytes(data.replace(size.to_bytes(4, "little"), (200).to_bytes(4, "little")))
    with pytest.raises(InputError):
        read_layout_npz(path)


@pytest.mark.parametrize(
    ("data", "told"),
    [(b"", "an empty file"), (b"not a zip", "no readable archive"), (None, "nothing")],
)
def test_bad_files(tmp_path, data, told):
    path = tmp_path / "a.npz"
    if data is not None:
        path.write_bytes(data)
    with pytest.raises(InputError, match=told):
        read_layout_npz(path)


@pytest.mark.parametrize("keep", [0.2, 0.5, 0.9])
def test_a_truncated_file(tmp_path, keep):
    path = tmp_path / "a.npz"
    np.savez(path, floor_boundary=FLOOR)
    data = path.read_bytes()
    path.write_bytes(data[: int(keep * len(data))])
    with pytest.raises(InputError, match="no readable archive"):
        read_layout_npz(path)


def test_a_corrupt_member(tmp_path):
    path = tmp_path / "a.npz"
    np.savez_compressed(path, floor_boundary=np.linspace(-1, -0.1, 1024))
    data = bytearray(path.read_bytes())
    data[200:260] = b"\xff" * 60
    path.write_bytes(bytes(data))
    with pytest.raises(InputError, match="no readable archive"):
        read_layout_npz(path)


@pytest.mark.parametrize(
    "array",
    [
        np.arange(-6, 6, dtype=">f4").reshape(3, 4) / 8,
        np.asfortranarray(np.arange(12.0).reshape(3, 4)),
        np.arange(12, dtype=np.uint8).reshape(3, 4),
        np.float64(2.5),
        np.zeros((0, 4)),
        np.arange(5, dtype=np.float16),
    ],
)
@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_arrays_are_read_as_numpy_reads_them(array, version):
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, np.asanyarray(array), version=version)
    again = parse_npy(buffer.getvalue(), "a")
    assert again.dtype == np.float64
    np.testing.assert_array_equal(again, array)


@pytest.mark.parametrize(
    "header",
    [
        "{'descr': '<f4', 'fortran_order': False, 'shape'4), }",
        "{'descr': '<f4',ortran_order': False, 'shape': (3,), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, -1), }",
        "{'descr': '<f9', 'fortran_order': False, 'shape': (3,), }",
        "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3,), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3 3), }",
        "__import__('os').abort()",
    ],
)
def test_broken_headers(header):
    data = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + b"\0" * 64
    with pytest.raises(InputError, match=r"^a: found"):
        parse_npy(data, "a")


def test_spans_and_ceiling_at_corners(tmp_path):
    np.savez(
        tmp_path / "a.npz",
        floor_boundary=FLOOR,
        door_cols=np.array([[3.0, 8.0], [30.0, 2.0]]),
        window_cols=np.empty((0, 2)),
        ceil_corner_u=np.array([4.4, 20.0]),
        ceil_corner_phi=np.array([0.5, 0.6]),
    )
    layout = read_layout_npz(tmp_path / "a.npz")
    np.testing.assert_array_equal(layout.spans.doors, [[3, 8], [30, 2]])
    assert layout.spans.openings.shape == (0, 2)
    assert np.flatnonzero(np.isfinite(layout.ceiling_boundary)).tolist() == [4, 20]
    write_layout_npz(tmp_path / "b.npz", layout)
    again = read_layout_npz(tmp_path / "b.npz")
    np.testing.assert_array_equal(again.spans.doors, layout.spans.doors)


@pytest.mark.parametrize(
    ("name", "columns", "told"),
    [
        ("door_cols", [[3.0, 80.0]], "doors: found a column outside the image"),
        ("door_cols", [[3.0, np.nan]], "doors"),
        ("ceil_corner_u", [1.0, 2.0, 3.0], "ceil_corner_u: found 3 columns; expected 2"),
    ],
)
def test_bad_spans_are_refused(tmp_path, name, columns, told):
    arrays = {
        "floor_boundary": FLOOR,
        "ceil_corner_u": np.array([1.0, 2.0]),
        "ceil_corner_phi": np.array([0.5, 0.6]),
        name: np.array(columns),
    }
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError, match=told):
        read_layout_npz(tmp_path / "a.npz")
