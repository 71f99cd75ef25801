"""Soft light baked into the patches: daylight, sun, lamps, and what walls send to one another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numba import njit
from scipy.ndimage import distance_transform_edt

from panoplan.simulate.render.cast import RayCaster
from panoplan.simulate.render.lamp import Lamp, Sun
from panoplan.simulate.render.materials import PATTERN, Float32Array, Pattern
from panoplan.simulate.render.mesh import Int32Array, Mesh
from panoplan.simulate.render.shell import Pane
from panoplan.types.arrays import BoolArray, FloatArray

_MOST_TEXELS = 48
_BOUNCES = 5
_LIFT_M = 2e-3
_REACH_M = 10.0
_LAMP_M = 0.12


@dataclass(frozen=True)
class BakeQuality:
    """How finely light is baked.

    Attributes:
        texel_m: size of a texel.
        source_rays: rays from a texel to each window and lamp near it.
        gather_rays: rays from a texel into all directions.
    """

    texel_m: float
    source_rays: int
    gather_rays: int


@dataclass(frozen=True, eq=False)
class LightMap:
    """Light on every patch, without the sun's own.

    Attributes:
        first: (P,) index of each patch's first texel.
        shape: (P, 2) texels along s and t.
        light: (L, 3) on a texel, s running fastest; 1 makes a white surface white.
    """

    first: Int32Array
    shape: Int32Array
    light: Float32Array


def bake(
    mesh: Mesh,
    caster: RayCaster,
    panes: tuple[Pane, ...],
    sky: FloatArray,
    lamps: tuple[Lamp, ...],
    sun: Sun | None,
    quality: BakeQuality,
    rng: np.random.Generator,
) -> LightMap:
    """Light on all patches.

    Args:
        mesh: the patches.
        caster: of the mesh.
        panes: through which daylight enters.
        sky: (3,) radiance of the panes.
        lamps: that are on.
        sun: where it shines.
        quality: how finely.
        rng: of the rays' directions.

    Returns:
        The light.
    """
    shape = np.clip(np.ceil(mesh.size / quality.texel_m), 1, _MOST_TEXELS).astype(np.int32)
    counts = shape[:, 0] * shape[:, 1]
    first = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int32)
    patch = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    inner = np.arange(counts.sum()) - first[patch]
    cell = np.stack([inner % shape[patch, 0], inner // shape[patch, 0]], axis=1)
    local = (cell + 0.5) / shape[patch] * mesh.size[patch]
    normal = mesh.normal[patch]
    place = (
        mesh.origin[patch]
        + local[:, :1] * mesh.along[patch]
        + local[:, 1:] * mesh.across[patch]
        + _LIFT_M * normal
    ).astype(np.float32)
    direct = np.full((len(patch), 3), 0.01)
    for pane in panes:
        direct += _daylight(place, normal, pane, caster, quality.source_rays, rng)[:, None] * sky
    for lamp in lamps:
        direct += (
            _lamplight(place, normal, lamp, caster, quality.source_rays, rng)[:, None] * lamp.power
        )
    sunlit = np.zeros((len(patch), 3))
    if sun is not None:
        sunlit = sunshine(mesh, caster, sun, place, normal)[:, None] * sun.power
    spread = _spread(mesh, caster, first, shape, place, patch, direct, sunlit, quality, rng)
    blurred = _blurred(spread, first, shape)
    light = np.ascontiguousarray(direct + blurred, dtype=np.float32)
    _fill_outside(mesh, first, shape, light)
    return LightMap(first, shape, light)


def sunshine(
    mesh: Mesh, caster: RayCaster, sun: Sun, place: Float32Array, normal: Float32Array
) -> FloatArray:
    """(N,) cosine of the sun's height over each place, 0 in the shade."""
    cosine = normal @ sun.towards
    facing = np.flatnonzero(cosine > 0.01)
    towards = np.broadcast_to(sun.towards.astype(np.float32), (len(facing), 3))
    hit = caster.first(place[facing], np.ascontiguousarray(towards)).triangle
    glass = mesh.materials[mesh.material[mesh.patch[hit]], PATTERN] == Pattern.OUTSIDE
    out = np.zeros(len(place))
    lit = facing[(hit >= 0) & glass]
    out[lit] = cosine[lit]
    return out


def _daylight(
    place: Float32Array,
    normal: Float32Array,
    pane: Pane,
    caster: RayCaster,
    count: int,
    rng: np.random.Generator,
) -> FloatArray:
    """Share of its sky that each place has in one window."""
    centre = pane.corner + (pane.along + pane.across) / 2
    offset = centre - place
    near = (offset @ pane.inward < -0.02) & ((offset**2).sum(axis=1) < _REACH_M**2)
    near &= (offset * normal).sum(axis=1) > -1.5
    chosen = np.flatnonzero(near)
    area = np.sqrt((pane.along @ pane.along) * (pane.across @ pane.across))
    total = np.zeros(len(place))
    for _ in range(count):
        u, v = rng.random((2, len(chosen), 1))
        ray = (pane.corner + u * pane.along + v * pane.across - place[chosen]).astype(np.float32)
        square = np.maximum((ray**2).sum(axis=1), 0.05)
        cosines = np.maximum((ray * normal[chosen]).sum(axis=1), 0) * -(ray @ pane.inward)
        form = np.maximum(cosines, 0) / square**2 * area / np.pi
        free = ~_blocked(caster, place[chosen], ray, form > 1e-5)
        total[chosen] += np.minimum(form, 1.0) * free / count
    return total


