"""nerfstudio's transforms.json."""

from __future__ import annotations

from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.types.arrays import frozen_array
from panoplan.types.pose import Trajectory

# OpenGL cameras have y up and look along −z.
_GL_FROM_CAM = np.diag([1.0, -1.0, -1.0])


def parse_nerfstudio(data: Any, source: object) -> Trajectory:
    """Reads the frames.

    Args:
        data: object with `frames`, each with `file_path` and `transform_matrix` (4×4
            world_from_cam of an OpenGL camera: x right, y up, z backwards).
        source: for messages.

    Returns:
        Poses labelled with the files' paths, in the order of the frames.

    Raises:
        InputError: no frame, one without its pose, a path twice, or no rotation.

    Source: nerfstudio's documentation, data conventions.
    """
    frames = data.get("frames")
    if not isinstance(frames, list) or not frames:
        raise InputError(source, "no frame", "frames of a nerfstudio transforms.json")
    labels, matrices = [], []
    for k, frame in enumerate(frames):
        where = f"{source}, frames[{k}]"
        if not isinstance(frame, dict) or not isinstance(frame.get("file_path"), str):
            raise InputError(where, "no file_path", "file_path and transform_matrix")
        matrix = frozen_array(where, frame.get("transform_matrix", []), (4, 4))
        labels.append(frame["file_path"])
        matrices.append(matrix)
    if len(set(labels)) < len(labels):
        raise InputError(source, "two frames of one file", "one frame a file")
    poses = np.array(matrices)
    try:
        return Trajectory(tuple(labels), poses[:, :3, :3] @ _GL_FROM_CAM, poses[:, :3, 3])
    except InputError as error:
        raise InputError(f"{source}, {error.source}", error.found, error.expected) from None
