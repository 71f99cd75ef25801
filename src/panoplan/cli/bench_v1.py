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
    from panoplan.bench.v1.scenes import Source

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


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.bench.parallel import processes
    from panoplan.bench.v1.predict import SHARES, Row
    from panoplan.bench.v1.run import run, write_figures
    from panoplan.bench.v1.store import Store

    if options.output is None:
        raise InputError("bench v1", "no folder", "-o FOLDER")
    if options.preset or options.config or options.set or options.seed is not None:
        raise InputError("bench v1", "settings", "--methods, whose settings are the benchmark's")
    rows = [Row(method, share) for method in options.methods for share in SHARES]
    workers = processes(options.jobs)
    make_folder(options.output)
    for scenes_of, sources in _sources(options).items():
        with progress(scenes_of, quiet=options.quiet) as report:
            figures = run(sources, rows, Store(options.output), workers, workers, report)
        for path in write_figures(figures, scenes_of, rows, options.output):
            print(path)
        for name, row in figures.items():
            for scene in row["scenes"]:
                if scene["failure"] is not None:
                    print(f"{scene['scene']}, {name}: failed: {scene['failure']}")
    return 0


def _sources(options: argparse.Namespace) -> dict[str, list[Source]]:
    from panoplan.bench.v1.scenes import FAMILIES, REPORTED_SEEDS, Simulated, mp3d_fpe_scenes

    if options.dataset is not None:
        if options.root is None:
            raise InputError("bench v1 --dataset", "no folder", f"--root FOLDER of {_DATASET}")
        return {"dataset": list(mp3d_fpe_scenes(options.root))}
    if options.family not in (None, *FAMILIES):
        raise InputError("--family", options.family, " or ".join(FAMILIES))
    families = FAMILIES if options.family is None else (options.family,)
    seeds = REPORTED_SEEDS if options.seeds is None else options.seeds
    return {family: [Simulated(family, seed) for seed in seeds] for family in families}


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
