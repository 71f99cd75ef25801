"""panoplan bench v1: the paper's tables on simulated buildings or on its dataset."""

from __future__ import annotations

import argparse
import re
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.cli.progress import progress
from panoplan.config import PRESETS
from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder

if TYPE_CHECKING:
    from panoplan.bench.parallel import Workers
    from panoplan.bench.v1.scenes import Simulated, Source

_DATASET = "mp3d-fpe"
_METHODS = ("points", *PRESETS)
_STUDIES = (
    ("--ispa", "ispa", "Table III, five kinds of shortest path"),
    ("--scale-error", "scale", "error of the scale by the number of layouts"),
    ("--sweeps", "sweeps", "more and less noise, drift, keyframes and leaks"),
    ("--ablate", "ablation", "what knowing one stage's output would gain, on seeds 0-24"),
)


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
        default=_METHODS,
        metavar="A,B",
        help=f"points (from a scan), or presets (default: {','.join(_METHODS)})",
    )
    for flag, study, told in _STUDIES:
        group.add_argument(
            flag, dest="studies", action="append_const", const=study, help=f"{told}, not Table II"
        )
    group.add_argument(
        "--all", action="store_true", help="Table II and all of these (about 5 h CPU)"
    )
    group.add_argument(
        "--ray", metavar="ADDRESS", help="works on a Ray cluster instead of --jobs processes"
    )
    group.add_argument(
        "--pictures",
        type=Path,
        metavar="DIR",
        help="draws the best, median and worst scene; model: photos and renderings",
    )


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    if options.output is None:
        raise InputError("bench v1", "no folder", "-o FOLDER")
    if options.preset or options.config or options.set or options.seed is not None:
        raise InputError("bench v1", "settings", "--methods, whose settings are the benchmark's")
    studies = [study for _, study, _ in _STUDIES] if options.all else options.studies or []
    if options.dataset is not None and studies:
        raise InputError("--dataset", "a study", "simulated buildings, of which all is known")
    if options.dataset is not None and options.root is None:
        raise InputError("bench v1 --dataset", "no folder", f"--root FOLDER of {_DATASET}")
    make_folder(options.output)
    started = time.monotonic()
    if options.all or not studies:
        _compare(options)
    for study in studies:
        _study(options, study)
    print(f"{(time.monotonic() - started) / 60:.1f} minutes")
    return 0


def _compare(options: argparse.Namespace) -> None:
    from panoplan.bench.parallel import processes
    from panoplan.bench.v1.pictures import write_pictures
    from panoplan.bench.v1.predict import rows_of
    from panoplan.bench.v1.run import run, write_methods
    from panoplan.bench.v1.scenes import mp3d_fpe_scenes
    from panoplan.bench.v1.store import Store
    from panoplan.simulate.families import REPORTED_SEEDS

    sources: dict[str, list[Source]]
    if options.dataset is not None:
        sources = {"dataset": list(mp3d_fpe_scenes(options.root))}
    else:
        sources = {name: list(own) for name, own in _simulated(options, REPORTED_SEEDS).items()}
    rows = rows_of(options.methods)
    workers, store = _workers(options), Store(options.output)
    scorers = processes(options.jobs)
    for scenes_of, own in sources.items():
        with progress(scenes_of, quiet=options.quiet) as report:
            figures = run(own, rows, store, workers, scorers, report)
        for path in write_methods(figures, scenes_of, rows, options.output):
            print(path)
        for name, row in figures.items():
            for scene in row["scenes"]:
                if scene["failure"] is not None:
                    print(f"{scene['scene']}, {name}: failed: {scene['failure']}")
        if options.pictures is not None:
            # The last method's, from the fewest keyframes.
            shown = next(row for row in rows if row.method == rows[-1].method)
            scenes = figures[shown.name]["scenes"]
            for path in write_pictures(options.pictures, scenes_of, shown, scenes, own, store):
                print(path)


def _study(options: argparse.Namespace, name: str) -> None:
    from panoplan.bench.v1.run import write_figures
    from panoplan.bench.v1.store import Store
    from panoplan.bench.v1.studies import STUDIES
    from panoplan.bench.v1.study import Runner

    study, workers = STUDIES[name], _workers(options)
    for family, own in _simulated(options, study.seeds).items():
        with progress(f"{name}, {family}", quiet=options.quiet) as report:
            runner = Runner(Store(options.output), workers, report)
            figures = study.measure(own, runner)
        print(write_figures(f"v1-{name}", study.row.settings, family, figures, options.output))


def _workers(options: argparse.Namespace) -> Workers:
    from panoplan.bench.cluster import on_ray
    from panoplan.bench.parallel import processes

    return processes(options.jobs) if options.ray is None else on_ray(options.ray)


def _simulated(options: argparse.Namespace, seeds: Sequence[int]) -> dict[str, list[Simulated]]:
    from panoplan.bench.v1.scenes import Simulated
    from panoplan.simulate.families import FAMILIES

    if options.family not in (None, *FAMILIES):
        raise InputError("--family", options.family, " or ".join(FAMILIES))
    families = FAMILIES if options.family is None else (options.family,)
    chosen = seeds if options.seeds is None else options.seeds
    return {family: [Simulated(family, seed) for seed in chosen] for family in families}


def _seeds(text: str) -> range:
    told = re.fullmatch("([0-9]{1,9})(?:-([0-9]{1,9}))?", text)
    if told is None:
        raise argparse.ArgumentTypeError(f"found {text!r}; expected a seed or A-B")
    seeds = range(int(told[1]), int(told[2] or told[1]) + 1)
    if not 0 < len(seeds) <= 10_000:
        raise argparse.ArgumentTypeError(f"found {text!r}; expected 1 to 10000 seeds")
    return seeds


def _methods(text: str) -> tuple[str, ...]:
    methods = tuple(dict.fromkeys(text.split(",")))
    unknown = [name for name in methods if name not in _METHODS]
    if unknown:
        wanted = ", ".join(_METHODS)
        raise argparse.ArgumentTypeError(f"found {unknown[0]!r}; expected some of {wanted}")
    return methods
