"""Time and memory on a walk through a building of forty rooms."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from panoplan.config import Config
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.simulate.buildings import make_corridor_building
from panoplan.simulate.scene import simulate
from panoplan.types.events import KeyframeWaiting, RoomShaped, ScaleFrozen

_ROOMS = 40
_KEYFRAMES = 2000


def measure(config: Config, progress: Callable[[int, int], None]) -> dict[str, Any]:
    """Feeds 2,000 keyframes and times each; compiled loops are warm.

    Args:
        config: settings.
        progress: called with (keyframes done, keyframes in all).

    Returns:
        Milliseconds of update() without and with a shape, early and late, of plan(), and the peak
        memory of the process in MB.
    """
    building = make_corridor_building(_ROOMS, seed=1)
    scene = simulate(building, 1, "mild", keyframes_per_room=20)
    keyframes = scene.keyframes[:_KEYFRAMES]
    warm = FloorPlanEstimator(config, Walk(expected_keyframes=len(keyframes)))
    for keyframe in keyframes[: config.scale.warmup_max + 50]:
        warm.update(keyframe)
    estimator = FloorPlanEstimator(config, Walk(expected_keyframes=len(keyframes)))
    plain = np.full(len(keyframes), np.nan)
    shaped: list[float] = []
    shapes = 0
    for number, keyframe in enumerate(keyframes):
        started = time.perf_counter()
        events = estimator.update(keyframe)
        taken = 1e3 * (time.perf_counter() - started)
        shapes_now = sum(isinstance(event, RoomShaped) for event in events)
        shapes += shapes_now
        if shapes_now:
            shaped.append(taken / shapes_now)
        elif not any(isinstance(event, (KeyframeWaiting, ScaleFrozen)) for event in events):
            plain[number] = taken
        progress(number + 1, len(keyframes))
    started = time.perf_counter()
    plan = estimator.plan()
    plan_ms = 1e3 * (time.perf_counter() - started)
    placed = np.flatnonzero(np.isfinite(plain))
    early, late = plain[placed[placed >= max(100, placed[0])][:100]], plain[-100:]
    early_95, late_95 = (float(np.nanpercentile(part, 95)) for part in (early, late))
    return {
        "keyframes": len(keyframes),
        "rooms": len(plan.rooms),
        "update_ms_median": float(np.nanmedian(plain)),
        "update_ms_95_early": early_95,
        "update_ms_95_late": late_95,
        "update_late_over_early": late_95 / early_95,
        "update_with_shape_ms_median": float(np.median(shaped)),
        "shapes": shapes,
        "plan_ms": plan_ms,
        "peak_memory_mb": _peak_memory_mb(),
    }


def _peak_memory_mb() -> float | None:
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)
