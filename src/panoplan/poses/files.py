"""Trajectories from files of any program, told apart by their content."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes
from panoplan.formats.sequence import TRAJECTORY
from panoplan.formats.trajectories.colmap import parse_colmap_binary, parse_colmap_text
from panoplan.formats.trajectories.kitti import parse_kitti
from panoplan.formats.trajectories.nerfstudio import parse_nerfstudio
from panoplan.formats.trajectories.opensfm import parse_opensfm
from panoplan.formats.trajectories.stella import parse_stella
from panoplan.formats.tum import read_tum
from panoplan.types.pose import Trajectory

_LIMIT = 2**30
_KITTI, _COLMAP = 12, 10
_ALWAYS_TEXT = (".tum", ".txt", ".csv")
_EXPECTED = (
    "a trajectory: TUM, KITTI, COLMAP images.txt or images.bin, stella_vslam map, OpenSfM "
    "reconstruction.json or nerfstudio transforms.json"
)
PLACES = (
    TRAJECTORY,
    "frame_trajectory.txt",
    "keyframe_trajectory.txt",
    "images.bin",
    "images.txt",
    "sparse/0/images.bin",
    "sparse/0/images.txt",
    "reconstruction.json",
    "transforms.json",
    "map.msg",
    "poses.txt",
)
"""Where a folder is looked through for a trajectory, the first one found being used."""


@dataclass(frozen=True, eq=False)
class ReadTrajectory:
    """A trajectory and what its file was recognised as.

    Attributes:
        trajectory: as the file has it.
        kind: name of the format.
        path: the file.
    """

    trajectory: Trajectory
    kind: str
    path: Path


def find_trajectory(folder: Path) -> Path | None:
    """The trajectory that a folder brings, by the usual names, or None."""
    return next((folder / name for name in PLACES if (folder / name).is_file()), None)


def read_trajectory(path: Path) -> ReadTrajectory:
    """Reads a trajectory of whatever program.

    Args:
        path: a file, or a folder with one of `PLACES` in it.

    Returns:
        Poses, and as what the file was recognised.

    Raises:
        InputError: nothing that is recognised, or as the format's reader.
        MissingExtraError: a stella_vslam map and no msgpack.
    """
    if path.is_dir():
        found = find_trajectory(path)
        if found is None:
            raise InputError(path, "a folder without a trajectory", _EXPECTED)
        path = found
    data = read_bytes(path, _LIMIT)
    text = _text(data)
    if text is None and path.suffix not in _ALWAYS_TEXT:
        if _is_map(data):
            return ReadTrajectory(parse_stella(data, path), "stella_vslam map", path)
        return ReadTrajectory(parse_colmap_binary(data, path), "COLMAP binary", path)
    if text is None:
        return ReadTrajectory(read_tum(path), "TUM", path)
    if text.lstrip()[:1] in ("{", "["):
        return _read_json(text, path)
    fields = _first_fields(text)
    if len(fields) == _KITTI and all(_is_number(field) for field in fields):
        return ReadTrajectory(parse_kitti(text, path), "KITTI", path)
    # A name may have spaces; a line of eight fields is TUM's.
    if len(fields) >= _COLMAP and not _is_number(" ".join(fields[9:])):
        return ReadTrajectory(parse_colmap_text(text, path), "COLMAP text", path)
    return ReadTrajectory(read_tum(path), "TUM", path)


def _read_json(text: str, path: Path) -> ReadTrajectory:
    try:
        data: Any = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError(path, "broken JSON", _EXPECTED) from None
    if isinstance(data, dict) and "frames" in data:
        return ReadTrajectory(parse_nerfstudio(data, path), "nerfstudio", path)
    if isinstance(data, list) and any(isinstance(r, dict) and "shots" in r for r in data):
        return ReadTrajectory(parse_opensfm(data, path), "OpenSfM", path)
    raise InputError(path, "JSON of another kind", _EXPECTED)


def _text(data: bytes) -> str | None:
    """The text, or None for binary data."""
    if b"\0" in data[:4096]:
        return None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None


def _is_map(data: bytes) -> bool:
    """Whether the first byte begins a msgpack map whose first key is a word."""
    first = data[0]
    start = 1 if 0x80 <= first <= 0x8F else {0xDE: 3, 0xDF: 5}.get(first, 0)
    return start > 0 and len(data) > start and 0xA0 <= data[start] <= 0xBF


def _first_fields(text: str) -> list[str]:
    lines = (line.split("#", 1)[0].replace(",", " ").split() for line in text.splitlines())
    return next((fields for fields in lines if fields), [])


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
