"""What is truly to be seen in a rendered panorama, as a layout network should tell it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.geometry.sphere import column_heading
from panoplan.simulate.render.scene import Scene
from panoplan.simulate.spans import column_runs
from panoplan.simulate.views import Surface, View, ViewCaster, tilted
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.layout import Layout, Spans

_FAR_M = 100.0
_ON_WALL_M = 1e-3


@dataclass(frozen=True, eq=False)
class Labels:
    """The truth of one panorama.

    Attributes:
        closed: boundaries of the camera's room with all doors and openings closed, its corners,
            and where doors (also ones that lead nowhere), openings and windows are.
        through: the floor boundary that is seen through open doors and openings; the walls of
            the room behind end it, its own doors are closed. Elsewhere as `closed`.
    """

    closed: Layout
    through: Layout


class Labeller:
    """Labels panoramas of one scene.

    Args:
        scene: what is photographed.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene, self._caster = scene, ViewCaster(scene.building)

    def labels(
        self,
        position: FloatArray,
        heading: float,
        camera_height_m: float,
        *,
        width: int = 1024,
        level_from_cam: FloatArray | None = None,
        room: int | None = None,
    ) -> Labels:
        """The truth of one panorama.

        Args:
            position: (2,) camera, plan.
            heading: of its z axis, rad from the plan's second axis towards its first.
            camera_height_m: above the floor.
            width: number of columns.
            level_from_cam: (3, 3) the camera's tilt; level where None.
            room: whose boundary is told; where None, of the room the camera stands in, in a
                doorway of the one it looks into.

        Raises:
            InputError: the camera stands in no room and no passage.
        """
        building = self._scene.building
        view = self._caster.view(position, heading, camera_height_m, width=width, room=room)
        leaks = {
            k: _FAR_M for k, _ in building.neighbours(view.room) if k not in self._scene.shell.shut
        }
        beyond = self._caster.view(
            position, heading, camera_height_m, width=width, leaks=leaks, room=view.room
        )
        closed = Layout(
            view.floor_boundary,
            view.ceiling_boundary,
            view.corners,
            spans=self._spans(view, position, heading),
        )
        through = Layout(beyond.floor_boundary)
        if level_from_cam is None:
            return Labels(closed, through)
        return Labels(tilted(closed, level_from_cam), tilted(through, level_from_cam))

    def _spans(self, view: View, position: FloatArray, heading: float) -> Spans:
        """Where the room's doors, openings and windows are seen."""
        width = len(view.range_m)
        angle = heading + column_heading(np.arange(width, dtype=np.float64), width)
        rays = np.stack([np.sin(angle), np.cos(angle)], axis=1)
        points = position + view.closed_range_m[:, None] * rays
        surface, group = view.closed_surface.copy(), view.passage.copy()
        furniture = self._scene.furniture
        for k, (room, base) in enumerate(zip(furniture.door_rooms, furniture.doors, strict=True)):
            if room == view.room:
                there = _on(points, base) & (surface == Surface.WALL)
                surface[there], group[there] = Surface.DOOR, -2 - k
        return Spans(
            *(
                np.array(column_runs(surface == kind, group), dtype=np.float64) % width
                for kind in (Surface.DOOR, Surface.OPENING, Surface.WINDOW)
            )
        )


def _on(points: FloatArray, segment: FloatArray) -> BoolArray:
    """Which of the points lie on a segment."""
    length = float(np.hypot(*(segment[1] - segment[0])))
    along = (segment[1] - segment[0]) / length
    offset = points - segment[0]
    at, off = offset @ along, offset @ np.array([-along[1], along[0]])
    return np.asarray((at >= 0) & (at <= length) & (np.abs(off) < _ON_WALL_M))
