import numpy as np
import pytest
from PIL import Image

from panoplan.errors import InputError
from panoplan.formats.image import list_images, read_panorama, resized, write_jpeg


def saved(path, image):
    image.save(path)
    return path


def test_pixels_are_read_as_saved(tmp_path):
    pixels = np.random.default_rng(0).integers(0, 256, (256, 512, 3), dtype=np.uint8)
    read = read_panorama(saved(tmp_path / "a.png", Image.fromarray(pixels)))
    np.testing.assert_array_equal(read, pixels)


def test_a_jpeg_is_read_nearly_as_written(tmp_path):
    ramp = np.broadcast_to(np.linspace(0, 255, 512).astype(np.uint8)[None, :, None], (256, 512, 3))
    write_jpeg(tmp_path / "a.jpg", np.ascontiguousarray(ramp))
    assert np.abs(read_panorama(tmp_path / "a.jpg").astype(int) - ramp).max() <= 4


@pytest.mark.parametrize("mode", ["L", "RGBA", "P", "1", "I;16"])
def test_every_mode_becomes_rgb(tmp_path, mode):
    if mode == "I;16":
        image = Image.fromarray(np.full((256, 512), 257 * 200, dtype=np.uint16))
    else:
        image = Image.new("RGB", (512, 256), (200, 200, 200)).convert(
            mode, palette=Image.Palette.ADAPTIVE
        )
    read = read_panorama(saved(tmp_path / "a.png", image))
    assert read.shape == (256, 512, 3)
    assert mode == "1" or np.all(np.abs(read.astype(int) - 200) <= 1)


def test_exif_orientation_is_obeyed(tmp_path):
    pixels = np.zeros((512, 256, 3), dtype=np.uint8)
    pixels[:, :10] = 255
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(pixels).save(tmp_path / "a.png", exif=exif)
    read = read_panorama(tmp_path / "a.png")
    assert read.shape == (256, 512, 3)
    assert read[:10].min() == 255


@pytest.mark.parametrize(
    ("size", "told"), [((800, 600), "twice as wide"), ((510, 255), "at least 512×256")]
)
def test_sizes_that_are_no_panorama_are_refused(tmp_path, size, told):
    with pytest.raises(InputError, match=told):
        read_panorama(saved(tmp_path / "a.png", Image.new("RGB", size)))


def test_a_truncated_image_is_refused(tmp_path):
    noise = np.random.default_rng(0).integers(0, 256, (256, 512, 3), dtype=np.uint8)
    path = saved(tmp_path / "a.png", Image.fromarray(noise))
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(InputError, match="no readable image"):
        read_panorama(path)


def test_a_declared_size_is_checked_before_it_is_unpacked(tmp_path):
    data = saved(tmp_path / "a.png", Image.new("1", (40000, 20000))).read_bytes()
    assert len(data) < 2**20
    with pytest.raises(InputError, match="pixels"):
        read_panorama(tmp_path / "a.png")


@pytest.mark.parametrize("name", ["a.png", "a.jpg"])
def test_what_is_wider_than_wanted_is_made_smaller(tmp_path, name):
    ramp = np.broadcast_to(np.linspace(0, 255, 1024)[None, :, None], (512, 1024, 3))
    path = saved(tmp_path / name, Image.fromarray(ramp.astype(np.uint8)))
    for width in (640, 512, 300):
        read = read_panorama(path, widest=width)
        assert read.shape == (width // 2, width, 3)
        expected = 255 * ((np.arange(width) + 0.5) * 1024 / width - 0.5) / 1023
        assert np.abs(read[9, 4:-4, 0] - expected[4:-4]).max() < 4
    assert read_panorama(path, widest=4096).shape == (512, 1024, 3)


def test_the_least_size_is_the_callers(tmp_path):
    path = saved(tmp_path / "a.png", Image.new("RGB", (64, 32)))
    assert read_panorama(path, smallest=(32, 16)).shape == (32, 64, 3)
    with pytest.raises(InputError, match="at least 66×33 px"):
        read_panorama(path, smallest=(66, 33))


def test_only_pictures_are_opened(tmp_path):
    script = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 512 256\n"
    (tmp_path / "a.jpg").write_bytes(script)
    with pytest.raises(InputError, match="no readable image"):
        read_panorama(tmp_path / "a.jpg")


def test_smaller_is_the_mean():
    pixels = np.zeros((4, 8, 3), dtype=np.uint8)
    pixels[:, ::2] = 100
    np.testing.assert_array_equal(resized(pixels, 4, 2), np.full((2, 4, 3), 50))


def test_images_are_listed_in_natural_order(tmp_path):
    for name in ("p10.jpg", "p9.JPG", "p1.png", ".p0.png", "notes.txt"):
        (tmp_path / name).write_bytes(b"")
    (tmp_path / "p2.png").mkdir()
    assert [p.name for p in list_images(tmp_path)] == ["p1.png", "p9.JPG", "p10.jpg"]
