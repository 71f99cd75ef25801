"""Labelled panoramas for training: made-up homes, photographed from everywhere."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from panoplan.layouts.network.homes import draw_home
from panoplan.layouts.network.stands import draw_stand
from panoplan.simulate.render.develop import Development, develop, draw_development
from panoplan.simulate.render.labels import Labeller, Labels
from panoplan.simulate.render.scene import PREVIEW, Quality, Scene
from panoplan.types.arrays import FloatArray
from panoplan.types.layout import Layout

WIDTH = 512
TARGETS = ("floor", "through", "ceiling", "corner", "door", "opening", "window")
"""Rows of a sample's targets: elevations in rad, then shares 0-1."""
REALISM = ("furniture", "light", "camera", "tilt", "open plans", "closets")
"""What can be left out of the samples: loose furniture; the sun, exposure
and colour; blur, noise, compression and what hides the nadir; tilt; rooms open to one another;
small rooms seen from their door or from within."""
_OF_LIGHT = ("exposure", "flattening", "shoulder", "contrast", "balance", "saturation", "lens_step")
_CORNER_DECAY = 0.9
_HEIGHT_M, _HEIGHT_SPREAD_M, _HEIGHT_RANGE_M = 1.5, 0.16, (1.05, 1.85)


@dataclass(frozen=True, eq=False)
class Sample:
    """A panorama and what a network should say of it.

    Attributes:
        image: (WIDTH / 2, WIDTH, 3) as a camera gives it.
        targets: (len(TARGETS), WIDTH).
    """

    image: NDArray[np.uint8]
    targets: NDArray[np.float32]


def samples(
    seed: int,
    per_building: int = 24,
    quality: Quality = PREVIEW,
    without: Collection[str] = (),
) -> Iterator[Sample]:
    """Panoramas without end.

    Args:
        seed: the same seed gives the same ones.
        per_building: how many of each home.
        quality: of the rendering.
        without: those of `REALISM` that are left out.

    Yields:
        A sample at a time.
    """
    root = np.random.SeedSequence(seed)
    while True:
        building_seed, scene_seed, camera_seed = root.spawn(3)
        building = draw_home(
            np.random.default_rng(building_seed), open_plans="open plans" not in without
        )
        scene = Scene(
            building,
            scene_seed,
            quality,
            furnished=0.0 if "furniture" in without else None,
            sunny="light" not in without,
        )
        labeller = Labeller(scene)
        # What is left out of one panorama must not change what is drawn for the next one.
        for rng in np.random.default_rng(camera_seed).spawn(per_building):
            yield _sample(scene, labeller, rng, without)


def targets(labels: Labels) -> NDArray[np.float32]:
    """(len(TARGETS), W) what a network should say."""
    closed = labels.closed
    if closed.ceiling_boundary is None or closed.spans is None:
        raise ValueError("labels of a panorama lack a ceiling or spans")
    spans = closed.spans
    rows = [
        closed.floor_boundary,
        labels.through.floor_boundary,
        closed.ceiling_boundary,
        _corner_share(closed),
        *(_covered(s, closed.width) for s in (spans.doors, spans.openings, spans.windows)),
    ]
    return np.array(rows, dtype=np.float32)


def _sample(
    scene: Scene, labeller: Labeller, rng: np.random.Generator, without: Collection[str]
) -> Sample:
    position, room = draw_stand(scene, rng, small="closets" not in without)
    heading = float(rng.uniform(-np.pi, np.pi))
    height = float(np.clip(rng.normal(_HEIGHT_M, _HEIGHT_SPREAD_M), *_HEIGHT_RANGE_M))
    drawn = _tilt(rng)
    tilt = np.eye(3) if "tilt" in without else drawn
    turn = _turned(heading)
    pixels = scene.panorama(np.array([position[0], -height, position[1]]), turn @ tilt, WIDTH)
    labels = labeller.labels(position, heading, height, width=WIDTH, level_from_cam=tilt, room=room)
    image = develop(pixels.radiance, _development(rng, without), rng)
    return Sample(image, targets(labels))


def _development(rng: np.random.Generator, without: Collection[str]) -> Development:
    """Some camera's, as every camera's in what is left out."""
    plain, drawn = Development(), draw_development(rng)
    names = [
        field.name
        for field in fields(Development)
        if ("light" if field.name in _OF_LIGHT else "camera") in without
    ]
    return replace(drawn, **{name: getattr(plain, name) for name in names})


def _tilt(rng: np.random.Generator) -> FloatArray:
    """A tripod stands straight, or nearly; a hand does not."""
    pitch, roll = np.deg2rad(rng.normal(0, 0.2 if rng.random() < 0.6 else 1.2, 2))
    c, s, d, t = np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
    about_x = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    about_z = np.array([[d, -t, 0], [t, d, 0], [0, 0, 1]])
    return np.asarray(about_x @ about_z)


def _turned(heading: float) -> FloatArray:
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def _corner_share(layout: Layout) -> FloatArray:
    """(W,) 1 at a corner, less with every column beside it."""
    width = layout.width
    if layout.corners is None or len(layout.corners) == 0:
        return np.zeros(width)
    off = np.abs(np.arange(width)[:, None] - layout.corners[None])
    return np.asarray(_CORNER_DECAY ** np.minimum(off, width - off).min(axis=1))


def _covered(spans: FloatArray, width: int) -> FloatArray:
    """(W,) 1 in the columns of the spans."""
    out = np.zeros(width)
    for first, last in np.rint(spans).astype(int):
        count = (last - first) % width + 1
        out[np.arange(first, first + count) % width] = 1
    return out
