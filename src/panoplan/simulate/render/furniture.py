"""Pieces of furniture, each built of boxes, prisms and balls in its own frame.

A piece stands at a wall: its first coordinate runs along the wall, the second into the room, the
third up; (0, 0, 0) is the middle of its back on the floor.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from panoplan.simulate.render.lamp import Lamp
from panoplan.simulate.render.looks import Look, any_colour, tinted, wood
from panoplan.simulate.render.materials import Colour, Material, Pattern
from panoplan.simulate.render.mesh import MeshBuilder
from panoplan.types.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Place:
    """Where a piece stands.

    Attributes:
        origin: (2,) plan, middle of its back.
        along: (2,) unit vector of its first coordinate.
        inward: (2,) unit vector of its second.
        mesh: what it is added to.
    """

    origin: FloatArray
    along: FloatArray
    inward: FloatArray
    mesh: MeshBuilder

    def box(
        self,
        x: tuple[float, float],
        y: tuple[float, float],
        z: tuple[float, float],
        material: Material,
        *,
        front: Material | None = None,
        top: Material | None = None,
    ) -> None:
        """An upright box between the given coordinates."""
        low, high = (x[0], y[0], z[0]), (x[1], y[1], z[1])
        self.mesh.box(
            self.origin, self.along, self.inward, low, high, material, front=front, top=top
        )

    def round(
        self,
        x: float,
        y: float,
        radius: float,
        z: tuple[float, float],
        material: Material,
        *,
        shrink: float = 1.0,
        stretch: float = 1.0,
        sides: int = 12,
    ) -> None:
        """An upright cylinder or frustum around (x, y); `stretch` lengthens it along y."""
        turn = np.linspace(0, 2 * np.pi, sides, endpoint=False)
        centre = self.point(x, y)
        ring = centre + radius * (
            np.cos(turn)[:, None] * self.along + stretch * np.sin(turn)[:, None] * self.inward
        )
        self.mesh.prism(ring, z[0], z[1], material, shrink=shrink)

    def ball(self, x: float, y: float, z: float, radius: float, material: Material) -> None:
        """A ball around (x, y, z)."""
        at = self.point(x, y)
        self.mesh.ball(np.array([at[0], -z, at[1]]), (radius, radius, radius), material)

    def point(self, x: float, y: float) -> FloatArray:
        """(2,) plan of a place in the piece's frame."""
        return np.asarray(self.origin + x * self.along + y * self.inward)


Builder = Callable[[Place, float, float, float, np.random.Generator, Look], None]


@dataclass(frozen=True)
class Piece:
    """A kind of furniture.

    Attributes:
        width: least and most along the wall, metres.
        depth: least and most into the room.
        height: least and most.
        build: adds it, given place, width, depth, height, rng and the home's look.
        at_wall: whether it stands at a wall; anywhere in the room otherwise.
    """

    width: tuple[float, float]
    depth: tuple[float, float]
    height: tuple[float, float]
    build: Builder
    at_wall: bool = True


def _cloth(rng: np.random.Generator) -> Material:
    return Material(Pattern.PILE, any_colour(rng), a=0.012, b=0.3, contrast=rng.uniform(0.05, 0.4))


def _timber(rng: np.random.Generator, colour: Colour | None = None) -> Material:
    return Material(
        Pattern.PANELS, colour or wood(rng), contrast=rng.uniform(0.05, 0.5), gloss=0.03
    )


def _steel(rng: np.random.Generator) -> Material:
    return Material(Pattern.PLAIN, tinted(rng, (0.6, 0.6, 0.62), 0.01, 0.15), gloss=0.25)


_WHITE_WARE = Material(Pattern.PLAIN, (0.8, 0.8, 0.78), gloss=0.08)
_DARK_GLASS = Material(Pattern.PLAIN, (0.01, 0.01, 0.012), gloss=0.12)
MIRROR = Material(Pattern.PLAIN, (0.03, 0.03, 0.03), gloss=0.88)


