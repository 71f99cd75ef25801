"""Equirectangular videos."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panoplan.errors import InputError, MissingExtraError
from panoplan.formats.image import Pixels, check_panorama_size

ENDINGS = (".mp4", ".mov", ".mkv", ".webm", ".avi", ".m4v", ".insv", ".360")
_LARGEST_SIDE = 16384


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame of a video.

    Attributes:
        time_s: since the first one.
        pixels: (H, W, 3) RGB.
    """

    time_s: float
    pixels: Pixels


@dataclass(frozen=True)
class VideoInfo:
    """What a video's container says.

    Attributes:
        width: px.
        height: px.
        duration_s: None where it does not say.
    """

    width: int
    height: int
    duration_s: float | None


def read_info(path: Path) -> VideoInfo:
    """Reads what a video's container says.

    Raises:
        InputError: no video, no picture in it, or frames that are no panorama.
        MissingExtraError: PyAV is not installed.
    """
    with _opened(path) as (container, stream):
        duration = None if container.duration is None else container.duration / 1e6
        return VideoInfo(stream.codec_context.width, stream.codec_context.height, duration)


def frames(path: Path, interval_s: float) -> Iterator[Frame]:
    """The frames of a video, at most one in each interval.

    A video that is cut short gives what can be decoded.

    Args:
        path: the video.
        interval_s: seconds.

    Raises:
        InputError: as `read_info`, or no frame can be decoded.
        MissingExtraError: PyAV is not installed.
    """
    import_av()
    due, count = 0.0, 0
    with _opened(path) as (container, stream):
        stream.thread_type = "AUTO"
        start: float | None = None
        for frame in _decoded(container, stream):
            at = float(frame.time) if frame.time is not None else count / 30
            start = at if start is None else start
            count += 1
            if at - start + 1e-6 < due:
                continue
            due = (at - start) + interval_s
            check_panorama_size(frame.width, frame.height, path)
            yield Frame(at - start, frame.to_ndarray(format="rgb24"))
    if count == 0:
        raise InputError(path, "no frame that can be decoded", "an equirectangular video")


def sample(path: Path, count: int) -> list[Pixels]:
    """Frames spread over a video, by jumping to the nearest place where decoding can begin.

    Args:
        path: the video.
        count: at most so many.

    Returns:
        The frames; none where the container does not say how long it is.

    Raises:
        InputError: as `read_info`.
        MissingExtraError: PyAV is not installed.
    """
    av = import_av()
    found: dict[float, Pixels] = {}
    with _opened(path) as (container, stream):
        if container.duration is None:
            return []
        for k in range(count):
            try:
                container.seek(int(container.duration * (k + 0.5) / count))
                frame = next(container.decode(stream), None)
            except av.FFmpegError:
                continue
            if frame is not None and frame.time is not None:
                found.setdefault(float(frame.time), frame.to_ndarray(format="rgb24"))
    return [found[at] for at in sorted(found)]


def import_av() -> Any:
    """PyAV.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        import av
    except ImportError:
        raise MissingExtraError("reading videos", "av", "images") from None
    av.logging.set_level(None)
    return av


@contextmanager
def _opened(path: Path) -> Iterator[tuple[Any, Any]]:
    """A video's container and its picture stream, checked."""
    av = import_av()
    if not path.is_file():
        raise InputError(path, "a folder" if path.is_dir() else "nothing", "a video")
    try:
        container = av.open(str(path))
    except (av.FFmpegError, OSError, ValueError) as error:
        found = f"no readable video ({str(error)[:80]})"
        raise InputError(path, found, "an equirectangular video") from None
    with container:
        streams = container.streams.video
        if not streams or _is_cover(streams[0]):
            raise InputError(path, "sound without pictures", "an equirectangular video")
        width, height = streams[0].codec_context.width, streams[0].codec_context.height
        if max(width, height) > _LARGEST_SIDE:
            raise InputError(path, f"{width}×{height} px", f"at most {_LARGEST_SIDE} px a side")
        check_panorama_size(width, height, path)
        yield container, streams[0]


def _is_cover(stream: Any) -> bool:
    """A cover picture in a sound file is a stream of pictures as well."""
    return bool(getattr(stream, "disposition", 0) and "attached_pic" in str(stream.disposition))


def _decoded(container: Any, stream: Any) -> Iterator[Any]:
    av = import_av()
    try:
        yield from container.decode(stream)
    except av.FFmpegError:
        # Cut short or damaged: what came before is used.
        return
