"""Doors and openings between the rooms of a house, by what the rooms are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from panoplan.simulate.adjacency import SharedWall, longest_walls, shared_walls
from panoplan.simulate.buildings import InteriorRoom, Passage, PassageKind

WAYS = frozenset({"corridor", "hall"})
SHARED = frozenset({"living", "dining", "kitchen", "family"})
SERVANT = frozenset({"closet", "bathroom"})
_JAMB_MARGIN_M = 0.1
_THICKEST_M = 0.26
_NARROW_OPENING = 0.4
"""An opening is at least this share of what the wall allows."""


@dataclass(frozen=True)
class Joinery:
    """How rooms are joined.

    Attributes:
        openings: probability that two shared rooms, or a way and a shared room, that are joined
            are so by an opening.
        rounds: probability of a further passage between shared rooms or ways that are joined
            already by another way round.
        door_m: least and largest width of a door.
        double_share: probability that a door is a double one.
        widest_opening_m: of the openings.
        whole_walls: probability that an opening no wider than that leaves nothing of the wall
            that both rooms share, neither jamb nor stub.
    """

    openings: float
    rounds: float
    door_m: tuple[float, float]
    double_share: float
    widest_opening_m: float
    whole_walls: float = 0.0


def join(
    rooms: Sequence[InteriorRoom], how: Joinery, rng: np.random.Generator
) -> tuple[Passage, ...]:
    """Passages that join as many rooms as the walls allow.

    A closet or bathroom has one door; ways and shared rooms are joined first, then what lies
    beside a way, then what can be reached through other rooms only.

    Args:
        rooms: disjoint; neighbours have parallel walls.
        how: the widths and shares.
        rng: of all choices.

    Returns:
        At most one passage a pair of rooms.
    """
    walls = longest_walls(shared_walls([r.polygon for r in rooms], _THICKEST_M))
    ranked = sorted(
        ((_rank(rooms, wall) + rng.random(), wall) for wall in walls),
        key=lambda pair: pair[0],
    )
    group = list(range(len(rooms)))
    doors = [0] * len(rooms)
    passages: list[Passage] = []
    for _, wall in ranked:
        labels = [rooms[k].label for k in wall.rooms]
        public = all(label in WAYS | SHARED for label in labels)
        i, j = (group[k] for k in wall.rooms)
        if i == j and not (public and rng.random() < how.rounds):
            continue
        if any(rooms[k].label in SERVANT and doors[k] for k in wall.rooms):
            continue
        passage = _passage(wall, how, how.openings if public else 0.0, rng)
        if passage is None:
            continue
        passages.append(passage)
        for k in wall.rooms:
            doors[k] += 1
        group = [i if g == j else g for g in group]
    return tuple(passages)


def _rank(rooms: Sequence[InteriorRoom], wall: SharedWall) -> float:
    labels = {rooms[k].label for k in wall.rooms}
    if labels <= WAYS:
        return 0.0
    if labels <= WAYS | SHARED:
        return 1.0
    if labels & WAYS:
        return 1.5 if labels & SERVANT else 1.0
    if labels <= SERVANT:
        return 5.0
    return 2.0 if labels & SERVANT else 3.0


def _passage(
    wall: SharedWall, how: Joinery, opening_share: float, rng: np.random.Generator
) -> Passage | None:
    room = wall.length - 2 * _JAMB_MARGIN_M
    wants_opening, wants_double = rng.random() < opening_share, rng.random() < how.double_share
    width = float(rng.uniform(*how.door_m))
    kind: PassageKind = "door"
    whole = wants_opening and how.whole_walls > 0 and rng.random() < how.whole_walls
    if whole and 1.2 <= wall.length <= how.widest_opening_m:
        return Passage("opening", wall.rooms, wall.faces(0.0, wall.length))
    if wants_opening and room >= 1.2:
        most = min(how.widest_opening_m, room)
        kind, width = "opening", float(rng.uniform(max(1.2, _NARROW_OPENING * most), most))
    elif wants_double and room >= 2 * width:
        width = min(2 * width, 1.8)
    if width > room:
        return None
    start = _JAMB_MARGIN_M + float(rng.beta(0.6, 0.6)) * (room - width)
    return Passage(kind, wall.rooms, wall.faces(start, start + width))
