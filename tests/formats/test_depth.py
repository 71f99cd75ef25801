import numpy as np
import pytest
from PIL import Image

from panoplan.errors import InputError
from panoplan.formats.depth import read_depth, write_depth


def test_depth_is_read_as_it_was_written(tmp_path):
    depth = np.array([[0.5, 3.1415, np.inf], [12.0, 65.0, 900.0]])
    write_depth(tmp_path / "a.png", depth)
    known = np.array([[0.5, 3.142, np.inf], [12.0, 65.0, 65.535]])
    assert np.array_equal(read_depth(tmp_path / "a.png"), known)


def test_what_is_no_depth_is_told(tmp_path):
    with pytest.raises(InputError, match="nothing"):
        read_depth(tmp_path / "a.png")
    (tmp_path / "a.png").write_bytes(b"no picture")
    with pytest.raises(InputError, match="no readable PNG"):
        read_depth(tmp_path / "a.png")
    Image.new("RGB", (4, 2)).save(tmp_path / "a.png")
    with pytest.raises(InputError, match="mode RGB"):
        read_depth(tmp_path / "a.png")
