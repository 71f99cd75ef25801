"""What each kind of realism brings a layout network: small trainings, each without one of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.bench.layouts import ROWS, SMALL_CH2
from panoplan.errors import InputError, MissingExtraError
from panoplan.pipeline import Progress
from panoplan.types.arrays import BoolArray, FloatArray

LEARNT, JUDGED = 256, 96
"""Panoramas that each training sees, and that all are judged on."""
STEPS = 160
_PER_LEARNT_HOME, _PER_JUDGED_HOME = 8, 4
_BATCH, _RATE, _WARM_UP, _AVERAGE = 16, 1.5e-3, 40, 0.98
_MOST_MINUTES = 24 * 60.0
_BOOTSTRAPS, _INTERVAL = 2000, (5.0, 95.0)


@dataclass(frozen=True)
class _Run:
    """A training: what it goes without, and the seed of its homes, their order and its head."""

    name: str
    without: tuple[str, ...] = ()
    seed: int = 0


def measure(work: Path, progress: Progress) -> dict[str, Any]:
    """Trains heads on renders that lack one kind of realism each, and judges them on full ones.

    All see equally many panoramas in equally many steps from the same untrained head, upon the same
    frozen features, and are judged on the same `still` renders of other homes. One more training
    lacks nothing but has other homes in another order and another untrained head: as far as chance
    alone goes.

    Args:
        work: folder for panoramas, features and errors, of nothing else; what is there already is
            gone on with.
        progress: called with panoramas rendered and steps trained, and with all of them.

    Returns:
        A line a training: median and mean over panoramas of the mean |Δ| of the floor boundary in
        rows of 512, the means of those with openings and of those in small rooms, and how much
        the mean is worse than with everything, with a 90 % interval by resampling the homes.

    Raises:
        MissingExtraError: what trains or renders is not installed.
        InputError: the folder cannot be written, or holds panoramas of another training.
    """
    try:
        import torch  # noqa: F401
    except ImportError:
        raise MissingExtraError("training", "torch", "train") from None
    from panoplan.layouts.network.data import Featuriser
    from panoplan.layouts.network.samples import samples
    from panoplan.layouts.network.shards import HELD_OUT_SEED, write_shard
    from panoplan.layouts.network.trunk import pretrained
    from panoplan.simulate.render.scene import STILL

    runs = _runs()
    total = JUDGED + len(runs) * (LEARNT + STEPS)
    shards = {HELD_OUT_SEED: JUDGED, **dict.fromkeys(range(len(runs)), LEARNT)}
    _refuse_others(work, shards)
    featuriser = Featuriser(pretrained())
    judged = samples(HELD_OUT_SEED, _PER_JUDGED_HOME, STILL)
    write_shard(work, HELD_OUT_SEED, judged, JUDGED, partial(_told, progress, 0, total))
    featuriser.shard(work, HELD_OUT_SEED)
    errors = []
    for number, run in enumerate(runs):
        before = JUDGED + number * (LEARNT + STEPS)
        learnt = samples(run.seed, _PER_LEARNT_HOME, without=run.without)
        write_shard(work, number, learnt, LEARNT, partial(_told, progress, before, total))
        featuriser.shard(work, number)
        errors.append(_errors(work, number, run))
        progress(before + LEARNT + STEPS, total)
    truth = np.load(work / f"targets-{HELD_OUT_SEED:07d}.npy", allow_pickle=False)
    return {
        "panoramas_learnt": LEARNT,
        "steps": STEPS,
        "panoramas_judged": JUDGED,
        "runs": figures([run.name for run in runs], errors, truth),
    }


def _refuse_others(work: Path, shards: Mapping[int, int]) -> None:
    """A folder of `model train` has shards of the same numbers, which nothing was left out of."""
    for number, count in shards.items():
        there = work / f"targets-{number:07d}.npy"
        if there.exists():
            found = len(np.load(there, mmap_mode="r", allow_pickle=False))
            if found != count:
                raise InputError(there, f"{found} panoramas", f"{count}: a folder of its own")


def _runs() -> list[_Run]:
    from panoplan.layouts.network.samples import REALISM

    return [
        _Run("everything"),
        _Run("everything, other homes", seed=1),
        *(_Run(f"without {kind}", (kind,)) for kind in REALISM),
    ]


def figures(
    names: Sequence[str], errors: Sequence[FloatArray], truth: FloatArray
) -> list[dict[str, Any]]:
    """A line a training, as `measure` tells it.

    Args:
        names: of the trainings; the first is the one that the others are compared with.
        errors: (P,) of each, rows.
        truth: (P, targets, W) of the panoramas, consecutive ones of one home.
    """
    from panoplan.layouts.network.samples import TARGETS

    floor, opening = (truth[:, TARGETS.index(name)] for name in ("floor", "opening"))
    openings = np.any(opening > 0, axis=1)
    small = np.pi * (1 / np.tan(floor) ** 2).mean(axis=1) < SMALL_CH2
    return [
        {
            "name": name,
            "floor_px": {"median": float(np.median(rows)), "mean": float(rows.mean())},
            "with_openings": _mean(rows, openings),
            "in_small_rooms": _mean(rows, small),
            "worse_by": None if rows is errors[0] else _difference(rows - errors[0]),
        }
        for name, rows in zip(names, errors, strict=True)
    ]


def _mean(rows: FloatArray, chosen: BoolArray) -> float | None:
    return float(rows[chosen].mean()) if chosen.any() else None


def _difference(change: FloatArray) -> dict[str, float]:
    """The mean, and an interval of it over draws of homes."""
    homes = change.reshape(-1, _PER_JUDGED_HOME).mean(axis=1)
    drawn = np.random.default_rng(0).integers(len(homes), size=(_BOOTSTRAPS, len(homes)))
    low, high = np.percentile(homes[drawn].mean(axis=1), _INTERVAL)
    return {"mean": float(change.mean()), "low": float(low), "high": float(high)}


def _errors(work: Path, number: int, run: _Run) -> FloatArray:
    """(JUDGED,) mean |Δ| of the floor boundary in rows, of a head trained on one shard."""
    from panoplan.layouts.network.data import batches
    from panoplan.layouts.network.shards import HELD_OUT_SEED
    from panoplan.layouts.network.train import CHECKPOINT, Plan, answer_of, load, train

    kept = work / f"errors-{number}.npy"
    if kept.exists():
        return np.asarray(np.load(kept, allow_pickle=False))
    out = work / f"run-{number}"
    # An interrupted training begins again: its learning rate would not fall as that of the others.
    (out / CHECKPOINT).unlink(missing_ok=True)
    plan = Plan(
        _MOST_MINUTES,
        steps=STEPS,
        rate=_RATE,
        batch=_BATCH,
        average=_AVERAGE,
        seed=run.seed,
        warm_up=_WARM_UP,
        shards=(number,),
    )
    train(work, out, plan, lambda line: None)
    network = load(out / CHECKPOINT)
    rows = []
    for *features, truth in batches(work, [HELD_OUT_SEED], 32, None):
        answer = answer_of(network, features, tuned=False).detach()
        rows.append((answer[:, 0] - truth[:, 0]).abs().mean(dim=1).numpy() * ROWS / np.pi)
    errors = np.concatenate(rows)
    np.save(kept, errors)
    return errors


def _told(progress: Callable[[int, int], None], before: int, total: int, done: int) -> None:
    progress(before + done, total)
