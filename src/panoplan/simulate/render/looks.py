"""The materials of a home, drawn at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from panoplan.simulate.render.materials import Colour, Material, Pattern


@dataclass(frozen=True)
class Look:
    """What a home is made of.

    Attributes:
        walls: paints that its rooms choose from.
        ceiling: of all rooms.
        floors: coverings that its rooms choose from.
        wet_floor: of kitchens and baths.
        trim: frames, window bars.
        leaf: door leaves.
        fronts: cupboards.
        worktop: kitchen and bath tops.
        outside: what is behind the windows.
    """

    walls: tuple[Material, ...]
    ceiling: Material
    floors: tuple[Material, ...]
    wet_floor: Material
    trim: Material
    leaf: Material
    fronts: Material
    worktop: Material
    outside: Material


def linear(red: float, green: float, blue: float) -> Colour:
    """Linear albedo of a colour as screens show it, each 0-1."""
    r, g, b = (float(np.clip(c, 0.01, 0.97)) ** 2.2 for c in (red, green, blue))
    return r, g, b


BARE = Material(Pattern.PLAIN, linear(0.9, 0.9, 0.88), contrast=0.0)
"""Even white paint."""


def tinted(rng: np.random.Generator, base: Colour, spread: float, shade: float = 0.0) -> Colour:
    """A colour near another: each channel off by `spread`, all together by `shade`."""
    off = rng.normal(0, spread, 3) + rng.normal(0, shade)
    return linear(*(np.asarray(base) + off))


WOODS: tuple[Colour, ...] = (
    (0.72, 0.52, 0.33),
    (0.60, 0.40, 0.24),
    (0.42, 0.27, 0.17),
    (0.80, 0.67, 0.50),
    (0.55, 0.50, 0.46),
    (0.66, 0.36, 0.16),
    (0.30, 0.20, 0.15),
)


def wood(rng: np.random.Generator) -> Colour:
    """The colour of some wood."""
    return tinted(rng, WOODS[int(rng.integers(len(WOODS)))], 0.02, 0.05)


def any_colour(rng: np.random.Generator) -> Colour:
    """Greys, browns and beiges mostly, now and then something bright."""
    grey, kind = rng.uniform(0.15, 0.9), rng.random()
    if kind < 0.6:
        return linear(grey + rng.normal(0.03, 0.03), grey, grey + rng.normal(-0.03, 0.04))
    return linear(*(grey + rng.normal(0, 0.08 if kind < 0.9 else 0.3, 3)))


def mineral(rng: np.random.Generator) -> Colour:
    """The colour of tiles and stone: grey, sand, slate, terracotta."""
    grey = rng.uniform(0.25, 0.88)
    warm = rng.exponential(0.04) * (1 if rng.random() < 0.8 else -0.5)
    return linear(grey + warm, grey, grey - warm)


def draw_look(rng: np.random.Generator) -> Look:
    """The materials of one home."""
    white = tinted(rng, (0.90, 0.90, 0.87), 0.012, 0.03)
    trim_colour = wood(rng) if rng.random() < 0.4 else white
    grain = 0.5 if trim_colour is not white else 0.05
    trim = Material(Pattern.PANELS, trim_colour, contrast=grain, gloss=0.03)
    same_leaf = rng.random() < 0.7
    leaf_colour = trim_colour if same_leaf else (wood(rng) if rng.random() < 0.6 else white)
    leaf = Material(
        Pattern.PANELS,
        leaf_colour,
        contrast=0.5 if leaf_colour is not white else 0.03,
        detail=float(rng.choice([0, 0, 1, 2, 3])),
        gloss=0.04,
    )
    skirting = trim_colour if rng.random() < 0.8 else white
    base = tinted(rng, (0.85, 0.83, 0.79), 0.012, 0.05)
    paints = [base, *(_paint(rng, base) for _ in range(3))]
    height = float(
        rng.choice([0.0, rng.uniform(0.05, 0.09), rng.uniform(0.08, 0.15)], p=[0.1, 0.5, 0.4])
    )
    cornice = float(rng.uniform(0.05, 0.12)) if rng.random() < 0.2 else 0.0
    walls = tuple(
        Material(
            Pattern.WALL, paint, skirting, a=height, b=cornice, contrast=rng.uniform(0.01, 0.06)
        )
        for paint in paints
    )
    worktop = Material(
        Pattern.MARBLE,
        mineral(rng),
        mineral(rng),
        a=rng.uniform(0.08, 0.5),
        contrast=rng.uniform(0, 0.5),
        detail=rng.uniform(0, 0.6),
        gloss=rng.uniform(0.02, 0.1),
    )
    kind = rng.random()
    fronts_colour = wood(rng) if kind < 0.5 else white if kind < 0.8 else any_colour(rng)
    fronts = Material(
        Pattern.FRONTS,
        fronts_colour,
        (0.05, 0.05, 0.05),
        a=rng.uniform(0.35, 0.6),
        b=0.76,
        c=0.004,
        detail=float(rng.random() < 0.6),
        contrast=1.0,
        gloss=rng.uniform(0.0, 0.06),
    )
    return Look(
        walls=walls,
        ceiling=_ceiling(rng),
        floors=(_floor(rng), _floor(rng)) if rng.random() < 0.5 else (_floor(rng),),
        wet_floor=_tiles(rng),
        trim=trim,
        leaf=leaf,
        fronts=fronts,
        worktop=worktop,
        outside=Material(
            Pattern.OUTSIDE,
            mineral(rng) if rng.random() < 0.5 else linear(0.4, 0.5, 0.3),
            linear(0.3, 0.42, 0.25) if rng.random() < 0.6 else mineral(rng),
            contrast=rng.uniform(0, 1),
            emission=rng.uniform(1.5, 7.0),
        ),
    )


def tiled(wall: Material, rng: np.random.Generator, height: float) -> Material:
    """A wall's paint with tiles or panels up to a height."""
    return Material(
        Pattern.WALL,
        wall.colour,
        tinted(rng, (0.85, 0.85, 0.82), 0.03, 0.08),
        a=0.0,
        b=wall.b,
        c=height,
        detail=rng.uniform(0.1, 0.6),
        contrast=wall.contrast,
        gloss=0.04,
    )


