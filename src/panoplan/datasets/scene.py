"""A scene: what a run starts from."""

from __future__ import annotations

from dataclasses import dataclass

from panoplan.types.arrays import FloatArray
from panoplan.types.keyframe import Keyframe


@dataclass(frozen=True, eq=False)
class Scene:
    """Keyframes of one walk, ready for the estimator.

    Attributes:
        name: of the scene.
        kind: what the input was recognised as.
        keyframes: in the order of the walk; poses in the level world.
        level_rotation: (3, 3) level_from_world that was applied.
        camera_height_m: metres, None where the input does not say.
        association: how layouts were matched with poses, in words.
    """

    name: str
    kind: str
    keyframes: tuple[Keyframe, ...]
    level_rotation: FloatArray
    camera_height_m: float | None
    association: str
