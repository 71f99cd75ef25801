"""The colour of what rays meet."""

from __future__ import annotations

import numpy as np
from numba import njit

from panoplan.simulate.render.cast import RayCaster
from panoplan.simulate.render.lamp import Sun
from panoplan.simulate.render.light import LightMap, sunshine
from panoplan.simulate.render.materials import (
    EMISSION,
    GLOSS,
    Float32Array,
    Pattern,
    albedo,
    outside,
)
from panoplan.simulate.render.mesh import Mesh

_OUTSIDE = int(Pattern.OUTSIDE)
_LEAST_MIRRORED = 0.03


def radiance(
    mesh: Mesh,
    caster: RayCaster,
    light: LightMap,
    sun: Sun | None,
    origin: Float32Array,
    directions: Float32Array,
    pixel_rad: float,
    world: int,
) -> tuple[Float32Array, Float32Array]:
    """Radiance along rays from one point; glossy surfaces mirror once.

    Args:
        mesh: the scene's patches.
        caster: of the mesh.
        light: baked.
        sun: where it shines.
        origin: (3,) camera.
        directions: (N, 3) unit vectors.
        pixel_rad: angle that a ray stands for.
        world: seed of what is outside.

    Returns:
        (N, 3) radiance, and (N,) distance, infinite where nothing is met.
    """
    origins = np.broadcast_to(origin.astype(np.float32), directions.shape)
    colour, distance, patch, mirrored = _seen(
        mesh, caster, light, sun, np.ascontiguousarray(origins), directions, 0.0, pixel_rad, world
    )
    at = np.flatnonzero(mirrored > _LEAST_MIRRORED)
    if len(at):
        rays, normal = directions[at], mesh.normal[patch[at]]
        bounced = rays - 2 * (rays * normal).sum(axis=1, keepdims=True) * normal
        start = origins[at] + distance[at, None] * rays + 1e-3 * bounced
        image, *_ = _seen(
            mesh,
            caster,
            light,
            None,
            np.ascontiguousarray(start, dtype=np.float32),
            np.ascontiguousarray(bounced, dtype=np.float32),
            0.02,
            pixel_rad,
            world,
        )
        share = mirrored[at, None]
        colour[at] = (1 - share) * colour[at] + share * image
    return colour, distance


def _seen(mesh, caster, light, sun, origins, directions, blur, pixel_rad, world):
    hits = caster.first(origins, directions)
    patch = mesh.patch[hits.triangle]
    colour, base, mirrored = _shade(
        hits.triangle,
        hits.distance,
        patch,
        origins,
        directions,
        mesh.origin,
        mesh.along,
        mesh.across,
        mesh.normal,
        mesh.size,
        mesh.material,
        mesh.materials,
        light.first,
        light.shape,
        light.light,
        np.float32(pixel_rad),
        np.float32(blur),
        world,
    )
    if sun is not None:
        normal = mesh.normal[patch]
        facing = np.where(hits.triangle >= 0, normal @ sun.towards.astype(np.float32), 0) > 0.01
        at = np.flatnonzero(facing & (base.sum(axis=1) > 0))
        place = origins[at] + hits.distance[at, None] * directions[at] + 2e-3 * normal[at]
        share = sunshine(mesh, caster, sun, place.astype(np.float32), normal[at])
        colour[at] += (share[:, None] * base[at] * sun.power).astype(np.float32)
    return colour, hits.distance, patch, mirrored


@njit(cache=True, error_model="numpy")
def _shade(
    triangle,
    distance,
    patches,
    origins,
    directions,
    origin,
    along,
    across,
    normal,
    size,
    material,
    materials,
    first,
    shape,
    light,
    pixel_rad,
    blur,
    world,
):
    count = len(triangle)
    colour = np.zeros((count, 3), dtype=np.float32)
    base = np.zeros((count, 3), dtype=np.float32)
    mirrored = np.zeros(count, dtype=np.float32)
    for k in range(count):
        if triangle[k] < 0:
            continue
        p = patches[k]
        look = materials[material[p]]
        dx, dy, dz = directions[k, 0], directions[k, 1], directions[k, 2]
        if int(look[0]) == _OUTSIDE:
            colour[k, 0], colour[k, 1], colour[k, 2] = outside(look, dx, dy, dz, world)
            continue
        d = distance[k]
        x = origins[k, 0] + d * dx - origin[p, 0]
        y = origins[k, 1] + d * dy - origin[p, 1]
        z = origins[k, 2] + d * dz - origin[p, 2]
        s = x * along[p, 0] + y * along[p, 1] + z * along[p, 2]
        t = x * across[p, 0] + y * across[p, 1] + z * across[p, 2]
        facing = abs(dx * normal[p, 0] + dy * normal[p, 1] + dz * normal[p, 2])
        pixel = (d * pixel_rad + blur) / np.sqrt(max(facing, np.float32(0.05)))
        r, g, b = albedo(look, s, t, size[p, 0], size[p, 1], pixel, p * 7 + world)
        nu, nv = shape[p, 0], shape[p, 1]
        u = min(max(s / size[p, 0] * nu - np.float32(0.5), np.float32(0)), np.float32(nu - 1))
        v = min(max(t / size[p, 1] * nv - np.float32(0.5), np.float32(0)), np.float32(nv - 1))
        i, j = min(int(u), max(nu - 2, 0)), min(int(v), max(nv - 2, 0))
        fu, fv = u - i, v - j
        right, below = 1 if nu > 1 else 0, nu if nv > 1 else 0
        at = first[p] + j * nu + i
        base[k, 0], base[k, 1], base[k, 2] = r, g, b
        for c in range(3):
            low = light[at, c] * (1 - fu) + light[at + right, c] * fu
            high = light[at + below, c] * (1 - fu) + light[at + below + right, c] * fu
            lit = low * (1 - fv) + high * fv
            colour[k, c] = base[k, c] * lit + look[EMISSION] * look[1 + c]
        gloss = look[GLOSS]
        if gloss > 0:
            mirrored[k] = gloss + (1 - gloss) * min(gloss * 8, 1.0) * (1 - facing) ** 5
    return colour, base, mirrored
