"""Panoramas as image files."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import ExifTags, Image, ImageOps

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes, write_bytes
from panoplan.formats.names import natural_order

ENDINGS = (".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff", ".bmp")
SMALLEST = (512, 256)
_FILE_LIMIT = 512 * 2**20
_PIXEL_LIMIT = 16384 * 8192
_ASPECT_TOLERANCE = 0.01
_JPEG_QUALITY = 92
_FORMATS = ("JPEG", "PNG", "WEBP", "TIFF", "BMP")
_BROKEN = (OSError, ValueError, SyntaxError, Image.DecompressionBombError)

Pixels = NDArray[np.uint8]


def decode_panorama(
    data: bytes,
    source: object,
    *,
    widest: int | None = None,
    smallest: tuple[int, int] = SMALLEST,
) -> Pixels:
    """Decodes an equirectangular panorama.

    Args:
        data: bytes of an image file: JPEG, PNG, WebP, TIFF or BMP.
        source: where they come from, for messages.
        widest: px; what is wider is made smaller to it; None for as it is.
        smallest: width and height that it has at least, px.

    Returns:
        (H, W, 3) RGB, turned as its EXIF orientation says.

    Raises:
        InputError: no readable image; more than 16384×8192 px; or as `check_panorama_size`.
    """
    try:
        with warnings.catch_warnings(), Image.open(io.BytesIO(data), formats=_FORMATS) as image:
            # The limit below is ours.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            if image.width * image.height > _PIXEL_LIMIT:
                found = f"{image.width}×{image.height} px"
                raise InputError(source, found, f"at most {_PIXEL_LIMIT} px in all")
            turned = image.getexif().get(ExifTags.Base.Orientation, 1) != 1
            upright = ImageOps.exif_transpose(image) if turned else image
            check_panorama_size(upright.width, upright.height, source, smallest)
            if widest is not None and not turned:
                # A JPEG is then decoded no larger than it has to be.
                image.draft(None, (widest, widest // 2))
            pixels = np.asarray(_eight_bits(upright).convert("RGB"))
    except _BROKEN as error:
        raise InputError(source, f"no readable image ({str(error)[:80]})", "an image") from None
    if widest is None or pixels.shape[1] <= widest:
        return pixels
    return resized(pixels, widest, widest // 2)


def check_panorama_size(
    width: int, height: int, source: object, smallest: tuple[int, int] = SMALLEST
) -> None:
    """Refuses what cannot be an equirectangular panorama.

    Args:
        width: px.
        height: px.
        source: for the message.
        smallest: width and height that it has at least, px.

    Raises:
        InputError: not twice as wide as high (± 1 %), or smaller than that.
    """
    if abs(width - 2 * height) > _ASPECT_TOLERANCE * width:
        raise InputError(
            source, f"{width}×{height} px", "an equirectangular panorama, twice as wide as high"
        )
    if width < smallest[0] or height < smallest[1]:
        raise InputError(source, f"{width}×{height} px", f"at least {smallest[0]}×{smallest[1]} px")


def read_panorama(
    path: Path, *, widest: int | None = None, smallest: tuple[int, int] = SMALLEST
) -> Pixels:
    """Reads an equirectangular panorama as `decode_panorama` does.

    Raises:
        InputError: missing, empty or larger than 512 MiB; or as `decode_panorama`.
    """
    return decode_panorama(read_bytes(path, _FILE_LIMIT), path, widest=widest, smallest=smallest)


def write_jpeg(path: Path, pixels: Pixels) -> None:
    """Writes an image as JPEG of quality 92.

    Raises:
        InputError: the place cannot be written.
    """
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "JPEG", quality=_JPEG_QUALITY)
    write_bytes(path, buffer.getvalue())


def resized(pixels: Pixels, width: int, height: int) -> Pixels:
    """The image at another size; each pixel is the mean of those it covers.

    Args:
        pixels: (H, W, 3).
        width: px.
        height: px.
    """
    if pixels.shape[:2] == (height, width):
        return pixels
    smaller = width <= pixels.shape[1]
    method = Image.Resampling.BOX if smaller else Image.Resampling.BILINEAR
    return np.asarray(Image.fromarray(pixels).resize((width, height), method))


def list_images(folder: Path) -> list[Path]:
    """The image files of a folder in natural order; hidden ones are passed over.

    Raises:
        InputError: the folder cannot be read.
    """
    try:
        paths = list(folder.iterdir())
    except OSError as error:
        raise InputError(folder, f"{error.strerror or error}", "a readable folder") from None
    images = (p for p in paths if p.suffix.lower() in ENDINGS and not p.name.startswith("."))
    return sorted((p for p in images if p.is_file()), key=lambda p: natural_order(p.name))


def _eight_bits(image: Image.Image) -> Image.Image:
    """16-bit grey levels scaled to 8 bits, which Pillow would cut off."""
    if not image.mode.startswith("I"):
        return image
    levels = np.asarray(image, dtype=np.float64) / 257
    return Image.fromarray(np.clip(np.rint(levels), 0, 255).astype(np.uint8))
