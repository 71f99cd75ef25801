"""Layouts of image files: predicted once, kept by content."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from panoplan.cache import Cache, content_key
from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder, read_bytes, write_bytes
from panoplan.formats.image import decode_panorama
from panoplan.formats.layout_npz import layout_npz
from panoplan.layouts.dense import layout
from panoplan.layouts.doubt import answer_doubt, image_doubt
from panoplan.layouts.onnx import OnnxLayouts

_STAGE = "layout 1"
_FILE_LIMIT = 512 * 2**20
_LEFT_OUT = b"left out: "


@dataclass(frozen=True)
class Predicted:
    """What became of some images.

    Attributes:
        files: layout file by image id.
        left_out: (id, reason) of images without one.
    """

    files: Mapping[str, Path]
    left_out: tuple[tuple[str, str], ...]


def image_ids(images: list[Path]) -> dict[str, Path]:
    """Images by id, which is the file's name without ending.

    Raises:
        InputError: two images of one name, or a name that cannot be printed.
    """
    ids: dict[str, Path] = {}
    for path in images:
        if not path.stem.isprintable():
            raise InputError(path.parent, f"an image named {path.stem!r}", "printable names")
        if path.stem in ids:
            found = f"two images named {path.stem} ({ids[path.stem].name}, {path.name})"
            raise InputError(path.parent, found, "one image a name")
        ids[path.stem] = path
    return ids


def predict_layouts(
    images: Mapping[str, Path],
    folder: Path,
    network: OnnxLayouts,
    cache: Cache,
    progress: Callable[[int, int], None],
) -> Predicted:
    """Writes a layout file for each image that shows a room.

    Args:
        images: by id.
        folder: for ID.npz; made where it does not exist.
        network: the layout network.
        cache: where answers about these bytes by this network are kept.
        progress: called with (images done, images in all).

    Returns:
        The files, and which images were left out and why: broken, no panorama, or an answer that
        cannot be believed.

    Raises:
        InputError: a place that cannot be written, or a network that does not do what its file
            says.
    """
    make_folder(folder)
    files, left_out = {}, []
    for done, (name, path) in enumerate(images.items(), start=1):
        file = folder / f"{name}.npz"
        reason = predict_layout(path, file, network, cache)
        if reason is None:
            files[name] = file
        else:
            left_out.append((name, reason))
        progress(done, len(images))
    cache.trim()
    return Predicted(files, tuple(left_out))


def predict_layout(path: Path, file: Path, network: OnnxLayouts, cache: Cache) -> str | None:
    """Writes the layout file of one image.

    Args:
        path: the image.
        file: to write.
        network: the layout network.
        cache: where answers about these bytes by this network are kept.

    Returns:
        Why there is none, else None.

    Raises:
        InputError: as `predict_layouts`.
    """
    answer = _answer(path, network, cache)
    if answer.startswith(_LEFT_OUT):
        return answer.removeprefix(_LEFT_OUT).decode()
    write_bytes(file, answer)
    return None


def _answer(path: Path, network: OnnxLayouts, cache: Cache) -> bytes:
    """The bytes of the layout file of an image, or the reason why there is none."""
    try:
        data = read_bytes(path, _FILE_LIMIT)
    except InputError as error:
        return _LEFT_OUT + f"found {error.found}; expected {error.expected}".encode()
    key = content_key(_STAGE, data, network.fingerprint)
    answer = cache.read(key)
    if answer is None:
        answer = _predict(data, path, network)
        cache.write(key, answer)
    return answer


def _predict(data: bytes, path: Path, network: OnnxLayouts) -> bytes:
    try:
        pixels = decode_panorama(data, path)
    except InputError as error:
        return _LEFT_OUT + f"found {error.found}; expected {error.expected}".encode()
    doubt = image_doubt(pixels)
    if doubt is None:
        dense = network(pixels)
        doubt = answer_doubt(dense)
        if doubt is None:
            return layout_npz(layout(dense))
    return _LEFT_OUT + doubt.encode()
