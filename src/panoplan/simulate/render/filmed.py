"""Walks through made-up homes as a camera films them, well and badly."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from panoplan.formats.atomic import write_bytes
from panoplan.formats.image import list_images, read_panorama
from panoplan.formats.sequence import write_sequence
from panoplan.simulate.flats import make_flat
from panoplan.simulate.render.develop import jpeg
from panoplan.simulate.render.record import IMAGES, Session, record
from panoplan.simulate.render.scene import QUALITIES
from panoplan.simulate.scene import SimulatedScene, simulate
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth

Trouble = Literal["blur", "exposure"]
TROUBLES: tuple[Trouble, ...] = get_args(Trouble)
"""A fifth of the frames blurred as by a turn of the hand; brightness that jumps."""
FRAMES = 300
_ROOMS, _AREA_M2, _TILT_DEG = 6, 75.0, 1.0
_BLURRED_SHARE, _SMEARED_RAD = 0.2, np.deg2rad(6.0)
_KEPT_FRAMES = 30
_STOPS = 1.2
_GAMMA = 2.2
_JPEG_QUALITY = 92


def filmed_home(seed: int) -> SimulatedScene:
    """A walk of `FRAMES` frames through a flat of six rooms, the camera tilted by a degree.

    Args:
        seed: of the flat and the way.
    """
    home = make_flat(seed, rooms=_ROOMS, area_m2=_AREA_M2, skewed=False)
    step_m = 0.25
    while True:
        walk = simulate(home, seed, "exact", step_m=step_m, tilt_deg=_TILT_DEG)
        count = len(walk.keyframes)
        if count >= FRAMES:
            return _first(walk, FRAMES)
        step_m *= 0.97 * count / FRAMES


def _first(walk: SimulatedScene, count: int) -> SimulatedScene:
    true = walk.truth.trajectory
    if true is None:
        raise ValueError("a simulated scene without its true trajectory")
    some = Trajectory(true.labels[:count], true.rotations[:count], true.translations[:count])
    truth = GroundTruth(walk.truth.plan, some)
    return replace(walk, keyframes=walk.keyframes[:count], views=walk.views[:count], truth=truth)


def film_walk(
    folder: Path,
    walk: SimulatedScene,
    look: int,
    told: Callable[[int, int], None],
    *,
    bare_corridor: bool = False,
) -> None:
    """Renders a walk and writes it with its truth.

    Args:
        folder: becomes a sequence folder.
        walk: what is filmed.
        look: seed of the home's looks and of the camera.
        told: called with the number of frames done and of all.
        bare_corridor: whether its corridor is empty and of an even white.

    Raises:
        InputError: a place that cannot be written.
        MissingExtraError: the `render` extra is not installed.
    """
    rooms = walk.building.rooms if bare_corridor else ()
    bare = frozenset(k for k, room in enumerate(rooms) if room.label == "corridor")
    session = Session(bare=bare)
    images = record(folder, walk, look, QUALITIES["preview"], session=session, told=told)
    write_sequence(folder, walk.name, walk.keyframes, walk.truth, walk.camera_height_m, images)


def film_badly(good: Path, bad: Path, trouble: Trouble, seed: int) -> None:
    """A walk again, with what can go wrong with its pictures.

    Args:
        good: sequence folder of the walk.
        bad: becomes one with the same truth.
        trouble: "blur" smears a fifth of the pictures sideways by 6°, "exposure" makes all
            brighter or darker by up to 1.2 stops, anew every 30 pictures or so.
        seed: of which and how much.

    Raises:
        InputError: a place that cannot be read or written.
    """
    rng = np.random.default_rng(seed)
    shutil.copytree(good, bad, ignore=shutil.ignore_patterns(IMAGES, "depth"))
    (bad / IMAGES).mkdir()
    gain = 1.0
    for path in list_images(good / IMAGES):
        pixels = read_panorama(path)
        if trouble == "blur" and rng.random() < _BLURRED_SHARE:
            pixels = smeared(pixels, _SMEARED_RAD)
        if trouble == "exposure":
            if rng.random() < 1 / _KEPT_FRAMES:
                gain = float(2 ** rng.uniform(-_STOPS, _STOPS))
            pixels = exposed(pixels, gain)
        write_bytes(bad / IMAGES / path.name, jpeg(pixels, _JPEG_QUALITY))


def smeared(pixels: NDArray[np.uint8], angle_rad: float) -> NDArray[np.uint8]:
    """(H, W, 3) a panorama of a camera that turned by an angle meanwhile."""
    width = max(1, round(pixels.shape[1] * angle_rad / (2 * np.pi)))
    mean = uniform_filter1d(pixels.astype(np.float32), width, axis=1, mode="wrap")
    return np.rint(mean).astype(np.uint8)


def exposed(pixels: NDArray[np.uint8], gain: float) -> NDArray[np.uint8]:
    """(H, W, 3) a panorama exposed longer by a factor; what is too bright for it is white."""
    levels = np.arange(256) / 255
    table = np.rint(255 * np.clip(levels * gain ** (1 / _GAMMA), 0, 1)).astype(np.uint8)
    return table[pixels]
