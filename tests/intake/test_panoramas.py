import numpy as np
import pytest
from PIL import Image

from panoplan.intake.panoramas import Panoramas

av = pytest.importorskip("av", reason="needs the extra images")


def test_a_film_gives_six_looks_a_second_named_by_their_time(tmp_path):
    path = tmp_path / "walk.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=30)
        stream.width, stream.height, stream.pix_fmt = 2560, 1280, "yuv420p"
        picture = np.full((1280, 2560, 3), 90, dtype=np.uint8)
        for _ in range(31):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())
    panoramas = Panoramas.of_video(path)
    seen = list(panoramas)
    assert [s.name for s in seen][:3] == ["t00000000", "t00000167", "t00000333"]
    assert len(seen) == 7
    assert {s.pixels.shape for s in seen} == {(1024, 2048, 3)}
    assert (panoramas.at, panoramas.end) == pytest.approx((1.0, 31 / 30), abs=0.05)


def test_the_digest_is_that_of_the_images_and_their_names(tmp_path):
    pixels = np.random.default_rng(0).integers(0, 255, (256, 512, 3)).astype(np.uint8)
    for name in ("a.png", "b.png"):
        Image.fromarray(pixels).save(tmp_path / name)
    one = Panoramas.of_images(tmp_path, [tmp_path / "a.png"]).digest()
    assert one == Panoramas.of_images(tmp_path, [tmp_path / "a.png"]).digest()
    assert one != Panoramas.of_images(tmp_path, [tmp_path / "b.png"]).digest()
    Image.fromarray(pixels[::-1]).save(tmp_path / "a.png")
    assert one != Panoramas.of_images(tmp_path, [tmp_path / "a.png"]).digest()
