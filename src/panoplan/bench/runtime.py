"""Time and memory on a walk through a building of forty rooms."""

from __future__ import annotations

import sys
import time
from collections import deque
from collections.abc import Callable, Iterable
from itertools import islice
from typing import Any

import numpy as np

from panoplan.config import Config
from panoplan.estimator.front import FloorPlanEstimator
from panoplan.estimator.state import Walk
from panoplan.simulate.flats import make_corridor_building
from panoplan.simulate.scene import simulate
from panoplan.types.events import KeyframeWaiting, RoomShaped, ScaleFrozen
from panoplan.types.keyframe import Keyframe

_ROOMS = 40
_KEYFRAMES = 2000


def measure(config: Config, progress: Callable[[int, int], None]) -> dict[str, Any]:
    """Feeds 2,000 keyframes and times each; compiled loops are warm.

    Args:
        config: settings.
        progress: called with (keyframes done, keyframes in all).

    Returns:
        Milliseconds of update(): without a room being shaped, and with; what 95 % stay below of the
        last 100 keyframes and of 100 early ones, whatever they do, from the 100th on or since the
        scale is known; of plan(); seconds of finish(); and the peak memory of the process in MB.
    """
    # As with a live camera, nobody keeps a keyframe once it has been taken in.
    coming = deque(_walk())
    count = len(coming)
    _warm_up(islice(coming, config.scale.warmup_max + 50), count, config)
    estimator = FloorPlanEstimator(config, Walk(expected_keyframes=count))
    plain, every = np.full(count, np.nan), np.zeros(count)
    shaped: list[float] = []
    for number in range(count):
        keyframe = coming.popleft()
        started = time.perf_counter()
        events = estimator.update(keyframe)
        taken = 1e3 * (time.perf_counter() - started)
        every[number] = taken
        frozen = any(isinstance(event, ScaleFrozen) for event in events)
        if not frozen and any(isinstance(event, RoomShaped) for event in events):
            shaped.append(taken)
        elif not any(isinstance(event, (KeyframeWaiting, ScaleFrozen)) for event in events):
            plain[number] = taken
        progress(number + 1, count)
    started = time.perf_counter()
    plan = estimator.plan()
    plan_ms = 1e3 * (time.perf_counter() - started)
    started = time.perf_counter()
    estimator.finish()
    finish_s = time.perf_counter() - started
    # Keyframes that waited for the scale say nothing of what one costs.
    first = max(100, int(np.flatnonzero(np.isfinite(plain))[0]))
    early, late = every[first : first + 100], every[-100:]
    early_95, late_95 = (float(np.percentile(part, 95)) for part in (early, late))
    return {
        "keyframes": count,
        "rooms": len(plan.rooms),
        "update_ms_median": float(np.nanmedian(plain)),
        "update_ms_95_early": early_95,
        "update_ms_95_late": late_95,
        "update_late_over_early": late_95 / early_95,
        "leaving_ms_median": float(np.median(shaped)),
        "leaving_ms_largest": float(np.max(shaped)),
        "leavings": len(shaped),
        "plan_ms": plan_ms,
        "finish_s": finish_s,
        "peak_memory_mb": _peak_memory_mb(),
    }


def _walk() -> tuple[Keyframe, ...]:
    building = make_corridor_building(_ROOMS, seed=1)
    return simulate(building, 1, "mild", keyframes_per_room=20).keyframes[:_KEYFRAMES]


def _warm_up(keyframes: Iterable[Keyframe], count: int, config: Config) -> None:
    estimator = FloorPlanEstimator(config, Walk(expected_keyframes=count))
    for keyframe in keyframes:
        estimator.update(keyframe)


def _peak_memory_mb() -> float | None:
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)
