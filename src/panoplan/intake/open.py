"""From whatever a run was given to a scene."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from panoplan.cache import Cache
from panoplan.config import Config
from panoplan.datasets.detect import image_files, open_scene
from panoplan.datasets.scene import Scene
from panoplan.intake.given import Given, recognise
from panoplan.intake.layouts import open_images_with_poses
from panoplan.intake.live import Follower, LayoutOf
from panoplan.intake.panoramas import Panoramas
from panoplan.intake.scene_folder import Report
from panoplan.intake.tour import is_tour, open_tour
from panoplan.intake.walk import open_walk
from panoplan.pipeline import Progress


def open_input(
    given: Given,
    work: Path,
    cache: Cache,
    progress: Progress,
    live: Callable[[LayoutOf], Follower],
    config: Config,
) -> tuple[Scene, Report]:
    """Opens whatever was given and makes what is missing.

    Args:
        given: what there is.
        work: folder for what is made: a sequence folder of its own.
        cache: of what was computed before.
        progress: is told how far the work has come.
        live: makes what follows the walk while it goes on, such as `LivePlan`.
        config: settings.

    Returns:
        The scene, and what else there is to tell; images without a layout and the reasons are in
        the scene.

    Raises:
        InputError: nothing usable, or images without a network to look at them.
        MissingExtraError: what looks at images is not installed.
    """
    kind = recognise(given)
    if kind == "scene":
        scene = open_scene(
            given.path,
            trajectory=given.trajectory,
            layouts=given.layouts,
            version=given.version,
        )
        return scene, Report()
    if kind == "images with poses":
        return open_images_with_poses(given, work, cache, progress), Report()
    if kind == "video":
        panoramas = Panoramas.of_video(given.path)
    else:
        panoramas = Panoramas.of_images(given.path, image_files(given.path))
        if is_tour(panoramas):
            return open_tour(given, panoramas, work, cache, progress, config)
    return open_walk(given, panoramas, work, cache, progress, live)
