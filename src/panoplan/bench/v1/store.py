"""What a benchmark run keeps: the truth of each scene and the prediction of each row.

    scenes/<scene>/                 a sequence folder without layouts: truth and odometry
    scenes/<scene>/kept.json        its key, and the true scale
    predictions/<scene>/<row>.json  a plan as `panoplan run` writes it
    predictions/<scene>/<row>.kept.json   its key, its cost, why it failed
    studies/<study>/<name>.json     a measurement of a study, with its key

kept.json comes last and makes the rest valid; what has another key is made anew.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panoplan.bench.record import to_json
from panoplan.bench.v1.predict import Prediction, Task
from panoplan.bench.v1.scenes import Recording, Source
from panoplan.datasets.folder import read_truth
from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder, write_text
from panoplan.formats.plan_json import read_plan, write_plan
from panoplan.formats.schema import read_json
from panoplan.formats.sequence import write_sequence
from panoplan.types.truth import GroundTruth


@dataclass(frozen=True, eq=False)
class KeptScene:
    """The truth of a scene.

    Attributes:
        truth: plan and poses.
        keyframes: how many.
        camera_height_m: None where unknown.
        true_ch_per_su: true scale, None where unknown.
    """

    truth: GroundTruth
    keyframes: int
    camera_height_m: float | None
    true_ch_per_su: float | None

    @staticmethod
    def of(recording: Recording) -> KeptScene:
        """What is kept of a recording."""
        return KeptScene(
            recording.truth,
            len(recording.keyframes),
            recording.camera_height_m,
            recording.true_ch_per_su,
        )


@dataclass(frozen=True)
class Store:
    """The folder of a run.

    Attributes:
        path: of it.
    """

    path: Path

    def has_scene(self, source: Source) -> bool:
        """Whether the truth of this scene, as it would be made today, is kept."""
        return self._key(self._scene(source) / "kept.json") == source.key()

    def keep_scene(self, source: Source, recording: Recording) -> None:
        """Keeps a scene's truth; raises InputError where it cannot be written."""
        folder = self._scene(source)
        make_folder(folder)
        keyframes = recording.bare.keyframes
        write_sequence(folder, source.name, keyframes, recording.truth, recording.camera_height_m)
        self._write(
            folder / "kept.json",
            {
                "key": source.key(),
                "keyframes": len(keyframes),
                "camera_height_m": recording.camera_height_m,
                "true_ch_per_su": recording.true_ch_per_su,
            },
        )

    def scene(self, source: Source) -> KeptScene:
        """The truth of a scene that is kept."""
        folder = self._scene(source)
        kept = read_json(folder / "kept.json")
        return KeptScene(
            read_truth(folder),
            kept["keyframes"],
            kept["camera_height_m"],
            kept["true_ch_per_su"],
        )

    def has_prediction(self, task: Task) -> bool:
        """Whether this prediction, as it would be made today, is kept."""
        return self._key(self._prediction(task, "kept.json")) == task.key()

    def keep_prediction(self, task: Task, made: Prediction) -> None:
        """Keeps a prediction; raises InputError where it cannot be written."""
        make_folder(self._prediction(task, "json").parent)
        if made.plan is not None:
            write_plan(self._prediction(task, "json"), made.plan)
        self._write(
            self._prediction(task, "kept.json"),
            {"key": task.key(), "failure": made.failure, "cpu_seconds": made.cpu_seconds},
        )

    def prediction(self, task: Task) -> Prediction:
        """A prediction that is kept."""
        kept = read_json(self._prediction(task, "kept.json"))
        failed = kept["failure"] is not None
        plan = None if failed else read_plan(self._prediction(task, "json"))
        return Prediction(plan, kept["failure"], kept["cpu_seconds"])

    def has_result(self, name: str, key: str) -> bool:
        """Whether a study's result of this key is kept."""
        return self._key(self._result(name)) == key

    def keep_result(self, name: str, key: str, result: dict[str, Any]) -> None:
        """Keeps a study's result; raises InputError where it cannot be written."""
        make_folder(self._result(name).parent)
        self._write(self._result(name), {"key": key, "result": result})

    def result(self, name: str) -> dict[str, Any]:
        """A study's result that is kept."""
        return dict(read_json(self._result(name))["result"])

    def _result(self, name: str) -> Path:
        return self.path / "studies" / f"{name}.json"

    def _scene(self, source: Source) -> Path:
        return self.path / "scenes" / source.name

    def _prediction(self, task: Task, ending: str) -> Path:
        return self.path / "predictions" / task.source.name / f"{task.row.name}.{ending}"

    def _key(self, path: Path) -> str | None:
        try:
            return str(read_json(path)["key"])
        except (InputError, KeyError, TypeError):
            return None

    def _write(self, path: Path, data: dict[str, Any]) -> None:
        write_text(path, to_json(data))
