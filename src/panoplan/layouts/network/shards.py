"""Training data on disk: shards of rendered panoramas, each a pair of plain arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from panoplan.formats.atomic import make_folder
from panoplan.layouts.network.samples import TARGETS, WIDTH, Sample, samples

SHARD = 512
"""Samples of a shard."""
HELD_OUT_SEED = 10**6
"""Shards from this number on are for choosing models, never for training."""


def render_shard(folder: Path, number: int, told: Callable[[int], None]) -> None:
    """Renders a shard, unless it is there.

    Args:
        folder: where `images-N.npy` (SHARD, H, W, 3) and `targets-N.npy` (SHARD, rows, W) go.
        number: of the shard, which is its seed.
        told: called with the number of panoramas done.
    """
    write_shard(folder, number, samples(number), SHARD, told)


def write_shard(
    folder: Path, number: int, source: Iterable[Sample], count: int, told: Callable[[int], None]
) -> None:
    """Writes so many samples as a shard, unless it is there.

    Args:
        folder: as `render_shard`'s.
        number: of the shard.
        source: of the samples, at least as many.
        count: how many.
        told: called with the number of panoramas done.
    """
    make_folder(folder)
    done = folder / f"targets-{number:07d}.npy"
    if done.exists():
        return
    images = np.empty((count, WIDTH // 2, WIDTH, 3), dtype=np.uint8)
    rows = np.empty((count, len(TARGETS), WIDTH), dtype=np.float32)
    for k, sample in zip(range(count), source, strict=False):
        images[k], rows[k] = sample.image, sample.targets
        told(k + 1)
    # The targets come last: with them the shard is whole.
    for name, array in (("images", images), ("targets", rows)):
        part = folder / f".{name}-{number:07d}.npy"
        np.save(part, array)
        part.rename(folder / f"{name}-{number:07d}.npy")


def shards(folder: Path, *, held_out: bool) -> list[int]:
    """Numbers of the whole shards of a folder, sorted."""
    numbers = sorted(int(p.stem.split("-")[1]) for p in folder.glob("targets-*.npy"))
    return [n for n in numbers if (n >= HELD_OUT_SEED) == held_out]
