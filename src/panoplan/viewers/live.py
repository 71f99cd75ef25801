"""A run as it goes, shown by Rerun."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from panoplan.errors import InputError, MissingExtraError
from panoplan.geometry.polygons import signed_area
from panoplan.geometry.sphere import column_heading
from panoplan.types.arrays import FloatArray
from panoplan.types.events import (
    Event,
    RoomOpened,
    RoomShaped,
    RoomsJoined,
    RoomsRegrouped,
    ScaleFrozen,
)
from panoplan.types.keyframe import Keyframe
from panoplan.types.plan import FloorPlan, PlanPose

_NEWS = (RoomOpened, RoomShaped, RoomsJoined, RoomsRegrouped, ScaleFrozen)
_EVERY = 10
_CELL = 0.05
_FARTHEST = 6.0
_LONGEST_NAME = 60


class LiveView:
    """Shows image and boundary, the growing density of all boundaries, rooms, walls and path.

    Args:
        recording: a .rrd file to write instead of opening the viewer.
        images: panorama by keyframe, as many as there are.

    Raises:
        MissingExtraError: rerun is not installed; InputError: the file cannot be written.
    """

    def __init__(self, recording: Path | None, images: Mapping[str, Path]) -> None:
        try:
            import rerun
            import rerun.blueprint as views
        except ImportError:
            raise MissingExtraError("the live view", "rerun-sdk", "live") from None
        self._rerun = rerun
        self._images = images
        self._layouts: dict[str, FloatArray] = {}
        self._stream = rerun.RecordingStream("panoplan")
        plan = views.Spatial2DView(origin="plan", name="Plan")
        density = views.Spatial2DView(origin="density", name="Density of boundaries")
        image = views.Spatial2DView(origin="image", name="Image and boundary")
        layout = views.Vertical(image, views.Horizontal(plan, density), row_shares=[1, 2])
        blueprint = views.Blueprint(layout, collapse_panels=True)
        if recording is None:
            self._stream.spawn(default_blueprint=blueprint)
            return
        if not recording.parent.is_dir() or recording.is_dir():
            raise InputError(recording, "no place for a file", "FILE.rrd in a folder that exists")
        self._stream.save(recording, default_blueprint=blueprint)

    def update(
        self,
        number: int,
        keyframe: Keyframe,
        events: Sequence[Event],
        plan: Callable[[], FloorPlan],
    ) -> None:
        """Shows a keyframe and, where something came of it, the plan.

        Args:
            number: of the keyframe in the walk.
            keyframe: that was taken in.
            events: what came of it.
            plan: gives the plan so far.
        """
        self._stream.set_time("keyframe", sequence=number)
        if keyframe.layout is not None:
            self._layouts[keyframe.id] = np.asarray(keyframe.layout.floor_boundary)
        self._show_image(keyframe)
        if number % _EVERY == 0 or any(isinstance(event, _NEWS) for event in events):
            self.show_plan(plan())

    def show_plan(self, plan: FloorPlan) -> None:
        """Shows a plan: rooms with names and areas, walls, doors, path, density."""
        rr = self._rerun
        shaped = [(room, room.polygon) for room in plan.rooms if room.polygon is not None]
        unit = "m²" if plan.unit == "m" else "ch²"
        labels = [
            f"{room.name[:_LONGEST_NAME]}  {abs(signed_area(ring)):.1f} {unit}"
            for room, ring in shaped
        ]
        rings = [_drawn(np.concatenate([ring, ring[:1]])) for _, ring in shaped]
        self._lines("plan/rooms", rings, (43, 48, 56), 0.03)
        self._stream.log(
            "plan/names",
            rr.Points2D(
                [_drawn(_inside(ring)[None])[0] for _, ring in shaped], labels=labels, radii=0.01
            ),
        )
        walls = [_drawn(np.array([w.a, w.b])) for room, _ in shaped for w in room.walls]
        self._lines("plan/walls", walls, (43, 48, 56), 0.05)
        doors = [_drawn(door.segment) for door in plan.doors]
        self._lines("plan/doors", doors, (154, 107, 63), 0.07)
        if plan.trajectory:
            path = _drawn(np.array([pose.position for pose in plan.trajectory]))
            self._lines("plan/path", [path], (37, 99, 168), 0.02)
        self._show_density(plan)

    def close(self) -> None:
        """Writes what is not written yet."""
        self._stream.flush()
        self._stream.disconnect()

    def _lines(
        self, where: str, strips: Sequence[FloatArray], colour: tuple[int, ...], radius: float
    ) -> None:
        self._stream.log(where, self._rerun.LineStrips2D(strips, colors=[colour], radii=radius))

    def _show_image(self, keyframe: Keyframe) -> None:
        rr = self._rerun
        boundary = self._layouts.get(keyframe.id)
        path = self._images.get(keyframe.id)
        width, height = 1024, 512
        if path is not None:
            from PIL import Image

            with Image.open(path) as image:
                width, height = image.size
            self._stream.log("image", rr.EncodedImage(path=path))
        if boundary is not None:
            column = (np.arange(len(boundary)) + 0.5) / len(boundary) * width
            row = (0.5 - boundary / np.pi) * height
            line = np.stack([column, row], axis=1)[np.isfinite(boundary)]
            self._lines("image/boundary", [line], (214, 51, 108), 2.0)

    def _show_density(self, plan: FloorPlan) -> None:
        """How many boundary points lie in each cell, in shades of their logarithm."""
        if plan.scale.ch_per_su is None:
            # No camera has a place yet.
            return
        height = plan.camera_height_m or 1.0
        points = [
            _boundary_points(pose, self._layouts[pose.id], height)
            for pose in plan.trajectory
            if pose.id in self._layouts
        ]
        if not points:
            return
        cell = _CELL * height
        cells = np.floor(_drawn(np.concatenate(points)) / cell).astype(int)
        cells -= cells.min(axis=0)
        count = np.zeros(cells.max(axis=0)[::-1] + 1)
        np.add.at(count, (cells[:, 1], cells[:, 0]), 1.0)
        shade = np.log1p(count) / np.log1p(count.max())
        self._stream.log("density", self._rerun.Image((255 * shade).astype(np.uint8)))


def _boundary_points(pose: PlanPose, boundary: FloatArray, height: float) -> FloatArray:
    """(N, 2) where a floor boundary lies in the plan, out to a few camera heights."""
    with np.errstate(invalid="ignore", divide="ignore"):
        distance = height / np.tan(-boundary)
    near = (boundary < 0) & (distance < _FARTHEST * height)
    heading = (
        column_heading(np.arange(len(boundary), dtype=float), len(boundary))[near] + pose.heading
    )
    direction = np.stack([np.sin(heading), np.cos(heading)], axis=1)
    return np.asarray(pose.position + distance[near, None] * direction)


def _inside(ring: FloatArray) -> FloatArray:
    area: Any = shapely.make_valid(shapely.Polygon(ring))
    return np.asarray(shapely.get_coordinates(area.representative_point())[0])


def _drawn(points: FloatArray) -> FloatArray:
    """Points of the plan with the second axis down, as Rerun draws."""
    return np.asarray(points * (1.0, -1.0))
