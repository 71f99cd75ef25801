"""Whether a camera moved at all."""

from __future__ import annotations

import numpy as np

from panoplan.errors import InputError
from panoplan.types.pose import Trajectory

_STILL = 1e-9


def check_moving(trajectory: Trajectory, source: object) -> None:
    """Refuses a trajectory of several cameras that are all at one spot.

    Args:
        trajectory: N poses; a single one may stand still.
        source: where it comes from, for the message.

    Raises:
        InputError: N > 1 and no axis along which the positions spread by more than 1e-9 of
            their largest coordinate.
    """
    if len(trajectory) < 2:
        return
    spread = np.ptp(trajectory.translations, axis=0).max()
    if spread <= _STILL * np.abs(trajectory.translations).max():
        raise InputError(source, f"{len(trajectory)} cameras at one spot", "a camera that moves")
