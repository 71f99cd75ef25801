"""A photo tour's images become a sequence folder: sparse stills, metres apart."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panoplan.cache import Cache, content_key
from panoplan.config import Config
from panoplan.datasets.detect import own_layouts
from panoplan.datasets.folder import open_folder
from panoplan.datasets.scene import Scene
from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder
from panoplan.formats.image import read_panorama, resized, write_jpeg
from panoplan.intake.given import Given
from panoplan.intake.layouts import open_network, predict, with_reasons
from panoplan.intake.panoramas import Panoramas
from panoplan.intake.scene_folder import IMAGES, Report, plain, trajectory_of, write_scene
from panoplan.layouts.files import list_layouts, read_layout
from panoplan.layouts.images import Predicted
from panoplan.pipeline import Progress
from panoplan.poses.tour.tour import join_tour
from panoplan.poses.walk.features import Extractor, matches
from panoplan.poses.walk.follow import working_grey
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory

_STAGE = "tour 1"
_PAIRS_LOOKED_AT = 12
_WALK_SHARE = 0.12
_LOOK_PX = (128, 64)
_COPY_LEVELS = 1.0
"""Two photos are copies of one whose small pictures differ by less, grey levels in the mean."""


def is_tour(panoramas: Panoramas) -> bool:
    """Whether images are stills far apart and not the frames of a walk.

    A dozen pairs of images that follow one another are looked at: in a walk, an eighth of the
    points of interest and more are found again.

    Raises:
        MissingExtraError: pycolmap is not installed.
    """
    names = list(panoramas.images)
    if len(names) < 2:
        return False
    extract = Extractor()
    shares = []
    for k in np.unique(np.linspace(0, len(names) - 2, _PAIRS_LOOKED_AT).astype(int)):
        try:
            one, other = (
                extract(working_grey(read_panorama(panoramas.images[names[n]]))) for n in (k, k + 1)
            )
        except InputError:
            continue
        shares.append(len(matches(one, other)) / max(len(one.points), 1))
    return bool(shares) and float(np.median(shares)) < _WALK_SHARE


def open_tour(
    given: Given,
    panoramas: Panoramas,
    work: Path,
    cache: Cache,
    progress: Progress,
    config: Config,
) -> tuple[Scene, Report]:
    """The scene of sparse photos.

    Args:
        given: layouts or the network to use, the camera height.
        panoramas: the photos.
        work: becomes a sequence folder.
        cache: of what was computed before.
        progress: is told how far the work has come.
        config: settings.

    Returns:
        The scene of the largest group of photos in one frame, in metres where the camera height
        is known, and what else there is to tell.

    Raises:
        InputError: no photo is usable, or no network.
        MissingExtraError: what finds poses or layouts is not installed.
    """
    make_folder(work / IMAGES)
    images: dict[str, Path] = {}
    looks: dict[str, NDArray[np.int16]] = {}
    for seen in panoramas:
        look = resized(seen.pixels, *_LOOK_PX).astype(np.int16)
        twin = next((name for name in looks if _alike(looks[name], look)), None)
        if twin is not None:
            panoramas.left_out[seen.name] = f"a copy of {twin}"
            continue
        looks[seen.name] = look
        images[seen.name] = work / IMAGES / f"{seen.name}.jpg"
        write_jpeg(images[seen.name], seen.pixels)
        progress(len(images), len(panoramas.images), "photos")
    if not images:
        name, reason = next(iter(panoramas.left_out.items()), ("none", "there is none"))
        found = f"{len(panoramas.left_out)} images, none usable ({name}: {reason})"
        raise InputError(panoramas.source, found, "panoramas of rooms")
    folder = given.layouts or own_layouts(given.path)
    predicted = Predicted({}, ())
    if folder is None:
        network = open_network(given.model, given.averaging)
        predicted = predict(images, network, panoramas.source, work, cache, progress)
        files: Mapping[str, Path] = predicted.files
    else:
        files = {n: p for n, p in list_layouts(folder).items() if n in images}
    layouts = {name: read_layout(path) for name, path in files.items()}
    groups, reasons = _joined(images, layouts, files, panoramas, cache, progress, config)
    height = given.camera_height_m or 1.0
    first = groups[0]
    poses = Trajectory(first.labels, np.array(first.rotations), first.translations * height)
    write_scene(work, panoramas.source, poses)
    scene = with_reasons(open_folder(work, layouts=folder), predicted)
    left = {**reasons, **panoramas.left_out}
    scene = replace(scene, kind="photo tour", skipped=(*scene.skipped, *left.items()))
    lines = _lines(groups, reasons, panoramas)
    return scene, Report(lines) if given.camera_height_m is None else Report(lines, "m")


def _alike(one: NDArray[np.int16], other: NDArray[np.int16]) -> bool:
    """Whether two small pictures differ by no more than a file's compression makes."""
    return bool(np.abs(one - other).mean() < _COPY_LEVELS)


class _Greys(Mapping[str, NDArray[np.uint8]]):
    """Grey levels of images, read when asked for."""

    def __init__(self, images: Mapping[str, Path]) -> None:
        self._images = images

    def __getitem__(self, name: str) -> NDArray[np.uint8]:
        pixels = read_panorama(self._images[name]).astype(np.float32)
        return np.rint(pixels @ np.array([0.299, 0.587, 0.114], np.float32)).astype(np.uint8)

    def __iter__(self) -> Iterator[str]:
        return iter(self._images)

    def __len__(self) -> int:
        return len(self._images)


def _joined(
    images: Mapping[str, Path],
    layouts: Mapping[str, Layout],
    files: Mapping[str, Path],
    panoramas: Panoramas,
    cache: Cache,
    progress: Progress,
    config: Config,
) -> tuple[list[Trajectory], dict[str, str]]:
    """Groups of photos, the largest first, and why the others are not in it."""
    seen = [name.encode() + files[name].read_bytes() for name in sorted(files)]
    key = content_key(_STAGE, repr(config), panoramas.digest(), *seen)
    known = cache.read(key)
    if known is not None:
        data = json.loads(known)
        return [trajectory_of(group) for group in data["groups"]], data["reasons"]
    result = join_tour(_Greys(images), layouts, config, progress)
    groups = [group.trajectory() for group in result.groups]
    data = {"groups": [plain(group) for group in groups], "reasons": dict(result.reasons)}
    cache.write(key, json.dumps(data).encode())
    return groups, data["reasons"]


def _lines(
    groups: list[Trajectory], reasons: Mapping[str, str], panoramas: Panoramas
) -> tuple[str, ...]:
    sizes = [len(group) for group in groups]
    lines = [f"{sizes[0]} of {sum(sizes)} photos have poses in one frame"]
    if len(sizes) > 1:
        told = ", ".join(str(n) for n in sizes[1:])
        lines.append(f"{len(sizes) - 1} other groups of {told} photos could not be joined")
        lines += [f"{name}: {reason}" for name, reason in reasons.items()]
    if panoramas.left_out:
        lines.append(f"{len(panoramas.left_out)} images left out")
    return tuple(lines)
