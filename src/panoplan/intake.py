"""From what was given to a scene: layouts are predicted where there are images and none."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from panoplan.cache import Cache
from panoplan.datasets.detect import has_layouts, image_files, open_scene
from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.formats.sequence import LAYOUTS
from panoplan.layouts.images import Predicted, image_ids, predict_layouts
from panoplan.layouts.onnx import SHIPPED, Averaging, OnnxLayouts
from panoplan.pipeline import Progress


@dataclass(frozen=True)
class Given:
    """What a run was given.

    Attributes:
        path: a scene or images.
        trajectory: file used instead of the folder's own.
        layouts: folder used instead of the folder's own.
        version: of an MP3D-FPE scene that has several.
        model: layout network used instead of the shipped one.
        averaging: what the network is asked besides the image as it is.
    """

    path: Path
    trajectory: Path | None = None
    layouts: Path | None = None
    version: str | None = None
    model: Path | None = None
    averaging: tuple[Averaging, ...] = ()


def open_input(given: Given, work: Path, cache: Cache, progress: Progress) -> Scene:
    """Opens whatever was given and makes what is missing.

    Args:
        given: what there is.
        work: folder for what is made: layouts_pred/.
        cache: of what was computed before.
        progress: is told how far the work has come.

    Returns:
        The scene; images without a layout and the reasons are in it.

    Raises:
        InputError: nothing usable, or images without a network to look at them.
        MissingExtraError: what looks at images is not installed.
    """
    path = given.path
    images: list[Path] = []
    if given.layouts is None and path.is_dir() and not has_layouts(path, given.version):
        images = image_files(path)
    if not images:
        return open_scene(
            path, trajectory=given.trajectory, layouts=given.layouts, version=given.version
        )
    network = open_network(given.model, given.averaging)
    predicted = predict_layouts(
        image_ids(images),
        work / LAYOUTS,
        network,
        cache,
        lambda done, total: progress(done, total, "layouts"),
    )
    if not predicted.files:
        raise InputError(path, f"{len(images)} images, {_worst(predicted)}", "panoramas of rooms")
    scene = open_scene(path, trajectory=given.trajectory, layouts=work / LAYOUTS)
    return _with_reasons(scene, predicted)


def open_network(model: Path | None, averaging: tuple[Averaging, ...]) -> OnnxLayouts:
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


def _worst(predicted: Predicted) -> str:
    name, reason = predicted.left_out[0]
    return f"none usable ({name}: {reason})"


def _with_reasons(scene: Scene, predicted: Predicted) -> Scene:
    """The scene whose keyframes without a layout say why the image gave none."""
    reasons = dict(predicted.left_out)
    keyframes = tuple(
        k if k.layout is not None else replace(k, missing=reasons.pop(k.id, k.missing))
        for k in scene.keyframes
    )
    left = tuple((name, reason) for name, reason in reasons.items())
    return replace(scene, keyframes=keyframes, skipped=(*scene.skipped, *left))
