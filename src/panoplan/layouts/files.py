"""Layouts from files: one a panorama, named after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from panoplan.errors import InputError
from panoplan.formats.horizonnet import read_boundaries_npy, read_corners_json
from panoplan.formats.layout_npz import read_layout_npz
from panoplan.types.layout import Layout

LayoutReader = Callable[[Path], Layout]
READERS: Mapping[str, LayoutReader] = {
    ".npz": read_layout_npz,
    ".npy": read_boundaries_npy,
    ".json": read_corners_json,
}


def list_layouts(folder: Path) -> dict[str, Path]:
    """The layout files of a folder.

    Args:
        folder: holds files ending in .npz, .npy or .json; others and hidden ones are passed over.

    Returns:
        File by name without ending, sorted by name.

    Raises:
        InputError: no folder, no layout in it, two layouts of one name, or a name that cannot be
            printed.
    """
    if not folder.is_dir():
        raise InputError(folder, "no folder", "a folder of layouts")
    try:
        paths = sorted(folder.iterdir())
    except OSError as error:
        raise InputError(folder, f"{error.strerror or error}", "a readable folder") from None
    files: dict[str, Path] = {}
    for path in paths:
        if path.suffix not in READERS or path.name.startswith(".") or path.is_dir():
            continue
        if not path.stem.isprintable():
            raise InputError(folder, f"a layout named {path.stem!r}", "printable names")
        if path.stem in files:
            found = f"two layouts of {path.stem} ({files[path.stem].name}, {path.name})"
            raise InputError(folder, found, "one layout a panorama")
        files[path.stem] = path
    if not files:
        raise InputError(folder, "no layout", "files ending in " + ", ".join(READERS))
    return files


def read_layout(path: Path) -> Layout:
    """Reads a layout file in the format that its ending tells.

    Raises:
        InputError: an ending not known, or as the format's reader.
    """
    reader = READERS.get(path.suffix)
    if reader is None:
        raise InputError(path, f"the ending {path.suffix!r}", " | ".join(READERS))
    return reader(path)
