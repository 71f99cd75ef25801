"""Rays and the surfaces they meet."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, Protocol

import numpy as np

from panoplan.errors import MissingExtraError
from panoplan.simulate.render import bvh
from panoplan.simulate.render.materials import Float32Array
from panoplan.simulate.render.mesh import Int32Array
from panoplan.types.arrays import BoolArray

Backend = Literal["auto", "embree", "numba"]


class Hits(NamedTuple):
    """What each of N rays meets first.

    Attributes:
        triangle: (N,) its index, −1 where there is none.
        distance: (N,) along the ray, in lengths of its direction; infinite where there is none.
    """

    triangle: Int32Array
    distance: Float32Array


class RayCaster(Protocol):
    """Casts rays at the triangles of a mesh."""

    def first(self, origins: Float32Array, directions: Float32Array) -> Hits:
        """The first triangle that each ray meets.

        Args:
            origins: (N, 3).
            directions: (N, 3), any length but 0.
        """
        ...

    def blocked(
        self, origins: Float32Array, directions: Float32Array, reach: Float32Array
    ) -> BoolArray:
        """Whether anything lies on each ray nearer than `reach` (N,) lengths of its direction."""
        ...


def ray_caster(triangles: Float32Array, backend: Backend = "auto") -> RayCaster:
    """A caster of rays.

    Args:
        triangles: (T, 3, 3) corners.
        backend: "embree", or "numba", which takes about five times as long; "auto" takes Embree
            where embreex is installed.

    Raises:
        MissingExtraError: Embree was asked for and embreex is not installed.
    """
    if backend == "numba":
        return _Numba(triangles)
    try:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene
    except ImportError:
        if backend == "auto":
            return _Numba(triangles)
        raise MissingExtraError("casting rays by Embree", "embreex", "render") from None
    scene = EmbreeScene()
    return _Embree(scene, TriangleMesh(scene, np.ascontiguousarray(triangles, dtype=np.float32)))


class _Embree:
    def __init__(self, scene: Any, mesh: Any) -> None:
        # The scene does not keep its mesh alive.
        self._scene, self._mesh = scene, mesh

    def first(self, origins: Float32Array, directions: Float32Array) -> Hits:
        found = self._scene.run(origins, directions, query="INTERSECT", output=True)
        triangle = found["primID"]
        return Hits(triangle, np.where(triangle >= 0, found["tfar"], np.float32(np.inf)))

    def blocked(
        self, origins: Float32Array, directions: Float32Array, reach: Float32Array
    ) -> BoolArray:
        found = self._scene.run(origins, directions, dists=reach, query="OCCLUDED")
        return np.asarray(found >= 0)


class _Numba:
    def __init__(self, triangles: Float32Array) -> None:
        self._tree = bvh.grow(triangles)

    def first(self, origins: Float32Array, directions: Float32Array) -> Hits:
        reach = np.full(len(origins), np.inf, dtype=np.float32)
        return Hits(*bvh.first_hits(self._tree, origins, directions, reach, False))

    def blocked(
        self, origins: Float32Array, directions: Float32Array, reach: Float32Array
    ) -> BoolArray:
        triangle, _ = bvh.first_hits(self._tree, origins, directions, reach, True)
        return np.asarray(triangle >= 0)
