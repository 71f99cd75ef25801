"""A building ready to be photographed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely

from panoplan.geometry.sphere import column_heading, rays
from panoplan.simulate.buildings import Building
from panoplan.simulate.render.cast import ray_caster
from panoplan.simulate.render.furnish import Furniture, draw_uses, furnish
from panoplan.simulate.render.lamp import Lamp, Sun
from panoplan.simulate.render.light import BakeQuality, LightMap, bake
from panoplan.simulate.render.looks import draw_look
from panoplan.simulate.render.materials import Float32Array
from panoplan.simulate.render.mesh import Mesh, MeshBuilder
from panoplan.simulate.render.shade import radiance
from panoplan.simulate.render.shell import Shell, raise_shell
from panoplan.types.arrays import FloatArray


@dataclass(frozen=True)
class Quality:
    """How well a scene is rendered.

    Attributes:
        bake: of its light.
        samples: rays along each side of a pixel.
    """

    bake: BakeQuality
    samples: int


PREVIEW = Quality(BakeQuality(texel_m=0.4, source_rays=3, gather_rays=12), samples=1)
STILL = Quality(BakeQuality(texel_m=0.12, source_rays=8, gather_rays=48), samples=2)
QUALITIES = {"preview": PREVIEW, "still": STILL}


@dataclass(frozen=True, eq=False)
class Panorama:
    """An equirectangular picture before the camera's own effects.

    Attributes:
        radiance: (H, W, 3) linear, 1 for a white wall in good light.
        distance_m: (H, W) along each ray, infinite where nothing is.
    """

    radiance: Float32Array
    distance_m: Float32Array


class Scene:
    """A furnished and lit building.

    Args:
        building: what is rendered.
        seed: of its looks, furniture and light.
        quality: how well.
        furnished: 0 for a home without loose furniture, 1 for a full one; drawn where None.
        clear: (N, 2) plan: where nothing may stand and doors are open, as people walk there.
        sunny: whether the sun may shine in.
        bare: indices of the rooms that are empty and of an even white.

    Raises:
        MissingExtraError: the `render` extra is not installed.
    """

    def __init__(
        self,
        building: Building,
        seed: int | np.random.SeedSequence,
        quality: Quality = PREVIEW,
        *,
        furnished: float | None = None,
        clear: FloatArray | None = None,
        sunny: bool = True,
        bare: frozenset[int] = frozenset(),
    ) -> None:
        root = np.random.SeedSequence(seed) if isinstance(seed, int) else seed
        look_rng, shell_rng, things_rng, light_rng = map(np.random.default_rng, root.spawn(4))
        self.building, self.quality = building, quality
        look = draw_look(look_rng)
        density = _density(things_rng) if furnished is None else furnished
        free = np.empty((0, 2)) if clear is None else clear
        uses = draw_uses(building, things_rng)
        wet = frozenset(k for k, use in enumerate(uses) if use in ("kitchen", "bath"))
        mesh = MeshBuilder()
        self.shell: Shell = raise_shell(building, look, wet, mesh, shell_rng, clear, bare)
        self.furniture: Furniture = furnish(
            building, uses, self.shell.leaves, look, density, free, mesh, things_rng, bare
        )
        self.mesh: Mesh = mesh.build()
        self.caster = ray_caster(self.mesh.triangles)
        sun = _sun(light_rng)
        self.sun = sun if sunny else None
        self._world = int(light_rng.integers(2**20))
        self.light: LightMap = bake(
            self.mesh,
            self.caster,
            self.shell.panes,
            look.outside.emission * np.array([0.9, 0.95, 1.0]),
            _lit(self.furniture.lamps, light_rng),
            self.sun,
            quality.bake,
            light_rng,
        )

    def panorama(
        self, camera: FloatArray, scene_from_cam: FloatArray, width: int = 1024
    ) -> Panorama:
        """What a camera sees.

        Args:
            camera: (3,) scene frame: plan x, −height above the floor, plan z.
            scene_from_cam: (3, 3) rotation.
            width: number of columns; half as many rows.

        Returns:
            The picture.
        """
        n = self.quality.samples
        height = width // 2
        directions = _grid(height * n, width * n) @ scene_from_cam.T.astype(np.float32)
        colour, distance = radiance(
            self.mesh,
            self.caster,
            self.light,
            self.sun,
            np.asarray(camera, dtype=np.float32),
            directions,
            2 * np.pi / (width * n),
            self._world,
        )
        colour = colour.reshape(height, n, width, n, 3)
        # The middle of a pixel has a distance of its own; a mean of several lies on nothing.
        middle = distance.reshape(height, n, width, n)[:, n // 2, :, n // 2]
        mean = np.minimum(colour, 8.0).mean(axis=(1, 3)) if n > 1 else colour[:, 0, :, 0]
        return Panorama(mean, middle)

    def stands_free(self, position: FloatArray, clearance_m: float) -> bool:
        """Whether a camera at a plan position (2,) is no nearer than that to any furniture."""
        point = shapely.Point(position)
        return all(piece.distance(point) > clearance_m for piece in self.furniture.solid)


@lru_cache(maxsize=2)
def _grid(height: int, width: int) -> Float32Array:
    """(height · width, 3) unit rays of all pixels in the camera frame."""
    elevation = np.pi / 2 - np.pi * (np.arange(height) + 0.5) / height
    heading = column_heading(np.arange(width, dtype=np.float64), width)
    grid = rays(np.repeat(elevation, width), np.tile(heading, height)).astype(np.float32)
    grid.setflags(write=False)
    return grid


def _density(rng: np.random.Generator) -> float:
    return 0.0 if rng.random() < 0.4 else float(rng.uniform(0.2, 1.0))


def _sun(rng: np.random.Generator) -> Sun | None:
    if rng.random() < 0.6:
        return None
    heading, height = rng.uniform(0, 2 * np.pi), np.deg2rad(rng.uniform(15, 60))
    towards = np.array(
        [np.cos(height) * np.cos(heading), -np.sin(height), np.cos(height) * np.sin(heading)]
    )
    return Sun(towards, rng.uniform(2.0, 6.0) * np.array([1.0, 0.93, 0.82]))


def _lit(lamps: tuple[Lamp, ...], rng: np.random.Generator) -> tuple[Lamp, ...]:
    """The lamps that are switched on."""
    share = rng.choice([0.0, 0.6, 1.0], p=[0.15, 0.25, 0.6])
    return tuple(lamp for lamp in lamps if rng.random() < share)
