"""The plan of a walk, as every benchmark makes it, and what it is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from panoplan.config import Config
from panoplan.datasets.detect import open_scene
from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.formats.image import read_panorama
from panoplan.formats.sequence import TRUE_TRAJECTORY, read_sequence
from panoplan.intake.layouts import layout_of
from panoplan.layouts.onnx import OnnxLayouts
from panoplan.pipeline import Progress
from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.plan import FloorPlan


def estimate(keyframes: Sequence[Keyframe], config: Config, walk: Walk) -> FloorPlan:
    """The plan at the end of a walk, as it is when all that can still change it is done."""
    estimator = FloorPlanEstimator(config, walk)
    for keyframe in keyframes:
        estimator.update(keyframe)
    estimator.finish()
    return estimator.plan()


def true_poses(folder: Path) -> Scene:
    """A scene with its true poses, which are metric, and its predicted layouts.

    Raises:
        InputError: the folder is not complete.
    """
    return open_scene(folder, trajectory=folder / TRUE_TRAJECTORY)


def images_of(folder: Path) -> dict[str, Path]:
    """The images of a sequence folder by their keyframes' ids.

    Raises:
        InputError: it has none, or is no sequence folder.
    """
    found = {k.id: folder / k.image for k in read_sequence(folder).keyframes if k.image}
    if not found:
        raise InputError(folder, "no image", "a scene with images")
    return found


def predicted(
    images: Mapping[str, Path], network: OnnxLayouts, progress: Progress
) -> dict[str, Layout]:
    """A network's layouts of images, without those whose answer cannot be believed.

    Raises:
        InputError: an image cannot be read.
    """
    found = {}
    for done, (name, path) in enumerate(images.items()):
        progress(done, len(images), "layouts")
        layout = layout_of(network, read_panorama(path))
        if layout is not None:
            found[name] = layout
    return found


def metric_plan(scene: Scene, config: Config) -> FloorPlan:
    """The plan of a scene whose poses are known to be in metres."""
    walk = Walk("m", scene.camera_height_m, len(scene.keyframes))
    return estimate(scene.keyframes, config, walk)
