"""What each kind of error costs: one after the other made smaller and larger."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from panoplan.bench.v1.predict import METHOD_CODE, Row, made_of
from panoplan.bench.v1.scenes import Recording, Simulated, code_version, digest
from panoplan.bench.v1.score import score, summary
from panoplan.bench.v1.store import KeptScene
from panoplan.bench.v1.study import Runner
from panoplan.simulate.noise import REAL, NoiseModel

USUAL = "as it is"
SWEEPS: dict[str, tuple[float, ...]] = {
    USUAL: (1.0,),
    "layout errors": (0.0, 0.5, 2.0),
    "drift": (0.0, 0.5, 2.0, 4.0),
    "keyframes": (0.5, 0.25, 0.125),
    "leaks": (0.0, 2.0),
}
"""Factors on what the scenes have."""


def noise(swept: str, factor: float) -> NoiseModel:
    """The usual errors, some of them changed.

    Args:
        swept: of `SWEEPS`; "keyframes" changes no error.
        factor: on the boundary's own error, the common one of a panorama's ranges and that of its
            camera's height; on how far the odometry errs, not on how often it jumps or is lost; or
            on the probabilities that a boundary goes through a passage.
    """
    if swept == "layout errors":
        bins = (
            replace(b, bias_deg=factor * b.bias_deg, core_deg=factor * b.core_deg)
            for b in REAL.bins
        )
        return replace(
            REAL,
            bins=tuple(bins),
            scale_std=factor * REAL.scale_std,
            scale_core_std=factor * REAL.scale_core_std,
            height_jitter=factor * REAL.height_jitter,
        )
    if swept == "drift":
        usual = REAL.odometry
        assert usual is not None
        names = ("slip_m", "heading_deg", "scale", "jump_m", "jump_deg")
        drift = {name: factor * getattr(usual, name) for name in names}
        return replace(REAL, odometry=replace(usual, **drift))
    if swept == "leaks":
        names = ("door_leak", "opening_leak", "door_part", "opening_part", "doorway_leak")
        leaks = {name: min(1.0, factor * getattr(REAL, name)) for name in names}
        # What goes through a passage as a whole does not in a part of it.
        for kind in ("door", "opening"):
            whole, part = leaks[f"{kind}_leak"], leaks[f"{kind}_part"]
            leaks[f"{kind}_part"] = min(part, 1.0 - whole)
        return replace(REAL, **leaks)
    return REAL


@dataclass(frozen=True)
class Swept:
    """A scene with one kind of error changed.

    Attributes:
        source: scene.
        row: method.
        swept: kind of error.
        factor: on it.
    """

    source: Simulated
    row: Row
    swept: str
    factor: float

    @property
    def name(self) -> str:
        """Kind, factor, row and scene."""
        kind = self.swept.replace(" ", "_")
        return f"sweeps/{kind}-{self.factor:g}-{self.row.name}-{self.source.name}"

    def key(self) -> str:
        """Of scene, settings, what is changed, and code."""
        code = code_version(*METHOD_CODE, "metrics", "bench/v1/sweeps")
        return digest(self.source.key(), repr(self.row.config), self.swept, repr(self.factor), code)

    def measure(self) -> dict[str, Any]:
        """Scores as of `score`; of fewer keyframes, still over the rooms of the whole walk."""
        recording = replace(self.source, grade=noise(self.swept, self.factor)).open()
        walked = thinned(recording, round(1 / self.factor) if self.swept == "keyframes" else 1)
        scores = score(KeptScene.of(walked), made_of(walked, self.row.config))
        return {
            "scene": self.source.name, "swept": self.swept, "factor": self.factor, **scores
        }  # fmt: skip


def thinned(recording: Recording, stride: int) -> Recording:
    """Every so many keyframes of a walk; its truth remains that of all."""
    return replace(recording, keyframes=recording.keyframes[::stride])


def swept(sources: Sequence[Simulated], runner: Runner, row: Row) -> dict[str, Any]:
    """Measures all sweeps.

    Args:
        sources: scenes of one family.
        runner: does the work.
        row: method.

    Returns:
        For each sweep and factor the summary, each scene's scores, and keyframes a room.
    """
    kinds = [(name, factor) for name, factors in SWEEPS.items() for factor in factors]
    made = runner.by_case(kinds, sources, lambda source, kind: Swept(source, row, *kind))
    points = []
    for (name, factor), scenes in made:
        keyframes, rooms = (sum(scene[what] for scene in scenes) for what in ("keyframes", "rooms"))
        points.append(
            {
                "swept": name,
                "factor": factor,
                "keyframes_a_room": keyframes / rooms,
                "summary": summary(scenes),
                "scenes": scenes,
            }
        )
    return {"share": row.share, "points": points}
