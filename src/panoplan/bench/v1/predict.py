"""One scene, one row of Table II: the plan and what it cost."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from panoplan.bench.estimate import estimate
from panoplan.bench.points.baseline import PointsConfig, plan_from_points
from panoplan.bench.v1.scenes import Recording, Source, code_version, digest
from panoplan.config import Config, as_dict, override, preset
from panoplan.errors import InputError, PanoplanError
from panoplan.geometry.rigid import heading_of
from panoplan.types.plan import FloorPlan, PlanPose

POINTS = "points"
"""The baseline from a scan; it needs no scale."""
SHARES = (0.2, 1.0)
"""Share of the keyframes that the scale is recovered from. Source: Table II of the paper."""

METHOD_CODE = ("errors", "config", "geometry", "types", "stages", "estimator")
"""What a prediction depends on beside scene and settings."""


@dataclass(frozen=True)
class Row:
    """A row of Table II.

    Attributes:
        method: `POINTS` or a preset.
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
        """The preset with this share.

        Raises:
            ConfigError: of the baseline, which is no preset.
        """
        return override(preset(self.method), {"scale": {"warmup": self.share}})

    @property
    def settings(self) -> dict[str, Any]:
        """All settings as plain values, "preset" the method."""
        if self.method == POINTS:
            return {"preset": POINTS, **asdict(PointsConfig())}
        return as_dict(self.config)


def rows_of(methods: Sequence[str]) -> list[Row]:
    """The rows of Table II: each method for each of `SHARES`, the baseline once."""
    return [
        Row(method, share)
        for method in methods
        for share in (SHARES if method != POINTS else SHARES[-1:])
    ]


@dataclass(frozen=True)
class Task:
    """What is to be predicted: the row for the scene."""

    source: Source
    row: Row

    def key(self) -> str:
        """A hash of all that the prediction depends on: scene, settings and code."""
        scene = self.source.key()
        code: tuple[str, ...] = METHOD_CODE
        if self.row.method == POINTS:
            scene, code = scene + self.source.scan_key(), (*METHOD_CODE, "bench/points")
        return digest(scene, repr(self.row.settings), code_version(*code))


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


def predict(tasks: Sequence[Task]) -> list[Prediction]:
    """Runs methods on a scene, which is made once.

    Args:
        tasks: rows of one scene, at least one.

    Returns:
        For each as of `made_of`.
    """
    source = tasks[0].source
    recording = source.open()
    return [
        made_of_points(source, recording)
        if task.row.method == POINTS
        else made_of(recording, task.row.config)
        for task in tasks
    ]


def made_of(recording: Recording, config: Config) -> Prediction:
    """What a method makes of a recording.

    Args:
        recording: the walk; its truth is not looked at.
        config: the method's settings.

    Returns:
        The plan, or why there is none: a scene that a method fails on counts, it does not stop the
        benchmark.
    """
    return _timed(lambda: estimate(recording.keyframes, config, recording.walk))


def made_of_points(source: Source, recording: Recording) -> Prediction:
    """What the baseline makes of a scene's scan.

    Args:
        source: the scene.
        recording: of it; the scan is in the world of the true poses, and tells them.

    Returns:
        As of `made_of`.
    """
    walked = recording.truth.trajectory
    cameras = (
        ()
        if walked is None
        else tuple(
            PlanPose(label, translation[[0, 2]], heading_of(rotation), None)
            for label, translation, rotation in zip(
                walked.labels, walked.translations, walked.rotations, strict=True
            )
        )
    )
    try:
        points = source.scan()
    except InputError as error:
        return Prediction(None, str(error), 0.0)
    return _timed(lambda: plan_from_points(points, cameras, PointsConfig()))


def _timed(make: Callable[[], FloorPlan]) -> Prediction:
    started = time.process_time()
    try:
        plan = make()
    except Exception as error:
        return Prediction(None, _told(error), time.process_time() - started)
    return Prediction(plan, None, time.process_time() - started)


def _told(error: Exception) -> str:
    if isinstance(error, PanoplanError):
        return str(error)
    frame = traceback.extract_tb(error.__traceback__)[-1]
    text = f"{type(error).__name__}: {error} ({frame.name}, line {frame.lineno})"
    return " ".join(text.split())
