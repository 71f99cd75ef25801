import numpy as np
import pytest
from PIL import Image
from tests.networks import WIDTH, brightness_network, painted

from panoplan.cache import Cache
from panoplan.errors import InputError
from panoplan.formats.image import list_images, write_jpeg
from panoplan.layouts.files import read_layout
from panoplan.layouts.images import image_ids, predict_layouts
from panoplan.layouts.onnx import OnnxLayouts

FLOOR = 0.65 + 0.2 * np.sin(np.arange(WIDTH) * 2 * np.pi / WIDTH)


class Counting(OnnxLayouts):
    asked = 0

    def __call__(self, pixels):
        self.asked += 1
        return super().__call__(pixels)


@pytest.fixture
def network(tmp_path):
    return Counting(brightness_network(tmp_path / "brightness.onnx"))


@pytest.fixture
def photos(tmp_path):
    folder = tmp_path / "photos"
    folder.mkdir()
    Image.fromarray(painted(FLOOR)).save(folder / "a.png")
    write_jpeg(folder / "b.jpg", painted(FLOOR[::-1]))
    (folder / "broken.jpg").write_bytes(b"\xff\xd8\xff no jpeg")
    Image.new("RGB", (800, 600)).save(folder / "photo.png")
    Image.new("RGB", (512, 256)).save(folder / "black.png")
    (folder / ".hidden.png").write_bytes(b"")
    return image_ids(list_images(folder))


def nothing(done, total):
    pass


def test_good_images_get_layouts_and_others_a_reason(tmp_path, network, photos):
    done = []
    predicted = predict_layouts(
        photos, tmp_path / "out", network, Cache(None), lambda *n: done.append(n)
    )
    assert sorted(predicted.files) == ["a", "b"]
    floor = read_layout(predicted.files["a"]).floor_boundary
    np.testing.assert_allclose((floor[7::16] + floor[8::16]) / 2, -FLOOR, atol=1 / 400)
    reasons = dict(predicted.left_out)
    assert "no readable image" in reasons["broken"]
    assert "800×600" in reasons["photo"]
    assert "one colour" in reasons["black"]
    assert done[-1] == (5, 5)


def test_an_image_is_looked_at_once(tmp_path, network, photos):
    cache = Cache(tmp_path / "cache")
    first = predict_layouts(photos, tmp_path / "one", network, cache, nothing)
    again = predict_layouts(photos, tmp_path / "two", network, cache, nothing)
    assert network.asked == 2
    assert first.left_out == again.left_out
    assert first.files["a"].read_bytes() == again.files["a"].read_bytes()
    write_jpeg(photos["b"], painted(FLOOR))
    predict_layouts(photos, tmp_path / "two", network, cache, nothing)
    assert network.asked == 3


def test_two_images_of_one_name_are_refused(tmp_path):
    with pytest.raises(InputError, match="two images named a"):
        image_ids([tmp_path / "a.png", tmp_path / "a.jpg"])
