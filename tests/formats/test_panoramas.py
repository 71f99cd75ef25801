import json

import numpy as np
import pytest
from PIL import Image

from panoplan.errors import InputError
from panoplan.formats.panoramas import find_panoramas


def save(path, width=64, height=32):
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = np.arange(width, dtype=np.uint8)
    Image.fromarray(np.broadcast_to(columns[None, :, None], (height, width, 3))).save(path)
    return path


def test_files_are_found_by_id(tmp_path):
    one = save(tmp_path / "images" / "0001.png")
    two = save(tmp_path / "rgb" / "0002.png")
    save(tmp_path / "images" / "other.png")
    assert find_panoramas(tmp_path, ["0001", "0002", "0003"]) == {"0001": one, "0002": two}
    assert find_panoramas(tmp_path / "images", ["0001"]) == {"0001": one}
    with pytest.raises(InputError, match="no folder"):
        find_panoramas(tmp_path / "nowhere", [])


def test_a_sequence_lists_its_images(tmp_path):
    path = save(tmp_path / "images" / "IMG_7.png")
    keyframes = [{"id": "a", "image": "images/IMG_7.png", "order": 0}]
    (tmp_path / "sequence.json").write_text(json.dumps({"name": "x", "keyframes": keyframes}))
    assert find_panoramas(tmp_path, ["a"]) == {"a": path}
