"""Level pictures of a walk's keyframes: written as each gets its pose, mended at the end."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from panoplan.formats.atomic import make_folder
from panoplan.formats.image import write_jpeg
from panoplan.geometry.panorama import turned
from panoplan.pipeline import Progress
from panoplan.poses.level import level_turn, median_direction, upright
from panoplan.poses.walk.follow import Seen
from panoplan.types.arrays import FloatArray
from panoplan.types.pose import Pose, Trajectory

_LEVEL_DEG = 0.5
"""A camera tilted by less is taken as level."""
_SAME_DEG = 0.5
"""A picture turned by so much more or less is as good."""


class LevelImages:
    """Pictures as cameras standing upright would have taken them.

    While the walk goes on, gravity is what the keyframes so far say. A picture stays as it was
    written where the adjusted poses say the same.

    Args:
        folder: for NAME.jpg; made with the first one.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.turns: dict[str, FloatArray] = {}
        self._written: set[str] = set()
        self._downs: list[FloatArray] = []

    def add(self, seen: Seen, pose: Pose) -> Path:
        """Writes the picture of a keyframe that got its pose.

        Args:
            seen: the keyframe.
            pose: world_from_cam in the same world as those before.

        Returns:
            The file.
        """
        self._downs.append(pose.rotation[:, 1])
        gravity = median_direction(np.array(self._downs))
        return self._write(seen, level_turn(pose.rotation, gravity))

    def complete(self, panoramas: Iterable[Seen], poses: Trajectory, progress: Progress) -> None:
        """Writes what is not there yet, or was turned otherwise than the poses say.

        Pictures of keyframes that have no pose go.

        Args:
            panoramas: of the walk; gone through only where there is something to write.
            poses: of the keyframes, in the level world.
            progress: is told how far the work has come.
        """
        for name in self._written - set(poses.labels):
            (self._folder / f"{name}.jpg").unlink(missing_ok=True)
        stands = np.swapaxes(poses.rotations, 1, 2) @ upright(poses.rotations)
        todo = {}
        for name, turn in zip(poses.labels, stands, strict=True):
            known = self.turns.get(name)
            near = known is not None and _angle_deg(known.T @ turn) <= _SAME_DEG
            if not (near and name in self._written):
                todo[name] = known if near else turn
        count = len(todo)
        for seen in panoramas if todo else ():
            turn = todo.pop(seen.name, None)
            if turn is not None:
                self._write(seen, turn)
                progress(count - len(todo), count, "keyframes")

    def _write(self, seen: Seen, turn: FloatArray) -> Path:
        level = _angle_deg(turn) <= _LEVEL_DEG
        make_folder(self._folder)
        path = self._folder / f"{seen.name}.jpg"
        write_jpeg(path, seen.pixels if level else turned(seen.pixels, turn))
        self.turns[seen.name] = turn
        self._written.add(seen.name)
        return path


def _angle_deg(rotation: FloatArray) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(rotation) - 1) / 2, -1, 1))))
