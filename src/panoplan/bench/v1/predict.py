"""One scene, one row of Table II: the plan and what it cost."""

from __future__ import annotations

import time
import traceback
from dataclasses import dataclass

from panoplan.bench.v1.scenes import Recording, Source, code_version, digest
from panoplan.config import PRESETS, Config, override, preset
from panoplan.errors import PanoplanError
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.types.plan import FloorPlan

METHODS = PRESETS
SHARES = (0.2, 1.0)
"""Share of the keyframes that the scale is recovered from. Source: Table II of the paper."""

METHOD_CODE = ("errors", "config", "geometry", "types", "stages", "estimator")
"""What a prediction depends on beside scene and settings."""


@dataclass(frozen=True)
class Row:
    """A row of Table II.

    Attributes:
        method: preset.
        share: of the keyframes that the scale is recovered from, in (0, 1].
    """

    method: str
    share: float

    @property
    def name(self) -> str:
        """Method and per cent."""
        return f"{self.method}-{100 * self.share:.0f}"

    @property
    def config(self) -> Config:
        """The preset with this share."""
        return override(preset(self.method), {"scale": {"warmup": self.share}})


@dataclass(frozen=True)
class Task:
    """What is to be predicted: the row for the scene."""

    source: Source
    row: Row

    def key(self) -> str:
        """A hash of all that the prediction depends on: scene, settings and code."""
        return digest(self.source.key(), repr(self.row.config), code_version(*METHOD_CODE))


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a method made of a scene.

    Attributes:
        plan: None where it failed.
        failure: why, in one line; None where it did not.
        cpu_seconds: of the method, without making or reading the scene.
    """

    plan: FloorPlan | None
    failure: str | None
    cpu_seconds: float


def predict(task: Task) -> Prediction:
    """Runs a method on a scene.

    Args:
        task: scene and row.

    Returns:
        As of `made_of`.
    """
    return made_of(task.source.open(), task.row.config)


def made_of(recording: Recording, config: Config) -> Prediction:
    """What a method makes of a recording.

    Args:
        recording: the walk; its truth is not looked at.
        config: the method's settings.

    Returns:
        The plan, or why there is none: a scene that a method fails on counts, it does not stop the
        benchmark.
    """
    started = time.process_time()
    walk = Walk(recording.trajectory_unit, recording.camera_height_m, len(recording.keyframes))
    try:
        estimator = FloorPlanEstimator(config, walk)
        for keyframe in recording.keyframes:
            estimator.update(keyframe)
        estimator.finish()
        plan = estimator.plan()
    except Exception as error:
        return Prediction(None, _told(error), time.process_time() - started)
    return Prediction(plan, None, time.process_time() - started)


def _told(error: Exception) -> str:
    if isinstance(error, PanoplanError):
        return str(error)
    frame = traceback.extract_tb(error.__traceback__)[-1]
    text = f"{type(error).__name__}: {error} ({frame.name}, line {frame.lineno})"
    return " ".join(text.split())
