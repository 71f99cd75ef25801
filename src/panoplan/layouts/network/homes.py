"""Homes to learn from: more open plans and more closets than the families of the benchmark have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from panoplan.simulate.buildings import Building
from panoplan.simulate.families import family_of, make_building
from panoplan.simulate.flats import make_corridor_building, make_flat
from panoplan.simulate.houses import make_house
from panoplan.simulate.joining import Joinery

_MOST_ROOMS = 14


def draw_home(rng: np.random.Generator, *, open_plans: bool = True) -> Building:
    """Some home.

    Args:
        rng: of all choices.
        open_plans: False for doors between all rooms of most homes.
    """
    seed, kind = int(rng.integers(2**31)), rng.random()
    if kind < 0.05:
        return make_corridor_building(int(rng.integers(3, 9)), seed, opening_share=0.3)
    if kind < 0.75:
        return _open_plan(seed, rng) if open_plans else make_flat(seed, opening_share=0.0)
    if kind < 0.87:
        return make_building("flat", seed)
    opening_share = float(rng.choice([0.05, 0.3, 0.7]))
    return make_flat(seed, opening_share=opening_share, extra_doors=float(rng.uniform(0, 0.5)))


def _open_plan(seed: int, rng: np.random.Generator) -> Building:
    """A flat whose shared rooms run into one another, with closets in plenty."""
    flat = family_of("flat")
    rooms, area = flat.size(seed)
    more = int(rng.integers(0, 4))
    joinery = Joinery(
        openings=float(rng.uniform(0.6, 1.0)),
        rounds=float(rng.uniform(0.3, 0.9)),
        door_m=(0.62, 0.95),
        double_share=float(rng.uniform(0.0, 0.4)),
        widest_opening_m=float(rng.uniform(3.0, 8.0)),
        whole_walls=float(rng.uniform(0.0, 0.9)),
    )
    style = replace(flat.style, closet_share=float(rng.uniform(0.15, 0.4)), doors=joinery)
    # A closet adds a room, and next to nothing to the area.
    return make_house("home", style, min(rooms + more, _MOST_ROOMS), area + 2.0 * more, rng)
