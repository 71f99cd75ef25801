"""Pictures of surfaces from the panoramas that see them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panoplan.exporters.heights import elevations
from panoplan.exporters.model.blend import SurfaceView, blended, filled
from panoplan.exporters.model.photos import Photo, free_space, reach_of
from panoplan.exporters.model.surfaces import Surface, in_model
from panoplan.exporters.storeys import metric_storeys
from panoplan.formats.image import read_panorama
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import FloorPlan, PlanPose

EDGE = 2
"""Texels beyond the edges of a surface, so that no colour bleeds in."""

SMALLEST_PX = (32, 16)
"""Of a panorama that is shown; one that a network looks at has to be larger."""

_PHOTOS_BYTES = 1.5 * 2**30
_THREADS = 4
_VIEWS = 4
_FARTHEST_M = 8.0
_AFAR = 1e-3
_COARSE = 6


@dataclass(frozen=True, eq=False)
class Picture:
    """A surface's picture.

    Attributes:
        pixels: (H, W, 3) RGB, first row at the top; `EDGE` texels around the region's bounds.
        low: (2,) least (s, t) of the region.
        size: (2,) of the region along s and t, metres.
    """

    pixels: NDArray[np.uint8]
    low: FloatArray
    size: FloatArray


def read_photos(
    plan: FloorPlan, files: Mapping[str, Path], widest: int = 4096
) -> tuple[Photo, ...]:
    """The panoramas of cameras that stand in a room or on the way between two.

    Args:
        plan: metric, its camera height known.
        files: image by keyframe.
        widest: px, of each; less where all together would be more than 1.5 GiB.

    Raises:
        InputError: not metric, or an image that cannot be used.
    """
    floors = metric_storeys(plan)
    rises = elevations(floors)
    height = plan.camera_height_m or 0.0
    # Three bytes a pixel, half as many rows as columns.
    widest = min(widest, int(np.sqrt(_PHOTOS_BYTES / 1.5 / max(len(files), 1))))
    found: list[tuple[PlanPose, FloatArray, FloatArray]] = []
    for floor in floors:
        free = free_space(floor)
        for camera in floor.cameras:
            reach = reach_of(camera, free) if camera.id in files else None
            if reach is not None:
                place = in_model(camera.position[None], rises[floor.level] + height)[0]
                found.append((camera, place, reach))

    def pixels_of(camera: PlanPose) -> NDArray[np.uint8]:
        return read_panorama(files[camera.id], widest=widest, smallest=SMALLEST_PX)

    with ThreadPoolExecutor(_THREADS) as pool:
        pixels = pool.map(pixels_of, (camera for camera, _, _ in found))
        return tuple(
            Photo(camera.id, camera.room, place, camera.heading, picture, reach)
            for (camera, place, reach), picture in zip(found, pixels, strict=True)
        )


def pictures(
    surfaces: Sequence[Surface],
    photos: Sequence[Photo],
    texel_m: float,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, Picture]:
    """Pictures of those surfaces that a photo shows, by their id.

    Of each texel those photos count that see it from before the surface with nothing between,
    outside the cone below the camera; the nearer and the more frontal, the more.

    Args:
        surfaces: of the model.
        photos: all.
        texel_m: metres a texel.
        progress: called with (surfaces done, surfaces in all).
    """
    made = {}
    # Nearly all of the work lets threads run beside one another.
    with ThreadPoolExecutor(_THREADS) as pool:
        found = pool.map(lambda surface: _picture(surface, photos, texel_m), surfaces)
        for number, (surface, picture) in enumerate(zip(surfaces, found, strict=True)):
            if picture is not None:
                made[surface.id] = picture
            progress(number + 1, len(surfaces))
    return made


def _picture(surface: Surface, photos: Sequence[Photo], texel_m: float) -> Picture | None:
    low, high = np.array(surface.region.bounds).reshape(2, 2)
    columns, rows = np.maximum(np.ceil((high - low) / texel_m), 1).astype(int)
    size = high - low
    s = low[0] + size[0] * np.clip((np.arange(columns + 2 * EDGE) - EDGE + 0.5) / columns, 0, 1)
    t = low[1] + size[1] * np.clip((np.arange(rows + 2 * EDGE) - EDGE + 0.5) / rows, 0, 1)
    grid = np.stack(np.meshgrid(s, t[::-1]), axis=-1)
    shape = grid.shape[:2]
    chosen = _best(surface, _near(surface, photos), grid[::_COARSE, ::_COARSE].reshape(-1, 2))
    points = surface.in_space(grid.reshape(-1, 2))
    views = [_view(surface, photo, points, shape) for photo in chosen]
    if not any(view.weights.any() for view in views):
        return None
    colours, seen = blended(views)
    pixels = np.rint(filled(colours, seen)).astype(np.uint8)
    return Picture(pixels, low, size)


def _best(surface: Surface, photos: Sequence[Photo], grid: FloatArray) -> list[Photo]:
    """The few photos that show most of (N, 2) points of a surface best."""
    points = surface.in_space(grid)
    worth = [float(np.sqrt(_weights(surface, photo, points)).sum()) for photo in photos]
    order = np.argsort(worth, kind="stable")[::-1][:_VIEWS]
    return [photos[k] for k in order if worth[k] > 0]


def _near(surface: Surface, photos: Sequence[Photo]) -> list[Photo]:
    """Photos before the surface and not too far from it."""
    bounds = np.array(surface.region.bounds).reshape(2, 2)
    corners = surface.in_space(np.array(np.meshgrid(*bounds.T)).reshape(2, -1).T)
    low, high = corners.min(axis=0), corners.max(axis=0)
    found = []
    for photo in photos:
        before = float((photo.place - surface.origin) @ surface.normal)
        away = photo.place - np.clip(photo.place, low, high)
        if before > 0.02 and float(np.linalg.norm(away)) < _FARTHEST_M:
            found.append(photo)
    return found


def _weights(surface: Surface, photo: Photo, points: FloatArray) -> FloatArray:
    """(N,) how well a photo shows points of a surface: the solid angle of a texel, 0 if not."""
    # Other rooms' cameras look in through doors: they help where its own see nothing.
    trust = 1.0 if photo.room == surface.room or surface.kind == "reveal" else _AFAR
    return trust * photo.worth(points, surface.normal)


def _view(
    surface: Surface, photo: Photo, points: FloatArray, shape: tuple[int, ...]
) -> SurfaceView:
    weights = _weights(surface, photo, points)
    shown = weights > 0
    colours = np.zeros((len(points), 3))
    colours[shown] = photo.sample(points[shown] - photo.place)
    return SurfaceView(colours.reshape(*shape, 3), weights.reshape(shape))
