"""TUM trajectories: `label tx ty tz qx qy qz qw` a line, camera-to-world."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.atomic import read_text, write_text
from panoplan.types.arrays import FloatArray
from panoplan.types.pose import Trajectory

_LIMIT = 256 * 2**20
_LARGEST = 1e100
_LABEL_LIMIT = 200


def read_rows(path: Path) -> tuple[tuple[str, ...], FloatArray]:
    """Labels and numbers of a pose file.

    Args:
        path: text; fields separated by space, comma or tab, `#` begins a comment.

    Returns:
        N labels, and (N, 7) tx ty tz qx qy qz qw as written, NaN included.

    Raises:
        InputError: missing, empty, a row without eight fields, a label that cannot be
            printed, or a field that is no number or beyond 1e100.
    """
    labels, rows = [], []
    for number, line in enumerate(read_text(path, _LIMIT).splitlines(), start=1):
        fields = [f for f in re.split(r"[\s,]+", line.split("#", 1)[0]) if f]
        if not fields:
            continue
        if len(fields) != 8:
            raise InputError(
                f"{path}:{number}", f"{len(fields)} fields", "label tx ty tz qx qy qz qw"
            )
        if not (fields[0].isprintable() and len(fields[0]) <= _LABEL_LIMIT):
            found = f"the label {fields[0][:40]!r}"
            raise InputError(f"{path}:{number}", found, f"{_LABEL_LIMIT} printable characters")
        try:
            rows.append([float(field) for field in fields[1:]])
        except ValueError:
            raise InputError(f"{path}:{number}", repr(line[:60]), "seven numbers") from None
        if any(_LARGEST < abs(value) < np.inf for value in rows[-1]):
            raise InputError(f"{path}:{number}", repr(line[:60]), f"at most {_LARGEST:g}")
        labels.append(fields[0])
    if not rows:
        raise InputError(path, "no pose", "at least one row")
    return tuple(labels), np.array(rows)


def read_tum(path: Path) -> Trajectory:
    """Reads a TUM trajectory.

    Raises:
        InputError: as `read_rows`; a pose that is not finite or whose quaternion is not of unit
            length; a label that stands twice.
    """
    labels, rows = read_rows(path)
    seen: set[str] = set()
    for label, row in zip(labels, rows, strict=True):
        if label in seen:
            raise InputError(path, f"the label {label} twice", "one pose a label")
        seen.add(label)
        if not np.isfinite(row).all():
            raise InputError(f"{path}, pose {label}", "NaN or infinity", "finite numbers")
    try:
        return Trajectory.from_quaternions(labels, rows[:, :3], rows[:, 3:])
    except InputError as error:
        raise InputError(f"{path}, {error.source}", error.found, error.expected) from None


def write_tum(path: Path, trajectory: Trajectory) -> None:
    """Writes a TUM trajectory; translations are read back to the bit, rotations to 1e-15.

    Raises:
        InputError: no pose, a label that would not be read back, or a place that cannot be written.
    """
    if not len(trajectory):
        raise InputError(path, "no pose", "at least one")
    for label in trajectory.labels:
        if not re.fullmatch(r"[^\s,#]+", label):
            raise InputError(path, f"the label {label!r}", "a word without space, comma or #")
    # It takes longer to import than all that reading a plan needs.
    from scipy.spatial.transform import Rotation

    quaternions = Rotation.from_matrix(trajectory.rotations).as_quat()
    lines = ["# label tx ty tz qx qy qz qw (camera-to-world; x right, y down, z forward)"]
    for label, t, q in zip(trajectory.labels, trajectory.translations, quaternions, strict=True):
        lines.append(" ".join([label, *(repr(float(value)) for value in (*t, *q))]))
    write_text(path, "\n".join(lines) + "\n")
