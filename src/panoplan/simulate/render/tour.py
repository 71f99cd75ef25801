"""A made-up home photographed as an estate agent does: a few sharp stills a room, doors open."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.sequence import write_sequence
from panoplan.simulate.flats import make_flat
from panoplan.simulate.render.record import Session, record
from panoplan.simulate.render.scene import QUALITIES
from panoplan.simulate.scene import Grade, SimulatedScene, noise_model, recorded
from panoplan.simulate.walks import stills

_GRADE: Grade = "measured"
_ROOMS, _ROOM_M2, _OPENING_SHARE = (8, 9), 7.5, 0.25
_PHOTOS_A_ROOM, _IN_DOORWAYS = 1.7, 0.25
"""As in a real tour, closets counted as rooms; a quarter of its photos stands in a doorway."""
_WIDTH_PX, _QUALITY = 2048, replace(QUALITIES["still"], samples=1)
"""As many rays as a still of 1024 px has, each a pixel of its own."""
_FURNISHED = (0.5, 1.0)


def tour_home(seed: int) -> SimulatedScene:
    """A tour of a flat of small rooms: a photo in each, more in doorways and where most floor is.

    Args:
        seed: of the flat, the places and the errors of the layouts, ≥ 0.

    Raises:
        InputError: a negative seed.
    """
    if seed < 0:
        raise InputError("seed", str(seed), "0 or more")
    ways, noise, drift = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(3))
    rooms = int(ways.integers(_ROOMS[0], _ROOMS[1] + 1))
    flat = make_flat(seed, rooms=rooms, area_m2=_ROOM_M2 * rooms, opening_share=_OPENING_SHARE)
    building = replace(flat, name=f"tour_{seed:04d}")
    photos = round(_PHOTOS_A_ROOM * rooms)
    doorways = round(_IN_DOORWAYS * photos)
    counts = _counts([room.area for room in building.rooms], photos - doorways)
    way = stills(building, ways, counts=counts, doorways=doorways)
    return recorded(building, way, noise_model(_GRADE), 1.0, noise, drift)


def _counts(areas: Sequence[float], photos: int) -> list[int]:
    """Photos of each room: each further one goes where there is most floor a photo."""
    counts = [1] * len(areas)
    while sum(counts) < photos:
        floor = [area / count for area, count in zip(areas, counts, strict=True)]
        counts[int(np.argmax(floor))] += 1
    return counts


def photograph_tour(
    folder: Path, home: SimulatedScene, seed: int, told: Callable[[int, int], None]
) -> None:
    """Takes the photos of a tour and writes them with layouts and truth.

    Args:
        folder: becomes a sequence folder with the true poses and the true plan.
        home: the tour.
        seed: of the home's looks, furniture and the camera.
        told: called with the number of photos done and of all.

    Raises:
        InputError: a place that cannot be written.
        MissingExtraError: the `render` extra is not installed.
    """
    furnished = float(np.random.default_rng([seed, 1]).uniform(*_FURNISHED))
    session = Session(furnished, doors_open=True, sharp=True)
    images = record(folder, home, seed, _QUALITY, width=_WIDTH_PX, session=session, told=told)
    write_sequence(folder, home.name, home.keyframes, home.truth, home.camera_height_m, images)
