"""What surfaces look like: procedural patterns, evaluated where a ray meets a surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from enum import IntEnum

import numpy as np
from numba import njit
from numpy.typing import NDArray

Float32Array = NDArray[np.float32]
Colour = tuple[float, float, float]


class Pattern(IntEnum):
    """How a surface's colour varies over it; `a`, `b` and `c` are metres unless said."""

    PLAIN = 0
    """Paint: faint blotches of size a."""
    PLANKS = 1
    """Boards b long and a wide, grained, each of its own tint."""
    TILES = 2
    """Tiles a × b with joints c wide; rows shifted by half a tile where `detail` is above ½."""
    PILE = 3
    """Carpet or plaster: fine grain of size a, blotches of size b."""
    STRIPES = 4
    """Upright stripes a wide."""
    PICTURE = 5
    """A framed picture over the whole patch, frame a wide."""
    BOOKS = 6
    """Shelves a high with books about b wide."""
    FRONTS = 7
    """Cupboard fronts a × b with gaps c wide and handles."""
    PANELS = 8
    """A door leaf with `detail` rows of two raised panels; plain wood grain where 0."""
    SLATS = 9
    """Level slats a high: blinds, louvres, garage doors, grilles."""
    MARBLE = 10
    """Veins of size a."""
    WALL = 11
    """Paint with a skirting board a high in the second colour, a cornice b high, and up to c tiles
    of the second colour, `detail` wide."""
    OUTSIDE = 12
    """What is seen through a window: sky, trees, ground, by the ray's direction."""


@dataclass(frozen=True)
class Material:
    """A surface's look.

    Attributes:
        pattern: how its colour varies.
        colour: linear albedo, 0-1.
        second: the pattern's other colour.
        a: first size of the pattern.
        b: second size.
        c: third size.
        contrast: how strongly the pattern shows, 0-1.
        detail: a number that the pattern uses.
        gloss: share of light mirrored at a right angle, 0-1; more at grazing angles.
        emission: radiance that it sends out, in units of a white wall in full light.
    """

    pattern: Pattern
    colour: Colour
    second: Colour = (0.5, 0.5, 0.5)
    a: float = 1.0
    b: float = 1.0
    c: float = 0.0
    contrast: float = 0.1
    detail: float = 0.0
    gloss: float = 0.0
    emission: float = 0.0


FIELDS = 14
PATTERN, GLOSS, EMISSION = 0, 12, 13


def packed(materials: Sequence[Material]) -> Float32Array:
    """(M, FIELDS) rows that the shader reads."""
    rows = [np.hstack([float(m.pattern), *astuple(m)[1:]]) for m in materials]
    return np.array(rows, dtype=np.float32).reshape(-1, FIELDS)


@njit(cache=True, error_model="numpy")
def _hash(i, j, seed):
    """A number in [0, 1) for a lattice cell."""
    h = np.uint32(i) * np.uint32(0x9E3779B1) ^ np.uint32(j) * np.uint32(0x85EBCA77)
    h ^= np.uint32(seed) * np.uint32(0xC2B2AE3D)
    h = (h ^ (h >> np.uint32(15))) * np.uint32(0x2C1B3C6D)
    h = (h ^ (h >> np.uint32(12))) * np.uint32(0x297A2D39)
    h ^= h >> np.uint32(15)
    return np.float32(np.uint32(h) & np.uint32(0xFFFFFF)) * np.float32(1 / 16777216)


@njit(cache=True, error_model="numpy")
def _noise(x, y, seed):
    """Smooth noise in [0, 1] with features of size 1."""
    i, j = int(np.floor(x)), int(np.floor(y))
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    low = _hash(i, j, seed) * (1 - u) + _hash(i + 1, j, seed) * u
    high = _hash(i, j + 1, seed) * (1 - u) + _hash(i + 1, j + 1, seed) * u
    return low * (1 - v) + high * v


@njit(cache=True, error_model="numpy")
def _line(x, period, width, pixel):
    """How far x lies in a line around multiples of the period, softened to the pixel: 0-1."""
    near = abs(x - period * np.round(x / period))
    soft = max(pixel, np.float32(1e-4))
    share = min(max((width / 2 - near) / soft + 0.5, 0.0), 1.0)
    return share * min(1.0, 2 * width / soft)


@njit(cache=True, error_model="numpy")
def _fade(size, pixel):
    """How much of a pattern of a size is seen by a pixel of a width: it vanishes, not flickers."""
    return min(max(size / max(pixel, np.float32(1e-5)) - 1.0, 0.0), 1.0)


