"""Rooms told apart on the map of a scene."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from panoplan.bench.points.maps import Maps
from panoplan.geometry.basins import basins
from panoplan.types.arrays import BoolArray


def segmented(found: Maps, wall_share: float, neck: float, min_area_m2: float) -> list[BoolArray]:
    """Masks of the rooms.

    Free floor is cut where it has a neck: the basins of the distance to the nearest wall are rooms
    where the pass between them is narrow against the smaller one.

    Args:
        found: of the scene.
        wall_share: share of the height from which a cell is wall.
        neck: of the smaller basin's radius, from which a pass joins them.
        min_area_m2: smaller rooms are none.

    Returns:
        (n, m) masks, largest first.

    Source: distance-transform segmentation as in Bormann et al., Room segmentation: survey,
        implementation, and analysis, ICRA 2016; joined by the persistence of basins.
    """
    free = found.floor & (found.walls < wall_share)
    distance = np.asarray(ndimage.distance_transform_edt(free))
    labels = basins(distance, neck)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    least = min_area_m2 / found.cell_m**2
    return [labels == k for k in np.argsort(-sizes, kind="stable") if sizes[k] >= least]
