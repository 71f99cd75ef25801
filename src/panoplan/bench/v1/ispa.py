"""Table III: the same rooms shaped by five kinds of shortest path."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from panoplan.bench.v1.predict import METHOD_CODE, Prediction, Row
from panoplan.bench.v1.scenes import Simulated, code_version, digest
from panoplan.bench.v1.score import score, summary
from panoplan.bench.v1.store import KeptScene
from panoplan.bench.v1.study import Runner
from panoplan.config import Config, override
from panoplan.estimator.assemble import assemble
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import State
from panoplan.estimator.step import evidence_of
from panoplan.stages.shape.ispa import room_shape

ROW = Row("paper", 0.2)
"""Table III is of this row of Table II."""


@dataclass(frozen=True)
class Path:
    """A row of Table III.

    Attributes:
        name: what is done.
        shape: settings of the shape stage.
    """

    name: str
    shape: tuple[tuple[str, Any], ...]

    def of(self, config: Config) -> Config:
        """Settings with this kind of path."""
        return override(config, {"shape": dict(self.shape)})


PATHS = (
    Path("cells of one size, once",
         (("fixed_cell_ch", 0.1), ("limit_edges", False), ("grids", (64,)))),
    Path("grid of one size, once", (("limit_edges", False), ("grids", (64,)))),
    Path("grid of one size, short edges, once", (("grids", (64,)),)),
    Path("the same, 3 rounds", (("grids", (64, 96, 96)),)),
    Path("the same, 5 rounds", (("grids", (64, 96, 96, 96, 96)),)),
)  # fmt: skip
"""Fixed size, limited edge length and iterations as in the paper; a cell of the first is 15 cm."""


@dataclass(frozen=True)
class Shaped:
    """One scene, its rooms shaped in each way from the same evidence."""

    source: Simulated

    @property
    def name(self) -> str:
        """The scene."""
        return f"ispa/{self.source.name}"

    def key(self) -> str:
        """Of scene, settings and code."""
        settings = [repr(path.of(ROW.config)) for path in PATHS]
        code = code_version(*METHOD_CODE, "metrics", "bench/v1/ispa")
        return digest(self.source.key(), *settings, code)

    def measure(self) -> dict[str, Any]:
        """Scores as of `score` by path, each with the rooms shaped; CPU seconds are theirs."""
        recording = self.source.open()
        config = ROW.config
        estimator = FloorPlanEstimator(config, recording.walk)
        for keyframe in recording.keyframes:
            estimator.update(keyframe)
        truth, made = KeptScene.of(recording), {}
        for path in PATHS:
            state, seconds = _shaped(estimator.state, path.of(config))
            plan = assemble(state, config)
            scores = score(truth, Prediction(plan, None, seconds))
            made[path.name] = {
                "scene": self.source.name, "shaped": len(state.rooms), **scores
            }  # fmt: skip
        return made


def _shaped(state: State, config: Config) -> tuple[State, float]:
    """The rooms shaped anew, and the CPU seconds that took."""
    rooms = []
    started = time.process_time()
    for room in state.rooms:
        shape = room_shape(evidence_of(room, config), config.shape)
        rooms.append(replace(room, shape=shape, stale=False))
    seconds = time.process_time() - started
    return replace(state, rooms=tuple(rooms)), seconds


def shaped(sources: Sequence[Simulated], runner: Runner) -> dict[str, Any]:
    """Measures Table III.

    Args:
        sources: scenes of one family.
        runner: does the work.

    Returns:
        For each of `PATHS`, by name, the summary and each scene's scores.
    """
    made = runner.results([Shaped(source) for source in sources])
    figures = {}
    for path in PATHS:
        scenes = [scores[path.name] for scores in made]
        figures[path.name] = {
            "summary": summary(scenes),
            "seconds_a_room": sum(scene["cpu_seconds"] for scene in scenes)
            / max(1, sum(scene["shaped"] for scene in scenes)),
            "scenes": scenes,
        }
    return {"share": ROW.share, "paths": figures}
