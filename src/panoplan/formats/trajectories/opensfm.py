"""OpenSfM's reconstruction.json."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from panoplan.errors import InputError
from panoplan.formats.trajectories.matrices import from_cam_from_world
from panoplan.types.arrays import frozen_array
from panoplan.types.pose import Trajectory


def parse_opensfm(data: Any, source: object) -> Trajectory:
    """Reads the shots of the reconstruction that has most.

    Args:
        data: list of reconstructions, each with `shots` by image name, each shot with `rotation`
            (axis times angle in rad, cam_from_world) and `translation`.
        source: for messages.

    Returns:
        Poses labelled with the images' names, in their natural order.

    Raises:
        InputError: no shot, or one without its pose.

    Source: OpenSfM's documentation, reconstruction file format.
    """
    found = [r["shots"] for r in data if isinstance(r, dict) and isinstance(r.get("shots"), dict)]
    shots: dict[str, Any] = max(found, key=len, default={})
    if not shots:
        raise InputError(source, "no shot", "an OpenSfM reconstruction")
    turns, translations = [], []
    for name, shot in shots.items():
        where = f"{source}, {name[:80]}"
        if not isinstance(shot, dict) or not {"rotation", "translation"} <= set(shot):
            raise InputError(where, "no pose", "rotation and translation")
        turns.append(frozen_array(f"{where}, rotation", shot["rotation"], (3,)))
        translations.append(frozen_array(f"{where}, translation", shot["translation"], (3,)))
    quaternions = Rotation.from_rotvec(np.array(turns)).as_quat()
    return from_cam_from_world(list(shots), quaternions, np.array(translations), source)
