"""COLMAP images: cam_from_world, scalar first, as text and as binary."""

from __future__ import annotations

import struct

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.trajectories.matrices import from_cam_from_world
from panoplan.types.pose import Trajectory

_HEAD = struct.Struct("<I7dI")
_COUNT = struct.Struct("<Q")
_POINT_BYTES = 24
_NAME_LIMIT = 1024


def parse_colmap_text(text: str, source: object) -> Trajectory:
    """Reads images.txt.

    Args:
        text: two lines an image: `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`, and its points,
            which are passed over and may be an empty line.
        source: for messages.

    Returns:
        Poses labelled with the images' names, in the order of the names.

    Raises:
        InputError: a line of too few fields or with a field that is no number, or no rotation.

    Source: COLMAP's documentation, output format.
    """
    names, poses = [], []
    points_next = False
    for number, line in enumerate(text.splitlines(), start=1):
        if points_next:
            points_next = False
            continue
        if line.startswith("#") or not line.strip():
            continue
        fields = line.split(maxsplit=9)
        try:
            numbers = [float(field) for field in fields[1:8]]
        except ValueError:
            numbers = []
        if len(fields) < 10 or len(numbers) < 7:
            expected = "IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME"
            raise InputError(f"{source}:{number}", repr(line[:60]), expected)
        names.append(fields[9].strip())
        poses.append(numbers)
        points_next = True
    return _trajectory(names, poses, source)


def parse_colmap_binary(data: bytes, source: object) -> Trajectory:
    """Reads images.bin, as `parse_colmap_text` does images.txt.

    Args:
        data: count; an image's id, quaternion, translation, camera, name, and number of points
            with 24 bytes each. Little-endian.
        source: for messages.

    Raises:
        InputError: cut short, or a name that never ends; or as `parse_colmap_text`.
    """
    names, poses = [], []
    broken = InputError(source, "a file cut short or of another kind", "COLMAP's images.bin")
    try:
        (count,) = _COUNT.unpack_from(data)
        at = _COUNT.size
        if count > len(data) // _HEAD.size:
            raise broken
        for _ in range(count):
            _, *numbers, _ = _HEAD.unpack_from(data, at)
            at += _HEAD.size
            end = data.find(b"\0", at, at + _NAME_LIMIT)
            if end < 0:
                raise broken
            names.append(data[at:end].decode("utf-8", "replace"))
            poses.append(numbers)
            (points,) = _COUNT.unpack_from(data, end + 1)
            at = end + 1 + _COUNT.size + points * _POINT_BYTES
            if at > len(data):
                raise broken
    except struct.error:
        raise broken from None
    return _trajectory(names, poses, source)


def _trajectory(names: list[str], poses: list[list[float]], source: object) -> Trajectory:
    if not names:
        raise InputError(source, "no image with a pose", "at least one")
    rows = np.array(poses, dtype=np.float64)
    quaternions = np.roll(rows[:, :4], -1, axis=1)
    return from_cam_from_world(names, quaternions, rows[:, 4:], source)
