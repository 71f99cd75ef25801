"""Whether the textured model, rendered from the cameras' places, looks as the panoramas do."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from panoplan.bench.estimate import metric_plan, true_poses
from panoplan.config import Config
from panoplan.errors import InputError, MissingExtraError
from panoplan.exporters.export import TEXEL_M
from panoplan.exporters.model.glb import plan_glb
from panoplan.exporters.model.photos import NADIR_DEG, Photo
from panoplan.exporters.model.surfaces import Surface, plan_surfaces
from panoplan.exporters.model.texture import pictures, read_photos
from panoplan.formats.atomic import make_folder, write_bytes
from panoplan.formats.depth import read_depth
from panoplan.formats.panoramas import find_panoramas
from panoplan.geometry.sphere import column_heading, rays
from panoplan.pipeline import Progress
from panoplan.simulate.render.cast import ray_caster
from panoplan.simulate.render.record import DEPTHS
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.plan import FloorPlan

_POSES = 5
_WIDTH = 512
_DEPTH_M = 0.1
"""Where the model lies farther from what is truly there, it cannot show it."""


def measure(
    folder: Path, config: Config, progress: Progress, shown: Path | None = None
) -> dict[str, Any]:
    """Renders the model of a scene from five of its cameras and compares it with their photos.

    Left out are the cone below the camera, where tripod or hand may be, and, where the scene has
    the depth of its images, pixels whose true depth differs from the model's by more than 10 cm.

    Args:
        folder: a scene with trajectory_gt.tum, predicted layouts and images; depth/ID.png as of a
            rendered walk where it is known.
        config: settings of the plan.
        progress: called with surfaces textured and in all.
        shown: where to write photo and rendering, one above the other; None for nowhere.

    Returns:
        Bytes of the GLB and, for each of the cameras and over all of them, the peak signal to
        noise ratio in dB with all photos in the texture, and without those five.

    Raises:
        InputError: the folder is not complete; MissingExtraError: trimesh is not installed.
    """
    scene = true_poses(folder)
    plan = metric_plan(scene, config)
    photos = read_photos(plan, find_panoramas(folder, [pose.id for pose in plan.trajectory]))
    if len(photos) <= _POSES:
        raise InputError(folder, f"{len(photos)} images in rooms", f"more than {_POSES}")
    chosen = [photos[k] for k in np.linspace(0, len(photos) - 1, _POSES).round().astype(int)]
    others = [photo for photo in photos if photo not in chosen]
    surfaces = plan_surfaces(plan)
    told = {photo.id: _true_depth(folder, photo.id) for photo in chosen}
    figures: dict[str, Any] = {
        "scene": folder.name,
        "photos": len(photos),
        "true_depth": all(depth is not None for depth in told.values()),
    }
    for name, used in (("all_photos", photos), ("without_the_five", others)):
        data = _glb(plan, surfaces, used, progress)
        model = Model.of(data)
        rows, errors = [], []
        for photo in chosen:
            rendering = model.rendered(photo)
            true = _small(photo.pixels)
            counted = rendering.counted(told[photo.id])
            error = (rendering.colours - true)[counted]
            errors.append(error)
            rows.append(
                {"id": photo.id, "psnr_db": psnr(error), "pixels_share": float(counted.mean())}
            )
            if shown is not None:
                _show(shown / f"{folder.name}_{name}_{photo.id}.png", true, rendering, counted)
        figures[name] = {
            "glb_bytes": len(data),
            "psnr_db": psnr(np.concatenate(errors)),
            "psnr_db_worst": min(row["psnr_db"] for row in rows),
            "cameras": rows,
        }
    return figures


def psnr(error: FloatArray) -> float:
    """Peak signal to noise ratio of errors of colours 0-255, dB."""
    return float(10 * np.log10(255**2 / np.mean(error**2)))


def _glb(
    plan: FloorPlan, surfaces: Sequence[Surface], photos: Sequence[Photo], progress: Progress
) -> bytes:
    return plan_glb(plan, surfaces, pictures(surfaces, photos, TEXEL_M, progress))


@dataclass(frozen=True, eq=False)
class Rendering:
    """What a camera would see of a model.

    Attributes:
        colours: (H, W, 3) 0-255.
        depth_m: (H, W) along the ray, infinite where nothing is.
    """

    colours: FloatArray
    depth_m: FloatArray

    def counted(self, true_m: FloatArray | None) -> BoolArray:
        """(H, W) pixels to be compared: of the model, above the tripod, at their true depth."""
        height, width = self.depth_m.shape
        low = np.pi * (np.arange(height) + 0.5) / height - np.pi / 2 > np.deg2rad(NADIR_DEG[0])
        kept = np.isfinite(self.depth_m) & ~low[:, None]
        if true_m is None:
            return np.asarray(kept)
        rows = ((np.arange(height) + 0.5) / height * true_m.shape[0]).astype(int)
        columns = ((np.arange(width) + 0.5) / width * true_m.shape[1]).astype(int)
        with np.errstate(invalid="ignore"):
            off = np.abs(true_m[np.ix_(rows, columns)] - self.depth_m)
        return np.asarray(kept & (off <= _DEPTH_M))


@dataclass(frozen=True, eq=False)
class Model:
    """A textured model as read from a GLB.

    Attributes:
        triangles: (T, 3, 3) corners, metres, y up.
        uv: (T, 3, 2) texture coordinates, from the lower left corner.
        picture: (T,) index of each one's picture.
        pictures: (H, W, 3) each; of one pixel where a triangle is of one colour.
    """

    triangles: FloatArray
    uv: FloatArray
    picture: NDArray[np.intp]
    pictures: tuple[NDArray[np.uint8], ...]

    @staticmethod
    def of(data: bytes) -> Model:
        """Reads a GLB, which another library parses.

        Raises:
            MissingExtraError: trimesh is not installed.
        """
        try:
            import trimesh
        except ImportError:
            raise MissingExtraError("bench model", "trimesh", "export") from None
        scene = trimesh.load_scene(io.BytesIO(data), file_type="glb")
        triangles, uv, index = [], [], []
        images: list[NDArray[np.uint8]] = []
        for mesh in scene.geometry.values():
            material = mesh.visual.material
            if material.baseColorTexture is None:
                image = np.asarray(material.baseColorFactor[:3], dtype=np.uint8).reshape(1, 1, 3)
                corners = np.zeros((len(mesh.faces), 3, 2))
            else:
                image = np.asarray(material.baseColorTexture.convert("RGB"))
                corners = mesh.visual.uv[mesh.faces]
            triangles.append(mesh.triangles)
            uv.append(corners)
            index.append(np.full(len(mesh.faces), len(images)))
            images.append(image)
        return Model(
            np.concatenate(triangles), np.concatenate(uv), np.concatenate(index), tuple(images)
        )

    def rendered(self, photo: Photo, width: int = _WIDTH) -> Rendering:
        """What a photo's camera would see of the model.

        Args:
            photo: only its place and heading count.
            width: columns; half as many rows.
        """
        height = width // 2
        elevation = np.pi / 2 - np.pi * (np.arange(height) + 0.5) / height
        heading = column_heading(np.arange(width, dtype=np.float64), width) + photo.heading
        # y up and -z ahead, where the camera has y down and z ahead.
        seen = rays(np.repeat(elevation, width), np.tile(heading, height)) * [1, -1, -1]
        directions = seen.astype(np.float32)
        origins = np.broadcast_to(photo.place, seen.shape).astype(np.float32)
        caster = ray_caster(self.triangles.astype(np.float32))
        hits = caster.first(origins, directions)
        met = hits.triangle >= 0
        triangle, depth = hits.triangle[met], hits.distance.astype(np.float64)
        points = photo.place + depth[met, None] * seen[met]
        colours = np.zeros((len(seen), 3))
        colours[met] = self._colours(triangle, points)
        return Rendering(colours.reshape(height, width, 3), depth.reshape(height, width))

    def _colours(self, triangle: NDArray[np.integer], points: FloatArray) -> FloatArray:
        """(N, 3) colours of (N, 3) points on (N,) triangles: the nearest texel."""
        a, b, c = np.moveaxis(self.triangles[triangle], 1, 0)
        area = np.cross(b - a, c - a)
        scale = np.maximum((area * area).sum(axis=1), 1e-18)
        v = (np.cross(points - a, c - a) * area).sum(axis=1) / scale
        w = (np.cross(b - a, points - a) * area).sum(axis=1) / scale
        shares = np.stack([1 - v - w, v, w], axis=1)
        uv = (self.uv[triangle] * shares[:, :, None]).sum(axis=1)
        colours = np.empty((len(points), 3))
        for number in np.unique(self.picture[triangle]):
            own, image = self.picture[triangle] == number, self.pictures[number]
            rows, columns = image.shape[:2]
            x = np.clip((uv[own, 0] * columns).astype(int), 0, columns - 1)
            y = np.clip(((1 - uv[own, 1]) * rows).astype(int), 0, rows - 1)
            colours[own] = image[y, x]
        return colours


def _true_depth(folder: Path, name: str) -> FloatArray | None:
    path = folder / DEPTHS / f"{name}.png"
    return read_depth(path) if path.is_file() else None


def _small(pixels: NDArray[np.uint8]) -> FloatArray:
    image = Image.fromarray(pixels).resize((_WIDTH, _WIDTH // 2), Image.Resampling.BOX)
    return np.asarray(image, dtype=np.float64)


def _show(path: Path, true: FloatArray, rendering: Rendering, counted: BoolArray) -> None:
    """Photo, rendering, and the photo where it is compared."""
    masked = np.where(counted[..., None], true, 0.0)
    picture = np.concatenate([true, rendering.colours, masked]).astype(np.uint8)
    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, "PNG")
    make_folder(path.parent)
    write_bytes(path, stream.getvalue())
