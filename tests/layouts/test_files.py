import json

import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.layouts.files import list_layouts, read_layout

UV = [[u, v] for u in (0.125, 0.375, 0.625, 0.875) for v in (0.375, 0.75)]


def test_the_ending_tells_the_format(tmp_path):
    np.savez(tmp_path / "a.npz", floor_boundary=np.full(64, -0.5))
    np.save(tmp_path / "b.npy", np.stack([np.full(64, -0.25), np.full(64, 0.5)]))
    (tmp_path / "c.json").write_text(json.dumps({"uv": UV}))
    (tmp_path / "c.jpg").write_text("a picture")
    (tmp_path / ".d.npz").write_text("being written")
    (tmp_path / "e.npz").mkdir()
    files = list_layouts(tmp_path)
    assert list(files) == ["a", "b", "c"]
    layouts = {name: read_layout(path) for name, path in files.items()}
    assert layouts["a"].floor_boundary[0] == -0.5
    assert layouts["b"].floor_boundary[0] == -0.5
    # A square room: floor corners 45° down at the diagonals, so that walls are 1/√2 away.
    assert 1 / np.tan(-layouts["c"].floor_boundary[512]) == pytest.approx(2**-0.5, abs=1e-4)


def test_bad_folders(tmp_path):
    with pytest.raises(InputError, match="no folder"):
        list_layouts(tmp_path / "none")
    with pytest.raises(InputError, match=r"no layout; expected files ending in \.npz, \.npy"):
        list_layouts(tmp_path)
    np.savez(tmp_path / "a.npz", floor_boundary=np.full(64, -0.5))
    (tmp_path / "a.json").write_text("{}")
    with pytest.raises(InputError, match=r"two layouts of a \(a\.json, a\.npz\)"):
        list_layouts(tmp_path)


def test_a_name_that_cannot_be_printed(tmp_path):
    np.savez(tmp_path / "a\n.npz", floor_boundary=np.full(64, -0.5))
    with pytest.raises(InputError, match="printable names"):
        list_layouts(tmp_path)


def test_an_ending_that_is_not_known(tmp_path):
    with pytest.raises(InputError, match=r"'\.txt'; expected \.npz \| \.npy \| \.json"):
        read_layout(tmp_path / "a.txt")
