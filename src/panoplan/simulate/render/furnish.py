"""What the rooms of a building are used for, and where their furniture stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from panoplan.simulate.buildings import Building
from panoplan.simulate.render import furniture as f
from panoplan.simulate.render.furniture import Piece, Place
from panoplan.simulate.render.lamp import Lamp
from panoplan.simulate.render.looks import Look, wood
from panoplan.simulate.render.materials import Material, Pattern
from panoplan.simulate.render.mesh import MeshBuilder
from panoplan.types.arrays import FloatArray

Use = Literal["living", "bed", "kitchen", "bath", "dining", "office", "hall", "closet", "garage"]

_SOFA = Piece((1.5, 2.4), (0.8, 1.0), (0.7, 0.95), f.sofa)
_ARMCHAIR = Piece((0.75, 1.0), (0.75, 0.95), (0.7, 1.0), f.sofa, at_wall=False)
_LOW_TABLE = Piece((0.8, 1.3), (0.5, 0.8), (0.35, 0.5), f.table, at_wall=False)
_TELEVISION = Piece((1.2, 2.0), (0.35, 0.5), (1.2, 1.2), f.television)
_BOOKCASE = Piece((0.6, 1.8), (0.25, 0.35), (0.9, 2.2), f.bookcase)
_CHEST = Piece((0.7, 1.6), (0.35, 0.5), (0.6, 1.2), f.cupboard)
_WARDROBE = Piece((0.9, 2.4), (0.5, 0.62), (1.8, 2.3), f.cupboard)
_BED = Piece((0.9, 1.9), (2.0, 2.15), (0.45, 0.65), f.bed)
_NIGHT_TABLE = Piece((0.4, 0.5), (0.35, 0.45), (0.5, 0.65), f.cupboard)
_COUNTER = Piece((1.2, 3.6), (0.58, 0.65), (0.86, 0.95), f.counter)
_FRIDGE = Piece((0.6, 0.95), (0.65, 0.8), (1.6, 1.85), f.fridge)
_DINING = Piece((1.1, 2.0), (0.75, 1.0), (0.72, 0.78), f.table, at_wall=False)
_VANITY = Piece((0.6, 1.6), (0.45, 0.56), (0.78, 0.9), f.vanity)
_TOILET = Piece((0.45, 0.5), (0.68, 0.72), (0.75, 0.85), f.toilet)
_TUB = Piece((1.4, 1.7), (0.7, 0.8), (0.42, 0.58), f.bathtub)
_DESK = Piece((1.0, 1.7), (0.6, 0.8), (0.72, 0.76), f.table)
_LAMP = Piece((0.4, 0.4), (0.4, 0.4), (1.3, 1.8), f.lamp)
_PLANT = Piece((0.4, 0.4), (0.4, 0.4), (0.7, 1.6), f.plant)
_BOXES = Piece((0.3, 0.7), (0.3, 0.6), (0.3, 1.4), f.boxes)
_SLIDING = Piece((1.2, 2.4), (0.03, 0.03), (1.95, 2.1), f.sliding_doors)
_OUTER_DOOR = Piece((0.8, 0.95), (0.03, 0.03), (2.0, 2.1), f.outer_door)
_HANGING = Piece((0.8, 2.4), (0.3, 0.5), (2.0, 2.0), f.hanging)
_RADIATOR = Piece((0.6, 1.6), (0.06, 0.12), (0.2, 0.65), f.radiator)
_STAIRS = Piece((2.2, 3.0), (0.8, 1.0), (2.6, 2.6), f.stairs)
_PICTURE = Piece((0.25, 1.2), (0.03, 0.03), (1.4, 1.7), f.picture)
_SWITCH = Piece((0.07, 0.12), (0.02, 0.02), (0.25, 1.2), f.vent)
_GRILLE = Piece((0.2, 0.6), (0.02, 0.02), (0.1, 2.0), f.vent)
_RUG = Piece((1.2, 2.4), (0.8, 1.7), (0.1, 0.1), f.rug, at_wall=False)

_FITTED: dict[Use, tuple[tuple[Piece, float], ...]] = {
    "kitchen": ((_COUNTER, 1.0), (_COUNTER, 0.8), (_FRIDGE, 0.8), (_COUNTER, 0.3)),
    "bath": ((_TUB, 0.8), (_VANITY, 1.0), (_TOILET, 0.9)),
    "closet": ((_HANGING, 0.8), (_HANGING, 0.3)),
    "bed": ((_SLIDING, 0.6),),
    "hall": ((_SLIDING, 0.35), (_OUTER_DOOR, 0.5), (_STAIRS, 0.06)),
    "living": ((_OUTER_DOOR, 0.3), (_STAIRS, 0.08)),
    "garage": ((_BOXES, 0.5),),
}
_LOOSE: dict[Use, tuple[tuple[Piece, float], ...]] = {
    "living": (
        (_SOFA, 0.9),
        (_SOFA, 0.5),
        (_TELEVISION, 0.7),
        (_BOOKCASE, 0.5),
        (_CHEST, 0.4),
        (_ARMCHAIR, 0.5),
        (_LOW_TABLE, 0.7),
        (_RUG, 0.5),
        (_LAMP, 0.4),
        (_PLANT, 0.5),
    ),
    "bed": (
        (_BED, 1.0),
        (_NIGHT_TABLE, 0.7),
        (_NIGHT_TABLE, 0.5),
        (_CHEST, 0.6),
        (_WARDROBE, 0.5),
        (_DESK, 0.3),
        (_RUG, 0.4),
        (_BOXES, 0.2),
    ),
    "kitchen": ((_DINING, 0.4), (_BOXES, 0.2)),
    "bath": ((_RUG, 0.2), (_BOXES, 0.3)),
    "dining": ((_DINING, 1.0), (_CHEST, 0.7), (_RUG, 0.3), (_PLANT, 0.5)),
    "office": ((_DESK, 1.0), (_BOOKCASE, 0.9), (_BOOKCASE, 0.6), (_CHEST, 0.5), (_BOXES, 0.4)),
    "hall": ((_CHEST, 0.3), (_PLANT, 0.15), (_RUG, 0.2)),
    "closet": ((_BOXES, 0.5), (_BOXES, 0.4)),
    "garage": tuple(
        (piece, 0.7) for piece in (_BOXES, _BOXES, _BOXES, _CHEST, _BOOKCASE, _WARDROBE)
    ),
}
_CLOSET_M2, _SMALL_M2 = 2.5, 7.0
_NAMED: dict[str, Use] = {
    "corridor": "hall",
    "bedroom": "bed",
    "kitchen": "kitchen",
    "dining": "dining",
    "bathroom": "bath",
}
_CLOSET: dict[Use, float] = {"closet": 0.6, "bath": 0.4}
_LIVING: dict[Use, float] = {"living": 0.8, "kitchen": 0.2}
_SMALL: dict[Use, float] = {"bath": 0.5, "kitchen": 0.2, "bed": 0.2, "office": 0.1}
_LARGE: dict[Use, float] = {
    "bed": 0.4,
    "living": 0.18,
    "kitchen": 0.16,
    "dining": 0.1,
    "office": 0.1,
    "garage": 0.06,
}
_TRIES = 12
_CLEAR_M = 0.3


@dataclass(frozen=True, eq=False)
class Furniture:
    """What stands in a building.

    Attributes:
        uses: of each room.
        solid: (K,) shapely polygons that a camera cannot stand in.
        doors: (D, 2, 2) plan: shut doors that lead nowhere, on the walls of rooms.
        door_rooms: (D,) index of the room each is in.
        lamps: at the ceilings.
    """

    uses: tuple[Use, ...]
    solid: tuple[shapely.Polygon, ...]
    doors: FloatArray
    door_rooms: tuple[int, ...]
    lamps: tuple[Lamp, ...]


def draw_uses(building: Building, rng: np.random.Generator) -> tuple[Use, ...]:
    """What each room is used for, by its label and size."""
    uses: list[Use] = []
    for room in building.rooms:
        if room.label in _NAMED:
            odds = {_NAMED[room.label]: 1.0}
        elif room.label == "closet" or room.area < _CLOSET_M2:
            odds = _CLOSET
        elif room.label == "living":
            odds = _LIVING
        else:
            odds = _SMALL if room.area < _SMALL_M2 else _LARGE
        kinds = list(odds)
        uses.append(kinds[int(rng.choice(len(kinds), p=list(odds.values())))])
    return tuple(uses)


def furnish(
    building: Building,
    uses: Sequence[Use],
    leaves: FloatArray,
    look: Look,
    density: float,
    clear: FloatArray,
    mesh: MeshBuilder,
    rng: np.random.Generator,
    bare: frozenset[int] = frozenset(),
) -> Furniture:
    """Adds lamps, beams, fitted and loose furniture.

    Args:
        building: what is furnished.
        uses: of its rooms.
        leaves: (K, 2, 2) open door leaves, hinge to edge.
        look: its materials.
        density: 0 for a home without loose furniture, 1 for a full one.
        clear: (N, 2) plan: places that people walk; nothing stands there.
        mesh: what they are added to.
        rng: of all choices.
        bare: indices of the rooms that have nothing but a lamp.

    Returns:
        What stands where.
    """
    solid: list[shapely.Polygon] = []
    doors: list[FloatArray] = []
    door_rooms: list[int] = []
    lamps: list[Lamp] = []
    for k, room in enumerate(building.rooms):
        spot = _Room(building, k, leaves, clear, look, mesh, rng)
        if k in bare:
            lamps += spot.light()
            continue
        for piece, odds in _FITTED.get(uses[k], ()):
            if rng.random() < odds:
                base = spot.put(piece)
                if base is not None and piece in (_SLIDING, _OUTER_DOOR):
                    doors.append(base)
                    door_rooms.append(k)
        for piece, odds in _LOOSE[uses[k]]:
            if rng.random() < odds * density:
                spot.put(piece)
        for piece, most in (
            (_PICTURE, 4 * density),
            (_SWITCH, 3.0),
            (_GRILLE, 1.0),
            (_RADIATOR, 0.6),
        ):
            for _ in range(rng.poisson(most / 2)):
                spot.put(piece)
        lamps += spot.light()
        if rng.random() < 0.12 and uses[k] not in ("closet", "bath"):
            spot.beams(room.ceiling_height_m)
        solid += spot.solid
    return Furniture(
        tuple(uses),
        tuple(solid),
        np.array(doors).reshape(-1, 2, 2),
        tuple(door_rooms),
        tuple(lamps),
    )


class _Room:
    """One room while it is furnished."""

    def __init__(
        self,
        building: Building,
        index: int,
        leaves: FloatArray,
        clear: FloatArray,
        look: Look,
        mesh: MeshBuilder,
        rng: np.random.Generator,
    ) -> None:
        room = building.rooms[index]
        self.polygon, self.ceiling = room.polygon, room.ceiling_height_m
        self.look, self.mesh, self.rng = look, mesh, rng
        self.area = room.floor
        self.solid: list[shapely.Polygon] = []
        faces = [p.faces[p.side(index)] for p in building.passages if index in p.rooms]
        self.ways = [shapely.LineString(face).buffer(0.75, cap_style="flat") for face in faces]
        self.ways += [shapely.LineString(leaf).buffer(0.05) for leaf in leaves]
        if len(clear):
            self.ways.append(shapely.MultiPoint(clear).buffer(_CLEAR_M))
        # What hangs flat on a wall keeps clear of the holes in it only.
        holes = faces + [w.segment for w in building.windows if w.room == index]
        self.holes = [shapely.LineString(hole).buffer(0.15) for hole in holes]

    def put(self, piece: Piece) -> FloatArray | None:
        """Places a piece where it fits; (2, 2) its back on the wall, None where it fits nowhere."""
        rng = self.rng
        width, depth, height = (
            float(rng.uniform(*r)) for r in (piece.width, piece.depth, piece.height)
        )
        flat = depth < 0.05
        tall = not flat and height > 1.3
        for _ in range(_TRIES):
            if piece.at_wall:
                k = int(rng.integers(len(self.polygon)))
                a, b = self.polygon[k], self.polygon[(k + 1) % len(self.polygon)]
                length = float(np.hypot(*(b - a)))
                if length < width + 0.04:
                    continue
                along = (b - a) / length
                at_end = rng.random() < 0.4 and not flat
                slack = length - width
                shift = (
                    float(rng.choice([0.01, slack - 0.01])) if at_end else rng.uniform(0.02, slack)
                )
                origin = a + (shift + width / 2) * along
            else:
                turn = float(rng.choice(np.arange(4))) * np.pi / 2
                edge = self.polygon[1] - self.polygon[0]
                edge = edge / np.hypot(*edge)
                c, s = np.cos(turn), np.sin(turn)
                along = np.array([c * edge[0] - s * edge[1], s * edge[0] + c * edge[1]])
                low, high = self.polygon.min(axis=0), self.polygon.max(axis=0)
                origin = rng.uniform(low, high)
            inward = np.array([-along[1], along[0]])
            base = np.array([origin - width / 2 * along, origin + width / 2 * along])
            print_ = shapely.Polygon([*base, *(base + (depth + 0.01) * inward)[::-1]])
            gap = 0.0 if piece.at_wall else 0.05
            if not self.area.buffer(1e-3 - gap).covers(print_):
                continue
            barred = (
                self.holes if flat else [*self.ways, *self.solid, *(self.holes if tall else ())]
            )
            if flat:
                barred = [*barred, *(s for s in self.solid if piece not in (_PICTURE, _RUG))]
            if any(print_.intersects(other) for other in barred):
                continue
            piece.build(
                Place(origin, along, inward, self.mesh), width, depth, height, rng, self.look
            )
            if piece is not _RUG and piece is not _PICTURE:
                self.solid.append(print_)
            return base
        return None

    def light(self) -> list[Lamp]:
        """Mostly a lamp in the middle of the ceiling."""
        centre = self.area.representative_point() if len(self.polygon) > 4 else self.area.centroid
        middle = np.array([centre.x, centre.y])
        if not self.area.covers(centre.buffer(0.65)) or self.rng.random() > 0.85:
            return []
        low = centre.buffer(_CLEAR_M)
        hanging = not any(low.intersects(other) for other in self.ways)
        lamp, hangs = f.ceiling_lamp(middle, self.ceiling, self.mesh, self.rng, hanging=hanging)
        if hangs:
            self.solid.append(low)
        return [lamp]

    def beams(self, ceiling: float) -> None:
        """Beams under the ceiling from wall to wall."""
        rng = self.rng
        edge = self.polygon[1] - self.polygon[0]
        along = edge / np.hypot(*edge) * 1.0
        if rng.random() < 0.5:
            along = np.array([-along[1], along[0]])
        side = np.array([-along[1], along[0]])
        reach = self.polygon @ side
        deep, wide = float(rng.uniform(0.08, 0.35)), float(rng.uniform(0.1, 0.3))
        look = (
            Material(Pattern.PANELS, wood(rng), contrast=0.6)
            if rng.random() < 0.4
            else self.look.ceiling
        )
        count = 1 if rng.random() < 0.5 else int(rng.integers(2, 6))
        for share in (np.arange(count) + 0.5) / count + (
            rng.uniform(-0.3, 0.3) if count == 1 else 0
        ):
            offset = reach.min() + share * np.ptp(reach)
            line = shapely.LineString(
                [offset * side - 99 * along, offset * side + 99 * along]
            ).intersection(self.area)
            for part in getattr(line, "geoms", [line]):
                if part.length > 0.5 and part.geom_type == "LineString":
                    ends = np.asarray(part.coords)
                    if (ends[1] - ends[0]) @ along < 0:
                        ends = ends[::-1]
                    low, high = (0.0, -wide / 2, ceiling - deep), (part.length, wide / 2, ceiling)
                    self.mesh.box(ends[0], along, side, low, high, look)