def _paint(rng: np.random.Generator, base: Colour) -> Colour:
    kind = rng.random()
    if kind < 0.6:
        return base
    if kind < 0.8:
        return tinted(rng, (0.78, 0.77, 0.72), 0.02, 0.07)
    grey = rng.uniform(0.4, 0.85)
    red, green, blue = grey + rng.normal(0, 0.09, 3)
    return linear(red, green, blue)


def _ceiling(rng: np.random.Generator) -> Material:
    colour = tinted(rng, (0.90, 0.90, 0.88), 0.01, 0.03)
    if rng.random() < 0.05:
        return Material(Pattern.PLANKS, wood(rng), (0.05, 0.03, 0.02), a=0.12, b=2.0, contrast=0.5)
    rough = rng.uniform(0.05, 0.25) if rng.random() < 0.5 else 0.02
    return Material(Pattern.PILE, colour, a=0.02, b=1.5, contrast=rough)


def _floor(rng: np.random.Generator) -> Material:
    kind = rng.random()
    if kind < 0.4:
        colour = tinted(rng, (0.62, 0.57, 0.50), 0.03, 0.12)
        return Material(
            Pattern.PILE, colour, a=rng.uniform(0.008, 0.025), b=0.4, contrast=rng.uniform(0.2, 0.9)
        )
    if kind < 0.85:
        return Material(
            Pattern.PLANKS,
            wood(rng),
            (0.03, 0.02, 0.015),
            a=rng.uniform(0.06, 0.22),
            b=rng.uniform(0.4, 1.8),
            contrast=rng.uniform(0.15, 0.8),
            gloss=max(0.0, rng.uniform(-0.04, 0.08)),
        )
    return _tiles(rng)


def _tiles(rng: np.random.Generator) -> Material:
    if rng.random() < 0.2:
        return Material(
            Pattern.MARBLE, mineral(rng), mineral(rng), a=0.4, contrast=0.4, detail=0.1, gloss=0.05
        )
    size = rng.uniform(0.15, 0.6)
    return Material(
        Pattern.TILES,
        mineral(rng),
        tinted(rng, (0.55, 0.53, 0.5), 0.02, 0.15),
        a=size,
        b=size if rng.random() < 0.7 else size / 2,
        c=rng.uniform(0.003, 0.009),
        contrast=rng.uniform(0.02, 0.3),
        detail=float(rng.random() < 0.3),
        gloss=max(0.0, rng.uniform(-0.03, 0.09)),
    )
