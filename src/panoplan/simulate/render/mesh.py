"""Surfaces as flat patches of triangles.

Scene frame: metres, x and z those of the plan, y down, the floor at y = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from panoplan.simulate.render.materials import Float32Array, Material, packed
from panoplan.types.arrays import FloatArray

Int32Array = NDArray[np.int32]
Rectangle = tuple[float, float, float, float]
"""Low s, high s, low t, high t on a patch, metres."""
UP = np.array([0.0, -1.0, 0.0])


@dataclass(frozen=True, eq=False)
class Mesh:
    """All surfaces of a scene.

    A patch is flat; (s, t) are coordinates on it in metres from its origin, the lower corner of
    the rectangle around it.

    Attributes:
        triangles: (T, 3, 3) corners.
        patch: (T,) index of each triangle's patch.
        origin: (P, 3) of each patch.
        along: (P, 3) unit vector of s.
        across: (P, 3) unit vector of t.
        normal: (P, 3) unit vector out of the solid.
        size: (P, 2) extent along s and t.
        material: (P,) row of `materials`.
        materials: (M, FIELDS) as `packed` gives them.
        outlines: polygons in (s, t) of the patches that do not fill their rectangle, by patch.
    """

    triangles: Float32Array
    patch: Int32Array
    origin: Float32Array
    along: Float32Array
    across: Float32Array
    normal: Float32Array
    size: Float32Array
    material: Int32Array
    materials: Float32Array
    outlines: dict[int, FloatArray]


class MeshBuilder:
    """Collects patches."""

    def __init__(self) -> None:
        self._rows: dict[Material, int] = {}
        self._triangles: list[FloatArray] = []
        self._patch: list[int] = []
        self._frames: list[FloatArray] = []
        self._sizes: list[tuple[float, float]] = []
        self._materials: list[int] = []
        self._outlines: dict[int, FloatArray] = {}

    def rectangles(
        self,
        origin: FloatArray,
        along: FloatArray,
        across: FloatArray,
        normal: FloatArray,
        size: tuple[float, float],
        parts: Sequence[Rectangle],
        material: Material,
    ) -> None:
        """A patch made of rectangles: a wall with holes for its doors and windows.

        Args:
            origin: (3,) corner with s = t = 0.
            along: (3,) unit vector of s.
            across: (3,) unit vector of t, square to it.
            normal: (3,) unit vector out of the solid.
            size: extent of the whole along s and t.
            parts: what is solid.
            material: its look.
        """
        patch = self._begin(origin, along, across, normal, size, material)
        for low_s, high_s, low_t, high_t in parts:
            a, b = origin + low_s * along, origin + high_s * along
            low, high = low_t * across, high_t * across
            self._triangles += [np.array([a + low, b + low, b + high])]
            self._triangles += [np.array([a + low, b + high, a + high])]
            self._patch += [patch, patch]

    def quad(
        self,
        origin: FloatArray,
        along: FloatArray,
        across: FloatArray,
        outward: FloatArray,
        material: Material,
    ) -> None:
        """A rectangular patch; one without area is left out.

        Args:
            origin: (3,) corner.
            along: (3,) first side, as long as the rectangle.
            across: (3,) second side, square to it.
            outward: (3,) unit normal out of the solid.
            material: its look.
        """
        width, height = float(np.sqrt(along @ along)), float(np.sqrt(across @ across))
        if min(width, height) < 1e-4:
            return
        whole = (0.0, width, 0.0, height)
        self.rectangles(
            origin, along / width, across / height, outward, (width, height), [whole], material
        )

    def level(
        self, polygon: FloatArray, height: float, material: Material, *, facing_up: bool
    ) -> None:
        """A level patch: a floor or a ceiling; s runs along the polygon's longest edge.

        Args:
            polygon: (N, 2) plan, simple.
            height: above the floor.
            material: its look.
            facing_up: whether it is seen from above.
        """
        edges = np.roll(polygon, -1, axis=0) - polygon
        longest = edges[np.argmax(np.hypot(*edges.T))]
        axes = np.array([longest, [-longest[1], longest[0]]]) / np.hypot(*longest)
        local = polygon @ axes.T
        low = local.min(axis=0)
        width, depth = local.max(axis=0) - low
        origin, along, across = (np.array([p[0], 0.0, p[1]]) for p in (low @ axes, *axes))
        origin[1] = -height
        normal = UP if facing_up else -UP
        patch = self._begin(origin, along, across, normal, (float(width), float(depth)), material)
        self._outlines[patch] = local - low
        if len(polygon) == 4 and shapely.Polygon(polygon).convex_hull.area > 0:
            rings = [polygon[:3], polygon[[0, 2, 3]]] if _convex(polygon) else _triangles(polygon)
        else:
            rings = _triangles(polygon)
        for ring in rings:
            self._triangles += [np.stack([ring[:, 0], np.full(3, -height), ring[:, 1]], axis=1)]
            self._patch += [patch]

    def facet(self, corners: FloatArray, inside: FloatArray, material: Material) -> None:
        """A flat convex patch.

        Args:
            corners: (N, 3) in order.
            inside: (3,) a point of the solid behind it.
            material: its look; s runs along the first edge.
        """
        first = corners[1] - corners[0]
        turn = _cross(first, corners[-1] - corners[0])
        lengths = float(np.sqrt(first @ first)), float(np.sqrt(turn @ turn))
        if min(lengths) < 1e-9:
            return
        along, normal = first / lengths[0], turn / lengths[1]
        if normal @ (corners[0] - inside) < 0:
            normal = -normal
        across = _cross(turn / lengths[1], along)
        local = np.stack([corners @ along, corners @ across], axis=1)
        low = local.min(axis=0)
        origin = corners[0] + (low[0] - local[0, 0]) * along + (low[1] - local[0, 1]) * across
        width, height = local.max(axis=0) - low
        patch = self._begin(origin, along, across, normal, (float(width), float(height)), material)
        for k in range(1, len(corners) - 1):
            self._triangles += [corners[[0, k, k + 1]]]
            self._patch += [patch]

    def box(
        self,
        origin: FloatArray,
        along: FloatArray,
        inward: FloatArray,
        low: Sequence[float],
        high: Sequence[float],
        material: Material,
        *,
        front: Material | None = None,
        top: Material | None = None,
    ) -> None:
        """An upright box.

        Args:
            origin: (2,) plan, where its coordinates begin.
            along: (2,) unit vector of its first coordinate.
            inward: (2,) unit vector of its second, square to it.
            low: (3,) least first and second coordinate and height.
            high: (3,) greatest.
            material: its look.
            front: look of the side at the greatest second coordinate; `material` where None.
            top: look of its top; `material` where None.
        """
        a, b = np.array([along[0], 0.0, along[1]]), np.array([inward[0], 0.0, inward[1]])
        (x0, y0, z0), (x1, y1, z1) = low, high
        dx, dy, dz = (x1 - x0) * a, (y1 - y0) * b, (z1 - z0) * UP
        near = np.array([origin[0], 0.0, origin[1]]) + x0 * a + y0 * b + z0 * UP
        self.quad(near + dy, dx, dz, b, front or material)
        self.quad(near, dx, dz, -b, material)
        self.quad(near, dy, dz, -a, material)
        self.quad(near + dx, dy, dz, a, material)
        self.quad(near + dz, dx, dy, UP, top or material)
        if z0 > 0.02:
            self.quad(near, dx, dy, -UP, material)

    def prism(
        self,
        polygon: FloatArray,
        low: float,
        high: float,
        material: Material,
        *,
        shrink: float = 1.0,
        top: Material | None = None,
    ) -> None:
        """An upright prism, or a frustum.

        Args:
            polygon: (N, 2) plan, convex.
            low: height of its foot.
            high: height of its top.
            material: its look.
            shrink: the top's size by the foot's.
            top: look of its top; `material` where None.
        """
        centre = polygon.mean(axis=0)
        upper = centre + shrink * (polygon - centre)
        foot = np.stack([polygon[:, 0], np.full(len(polygon), -low), polygon[:, 1]], axis=1)
        head = np.stack([upper[:, 0], np.full(len(polygon), -high), upper[:, 1]], axis=1)
        inside = (foot.mean(axis=0) + head.mean(axis=0)) / 2
        self.facet(head, inside, top or material)
        if low > 0.02:
            self.facet(foot, inside, material)
        for k in range(len(polygon)):
            n = (k + 1) % len(polygon)
            self.facet(np.array([foot[k], foot[n], head[n], head[k]]), inside, material)

    def ball(self, centre: FloatArray, radii: Sequence[float], material: Material) -> None:
        """An ellipsoid of flat facets.

        Args:
            centre: (3,) scene frame.
            radii: (3,) along x, y and z.
            material: its look.
        """
        polar = np.linspace(0, np.pi, 6)[:, None]
        turn = np.linspace(0, 2 * np.pi, 9)[None]
        unit = np.stack(
            [np.sin(polar) * np.cos(turn), 0 * turn - np.cos(polar), np.sin(polar) * np.sin(turn)],
            axis=-1,
        )
        p = centre + unit * np.asarray(radii)
        for i in range(5):
            for j in range(8):
                ring = [p[i + 1, j], p[i + 1, j + 1], p[i, j + 1], p[i, j]]
                ring = ring[:3] if i == 0 else [ring[0], *ring[2:]] if i == 4 else ring
                self.facet(np.array(ring), centre, material)

    def build(self) -> Mesh:
        """The mesh of all that was added."""
        frames = np.array(self._frames, dtype=np.float32).reshape(-1, 4, 3)
        origin, along, across, normal = (np.ascontiguousarray(frames[:, k]) for k in range(4))
        return Mesh(
            triangles=np.array(self._triangles, dtype=np.float32).reshape(-1, 3, 3),
            patch=np.array(self._patch, dtype=np.int32),
            origin=origin,
            along=along,
            across=across,
            normal=normal,
            size=np.array(self._sizes, dtype=np.float32).reshape(-1, 2),
            material=np.array(self._materials, dtype=np.int32),
            materials=packed(list(self._rows)),
            outlines=dict(self._outlines),
        )

    def _begin(
        self,
        origin: FloatArray,
        along: FloatArray,
        across: FloatArray,
        normal: FloatArray,
        size: tuple[float, float],
        material: Material,
    ) -> int:
        self._frames.append(np.array([origin, along, across, normal]))
        self._sizes.append(size)
        self._materials.append(self._rows.setdefault(material, len(self._rows)))
        return len(self._sizes) - 1


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """The product of two vectors; numpy's own takes ten times as long for one pair."""
    (x, y, z), (u, v, w) = a, b
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def _convex(ring: FloatArray) -> bool:
    edges = np.roll(ring, -1, axis=0) - ring
    after = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
    return bool((turns > 0).all() or (turns < 0).all())


def _triangles(polygon: FloatArray) -> list[FloatArray]:
    parts = shapely.constrained_delaunay_triangles(shapely.Polygon(polygon))
    return [np.asarray(part.exterior.coords)[:3] for part in parts.geoms]
