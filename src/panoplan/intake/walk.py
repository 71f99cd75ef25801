"""A walk's images become a sequence folder: keyframes, their poses, their layouts."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.cache import Cache, content_key
from panoplan.datasets.detect import own_layouts
from panoplan.datasets.folder import open_folder
from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder
from panoplan.formats.sequence import LAYOUTS
from panoplan.intake.given import Given
from panoplan.intake.layouts import open_network, predict, with_reasons
from panoplan.intake.level_images import LevelImages
from panoplan.intake.live import Follower, LayoutOf
from panoplan.intake.panoramas import Panoramas
from panoplan.intake.scene_folder import IMAGES, Report, plain, trajectory_of, write_scene
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.layouts.images import predict_layout
from panoplan.layouts.onnx import OnnxLayouts
from panoplan.pipeline import Progress
from panoplan.poses.level import level, tilts_deg, upright
from panoplan.poses.walk.carried import carried
from panoplan.poses.walk.follow import (
    HEIGHT,
    WIDTH,
    PlacedKeyframe,
    Walked,
    WalkSettings,
    follow,
)
from panoplan.poses.walk.keyframes import EVERY_IMAGE
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory

_STAGE = "walk 2"


def open_walk(
    given: Given,
    panoramas: Panoramas,
    work: Path,
    cache: Cache,
    progress: Progress,
    live: Callable[[LayoutOf], Follower],
) -> tuple[Scene, Report]:
    """The scene of a walk of which there are only images.

    Args:
        given: layouts or the network to use.
        panoramas: of the walk.
        work: becomes a sequence folder of level keyframes.
        cache: of what was computed before.
        progress: is told how far the work has come.
        live: makes what follows the walk while it goes on, such as `LivePlan`.

    Returns:
        The scene of the walk's largest map, and what else there is to tell.

    Raises:
        InputError: nothing usable in the images, no pose found, or no network.
        MissingExtraError: what finds poses or layouts is not installed.
    """
    layouts = given.layouts or own_layouts(given.path)
    network = None if layouts is not None else open_network(given.model, given.averaging)
    pictures = LevelImages(work / IMAGES)
    look = looker(layouts, network, pictures, work, cache)
    walked, masked = _followed(panoramas, cache, progress, live(look), pictures)
    poses, _ = level(_largest_map(walked, panoramas))
    tilts = tilts_deg(poses.rotations)
    pictures.complete(panoramas, poses, progress)
    stand = Trajectory(poses.labels, upright(poses.rotations), poses.translations)
    write_scene(work, panoramas.source, stand)
    if network is not None:
        images = {name: work / IMAGES / f"{name}.jpg" for name in poses.labels}
        predicted = predict(images, network, panoramas.source, work, cache, progress)
        scene = with_reasons(open_folder(work), predicted)
    else:
        scene = open_folder(work, layouts=layouts)
    apart = [(name, "in a map of its own") for map in walked.maps[1:] for name in map.labels]
    lost = [(name, "camera lost") for name in walked.lost if name not in poses.labels]
    skipped = (*scene.skipped, *apart, *lost, *panoramas.left_out.items())
    return replace(scene, kind="walk", skipped=skipped), _report(walked, masked, tilts, panoramas)


def _largest_map(walked: Walked, panoramas: Panoramas) -> Trajectory:
    """The map with most keyframes; a single keyframe is a map of its own."""
    if walked.maps:
        return walked.maps[0]
    if len(walked.lost) == 1:
        return Trajectory(walked.lost, np.eye(3)[None], np.zeros((1, 3)))
    if walked.lost:
        found = f"{len(walked.lost)} keyframes, no two of which could be joined"
        raise InputError(panoramas.source, found, "a walk whose images overlap")
    reasons = list(panoramas.left_out.items())
    found = f"{len(reasons)} images, none usable"
    if reasons:
        found += f" ({reasons[0][0]}: {reasons[0][1]})"
    raise InputError(panoramas.source, found, "panoramas of rooms")


def looker(
    layouts: Path | None,
    network: OnnxLayouts | None,
    pictures: LevelImages,
    work: Path,
    cache: Cache,
) -> LayoutOf:
    """What finds the layout of a keyframe: a folder of files, or a network.

    The network sees the level picture, and what it says of it is kept: it is asked again only
    where the picture is turned otherwise in the end.

    Args:
        layouts: folder of files, where there is no network.
        network: of layouts, or None.
        pictures: get each keyframe's.
        work: gets the layouts.
        cache: of what was computed before.
    """
    if network is None:
        assert layouts is not None
        known = list_layouts(layouts)
        return lambda placed: (
            read_layout(known[placed.seen.name]) if placed.seen.name in known else None
        )
    asked, folder = network, work / LAYOUTS

    def look(placed: PlacedKeyframe) -> Layout | None:
        make_folder(folder)
        picture = pictures.add(placed.seen, placed.pose)
        file = folder / f"{placed.seen.name}.npz"
        return None if predict_layout(picture, file, asked, cache) else read_layout(file)

    return look


def _followed(
    panoramas: Panoramas,
    cache: Cache,
    progress: Progress,
    placed: Callable[[PlacedKeyframe], None],
    pictures: LevelImages,
) -> tuple[Walked, float]:
    """The walk's poses and the share of its images that the camera carries along.

    How `pictures` were turned meanwhile is kept, too.
    """
    settings = WalkSettings() if not panoramas.images else WalkSettings(keyframes=EVERY_IMAGE)
    key = content_key(_STAGE, repr(settings), panoramas.digest())
    known = cache.read(key)
    if known is not None:
        data = json.loads(known)
        panoramas.left_out.update(data["left_out"])
        pictures.turns = {name: np.array(turn) for name, turn in data["turns"].items()}
        return _walked(data), data["masked"]
    mask = carried(panoramas.sample(), WIDTH, HEIGHT)

    def told(keyframe: PlacedKeyframe) -> None:
        placed(keyframe)
        progress(int(panoramas.at), max(int(panoramas.end), int(panoramas.at)), "camera poses")

    walked = follow(panoramas, settings, mask, told)
    masked = 0.0 if mask is None else float(mask.mean())
    turns = {name: turn.tolist() for name, turn in pictures.turns.items()}
    more = {"left_out": panoramas.left_out, "masked": masked, "turns": turns}
    data = {**_plain(walked), **more}
    cache.write(key, json.dumps(data).encode())
    return walked, masked


def _report(walked: Walked, masked: float, tilts: Any, panoramas: Panoramas) -> Report:
    sizes = [len(map) for map in walked.maps] or [1]
    total = max(sum(sizes), sum(len(map) for map in walked.maps) + len(walked.lost))
    lines = [
        f"{sizes[0]} of {total} keyframes have poses in one frame; "
        f"{walked.passed_over} panoramas passed over",
        f"horizon levelled: cameras were tilted by {np.median(tilts):.1f}° in the median, "
        f"{np.max(tilts):.1f}° at most",
    ]
    if len(sizes) > 1:
        told = ", ".join(str(n) for n in sizes[1:])
        lines.append(f"{len(sizes) - 1} other parts of {told} keyframes could not be joined")
    if walked.lost and walked.maps:
        lines.append(f"the camera was lost in {len(walked.lost)} keyframes")
    if masked:
        lines.append(f"{100 * masked:.0f} % of the image is what the camera carries: not looked at")
    if panoramas.left_out:
        lines.append(f"{len(panoramas.left_out)} images left out")
    return Report(tuple(lines))


def _plain(walked: Walked) -> dict[str, Any]:
    return {
        "maps": [plain(map) for map in walked.maps],
        "lost": list(walked.lost),
        "passed_over": walked.passed_over,
    }


def _walked(data: Mapping[str, Any]) -> Walked:
    maps = tuple(trajectory_of(map) for map in data["maps"])
    return Walked(maps, tuple(data["lost"]), data["passed_over"])