def _legs(p: Place, w: float, d: float, h: float, thick: float, look: Material) -> None:
    for x in (-w / 2, w / 2 - thick):
        for y in (0.0, d - thick):
            p.box((x, x + thick), (y, y + thick), (0, h), look)


def sofa(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A sofa or armchair."""
    cloth, arm = _cloth(rng), float(rng.uniform(0.1, 0.22))
    foot, seat = float(rng.choice([0.0, 0.1])), 0.43
    p.box((-w / 2, w / 2), (0, d), (foot, seat - 0.12), cloth)
    p.box((-w / 2, w / 2), (0, 0.22), (seat - 0.12, h), cloth)
    for x in (-w / 2, w / 2 - arm):
        p.box((x, x + arm), (0.22, d), (seat - 0.12, seat + 0.18), cloth)
    count = max(1, round((w - 2 * arm) / 0.7))
    wide = (w - 2 * arm) / count
    for k in range(count):
        x = -w / 2 + arm + k * wide
        p.box((x + 0.01, x + wide - 0.01), (0.22, d + 0.02), (seat - 0.12, seat + 0.03), cloth)
        if rng.random() < 0.4:
            p.ball(x + wide / 2, 0.36, seat + 0.2, 0.18, _cloth(rng))


def bed(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A bed, its head at the wall."""
    frame, cover = _timber(rng), _cloth(rng)
    sheet = Material(
        Pattern.PILE, tinted(rng, (0.9, 0.9, 0.88), 0.02, 0.05), a=0.02, b=0.4, contrast=0.1
    )
    if rng.random() < 0.7:
        p.box((-w / 2 - 0.03, w / 2 + 0.03), (0, 0.07), (0, h + rng.uniform(0.3, 0.7)), frame)
    p.box((-w / 2, w / 2), (0.07, d), (float(rng.choice([0.0, 0.15])), h - 0.22), frame)
    p.box((-w / 2 + 0.02, w / 2 - 0.02), (0.07, d - 0.02), (h - 0.22, h), sheet)
    p.box((-w / 2, w / 2), (0.6, d + 0.01), (h - 0.3, h + 0.03), cover)
    for x in (-w / 4, w / 4) if w > 1.2 else (0.0,):
        p.box((x - 0.3, x + 0.3), (0.1, 0.5), (h, h + 0.13), sheet)


def table(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A dining table with chairs, or a low one without."""
    timber = _timber(rng)
    if rng.random() < 0.3:
        p.round(0, d / 2, w / 2, (h - 0.04, h), timber, stretch=d / w, sides=16)
        p.round(0, d / 2, 0.06, (0, h - 0.04), timber, sides=8)
        p.round(0, d / 2, 0.3, (0, 0.04), timber)
    else:
        p.box((-w / 2, w / 2), (0, d), (h - 0.04, h), timber)
        _legs(p, w, d, h - 0.04, 0.06, timber)
    if h > 0.65:
        seat = _timber(rng) if rng.random() < 0.6 else _cloth(rng)
        count = max(1, int(w / 0.75))
        for side, y in ((-1, -0.15), (1, d + 0.15)):
            for k in range(count):
                x = -w / 2 + w * (k + 0.5) / count
                turned = Place(p.point(x, y), p.along * side, p.inward * -side, p.mesh)
                chair(turned, 0.44, 0.44, 0.9, rng, look, seat)


def chair(
    p: Place,
    w: float,
    d: float,
    h: float,
    rng: np.random.Generator,
    look: Look,
    material: Material | None = None,
) -> None:
    """A chair, its back at the origin."""
    m = material or _timber(rng)
    p.box((-w / 2, w / 2), (0, d), (0.43, 0.47), m)
    p.box((-w / 2, w / 2), (0, 0.03), (0.55, h), m)
    _legs(p, w, d, 0.45, 0.035, m)


def cupboard(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A chest, sideboard or wardrobe with doors or drawers."""
    timber = _timber(rng)
    front = Material(
        Pattern.FRONTS,
        timber.colour,
        (0.06, 0.05, 0.05),
        a=w / max(1, round(w / rng.uniform(0.35, 0.7))),
        b=h / max(1, round(h / rng.uniform(0.25, 1.2))),
        c=0.005,
        detail=float(rng.random() < 0.4),
        contrast=1.0,
        gloss=0.02,
    )
    p.box((-w / 2, w / 2), (0, d), (float(rng.choice([0.0, 0.08])), h), timber, front=front)
    if h < 1.2:
        clutter(p, w, d, h, rng)


def clutter(p: Place, w: float, d: float, z: float, rng: np.random.Generator) -> None:
    """A few small things on a top."""
    for _ in range(int(rng.integers(0, 5))):
        x, y = rng.uniform(-w / 2 + 0.1, w / 2 - 0.1), rng.uniform(0.1, max(0.11, d - 0.1))
        size = float(rng.uniform(0.03, 0.1))
        colour = Material(Pattern.PLAIN, any_colour(rng), gloss=0.03)
        kind = rng.random()
        if kind < 0.4:
            p.box(
                (x - size, x + size), (y - size, y + size), (z, z + rng.uniform(0.03, 0.35)), colour
            )
        elif kind < 0.8:
            p.round(x, y, size, (z, z + rng.uniform(0.08, 0.35)), colour, shrink=0.7, sides=8)
        else:
            p.ball(x, y, z + size, size, colour)


def bookcase(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """Shelves with books."""
    timber = _timber(rng)
    books = Material(Pattern.BOOKS, timber.colour, a=0.34, b=0.035)
    p.box((-w / 2, w / 2), (0, d), (0, h), timber, front=books)


def television(
    p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look
) -> None:
    """A low board with a screen."""
    cupboard(p, w, d, 0.5, rng, look)
    wide = min(w, float(rng.uniform(0.9, 1.4)))
    p.box((-wide / 2, wide / 2), (0.1, 0.15), (0.6, 0.6 + 0.56 * wide), _DARK_GLASS)


def counter(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A kitchen run: base, worktop, splashback, wall cupboards, range, dishwasher, sink."""
    plinth = Material(Pattern.PLAIN, (0.03, 0.03, 0.03))
    p.box((-w / 2, w / 2), (0, d - 0.07), (0, 0.1), plinth)
    p.box((-w / 2, w / 2), (0, d), (0.1, h - 0.04), look.fronts)
    p.box((-w / 2, w / 2), (0, d + 0.03), (h - 0.04, h), look.worktop)
    splash = float(rng.choice([0.1, 0.55]))
    tiles = Material(
        Pattern.TILES, any_colour(rng), (0.6, 0.6, 0.6), a=0.15, b=0.075, c=0.004, detail=1
    )
    p.box((-w / 2, w / 2), (0, 0.012), (h, h + splash), tiles if splash > 0.2 else look.worktop)
    gap = float(rng.uniform(-w / 2, w / 2)) if rng.random() < 0.7 else -9.0
    if rng.random() < 0.8:
        for x0, x1 in (
            ((-w / 2, gap - 0.45), (gap + 0.45, w / 2)) if gap > -9 else ((-w / 2, w / 2),)
        ):
            if x1 - x0 > 0.3:
                p.box((x0, x1), (0, 0.35), (1.4, 2.1 if rng.random() < 0.8 else 2.3), look.fronts)
    metal = (
        _steel(rng) if rng.random() < 0.6 else (_WHITE_WARE if rng.random() < 0.5 else _DARK_GLASS)
    )
    if w > 1.6:
        x = float(rng.uniform(-w / 2 + 0.4, w / 2 - 0.4))
        p.box((x - 0.38, x + 0.38), (0.02, d + 0.02), (0.05, h + 0.01), metal, top=_DARK_GLASS)
        p.box((x - 0.3, x + 0.3), (d + 0.02, d + 0.025), (0.3, 0.65), _DARK_GLASS)
        p.box((x - 0.38, x + 0.38), (0.0, 0.38), (1.4, 1.75), metal)
        y = -x / 2
        p.box((y - 0.35, y + 0.35), (0.1, 0.5), (h, h + 0.005), _steel(rng))
        p.round(y, 0.09, 0.015, (h, h + 0.3), _steel(rng), sides=6)
    clutter(p, w, d * 0.6, h, rng)


def fridge(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A refrigerator."""
    metal = _steel(rng) if rng.random() < 0.5 else _WHITE_WARE
    p.box((-w / 2, w / 2), (0.03, d - 0.03), (0.02, h), metal)
    split = h * float(rng.choice([0.35, 0.65]))
    for z0, z1 in ((0.06, split - 0.01), (split, h)):
        p.box((-w / 2, w / 2), (d - 0.03, d), (z0, z1), metal)
        p.box((-w / 2 + 0.04, -w / 2 + 0.06), (d, d + 0.04), (z0 + 0.1, z1 - 0.1), metal)


def vanity(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A washstand with a mirror and lamps above it."""
    p.box((-w / 2, w / 2), (0, d), (0.08, h - 0.04), look.fronts)
    p.box((-w / 2, w / 2), (0, d + 0.02), (h - 0.04, h), look.worktop)
    p.round(0, d / 2, 0.2, (h, h + 0.006), _WHITE_WARE, stretch=0.75)
    p.round(0, 0.08, 0.015, (h, h + 0.2), _steel(rng), sides=6)
    if rng.random() < 0.85:
        half = w / 2 - 0.03 if rng.random() < 0.6 else 0.3
        p.box((-half, half), (0, 0.015), (h + 0.12, h + rng.uniform(0.9, 1.15)), MIRROR)
        bulb = Material(Pattern.PLAIN, (0.9, 0.85, 0.75), emission=rng.uniform(1, 4))
        for k in range(int(rng.integers(0, 5))):
            p.ball(-half + 2 * half * (k + 0.5) / 4, 0.08, h + 1.2, 0.05, bulb)


def toilet(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A toilet."""
    p.box((-0.2, 0.2), (0, 0.18), (0.38, h), _WHITE_WARE)
    p.round(0, 0.42, 0.19, (0, 0.4), _WHITE_WARE, shrink=1.0, stretch=1.25)
    p.box((-0.1, 0.1), (0.1, 0.4), (0, 0.36), _WHITE_WARE)


def bathtub(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A tub with a surround of tiles, or a curtain."""
    p.box((-w / 2, w / 2), (d - 0.07, d), (0, h), _WHITE_WARE)
    p.box((-w / 2, w / 2), (0, 0.07), (0, h), _WHITE_WARE)
    p.box((-w / 2, -w / 2 + 0.1), (0.07, d - 0.07), (0, h), _WHITE_WARE)
    p.box((w / 2 - 0.1, w / 2), (0.07, d - 0.07), (0, h), _WHITE_WARE)
    p.box((-w / 2, w / 2), (0, d), (0, 0.12), _WHITE_WARE)
    tiles = Material(
        Pattern.TILES, (0.8, 0.8, 0.78), (0.6, 0.6, 0.6), a=0.15, b=0.15, c=0.004, gloss=0.04
    )
    p.box((-w / 2, w / 2), (0, 0.01), (h, 2.0), tiles)
    if rng.random() < 0.35:
        side = float(rng.choice([-1, 1]))
        p.box(
            (side * w / 2 - 0.3, side * w / 2 + 0.3), (d - 0.03, d - 0.01), (0.1, 1.95), _cloth(rng)
        )


def lamp(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A standard lamp."""
    shade = Material(Pattern.PLAIN, (0.8, 0.75, 0.6), emission=float(rng.choice([0.0, 1.0])))
    p.round(0, d / 2, 0.14, (0, 0.03), _steel(rng))
    p.round(0, d / 2, 0.015, (0.03, h - 0.25), _steel(rng), sides=6)
    p.round(0, d / 2, 0.2, (h - 0.3, h), shade, shrink=0.7)


def plant(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A plant in its pot."""
    pot = Material(Pattern.PLAIN, any_colour(rng))
    leaf = Material(
        Pattern.PILE, tinted(rng, (0.3, 0.45, 0.2), 0.03, 0.08), a=0.03, b=0.1, contrast=0.9
    )
    p.round(0, d / 2, 0.13, (0, 0.3), pot, shrink=1.2, sides=10)
    for _ in range(int(rng.integers(3, 8))):
        z = rng.uniform(0.4, h)
        p.ball(*(rng.normal(0, 0.1), d / 2 + rng.normal(0, 0.1), z), rng.uniform(0.07, 0.2), leaf)


def boxes(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """Things left standing: cartons, bins, bags."""
    card = Material(Pattern.PLAIN, tinted(rng, (0.68, 0.52, 0.36), 0.03, 0.08), contrast=0.2)
    z = 0.0
    while z < h:
        high = float(rng.uniform(0.15, 0.45))
        x, half = rng.normal(0, 0.03), w / 2 * rng.uniform(0.7, 1.0)
        p.box(
            (x - half, x + half), (0, d), (z, z + high), card if rng.random() < 0.6 else _cloth(rng)
        )
        z += high


def sliding_doors(
    p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look
) -> None:
    """A shut built-in wardrobe, flush with the wall: sliding, folding or mirror doors."""
    mirrored = rng.random() < 0.25
    leaf = MIRROR if mirrored else look.leaf
    if rng.random() < 0.3 and not mirrored:
        leaf = Material(Pattern.SLATS, look.leaf.colour, (0.1, 0.1, 0.1), a=0.04, contrast=0.5)
    p.box((-w / 2, 0.02), (0, 0.012), (0.01, h), leaf)
    p.box((-0.02, w / 2), (0.012, 0.024), (0.01, h), leaf)
    _trim(p, w, h, look)


def outer_door(
    p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look
) -> None:
    """A shut door that leads out."""
    leaf = (
        look.leaf
        if rng.random() < 0.5
        else Material(Pattern.PANELS, any_colour(rng), contrast=0.1, detail=3)
    )
    p.box((-w / 2, w / 2), (0, 0.008), (0.005, h), leaf)
    p.box((w / 2 - 0.12, w / 2 - 0.06), (0.008, 0.06), (0.97, 1.03), _steel(rng))
    _trim(p, w, h, look)


def _trim(p: Place, w: float, h: float, look: Look) -> None:
    wide, thick = 0.07, 0.03
    for x0, x1 in ((-w / 2 - wide, -w / 2), (w / 2, w / 2 + wide)):
        p.box((x0, x1), (0, thick), (0, h), look.trim)
    p.box((-w / 2 - wide, w / 2 + wide), (0, thick), (h, h + wide), look.trim)


def hanging(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A closet's inside: shelves, a rail, clothes."""
    shelf = Material(Pattern.PLAIN, (0.8, 0.8, 0.78)) if rng.random() < 0.6 else _timber(rng)
    for z in (1.7, *(rng.uniform(0.3, 1.4, int(rng.integers(0, 4))))):
        p.box((-w / 2, w / 2), (0, d), (z, z + 0.02), shelf)
    if rng.random() < 0.4:
        x = -w / 2 + 0.05
        while x < w / 2 - 0.1:
            thick = float(rng.uniform(0.02, 0.08))
            p.box((x, x + thick), (0.05, d), (rng.uniform(0.5, 1.0), 1.62), _cloth(rng))
            x += thick + float(rng.exponential(0.05))


def picture(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """Something on the wall: a picture or a mirror; h is its middle's height."""
    tall = w * float(rng.uniform(0.6, 1.4))
    if rng.random() < 0.2:
        face = MIRROR
    else:
        face = Material(
            Pattern.PICTURE,
            any_colour(rng),
            any_colour(rng),
            a=0.03,
            detail=float(rng.choice([0, 0.06])),
        )
    p.box((-w / 2, w / 2), (0, 0.025), (h - tall / 2, h + tall / 2), face)


def rug(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A rug."""
    top = Material(
        Pattern.PICTURE if rng.random() < 0.3 else Pattern.PILE,
        any_colour(rng),
        any_colour(rng),
        a=0.05,
        b=0.3,
        contrast=rng.uniform(0.1, 0.8),
    )
    p.box((-w / 2, w / 2), (0, d), (0, 0.012), top)


def ceiling_lamp(
    centre: FloatArray,
    ceiling: float,
    mesh: MeshBuilder,
    rng: np.random.Generator,
    *,
    hanging: bool,
) -> tuple[Lamp, bool]:
    """A ceiling light: a bowl, a fan with a lamp, or where it may a pendant; whether it is one."""
    tint = tinted(rng, (0.97, 0.92, 0.84), 0.02, 0.02)
    glow = Material(Pattern.PLAIN, tint, emission=rng.uniform(1.0, 5.0))
    power = rng.uniform(0.5, 2.5) * np.array(tint)
    metal = _steel(rng)
    p = Place(centre, np.array([1.0, 0.0]), np.array([0.0, 1.0]), mesh)
    kind = rng.random()
    if kind < 0.55:
        radius = float(rng.uniform(0.1, 0.25))
        p.round(0, 0, radius * 1.1, (ceiling - 0.03, ceiling), metal)
        p.round(0, 0, radius * 0.7, (ceiling - 0.13, ceiling - 0.03), glow, shrink=1.35)
        low = 0.16
    elif kind < 0.75 and hanging:
        drop = float(rng.uniform(0.4, 0.9))
        p.round(0, 0, 0.012, (ceiling - drop, ceiling), metal, sides=6)
        p.round(0, 0, 0.2, (ceiling - drop - 0.2, ceiling - drop), glow, shrink=0.5)
        low = drop + 0.25
    else:
        p.round(0, 0, 0.03, (ceiling - 0.3, ceiling), metal, sides=6)
        p.round(0, 0, 0.1, (ceiling - 0.4, ceiling - 0.25), metal)
        turn = rng.uniform(0, 2 * np.pi)
        blade = _timber(rng)
        for k in range(5):
            a = turn + 2 * np.pi * k / 5
            along = np.array([np.cos(a), np.sin(a)])
            inward = np.array([-along[1], along[0]])
            foot, head = (0.1, -0.06, ceiling - 0.34), (0.62, 0.06, ceiling - 0.325)
            mesh.box(centre, along, inward, foot, head, blade)
        p.ball(0, 0, ceiling - 0.46, 0.1, glow)
        low = 0.6
    lamp = Lamp(np.array([centre[0], low - ceiling, centre[1]]), power)
    return lamp, 0.55 <= kind < 0.75 and hanging


def vent(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """Small fittings on a wall: a switch, a socket, a grille, a thermostat."""
    plate = Material(Pattern.SLATS, (0.75, 0.75, 0.7), (0.2, 0.2, 0.2), a=0.02, contrast=0.4)
    p.box((-w / 2, w / 2), (0, 0.012), (h, h + w * rng.uniform(0.5, 1.5)), plate)


def radiator(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A radiator or a baseboard heater."""
    ribs = Material(Pattern.STRIPES, (0.75, 0.75, 0.72), (0.4, 0.4, 0.4), a=0.03, contrast=0.6)
    p.box((-w / 2, w / 2), (0.02, d), (0.08, h), _WHITE_WARE, front=ribs)


def stairs(p: Place, w: float, d: float, h: float, rng: np.random.Generator, look: Look) -> None:
    """A straight flight up along the wall."""
    tread = _timber(rng)
    riser, going = 0.18, 0.27
    count = int(w / going)
    for k in range(count):
        x = -w / 2 + k * going
        p.box(
            (x, w / 2 if k == count - 1 else x + going), (0, d), (0, min(h, (k + 1) * riser)), tread
        )
