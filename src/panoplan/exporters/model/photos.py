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
from panoplan.geometry.panorama import sampled
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.plan import PlanPose

NADIR_DEG = (52.0, 62.0)
"""Below the horizon, from where the tripod or hand may be seen: fades out between the two."""

_UNCLEAR = 4
"""Power of that fading: another camera's view is soon the better one."""

_RAYS = 2048
_GRAZING = 0.08
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
        sine, cosine = np.sin(self.heading), np.cos(self.heading)
        # Of the camera: x right, y down, z forward.
        return sampled(self.pixels, np.stack([x * cosine + z * sine, -y, x * sine - z * cosine], 1))

    def worth(self, points: FloatArray, normal: FloatArray) -> FloatArray:
        """How well it shows points of a surface: the solid angle of a square metre there.

        Args:
            points: (N, 3) model frame.
            normal: (3,) of the surface, unit, towards where it is seen from.

        Returns:
            (N,) sr, 0 where it is too grazing, where something stands between over the floor, and
            in the cone below the camera.
        """
        ray = points - self.place
        distance = np.linalg.norm(ray, axis=1)
        facing = -(ray @ normal) / distance
        depression = np.degrees(np.arcsin(np.clip(-ray[:, 1] / distance, -1, 1)))
        first, last = NADIR_DEG
        clear = np.clip((last - depression) / (last - first), 0.0, 1.0) ** _UNCLEAR
        shown = (facing > _GRAZING) & self._sees(ray)
        return np.asarray(np.where(shown, clear * facing / distance**2, 0.0))

    def _sees(self, ray: FloatArray) -> BoolArray:
        """(N,) whether nothing stands in the way of (N, 3) rays to their ends, over the floor."""
        x, _, z = ray.T
        heading = np.rint(np.arctan2(x, -z) / (2 * np.pi) * _RAYS).astype(np.intp) % _RAYS
        return np.asarray(np.hypot(x, z) <= self.reach[heading] * (1 + _SLACK_SHARE) + _SLACK_M)


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