@njit(cache=True, error_model="numpy")
def albedo(material, s, t, width, height, pixel, seed):
    """Linear albedo of a place on a patch.

    Args:
        material: (FIELDS,) row of `packed`.
        s: along the patch, metres.
        t: across it, metres; up on upright patches.
        width: of the patch along s.
        height: of the patch along t.
        pixel: width of the pixel's footprint, metres.
        seed: of the patch.

    Returns:
        Red, green, blue.
    """
    r, g, b = material[1], material[2], material[3]
    r2, g2, b2 = material[4], material[5], material[6]
    size, size2, size3 = material[7], material[8], material[9]
    contrast, detail = material[10], material[11]
    kind = int(material[0])
    shade, mix = 1.0, 0.0
    if kind == 0:
        shade += contrast * (_noise(s / size, t / size, seed) - 0.5) * _fade(size, pixel)
    elif kind == 1:
        row = int(np.floor(t / size))
        along = s + _hash(row, 7, seed) * size2
        board = int(np.floor(along / size2))
        tint = _hash(row, board, seed) - 0.5
        grain = _noise(along * 4, t * 140, seed + row) - 0.5
        streak = _noise(along * 1.3, t * 40, seed + 5 + row) - 0.5
        shade += contrast * (
            1.2 * tint * _fade(size, pixel)
            + 0.6 * grain * _fade(0.01, pixel)
            + 0.9 * streak * _fade(0.04, pixel)
        )
        mix = 0.6 * max(_line(t, size, 0.004, pixel), _line(along, size2, 0.004, pixel))
    elif kind == 2:
        row = int(np.floor(t / size2))
        along = s + (0.5 * size * (row % 2) if detail > 0.5 else 0.0)
        tile = int(np.floor(along / size))
        tint = _hash(tile, row, seed) - 0.5
        cloud = _noise(s * 6, t * 6, seed) - 0.5
        shade += contrast * (tint * _fade(size, pixel) + cloud * _fade(0.16, pixel))
        mix = max(_line(along, size, size3, pixel), _line(t, size2, size3, pixel))
    elif kind == 3:
        fine = _noise(s / size, t / size, seed) - 0.5
        mid = _noise(s / (4 * size), t / (4 * size), seed + 1) - 0.5
        cloud = _noise(s / size2, t / size2, seed + 3) - 0.5
        shade += contrast * (
            fine * _fade(size, pixel) + 0.7 * mid * _fade(4 * size, pixel) + 0.5 * cloud
        )
    elif kind == 4:
        if int(np.floor(s / size)) % 2 == 0:
            mix = contrast * _fade(size, pixel)
    elif kind == 5:
        edge = min(min(s, width - s), min(t, height - t))
        if edge < size:
            return r, g, b
        if edge < size + detail:
            return np.float32(0.8), np.float32(0.8), np.float32(0.78)
        r, g, b = _painting(s / width, t / height, r2, g2, b2, seed)
    elif kind == 6:
        return _books(s, t, size, size2, pixel, seed, r, g, b)
    elif kind == 7:
        shade += 0.15 * (_noise(s * 2, t * 22, seed) - 0.5) * contrast
        mix = max(_line(s, size, size3, pixel), _line(t, size2, size3, pixel))
        x, y = s % size, t % size2
        if detail > 0.5:
            inset = min(min(x, size - x), min(y, size2 - y))
            shade -= 0.35 * _line(inset - 0.055, 10.0, 0.01, pixel)
        if abs(x - 0.88 * size) < 0.007 and abs(y - 0.72 * size2) < 0.05:
            mix = 0.8
    elif kind == 8:
        shade += contrast * (
            (_noise(s * 12, t * 1.1, seed) - 0.5) * 0.6
            + (_noise(s * 70, t * 3, seed + 1) - 0.5) * 0.4
        )
        if detail >= 1:
            rows = int(detail)
            x = (s % (width / 2)) - width / 4
            y = (t % (height / rows)) - height / rows / 2
            dx, dy = abs(x) - width / 4 + 0.075, abs(y) - height / rows / 2 + 0.085
            rim = max(dx, dy)
            soft = max(pixel, np.float32(0.012))
            shade -= 0.22 * max(0.0, 1 - abs(rim) / soft) * (1.0 if y > 0 else 0.5)
    elif kind == 9:
        x = (t % size) / size
        shade += contrast * (x - 0.5) * _fade(size, pixel)
        mix = contrast * _line(t, size, 0.12 * size, pixel)
    elif kind == 10:
        warp = _noise(s / size, t / size, seed) + 0.5 * _noise(
            2.3 * s / size, 2.3 * t / size, seed + 1
        )
        vein = 1 - abs(2 * _noise(s / size + 2 * warp, t / size + warp, seed + 2) - 1)
        mix = contrast * vein**6
        grain = _noise(s * 90, t * 90, seed + 4) - 0.5
        shade += detail * grain * _fade(0.011, pixel)
    elif kind == 11:
        if t < size and size > 0:
            shade = 1 - 0.35 * _line(t - size, 10.0, 0.012, pixel)
            return r2 * shade, g2 * shade, b2 * shade
        if t > height - size2:
            shade = 1 - 0.25 * _line(t - height + size2, 10.0, 0.015, pixel)
            return r2 * shade, g2 * shade, b2 * shade
        shade += contrast * (_noise(s * 1.3, t * 1.3, seed) - 0.5)
        if 0 < t < size3:
            if detail > 0:
                joint = max(_line(s, detail, 0.006, pixel), _line(t, detail, 0.006, pixel))
                shade = 1 - 0.2 * joint
            return r2 * shade, g2 * shade, b2 * shade
    keep = (1 - mix) * max(shade, 0.05)
    return r * keep + r2 * mix, g * keep + g2 * mix, b * keep + b2 * mix


