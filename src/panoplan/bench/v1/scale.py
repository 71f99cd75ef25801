"""How wrong the scale is after so many layouts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from panoplan.bench.v1.predict import METHOD_CODE
from panoplan.bench.v1.scenes import Simulated, code_version, digest
from panoplan.bench.v1.study import Runner
from panoplan.config import preset
from panoplan.geometry.rigid import heading_of, turn
from panoplan.stages.registration import cast
from panoplan.stages.scale import recover_scale

LAYOUTS = (5, 10, 20, 40, 80, 160)
METHODS = ("paper", "default")


@dataclass(frozen=True)
class Scaled:
    """The first layouts of one walk, more and more of them, by one method's scale stage."""

    source: Simulated
    method: str

    @property
    def name(self) -> str:
        """Method and scene."""
        return f"scale/{self.method}-{self.source.name}"

    def key(self) -> str:
        """Of scene, settings and code."""
        code = code_version(*METHOD_CODE, "bench/v1/scale")
        return digest(self.source.key(), repr(preset(self.method)), repr(LAYOUTS), code)

    def measure(self) -> dict[str, Any]:
        """Error of the scale in per cent by number of layouts; None where there is no scale."""
        recording, config = self.source.open(), preset(self.method)
        first = recording.keyframes[0].pose
        turned = turn(-heading_of(first.rotation))
        views = [
            view
            for index, keyframe in enumerate(recording.keyframes[: max(LAYOUTS)])
            if (view := cast(keyframe, index, first.translation, turned, config.registration))
        ]
        errors: dict[str, float | None] = {}
        for count in (n for n in LAYOUTS if n <= len(views)):
            found = recover_scale(views[:count], config.scale).ch_per_su
            assert recording.true_ch_per_su is not None
            errors[str(count)] = (
                None if found is None else (100 * (found / recording.true_ch_per_su - 1))
            )
        return {"scene": self.source.name, "method": self.method, "errors": errors}


def scaled(sources: Sequence[Simulated], runner: Runner) -> dict[str, Any]:
    """Measures the error of the scale.

    Args:
        sources: scenes of one family.
        runner: does the work.

    Returns:
        For each method and number of layouts the median and the 90th percentile of the absolute
        error in per cent and how many walks are so long; and each scene's errors.
    """
    made = runner.by_case(METHODS, sources, Scaled)
    figures = {
        method: {"layouts": [_at(scenes, count) for count in LAYOUTS], "scenes": scenes}
        for method, scenes in made
    }
    return {"methods": figures}


def _at(scenes: Sequence[dict[str, Any]], count: int) -> dict[str, Any]:
    told = [scene["errors"][str(count)] for scene in scenes if str(count) in scene["errors"]]
    # A walk without a scale is as wrong as can be.
    errors = [np.inf if error is None else abs(error) for error in told]
    half, most = (_percentile(errors, share) for share in (50, 90))
    return {"layouts": count, "walks": len(errors), "median": half, "percentile_90": most}


def _percentile(errors: Sequence[float], share: float) -> float | None:
    if not errors:
        return None
    value = float(np.percentile(errors, share, method="higher"))
    return value if np.isfinite(value) else None
