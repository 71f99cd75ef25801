"""The panoramas of a walk, one after the other: of a video or of a folder."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from panoplan.errors import InputError
from panoplan.formats.image import Pixels, read_panorama, resized
from panoplan.formats.video import frames, read_info, sample
from panoplan.layouts.doubt import image_doubt
from panoplan.layouts.images import image_ids
from panoplan.poses.walk.follow import Seen

_LOOKS_A_SECOND = 6
_LARGEST_WIDTH = 2048
_SAMPLE = 24
_CHUNK = 2**20


@dataclass
class Panoramas:
    """Panoramas that can be gone through more than once.

    Attributes:
        source: a video or a folder of images.
        images: by name, empty for a video.
        left_out: (name, reason) of images that are none; known after they were gone through.
        at: seconds into the video, or images gone through.
        end: seconds or images in all, 0 where a video does not say.
    """

    source: Path
    images: dict[str, Path] = field(default_factory=dict)
    left_out: dict[str, str] = field(default_factory=dict)
    at: float = 0.0
    end: float = 0.0

    @staticmethod
    def of_video(path: Path) -> Panoramas:
        """The frames of a video.

        Raises:
            InputError: no equirectangular video.
            MissingExtraError: PyAV is not installed.
        """
        return Panoramas(path, end=read_info(path).duration_s or 0.0)

    @staticmethod
    def of_images(folder: Path, images: list[Path]) -> Panoramas:
        """Images in their order.

        Raises:
            InputError: two of one name.
        """
        return Panoramas(folder, image_ids(images), end=len(images))

    def __iter__(self) -> Iterator[Seen]:
        """The panoramas, at most 2048 px wide; images that are none are left out."""
        if not self.images:
            for frame in frames(self.source, 1 / _LOOKS_A_SECOND):
                self.at = frame.time_s
                yield Seen(f"t{round(1000 * frame.time_s):08d}", _bounded(frame.pixels))
            return
        for k, (name, path) in enumerate(self.images.items()):
            self.at = k + 1
            try:
                pixels = read_panorama(path)
            except InputError as error:
                self.left_out[name] = f"found {error.found}; expected {error.expected}"
                continue
            doubt = image_doubt(pixels)
            if doubt is not None:
                self.left_out[name] = doubt
                continue
            yield Seen(name, _bounded(pixels))

    def sample(self) -> list[Pixels]:
        """A few of them, spread over the walk."""
        if not self.images:
            return sample(self.source, _SAMPLE)
        paths = list(self.images.values())
        found = []
        for path in paths[:: max(1, len(paths) // _SAMPLE)]:
            try:
                found.append(_bounded(read_panorama(path)))
            except InputError:
                continue
        return found

    def digest(self) -> str:
        """A hash of all their bytes and names."""
        total = hashlib.sha256()
        for name, path in (self.images or {"": self.source}).items():
            one = hashlib.sha256()
            with contextlib.suppress(OSError), path.open("rb") as stream:
                while chunk := stream.read(_CHUNK):
                    one.update(chunk)
            total.update(f"{name}\0{one.hexdigest()}\n".encode())
        return total.hexdigest()


def _bounded(pixels: Pixels) -> Pixels:
    width = pixels.shape[1]
    if width <= _LARGEST_WIDTH:
        return pixels
    return resized(pixels, _LARGEST_WIDTH, _LARGEST_WIDTH // 2)