def _lamplight(
    place: Float32Array,
    normal: Float32Array,
    lamp: Lamp,
    caster: RayCaster,
    count: int,
    rng: np.random.Generator,
) -> FloatArray:
    """Light of a lamp of power 1 on each place, from several points of the lamp."""
    total = np.zeros(len(place))
    near = np.flatnonzero(((lamp.position - place) ** 2).sum(axis=1) < _REACH_M**2)
    for _ in range(count):
        shift = rng.uniform(-_LAMP_M, _LAMP_M, (len(near), 3))
        ray = (lamp.position + shift - place[near]).astype(np.float32)
        square = (ray**2).sum(axis=1)
        lit = np.maximum((ray * normal[near]).sum(axis=1) / np.sqrt(square), 0) / (square + 0.1)
        total[near] += lit * ~_blocked(caster, place[near], ray, lit > 1e-3) / count
    return total


def _blocked(
    caster: RayCaster, place: Float32Array, ray: Float32Array, asked: BoolArray
) -> BoolArray:
    """Whether something lies between the places and the ends of their rays, where asked."""
    out = np.ones(len(place), dtype=np.bool_)
    at = np.flatnonzero(asked)
    if len(at):
        reach = np.full(len(at), 0.97, dtype=np.float32)
        out[at] = caster.blocked(
            np.ascontiguousarray(place[at]), np.ascontiguousarray(ray[at]), reach
        )
    return out


def _spread(
    mesh: Mesh,
    caster: RayCaster,
    first: Int32Array,
    shape: Int32Array,
    place: Float32Array,
    patch: Int32Array,
    direct: FloatArray,
    sunlit: FloatArray,
    quality: BakeQuality,
    rng: np.random.Generator,
) -> FloatArray:
    """Light that reaches each texel over other surfaces."""
    rays = quality.gather_rays
    count = len(place)
    seen = np.empty((rays, count), dtype=np.int64)
    tint = np.empty((rays, count, 3), dtype=np.float32)
    frames = (mesh.along[patch], mesh.across[patch], mesh.normal[patch])
    shift = rng.random((2, count))
    golden = 0.6180339887
    for k in range(rays):
        radius = np.sqrt((k + shift[0]) / rays)
        turn = 2 * np.pi * (k * golden + shift[1])
        ray = (
            (radius * np.cos(turn))[:, None] * frames[0]
            + (radius * np.sin(turn))[:, None] * frames[1]
            + np.sqrt(np.maximum(1 - radius**2, 1e-3))[:, None] * frames[2]
        ).astype(np.float32)
        hits = caster.first(place, np.ascontiguousarray(ray))
        there = mesh.patch[hits.triangle]
        distance = np.where(hits.triangle >= 0, hits.distance, 0)[:, None]
        offset = place + distance * ray - mesh.origin[there]
        part = np.stack(
            [(offset * mesh.along[there]).sum(axis=1), (offset * mesh.across[there]).sum(axis=1)], 1
        )
        cell = (part / mesh.size[there] * shape[there]).astype(np.int64)
        cell = np.clip(cell, 0, shape[there] - 1)
        seen[k] = first[there] + cell[:, 1] * shape[there, 0] + cell[:, 0]
        look = mesh.materials[mesh.material[there]]
        dark = (hits.triangle < 0) | (look[:, PATTERN] == Pattern.OUTSIDE)
        tint[k] = np.where(dark[:, None], 0, look[:, 1:4])
    light = direct + sunlit
    indirect = np.zeros_like(direct)
    for _ in range(_BOUNCES):
        indirect = np.zeros_like(direct)
        for k in range(rays):
            indirect += tint[k] * light[seen[k]]
        indirect /= rays
        light = direct + sunlit + indirect
    return indirect


@njit(cache=True)
def _blurred(values, first, shape):
    """Each texel's mean with its neighbours on the patch."""
    out = np.empty_like(values)
    for p in range(len(first)):
        width, height = shape[p, 0], shape[p, 1]
        for j in range(height):
            for i in range(width):
                total = np.zeros(3)
                count = 0
                for y in range(max(j - 1, 0), min(j + 2, height)):
                    for x in range(max(i - 1, 0), min(i + 2, width)):
                        total += values[first[p] + y * width + x]
                        count += 1
                out[first[p] + j * width + i] = total / count
    return out


def _fill_outside(mesh: Mesh, first: Int32Array, shape: Int32Array, light: Float32Array) -> None:
    """Texels outside of their patch's outline take the nearest one's light, in place."""
    for patch, outline in mesh.outlines.items():
        width, height = shape[patch]
        u = (np.arange(width) + 0.5) / width * mesh.size[patch, 0]
        v = (np.arange(height) + 0.5) / height * mesh.size[patch, 1]
        inside = shapely.contains_xy(shapely.Polygon(outline), *np.meshgrid(u, v))
        if inside.all() or not inside.any():
            continue
        _, at = distance_transform_edt(~inside, return_indices=True)
        rows = slice(first[patch], first[patch] + width * height)
        light[rows] = light[rows].reshape(height, width, 3)[at[0], at[1]].reshape(-1, 3)
