"""panoplan bench v1: the paper's tables on simulated buildings or on its dataset."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.cli.progress import progress
from panoplan.config import PRESETS
from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder

if TYPE_CHECKING:
    from panoplan.bench.v1.scenes import Simulated, Source

_DATASET = "mp3d-fpe"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what chooses scenes and rows."""
    group = parser.add_argument_group("v1")
    group.add_argument("--family", help="kind of building (default: all)")
    group.add_argument(
        "--seeds", type=_seeds, metavar="A-B", help="buildings (default: 25-49, those reported)"
    )
    group.add_argument("--dataset", choices=[_DATASET], help="scenes of a dataset instead")
    group.add_argument("--root", type=Path, help="folder of the dataset: <root>/<scene>/<version>")
    group.add_argument(
        "--methods",
        type=_methods,
        default=PRESETS,
        metavar="A,B",
        help=f"presets (default: {','.join(PRESETS)})",
    )
    group.add_argument(
        "--ablate",
        action="store_true",
        help="instead of the table: what knowing the scale, the poses, the layouts or the grouping "
        "would gain, on the buildings to tune on (seeds 0-24)",
    )


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    if options.output is None:
        raise InputError("bench v1", "no folder", "-o FOLDER")
    if options.preset or options.config or options.set or options.seed is not None:
        raise InputError("bench v1", "settings", "--methods, whose settings are the benchmark's")
    if options.dataset is not None and options.root is None:
        raise InputError("bench v1 --dataset", "no folder", f"--root FOLDER of {_DATASET}")
    make_folder(options.output)
    return _ablate(options) if options.ablate else _compare(options)


def _compare(options: argparse.Namespace) -> int:
    from panoplan.bench.parallel import processes
    from panoplan.bench.v1.predict import SHARES, Row
    from panoplan.bench.v1.run import run, write_methods
    from panoplan.bench.v1.scenes import mp3d_fpe_scenes
    from panoplan.bench.v1.store import Store
    from panoplan.simulate.families import REPORTED_SEEDS

    sources: dict[str, list[Source]]
    if options.dataset is not None:
        sources = {"dataset": list(mp3d_fpe_scenes(options.root))}
    else:
        sources = {name: list(own) for name, own in _simulated(options, REPORTED_SEEDS).items()}
    rows = [Row(method, share) for method in options.methods for share in SHARES]
    workers = processes(options.jobs)
    for scenes_of, own in sources.items():
        with progress(scenes_of, quiet=options.quiet) as report:
            figures = run(own, rows, Store(options.output), workers, workers, report)
        for path in write_methods(figures, scenes_of, rows, options.output):
            print(path)
        for name, row in figures.items():
            for scene in row["scenes"]:
                if scene["failure"] is not None:
                    print(f"{scene['scene']}, {name}: failed: {scene['failure']}")
    return 0


def _ablate(options: argparse.Namespace) -> int:
    from panoplan.bench.parallel import processes
    from panoplan.bench.v1.ablation import ablated
    from panoplan.bench.v1.predict import SHARES, Row
    from panoplan.bench.v1.run import write_figures
    from panoplan.bench.v1.store import Store
    from panoplan.simulate.families import TUNING_SEEDS

    if options.dataset is not None:
        raise InputError("--ablate", "--dataset", "simulated buildings, of which all is known")
    row = Row("default", SHARES[0])
    for family, own in _simulated(options, TUNING_SEEDS).items():
        with progress(family, quiet=options.quiet) as report:
            figures = ablated(own, row, Store(options.output), processes(options.jobs), report)
        print(write_figures("v1-ablation", row.method, family, figures, options.output))
    return 0


def _simulated(options: argparse.Namespace, seeds: range) -> dict[str, list[Simulated]]:
    from panoplan.bench.v1.scenes import Simulated
    from panoplan.simulate.families import FAMILIES

    if options.family not in (None, *FAMILIES):
        raise InputError("--family", options.family, " or ".join(FAMILIES))
    families = FAMILIES if options.family is None else (options.family,)
    chosen = seeds if options.seeds is None else options.seeds
    return {family: [Simulated(family, seed) for seed in chosen] for family in families}


def _seeds(text: str) -> range:
    first, dash, last = text.partition("-")
    if not (first.isascii() and first.isdigit() and (not dash or last.isdigit())):
        raise argparse.ArgumentTypeError(f"found {text!r}; expected a seed or A-B")
    seeds = range(int(first), int(last or first) + 1)
    if not 0 < len(seeds) <= 10_000:
        raise argparse.ArgumentTypeError(f"found {text!r}; expected 1 to 10000 seeds")
    return seeds


def _methods(text: str) -> tuple[str, ...]:
    methods = tuple(text.split(","))
    unknown = [name for name in methods if name not in PRESETS]
    if unknown:
        wanted = ", ".join(PRESETS)
        raise argparse.ArgumentTypeError(f"found {unknown[0]!r}; expected some of {wanted}")
    return methods