@njit(cache=True, error_model="numpy")
def _painting(x, y, r, g, b, seed):
    """A picture: a ground that brightens upwards, and a few blots."""
    shade = 0.5 + 0.6 * y * _hash(1, 2, seed)
    r, g, b = r * shade, g * shade, b * shade
    for k in range(4):
        cx, cy = _hash(k, 11, seed), _hash(k, 12, seed)
        radius = 0.1 + 0.25 * _hash(k, 13, seed)
        if abs(x - cx) ** 1.6 + abs(y - cy) ** 1.6 < radius**1.6:
            r, g, b = (0.9 * _hash(k, 14, seed), 0.9 * _hash(k, 15, seed), 0.9 * _hash(k, 16, seed))
    return np.float32(r), np.float32(g), np.float32(b)


@njit(cache=True, error_model="numpy")
def _books(s, t, shelf, thick, pixel, seed, r, g, b):
    """Backs of books of all colours on boards; some stretches are empty."""
    row = int(np.floor(t / shelf))
    y = t - row * shelf
    if y < 0.025:
        return r, g, b
    place = s / thick + 0.6 * _noise(s / thick * 0.7, row * 3.1, seed)
    book = int(np.floor(place))
    empty = _noise(s * 2.5, row * 7.7, seed + 9) > 0.62
    if empty or y > shelf * (0.62 + 0.3 * _hash(book, row, seed + 1)):
        return 0.35 * r, 0.35 * g, 0.35 * b
    tone = 0.08 + 0.6 * _hash(book, row, seed + 2)
    hue = _hash(book, row, seed + 3)
    keep = 1 - 0.5 * _line(place, 1.0, 0.12, pixel / thick)
    return (
        np.float32(tone * keep * (0.4 + 0.6 * abs(2 * hue - 1))),
        np.float32(tone * keep * (0.4 + 0.5 * abs(2 * ((hue + 0.33) % 1.0) - 1))),
        np.float32(tone * keep * (0.4 + 0.6 * abs(2 * ((hue + 0.66) % 1.0) - 1))),
    )


@njit(cache=True, error_model="numpy")
def outside(material, dx, dy, dz, seed):
    """Radiance from beyond a window: blotched sky, a band of trees or houses, ground.

    Args:
        material: (FIELDS,) row of `packed`.
        dx: the ray's direction, x.
        dy: the same, y, down.
        dz: the same, z.
        seed: of the building, so that all its windows look onto one world.

    Returns:
        Red, green, blue.
    """
    power = material[13]
    heading = np.arctan2(dx, dz)
    flat = np.sqrt(dx * dx + dz * dz)
    up = -dy / max(flat, np.float32(1e-3))
    skyline = 0.05 + 0.35 * _noise(heading * 5, 0.5, seed) * material[10]
    skyline += 0.1 * _noise(heading * 30, 1.5, seed)
    if up > skyline:
        haze = min(max(up - skyline, 0.0), 1.0)
        return power * (1 - 0.25 * haze), power * (1 - 0.12 * haze), power
    if up > -0.08:
        leaf = 0.25 + 0.5 * _noise(heading * 60, up * 60, seed + 1)
        leaf *= 0.5 + _noise(heading * 9, up * 9, seed + 2)
        return (power * leaf * material[4], power * leaf * material[5], power * leaf * material[6])
    turf = 0.5 * (0.7 + 0.5 * _noise(heading * 20, up * 20, seed + 3))
    return (power * turf * material[1], power * turf * material[2], power * turf * material[3])
