"""Equirectangular images of keyframes."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes
from panoplan.formats.sequence import DESCRIPTION, read_sequence

_FOLDERS = ("", "images", "rgb")
_SUFFIXES = (".jpg", ".jpeg", ".png", ".webp")
_LIMIT = 256 * 2**20
_MOST_PIXELS = 2**27


def find_panoramas(folder: Path, keyframes: Iterable[str]) -> dict[str, Path]:
    """The image files of keyframes.

    Looked for are the images that a sequence.json in the folder lists, and files named after the
    keyframe in the folder, its `images` or its `rgb`.

    Args:
        folder: a scene, or a folder of images.
        keyframes: ids.

    Returns:
        Files by id, of those keyframes that have one.

    Raises:
        InputError: no folder, or a sequence.json that cannot be read.
    """
    if not folder.is_dir():
        raise InputError(folder, "no folder", "a scene or a folder of images")
    listed = {}
    if (folder / DESCRIPTION).is_file():
        entries = read_sequence(folder).keyframes
        listed = {entry.id: folder / entry.image for entry in entries if entry.image}
    files = {
        path.stem: path
        for place in reversed(_FOLDERS)
        if (folder / place).is_dir()
        for path in sorted((folder / place).iterdir())
        if path.suffix.lower() in _SUFFIXES
    }
    found = {}
    for name in keyframes:
        path = listed.get(name)
        if path is None or not path.is_file():
            path = files.get(name)
        if path is not None:
            found[name] = path
    return found


def read_panorama(path: Path, width: int) -> NDArray[np.uint8]:
    """An equirectangular image, made smaller to a width where it is larger.

    Args:
        path: JPEG, PNG or WebP of at most 256 MiB and 134 million pixels.
        width: in pixels, at most.

    Returns:
        (H, W, 3) RGB, H = W / 2.

    Raises:
        InputError: missing, no image, too large, or not twice as wide as high.
    """
    image = _opened(path)
    columns, rows = image.size
    if abs(columns - 2 * rows) > 0.02 * columns or rows < 16:
        raise InputError(path, f"{columns} x {rows} pixels", "a panorama twice as wide as high")
    image = image.convert("RGB")
    wide = min(width, columns) // 2 * 2
    if (wide, wide // 2) != image.size:
        image = image.resize((wide, wide // 2), resample=_box())
    return np.asarray(image, dtype=np.uint8)


def _opened(path: Path) -> Any:
    from PIL import Image, UnidentifiedImageError

    data = read_bytes(path, _LIMIT)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(io.BytesIO(data), formats=("JPEG", "PNG", "WEBP"))
            if image.width * image.height > _MOST_PIXELS:
                found = f"{image.width} x {image.height} pixels"
                raise InputError(path, found, f"at most {_MOST_PIXELS} pixels")
            image.load()
    except (UnidentifiedImageError, OSError, SyntaxError, ValueError) as error:
        reason = "a damaged image" if isinstance(error, OSError) else "no image"
        raise InputError(path, reason, "a JPEG, PNG or WebP image") from None
    return image


def _box() -> Any:
    from PIL import Image

    return Image.Resampling.BOX
