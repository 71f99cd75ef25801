"""A small made-up home, walked through with a camera: what the demonstration begins with."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from panoplan.formats.sequence import write_sequence
from panoplan.simulate.flats import make_flat
from panoplan.simulate.render.record import IMAGES, record
from panoplan.simulate.render.scene import QUALITIES
from panoplan.simulate.scene import SimulatedScene, simulate

_ROOMS, _AREA_M2, _STEP_M = 5, 55.0, 0.25


def sample_home(seed: int) -> SimulatedScene:
    """A walk through a home of five rooms at right angles on 55 m².

    Args:
        seed: of the home and the way.
    """
    home = make_flat(seed, rooms=_ROOMS, area_m2=_AREA_M2, skewed=False)
    return simulate(home, seed, "exact", step_m=_STEP_M, keyframes_per_room=1)


def photograph(
    photographs: Path,
    truth: Path,
    home: SimulatedScene,
    seed: int,
    *,
    jobs: int,
    told: Callable[[int, int], None],
) -> None:
    """Takes the pictures of a home.

    Args:
        photographs: gets the pictures and nothing else; must not exist.
        truth: gets depth, true layouts, true poses and the true plan.
        home: what is photographed.
        seed: of its looks and the camera.
        jobs: processes.
        told: called with the number of pictures done and of all.

    Raises:
        InputError: a place that cannot be written.
        MissingExtraError: the `render` extra is not installed.
    """
    record(truth, home, seed, QUALITIES["preview"], jobs=jobs, told=told)
    write_sequence(truth, home.name, home.keyframes, home.truth, home.camera_height_m)
    (truth / IMAGES).rename(photographs)
