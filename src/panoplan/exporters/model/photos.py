"""Panoramas at their places in the model, and how far each camera sees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from panoplan.exporters.bodies import interval_on
from panoplan.exporters.storeys import Storey, room_area
from panoplan.geometry.hits import first_hits
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.plan import PlanPose

_RAYS = 2048
_SLACK_M = 0.04
_SLACK_SHARE = 0.02


@dataclass(frozen=True, eq=False)
class Photo:
    """A panorama of an upright camera.

    Attributes:
        id: the keyframe's.
        room: id of the room it was assigned to, or None.
        place: (3,) of the camera, model frame.
        heading: rad, of the camera's z axis, from the plan's second axis towards its first.
        pixels: (H, W, 3) RGB.
        reach: (R,) how far it sees over the floor in each of R headings, metres.
    """

    id: str
    room: str | None
    place: FloatArray
    heading: float
    pixels: NDArray[np.uint8]
    reach: FloatArray

    def sample(self, directions: FloatArray) -> FloatArray:
        """(N, 3) colours 0-255 along (N, 3) directions of the model frame, bilinear."""
        x, y, z = directions.T
        azimuth = np.arctan2(x, -z) - self.heading
        elevation = np.arctan2(y, np.hypot(x, z))
        height, width = self.pixels.shape[:2]
        pixels = self.pixels.reshape(-1, 3)
        column = (azimuth / (2 * np.pi) + 0.5) * width - 0.5
        row = np.clip((0.5 - elevation / np.pi) * height - 0.5, 0.0, height - 1.0)
        left, upper = np.floor(column), np.minimum(np.floor(row), height - 2)
        u, v = (column - left)[:, None], (row - upper)[:, None]
        at, j = upper.astype(np.intp) * width, left.astype(np.intp) % width
        k = (j + 1) % width
        top = pixels[at + j] * (1 - u) + pixels[at + k] * u
        bottom = pixels[at + width + j] * (1 - u) + pixels[at + width + k] * u
        return np.asarray(top * (1 - v) + bottom * v)

    def sees(self, points: FloatArray) -> BoolArray:
        """(N,) whether nothing stands between the camera and (N, 3) points, over the floor."""
        x, _, z = (points - self.place).T
        ray = np.rint(np.arctan2(x, -z) / (2 * np.pi) * _RAYS).astype(np.intp) % _RAYS
        distance = np.hypot(x, z)
        return np.asarray(distance <= self.reach[ray] * (1 + _SLACK_SHARE) + _SLACK_M)


def free_space(floor: Storey) -> Any:
    """The shapely area where nothing bars the view: rooms, and the ways between them."""
    ways = []
    for item in (*floor.doors, *floor.openings):
        walls = [floor.walls[name] for name in item.walls if name in floor.walls]
        if len(walls) == 2:
            ends = []
            for wall in walls:
                along = (wall.b - wall.a) / max(float(np.hypot(*(wall.b - wall.a))), 1e-12)
                ends.append(wall.a + np.outer(interval_on(wall, item.segment), along))
            # A little into both rooms, so that no slit closes the way.
            ways.append(shapely.MultiPoint(np.concatenate(ends)).convex_hull.buffer(0.01))
    return shapely.union_all([*(room_area(room) for room in floor.rooms), *ways])


def reach_of(camera: PlanPose, free: Any) -> FloatArray | None:
    """(R,) metres to what bars the view in each heading; None for a camera that stands in a wall.

    Args:
        camera: of a metric plan.
        free: what `free_space` gives.
    """
    if not free.contains(shapely.Point(camera.position)):
        return None
    heading = np.arange(_RAYS) / _RAYS * 2 * np.pi
    rays = np.stack([np.sin(heading), np.cos(heading)], axis=1)
    found = np.full(_RAYS, np.inf)
    for part in shapely.get_parts(free):
        for ring in (part.exterior, *part.interiors):
            corners = shapely.get_coordinates(ring)[:-1]
            found = np.minimum(found, first_hits(camera.position, rays, corners).range)
    return found
