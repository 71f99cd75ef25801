"""Which image is of which keyframe."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from panoplan.errors import InputError
from panoplan.formats.image import ENDINGS
from panoplan.formats.sequence import DESCRIPTION, read_sequence

_FOLDERS = ("", "images", "rgb")


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
        if path.suffix.lower() in ENDINGS
    }
    found = {}
    for name in keyframes:
        path = listed.get(name)
        if path is None or not path.is_file():
            path = files.get(name)
        if path is not None:
            found[name] = path
    return found
