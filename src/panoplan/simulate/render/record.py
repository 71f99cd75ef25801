"""The pictures that a simulated walk would have brought home."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from panoplan.formats.atomic import make_folder, write_bytes
from panoplan.formats.depth import write_depth
from panoplan.formats.layout_npz import write_layout_npz
from panoplan.formats.sequence import TRUE_LAYOUTS
from panoplan.geometry.rigid import heading_of
from panoplan.simulate.render.develop import develop, draw_development, jpeg
from panoplan.simulate.render.labels import Labeller
from panoplan.simulate.render.scene import Quality, Scene
from panoplan.simulate.scene import SimulatedScene
from panoplan.simulate.walks import about_y
from panoplan.types.arrays import FloatArray

IMAGES, DEPTHS = "images", "depth"
_JPEG_QUALITY = 92


@dataclass(frozen=True)
class Session:
    """How a home is prepared and photographed.

    Attributes:
        furnished: 0 for no loose furniture, 1 for a full home; drawn where None.
        doors_open: whether every door is open, not only those that the camera comes by.
        sharp: whether the camera is a sharp one on a tripod; drawn as any where not.
        bare: indices of the rooms that are empty and of an even white.
    """

    furnished: float | None = None
    doors_open: bool = False
    sharp: bool = False
    bare: frozenset[int] = frozenset()


USUAL = Session()
_SHARP_PX = 0.35
"""Blur of a sharp camera, pixels of a picture 1024 wide."""


def record(
    folder: Path,
    simulated: SimulatedScene,
    seed: int,
    quality: Quality,
    *,
    width: int = 1024,
    session: Session = USUAL,
    jobs: int = 1,
    told: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, str]:
    """Photographs every keyframe of a simulated walk with one camera.

    Args:
        folder: gets `images/ID.jpg`; `depth/ID.png`, 16 bit, millimetres along the ray, 0 where
            nothing was met; `layouts_gt/ID.npz`, the true layouts.
        simulated: the walk.
        seed: of the building's looks and the camera.
        quality: of the rendering.
        width: of the images.
        session: how the home is prepared and photographed.
        jobs: processes, this one included; the pictures do not depend on it.
        told: called with the number of pictures done and of all.

    Returns:
        Path of each image within the folder, by its keyframe's id.

    Raises:
        InputError: the building cannot be labelled from a keyframe, or a place cannot be written.
    """
    for part in (IMAGES, DEPTHS, TRUE_LAYOUTS):
        make_folder(folder / part)
    count = len(simulated.keyframes)
    mine, *others = (range(k, count, jobs) for k in range(jobs))
    # Fresh processes: forked ones would inherit the threads of the progress display.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(max(1, len(others)), mp_context=context) as pool:
        working = [
            pool.submit(_photograph, folder, simulated, seed, quality, width, session, numbers)
            for numbers in others
        ]
        _photograph(
            folder,
            simulated,
            seed,
            quality,
            width,
            session,
            mine,
            lambda k: told(min(k + jobs, count), count),
        )
        for work in working:
            work.result()
    return {keyframe.id: _image(keyframe.id) for keyframe in simulated.keyframes}


def _image(key: str) -> str:
    return f"{IMAGES}/{key}.jpg"


def _photograph(
    folder: Path,
    simulated: SimulatedScene,
    seed: int,
    quality: Quality,
    width: int,
    session: Session,
    numbers: Sequence[int],
    told: Callable[[int], None] = lambda number: None,
) -> None:
    """Takes some of the pictures."""
    scene_seed, camera_seed, *seeds = np.random.SeedSequence(seed).spawn(
        2 + len(simulated.keyframes)
    )
    poses = simulated.truth.trajectory
    if poses is None:
        raise ValueError("a simulated scene without its true trajectory")
    scene = Scene(
        simulated.building,
        scene_seed,
        quality,
        furnished=session.furnished,
        clear=kept_clear(simulated, session),
        bare=session.bare,
    )
    labeller = Labeller(scene)
    # The file itself is the only compression.
    development = replace(draw_development(np.random.default_rng(camera_seed)), jpeg=0)
    if session.sharp:
        development = replace(development, blur_px=_SHARP_PX)
    for k in numbers:
        pose, key = poses[k], simulated.keyframes[k].id
        camera = pose.translation - np.array([0.0, simulated.camera_height_m, 0.0])
        panorama = scene.panorama(camera, pose.rotation, width)
        picture = develop(panorama.radiance, development, np.random.default_rng(seeds[k]))
        heading = heading_of(pose.rotation)
        labels = labeller.labels(
            camera[[0, 2]],
            heading,
            -float(camera[1]),
            width=width,
            level_from_cam=about_y(np.array([-heading]))[0] @ pose.rotation,
        )
        write_bytes(folder / _image(key), jpeg(picture, _JPEG_QUALITY))
        write_depth(folder / DEPTHS / f"{key}.png", panorama.distance_m)
        write_layout_npz(folder / TRUE_LAYOUTS / f"{key}.npz", labels.closed)
        told(k)


def kept_clear(simulated: SimulatedScene, session: Session) -> FloatArray:
    """(N, 2) plan: where nothing may stand and doors are open.

    Raises:
        ValueError: a scene without its true trajectory.
    """
    poses = simulated.truth.trajectory
    if poses is None:
        raise ValueError("a simulated scene without its true trajectory")
    stands = poses.translations[:, [0, 2]]
    if not session.doors_open:
        return np.asarray(stands)
    doors = [passage.area.mean(axis=0) for passage in simulated.building.passages]
    return np.vstack([stands, *doors])
