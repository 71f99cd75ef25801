"""What a run was given, told by its content."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from panoplan.datasets.detect import has_layouts, has_trajectory, image_files
from panoplan.formats.video import ENDINGS
from panoplan.layouts.onnx import Averaging

Kind = Literal["scene", "images with poses", "images", "video"]


@dataclass(frozen=True)
class Given:
    """What a run was given.

    Attributes:
        path: a scene, images or a video.
        trajectory: file used instead of the folder's own.
        layouts: folder used instead of the folder's own.
        version: of an MP3D-FPE scene that has several.
        model: layout network used instead of the shipped one.
        averaging: what the network is asked besides the image as it is.
        camera_height_m: above the floor in metres, None where it is not known.
    """

    path: Path
    trajectory: Path | None = None
    layouts: Path | None = None
    version: str | None = None
    model: Path | None = None
    averaging: tuple[Averaging, ...] = ()
    camera_height_m: float | None = None


def recognise(given: Given) -> Kind:
    """What the path is.

    Returns:
        "video" for a file with a video's ending, "images" for a folder with images and no poses,
        "images with poses" for one with poses and no layouts, else "scene".
    """
    path = given.path
    if path.is_file() and path.suffix.lower() in ENDINGS:
        return "video"
    if not path.is_dir() or not image_files(path):
        return "scene"
    posed = given.trajectory is not None or has_trajectory(path, given.version)
    if not posed:
        return "images"
    told = given.layouts is not None or has_layouts(path, given.version)
    return "scene" if told else "images with poses"
