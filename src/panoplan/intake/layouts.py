"""Layouts for images, by the network that was named or the shipped one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from panoplan.cache import Cache
from panoplan.datasets.detect import image_files, open_scene
from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.formats.image import Pixels
from panoplan.formats.sequence import LAYOUTS
from panoplan.intake.given import Given
from panoplan.layouts.dense import layout
from panoplan.layouts.doubt import answer_doubt, image_doubt
from panoplan.layouts.images import Predicted, image_ids, predict_layouts
from panoplan.layouts.onnx import SHIPPED, Averaging, OnnxLayouts
from panoplan.pipeline import Progress
from panoplan.types.layout import Layout


def open_network(model: Path | None, averaging: Sequence[Averaging]) -> OnnxLayouts:
    """The layout network that was named, or the shipped one.

    Raises:
        InputError: no model is shipped and none named; or as `OnnxLayouts`.
        MissingExtraError: ONNX Runtime is not installed.
    """
    if model is None and not SHIPPED.exists():
        raise InputError(
            "images",
            "no layouts and no network to predict them",
            "--layouts FOLDER, or --model FILE with pip install 'panoplan[images]'",
        )
    return OnnxLayouts(model or SHIPPED, averaging)


def open_images_with_poses(given: Given, work: Path, cache: Cache, progress: Progress) -> Scene:
    """The scene of a folder that has images and poses; layouts are predicted into `work`.

    Raises:
        InputError: no image is usable, no network, or as `open_scene`.
        MissingExtraError: ONNX Runtime is not installed.
    """
    images = image_ids(image_files(given.path))
    network = open_network(given.model, given.averaging)
    predicted = predict(images, network, given.path, work, cache, progress)
    scene = open_scene(given.path, trajectory=given.trajectory, layouts=work / LAYOUTS)
    return with_reasons(scene, predicted)


def predict(
    images: Mapping[str, Path],
    network: OnnxLayouts,
    source: Path,
    work: Path,
    cache: Cache,
    progress: Progress,
) -> Predicted:
    """Predicts layouts of images into `work`.

    Raises:
        InputError: none of the images is usable.
    """
    predicted = predict_layouts(
        images,
        work / LAYOUTS,
        network,
        cache,
        lambda done, total: progress(done, total, "layouts"),
    )
    if not predicted.files:
        name, reason = predicted.left_out[0]
        found = f"{len(images)} images, none usable ({name}: {reason})"
        raise InputError(source, found, "panoramas of rooms")
    return predicted


def layout_of(network: OnnxLayouts, pixels: Pixels) -> Layout | None:
    """The layout of a panorama, None where the answer cannot be believed."""
    if image_doubt(pixels) is not None:
        return None
    dense = network(pixels)
    return None if answer_doubt(dense) is not None else layout(dense)


def with_reasons(scene: Scene, predicted: Predicted) -> Scene:
    """The scene whose keyframes without a layout say why the image gave none."""
    reasons = dict(predicted.left_out)
    keyframes = tuple(
        k if k.layout is not None else replace(k, missing=reasons.pop(k.id, k.missing))
        for k in scene.keyframes
    )
    left = tuple((name, reason) for name, reason in reasons.items())
    return replace(scene, keyframes=keyframes, skipped=(*scene.skipped, *left))
