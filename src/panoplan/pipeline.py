"""From a scene to a plan: wiring only."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

from panoplan.config import Config
from panoplan.datasets.scene import Scene
from panoplan.editing.apply import apply
from panoplan.estimator.explain import explain
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.exporters.explain.pictures import FOLDER, forget_explanation, write_explanation
from panoplan.exporters.pictures import write_plan_pictures
from panoplan.exporters.storeys import room_area
from panoplan.formats.edits_json import EDITS, read_edits
from panoplan.formats.run_folder import RunFolder
from panoplan.types.events import Event
from panoplan.types.keyframe import Keyframe
from panoplan.types.plan import FloorPlan, Skipped


class Progress(Protocol):
    """Is told how far the work has come."""

    def __call__(self, done: int, total: int, title: str = ..., /) -> None:
        """`done` of `total`; a title where something else than keyframes is counted."""


class Watcher(Protocol):
    """Sees the run as it goes."""

    def update(
        self,
        number: int,
        keyframe: Keyframe,
        events: Sequence[Event],
        plan: Callable[[], FloorPlan],
        /,
    ) -> None:
        """A keyframe was taken in; `plan` gives the plan so far."""

    def show_plan(self, plan: FloorPlan, /) -> None:
        """The plan at the end."""


@dataclass(frozen=True)
class RunOptions:
    """What a run is told beside its settings.

    Attributes:
        trajectory_unit: "m" where the trajectory is metric.
        camera_height_m: overrides what the scene says.
        explain: whether pictures of each stage are written, too.
    """

    trajectory_unit: Literal["unknown", "m"] = "unknown"
    camera_height_m: float | None = None
    explain: bool = False


def run(
    scene: Scene,
    config: Config,
    options: RunOptions,
    folder: RunFolder,
    progress: Progress,
    watcher: Watcher | None = None,
) -> FloorPlan:
    """Estimates the plan of a scene and writes plan.json, plan.svg, plan.png and log.jsonl.

    The pictures of an earlier explanation in the folder go. Edits in the folder stay, and the
    pictures show them; plan.json is the estimate.

    The walk goes on where an interrupted run with the same input and settings stopped.

    Args:
        scene: keyframes in the order of the walk.
        config: settings.
        options: what is known of the walk.
        folder: where to; its log and its saved state are kept up to date.
        progress: called with (keyframes done, keyframes in all) and how many rooms there are,
            then with those of pictures.
        watcher: shown each keyframe and what came of it, or None.

    Returns:
        The plan.
    """
    height = options.camera_height_m or scene.camera_height_m
    walk = Walk(options.trajectory_unit, height, len(scene.keyframes))
    state = folder.begin(scene.keyframes, config, walk)
    forget_explanation(folder.path / FOLDER)
    estimator = FloorPlanEstimator(config, walk, state=state)
    try:
        for number in range(estimator.state.seen, len(scene.keyframes)):
            events = estimator.update(scene.keyframes[number])
            folder.record(number, events)
            folder.save(estimator.state)
            if watcher is not None:
                watcher.update(number, scene.keyframes[number], events, estimator.plan)
            told = f"keyframes, {len(estimator.state.rooms)} rooms"
            progress(number + 1, len(scene.keyframes), told)
    except KeyboardInterrupt:
        folder.save(estimator.state, now=True)
        raise
    folder.record(len(scene.keyframes), estimator.finish())
    plan = estimator.plan()
    unread = tuple(Skipped(name, "keyframe", reason) for name, reason in scene.skipped)
    plan = replace(plan, level_rotation=scene.level_rotation, skipped=(*unread, *plan.skipped))
    edited = apply(plan, read_edits(folder.path / EDITS))
    write_plan_pictures(folder.path, edited.plan)
    if watcher is not None:
        watcher.show_plan(edited.plan)
    if options.explain:
        explanation = explain(estimator.state, scene.keyframes, config)
        write_explanation(
            folder.path / FOLDER,
            explanation,
            lambda done, total: progress(done, total, "pictures"),
        )
    folder.complete(plan)
    return plan


_UNSURE = 0.05
"""Relative sigma of a scale with which rooms a few metres apart are off by more than a wall."""


def summary(plan: FloorPlan) -> str:
    """A few lines about a plan for the terminal."""
    shaped = [room for room in plan.rooms if room.polygon is not None]
    scale = plan.scale
    lines = [f"{len(shaped)} rooms from {len(plan.trajectory)} keyframes, unit {plan.unit}"]
    if scale.ch_per_su is None:
        lines.append("scale unknown: lengths are camera heights, cameras are not placed")
    else:
        sigma = "" if scale.sigma is None else f" ± {100 * scale.sigma:.1f} %"
        found = f"scale {scale.ch_per_su:.6g} camera heights a trajectory unit{sigma}"
        told = [f"{found} ({scale.method})"]
        if scale.sigma is not None and scale.sigma > _UNSURE:
            told.append(f"uncertain: {scale.keyframes_used} layouts agree too little on any")
        if scale.at_edge:
            told.append("at the edge of the searched range: do not trust it")
        if not scale.converged:
            told.append("it had not settled when the walk ended")
        lines.append("; ".join(told))
    if plan.metric is not None:
        lines.append(f"metres by {plan.metric.source}, ± {100 * plan.metric.sigma:.1f} %")
    unit = "m²" if plan.unit == "m" else "ch²"
    for room in shaped:
        area = float(room_area(room).area)
        sigma = "" if room.area_sigma is None else f" ± {room.area_sigma:.1f}"
        lines.append(f"{room.id}: {area:.1f}{sigma} {unit}")
    for room in plan.rooms:
        if room.polygon is None:
            lines.append(f"{room.id}: no shape, {room.failure}")
    skipped = Counter((s.what, s.reason) for s in plan.skipped if s.what != "wall")
    lines += [
        f"{count} keyframes {'left out' if what == 'keyframe' else 'moved'}: {reason}"
        for (what, reason), count in sorted(skipped.items())
    ]
    return "\n".join(lines)
