"""panoplan model train: data, training and export of the layout network."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.cli.progress import progress
from panoplan.errors import InputError, MissingExtraError

if TYPE_CHECKING:
    from panoplan.pipeline import Progress


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of the training."""
    parser.add_argument(
        "--panoramas", type=int, default=12288, metavar="N", help="train: rendered in all (12288)"
    )
    parser.add_argument(
        "--minutes", type=float, default=60.0, metavar="M", help="train: at most so long (60)"
    )
    parser.add_argument(
        "--head-share",
        type=float,
        default=0.5,
        metavar="S",
        help="train: of the minutes with the ImageNet features as they are (0.5)",
    )
    parser.add_argument(
        "--beside",
        type=Path,
        action="append",
        default=[],
        metavar="CHECKPOINT",
        help="train: of an earlier run with --head-share 1, averaged with this one",
    )
    parser.add_argument(
        "--mixing",
        type=float,
        default=0.0,
        metavar="S",
        help="train: share of the steps with the ImageNet features whose panoramas borrow one "
        "another's looks (0)",
    )
    parser.add_argument("--seed", type=int, default=0, help="train: of the order (0)")
    parser.add_argument("--quiet", action="store_true", help="train, adapt: no progress")


def act(options: argparse.Namespace) -> int:
    """Runs the training."""
    if options.output is None:
        raise InputError("model train", "no output", "-o FILE.onnx")
    if not 0.01 <= options.minutes <= 1e5:
        raise InputError("--minutes", f"{options.minutes:g}", "0.01 to 100000")
    if not 1 <= options.panoramas <= 10**7:
        raise InputError("--panoramas", str(options.panoramas), "1 to 10000000")
    if not 0 <= options.head_share <= 1:
        raise InputError("--head-share", f"{options.head_share:g}", "0 to 1")
    if not 0 <= options.mixing <= 1:
        raise InputError("--mixing", f"{options.mixing:g}", "0 to 1")
    try:
        import torch  # noqa: F401
    except ImportError:
        raise MissingExtraError("training", "torch", "train") from None
    from panoplan.layouts.network.data import Featuriser
    from panoplan.layouts.network.finish import finish
    from panoplan.layouts.network.shards import HELD_OUT_SEED, SHARD, render_shard
    from panoplan.layouts.network.train import CHECKPOINT, head_plan, train, tuned_plan
    from panoplan.layouts.network.trunk import pretrained

    numbers = [HELD_OUT_SEED, *range(-(-options.panoramas // SHARD))]
    featuriser = Featuriser(pretrained())
    with progress("rendering", quiet=options.quiet) as told:
        for place, number in enumerate(numbers):
            count = partial(_told, told, place * SHARD, len(numbers) * SHARD)
            render_shard(options.input, number, count)
            featuriser.shard(options.input, number)
    say: Callable[[str], None] = _silent if options.quiet else print
    share = options.head_share
    minutes, seed = options.minutes, options.seed
    plans = (
        head_plan(minutes * share, seed, options.mixing),
        tuned_plan(minutes * (1 - share), seed),
    )
    for plan in plans:
        if plan.minutes > 0:
            train(options.input, options.input, plan, say)
    finish(options.input, options.input / CHECKPOINT, options.output, say, beside=options.beside)
    print(options.output)
    return 0


def _told(told: Progress, before: int, total: int, done: int) -> None:
    told(before + done, total)


def _silent(line: str) -> None:
    pass
