import wave

import numpy as np
import pytest

av = pytest.importorskip("av", reason="needs the extra images")

from panoplan.errors import InputError  # noqa: E402
from panoplan.formats.video import frames, read_info, sample  # noqa: E402


def video(path, count=30, size=(512, 256), rate=10):
    """A film whose k-th picture is k times 8 bright, up to 30 of them."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=rate)
        stream.width, stream.height, stream.pix_fmt, stream.gop_size = *size, "yuv420p", 5
        for k in range(count):
            picture = np.full((size[1], size[0], 3), 8 * (k % 30), dtype=np.uint8)
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def test_frames_come_in_intervals_with_their_times(tmp_path):
    path = video(tmp_path / "a.mp4")
    told = list(frames(path, 0.5))
    assert [f.time_s for f in told] == pytest.approx([0, 0.5, 1.0, 1.5, 2.0, 2.5])
    assert [round(f.pixels.mean() / 8) for f in told] == [0, 5, 10, 15, 20, 25]
    info = read_info(path)
    assert (info.width, info.height) == (512, 256)
    assert info.duration_s == pytest.approx(3, abs=0.11)


def test_a_sample_is_spread_over_the_film(tmp_path):
    brightness = [p.mean() / 8 for p in sample(video(tmp_path / "a.mp4"), 4)]
    assert len(brightness) >= 3
    assert brightness == sorted(brightness)
    assert brightness[-1] - brightness[0] > 10


def test_a_film_cut_short_gives_what_it_has(tmp_path):
    path = video(tmp_path / "a.mkv", count=60)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert 3 <= len(list(frames(path, 0.1))) < 60


def sound(path):
    with wave.open(str(path), "wb") as stream:
        stream.setparams((1, 2, 8000, 0, "NONE", ""))
        stream.writeframes(bytes(16000))


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (sound, "sound without pictures"),
        (lambda p: p.write_bytes(b"no film at all"), "no readable video"),
        (lambda p: p.write_bytes(b""), "no readable video"),
        (lambda p: video(p, size=(640, 480)), "640×480"),
        (lambda p: video(p, size=(256, 128)), "at least 512×256"),
        (lambda p: None, "found nothing"),
    ],
)
def test_what_is_no_panorama_film_is_refused(tmp_path, make, told):
    path = tmp_path / "a.mp4"
    make(path)
    with pytest.raises(InputError, match=told):
        list(frames(path, 0.1))


def test_a_film_without_a_frame_is_refused(tmp_path):
    path = video(tmp_path / "a.mkv", count=2)
    data = path.read_bytes()
    path.write_bytes(data[: data.index(b"\x1f\x43\xb6\x75")])
    with pytest.raises(InputError):
        list(frames(path, 0.1))
