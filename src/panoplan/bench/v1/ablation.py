"""What costs most: one stage's output after the other is replaced by the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import shapely

from panoplan.bench.v1.predict import METHOD_CODE, Row, made_of
from panoplan.bench.v1.scenes import Recording, Simulated, code_version, digest, recorded
from panoplan.bench.v1.score import score, summary
from panoplan.bench.v1.store import KeptScene
from panoplan.bench.v1.study import Runner
from panoplan.metrics.rooms import region
from panoplan.simulate.noise import EXACT, REAL
from panoplan.types.arrays import IntArray
from panoplan.types.pose import Pose
from panoplan.types.truth import GroundTruth

Known = Literal["nothing", "scale", "poses", "layouts", "grouping"]
KNOWN: tuple[Known, ...] = ("nothing", "scale", "poses", "layouts", "grouping")


@dataclass(frozen=True)
class Ablated:
    """A row of Table II on one scene, where something is known that is else to be found.

    Attributes:
        source: scene.
        row: method.
        known: "scale": the trajectory is metric; "poses": odometry does not drift; "layouts": they
            are what is to be seen from the camera, without leaks; "grouping": which views are of
            one room (of methods that fuse views).
    """

    source: Simulated
    row: Row
    known: Known

    @property
    def name(self) -> str:
        """What is known, row and scene."""
        return f"ablation/{self.known}-{self.row.name}-{self.source.name}"

    def key(self) -> str:
        """Of scene, settings, what is known, and code."""
        code = code_version(*METHOD_CODE, "metrics", "bench/v1/ablation")
        return digest(self.source.key(), repr(self.row.config), self.known, code)

    def measure(self) -> dict[str, Any]:
        """Scores as of `score`."""
        recording = _knowing(self.source, self.known)
        scores = score(KeptScene.of(recording), made_of(recording, self.row.config))
        return {"scene": self.source.name, "known": self.known, **scores}


def ablated(sources: Sequence[Simulated], runner: Runner, row: Row) -> dict[str, Any]:
    """Measures what is gained by knowing each thing.

    Args:
        sources: scenes of one family.
        runner: does the work.
        row: method.

    Returns:
        For each of `KNOWN` the summary and each scene's scores.
    """
    made = runner.by_case(KNOWN, sources, lambda source, known: Ablated(source, row, known))
    known = {name: {"summary": summary(scenes), "scenes": scenes} for name, scenes in made}
    return {"share": row.share, "known": known}


def _knowing(source: Simulated, known: Known) -> Recording:
    """The walk with its poses, its scale, its layouts or its rooms as they truly are."""
    if known == "layouts":
        exact = replace(EXACT, name="exact layouts", odometry=REAL.odometry)
        return replace(source, grade=exact).open()
    scene = source.simulated()
    recording = recorded(scene)
    true = scene.truth.trajectory
    assert true is not None
    if known == "grouping":
        return replace(recording, rooms=tuple(_true_rooms(scene.truth).tolist()))
    if known == "poses":
        poses = [
            Pose(true.rotations[k], true.translations[k] / scene.metres_per_su)
            for k in range(len(true))
        ]
        keyframes = (
            replace(keyframe, pose=pose)
            for keyframe, pose in zip(scene.keyframes, poses, strict=True)
        )
        return replace(recording, keyframes=tuple(keyframes))
    if known == "scale":
        unit = scene.metres_per_su
        metric = (
            replace(k, pose=Pose(k.pose.rotation, unit * k.pose.translation))
            for k in scene.keyframes
        )
        assert recording.true_ch_per_su is not None
        return replace(
            recording,
            keyframes=tuple(metric),
            true_ch_per_su=recording.true_ch_per_su / unit,
            trajectory_unit="m",
        )
    return recording


def _true_rooms(truth: GroundTruth) -> IntArray:
    """(N,) the true room nearest to each camera of the walk."""
    assert truth.trajectory is not None
    cameras = shapely.points(truth.trajectory.translations[:, [0, 2]])
    regions = [region(room.polygon, room.holes) for room in truth.plan.rooms]
    apart = np.array([shapely.distance(area, cameras) for area in regions])
    return np.asarray(apart.argmin(axis=0))
