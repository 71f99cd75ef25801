"""KITTI poses: twelve numbers a line, the 3×4 matrix world_from_cam row by row."""

from __future__ import annotations

import numpy as np

from panoplan.errors import InputError
from panoplan.types.pose import Trajectory


def parse_kitti(text: str, source: object) -> Trajectory:
    """Reads KITTI poses.

    Args:
        text: of the file.
        source: for messages.

    Returns:
        Poses labelled with the number of their line, from 0.

    Raises:
        InputError: a line without twelve finite numbers, or a matrix that is no rotation.

    Source: the odometry benchmark's development kit, readme.txt.
    """
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        fields = line.split("#", 1)[0].split()
        if not fields:
            continue
        try:
            row = np.array([float(field) for field in fields])
        except ValueError:
            row = np.full(1, np.nan)
        if len(row) != 12 or not np.isfinite(row).all():
            raise InputError(f"{source}:{number}", repr(line[:60]), "twelve finite numbers")
        rows.append(row.reshape(3, 4))
    matrices = np.array(rows).reshape(-1, 3, 4)
    return Trajectory(
        tuple(str(k) for k in range(len(rows))), matrices[:, :, :3], matrices[:, :, 3]
    )
