"""From the panoramas of a walk to keyframes with poses."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from panoplan.formats.image import Pixels, resized
from panoplan.poses.walk.features import Extractor, Features, sharpness
from panoplan.poses.walk.keyframes import KeyframeChooser, KeyframeSettings
from panoplan.poses.walk.odometry import Odometry, OdometrySettings
from panoplan.types.pose import Pose, Trajectory

WIDTH, HEIGHT = 1024, 512
_AHEAD = 2


@dataclass(frozen=True, eq=False)
class Seen:
    """A panorama of a walk.

    Attributes:
        name: unique.
        pixels: (H, W, 3) RGB.
    """

    name: str
    pixels: Pixels


@dataclass(frozen=True)
class WalkSettings:
    """How a walk is followed.

    Attributes:
        keyframes: which panoramas get a pose.
        odometry: how poses are found.
    """

    keyframes: KeyframeSettings = field(default_factory=KeyframeSettings)
    odometry: OdometrySettings = field(default_factory=OdometrySettings)


@dataclass(frozen=True, eq=False)
class Walked:
    """What became of a walk.

    Attributes:
        maps: trajectories labelled with keyframe names, in the order of the walk; the one with
            most keyframes first. What is not in one map could not be joined.
        lost: keyframes without a pose.
        passed_over: panoramas that were no keyframes.
    """

    maps: tuple[Trajectory, ...]
    lost: tuple[str, ...]
    passed_over: int


@dataclass(frozen=True, eq=False)
class PlacedKeyframe:
    """A keyframe that got its pose while the walk goes on.

    Attributes:
        seen: its panorama.
        map: of the pose, from 0 in the order in which maps began.
        pose: world_from_cam in that map, as known now.
    """

    seen: Seen
    map: int
    pose: Pose


def follow(
    panoramas: Iterable[Seen],
    settings: WalkSettings,
    mask: NDArray[np.bool_] | None,
    placed: Callable[[PlacedKeyframe], None],
) -> Walked:
    """Finds the poses of a walk while its panoramas come in.

    Features of the next panoramas are found in another thread meanwhile.

    Args:
        panoramas: in the order of the walk.
        settings: how.
        mask: (512, 1024), True where the camera sees what it carries; or None.
        placed: is told each keyframe that got a pose.

    Returns:
        The poses after all has been adjusted.

    Raises:
        MissingExtraError: pycolmap is not installed.
    """
    extractor = Extractor(mask=None if mask is None else ~mask)
    choose = KeyframeChooser(WIDTH, HEIGHT, settings.keyframes)
    odometry = Odometry(WIDTH, HEIGHT, settings.odometry)
    names: list[str] = []
    waiting: dict[int, Seen] = {}
    count = 0
    for seen, features, sharp in _extracted(panoramas, extractor):
        count += 1
        if not choose(features, sharp):
            continue
        waiting[len(names)] = seen
        names.append(seen.name)
        for told in odometry.add(features):
            placed(PlacedKeyframe(waiting.pop(told.number), told.map, told.pose))
        # Those that have waited long get their pose, if any, at the end.
        for number in [n for n in waiting if n < len(names) - odometry.settings.patience]:
            del waiting[number]
    odometry.finish()
    maps = tuple(trajectory_of_map(names, poses) for poses in odometry.poses())
    return Walked(maps, tuple(names[n] for n in odometry.lost), count - len(names))


def working_grey(pixels: Pixels) -> NDArray[np.uint8]:
    """The grey levels, 1024×512, that poses are found from."""
    small = resized(pixels, WIDTH, HEIGHT).astype(np.uint16)
    weighted = 77 * small[..., 0] + 150 * small[..., 1] + 29 * small[..., 2]
    return (weighted >> 8).astype(np.uint8)


def _extracted(
    panoramas: Iterable[Seen], extractor: Extractor
) -> Iterator[tuple[Seen, Features, float]]:
    """Panoramas with their points, found a few panoramas ahead."""

    def work(seen: Seen) -> tuple[Seen, Features, float]:
        grey = working_grey(seen.pixels)
        return seen, extractor(grey), sharpness(grey)

    with ThreadPoolExecutor(max_workers=1) as pool:
        ahead: list[Future[tuple[Seen, Features, float]]] = []
        for seen in panoramas:
            ahead.append(pool.submit(work, seen))
            if len(ahead) > _AHEAD:
                yield ahead.pop(0).result()
        for job in ahead:
            yield job.result()


def trajectory_of_map(names: Sequence[str], poses: Mapping[int, Pose]) -> Trajectory:
    """The trajectory of a map: poses by the numbers of their keyframes, which have names."""
    numbers = sorted(poses)
    return Trajectory(
        tuple(names[n] for n in numbers),
        np.array([poses[n].rotation for n in numbers]),
        np.array([poses[n].translation for n in numbers]),
    )
