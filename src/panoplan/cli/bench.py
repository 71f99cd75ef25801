"""panoplan bench: accuracy and runtime, and the tables made from them."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panoplan.cli import bench_v1, settings
from panoplan.cli.progress import progress
from panoplan.errors import InputError
from panoplan.formats.atomic import write_text

if TYPE_CHECKING:
    from panoplan.config import Config
    from panoplan.pipeline import Progress


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "bench",
        help="accuracy and runtime, and tables of them",
        description="v1: the paper's tables on simulated buildings. accuracy: on simulated flats. "
        "metric: whether the ± of metres holds. home: on a scene with known truth. misplaced: one "
        "room's cameras of a tour shifted, on simulated flats or on a scene. difficulty: a scene's "
        "real layouts against simulated ones. runtime: time and memory on a long walk. odometry: "
        "on rendered walks. tour: joining a scene's photos, and the plan. layouts: a layout "
        "network on a folder with images and true layouts. realism: what each kind of realism in "
        "the renders brings to its training. exports: what each format of a scene's plan takes, "
        "read back. model: the textured model against a scene's photos. table: writes what they "
        "measured into a page.",
        epilog="example: panoplan bench v1 --methods default --jobs 2 -o v1/",
    )
    parser.add_argument(
        "what",
        nargs="?",
        choices=[
            "v1", "accuracy", "metric", "home", "misplaced", "difficulty", "runtime", "odometry",
            "tour", "layouts", "realism", "exports", "model", "table",
        ],
    )  # fmt: skip
    parser.add_argument(
        "input",
        nargs="?",
        type=Path,
        help="home, misplaced, difficulty, tour, layouts, exports, model: scene; odometry: walks; "
        "realism: folder to work in; table: page",
    )
    parser.add_argument(
        "--model",
        type=Path,
        metavar="ONNX",
        help="layouts, home, tour, odometry: network (default: the shipped)",
    )
    parser.add_argument(
        "--flats", type=_count, default=20, metavar="N", help="seeds 0 to N-1 a grade"
    )
    parser.add_argument(
        "--trials", type=_count, default=40, metavar="N", help="misplaced: how many"
    )
    parser.add_argument(
        "--draws",
        type=partial(_count, least=0),
        default=0,
        metavar="N",
        help="tour: so often three quarters of the photos are drawn and joined, too",
    )
    parser.add_argument(
        "--rendered",
        action="store_true",
        help="tour: of made-up homes (--seeds, default 25-34), photographed into the folder given "
        "where they are not there yet; odometry: walks through such homes, well and badly filmed",
    )
    parser.add_argument(
        "--predict",
        action="store_true",
        help="home, tour: layouts by the network (--model) instead of those in the scene",
    )
    parser.add_argument(
        "--live",
        action="store_true",
        help="odometry: also how far a plan that grows meanwhile lags behind (--model)",
    )
    parser.add_argument(
        "--plans",
        action="store_true",
        help="odometry: also the plans of the walks, by the network (--model) and by true layouts",
    )
    parser.add_argument("--metric", action="store_true", help="accuracy: the scale is given")
    parser.add_argument(
        "--jobs",
        type=_count,
        default=1,
        metavar="N",
        help="v1, accuracy, metric, difficulty: processes",
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("benchmarks"),
        help="table: folder of the files measured (default: benchmarks)",
    )
    parser.add_argument("-o", "--output", type=Path, help="JSON file (default: stdout); v1: folder")
    parser.add_argument("--quiet", action="store_true", help="no progress")
    bench_v1.add_arguments(parser)
    settings.add_arguments(parser)
    parser.set_defaults(act=act)


_ONLY = {
    "rendered": ("tour", "odometry"),
    "predict": ("home", "tour"),
    "live": ("odometry",),
    "plans": ("odometry",),
}
"""Switches that are refused where they mean nothing."""


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.bench.record import commit, record, to_json

    commit()
    for name, where in _ONLY.items():
        if getattr(options, name) and options.what not in where:
            expected = " or ".join(f"bench {what}" for what in where)
            raise InputError(f"--{name}", f"bench {options.what or ''}".strip(), expected)
    if options.what == "v1" or (options.what is None and options.dataset is not None):
        return bench_v1.act(options)
    if options.what is None:
        raise InputError("bench", "nothing to measure", "bench v1, bench accuracy … (see --help)")
    asked = (
        "home", "difficulty", "odometry", "tour", "layouts", "realism", "exports", "model", "table",
    )  # fmt: skip
    if options.what in asked and options.input is None:
        raise InputError(f"bench {options.what}", "no path", f"bench {options.what} PATH")
    if options.what == "table":
        from panoplan.bench.table import update

        changed = update(options.input, options.results)
        print(f"{options.input}: {'changed' if changed else 'as it was'}")
        return 0
    if options.output is not None and not options.output.parent.is_dir():
        raise InputError(options.output, "no folder for it", "a file in a folder that exists")
    from panoplan.config import as_dict

    config = settings.resolve(options)
    with progress(options.what, quiet=options.quiet) as report:
        figures = _measured(options, config, report)
    text = to_json(record(options.what, as_dict(config), figures))
    if options.output is None:
        print(text, end="")
    else:
        write_text(options.output, text)
        print(options.output)
    return 0


def _measured(options: argparse.Namespace, config: Config, report: Progress) -> Any:
    """The figures of what is to be measured."""
    from panoplan.bench import (
        accuracy,
        difficulty,
        exports,
        home,
        layouts,
        metric,
        misplaced,
        model,
        odometry,
        realism,
        runtime,
        tour,
    )
    from panoplan.layouts.onnx import SHIPPED, OnnxLayouts

    place, jobs, trials = options.input, options.jobs, options.trials
    flats = range(options.flats)

    def predicting() -> OnnxLayouts | None:
        return OnnxLayouts(options.model or SHIPPED, threads=1) if options.predict else None

    measures: dict[str, Callable[[], Any]] = {
        "accuracy": lambda: accuracy.measure(
            flats, config, report, metric=options.metric, jobs=jobs
        ),
        "metric": lambda: metric.measure(flats, config, report, jobs=jobs),
        "home": lambda: home.measure(place, config, predicting(), report),
        "misplaced": lambda: (
            misplaced.measure_flats(range(trials), config, report)
            if place is None
            else misplaced.measure_home(place, config, trials, report)
        ),
        "difficulty": lambda: difficulty.measure(place, config, report, jobs=jobs),
        "runtime": lambda: runtime.measure(config, report),
        "odometry": lambda: odometry.measure(
            odometry.rendered(place, report) if options.rendered else _scenes(place),
            config,
            report,
            live=OnnxLayouts(options.model or SHIPPED) if options.live else None,
            plans=OnnxLayouts(options.model or SHIPPED) if options.plans else None,
        ),
        "tour": lambda: tour.measure(
            tour.rendered(place, options.seeds or tour.RENDERED_SEEDS, report)
            if options.rendered
            else _scenes(place),
            config,
            options.draws,
            predicting(),
            report,
        ),
        "layouts": lambda: layouts.measure(
            place, OnnxLayouts(options.model or SHIPPED, threads=1), report
        ),
        "realism": lambda: realism.measure(place, report),
        "exports": lambda: exports.measure(place, config, report),
        "model": lambda: model.measure(place, config, report, options.pictures),
    }
    return measures[options.what]()


def _scenes(path: Path) -> list[Path]:
    """The scene with true poses, or the scenes in a folder."""
    from panoplan.formats.sequence import TRUE_TRAJECTORY

    if not path.is_dir():
        raise InputError(path, "no folder", "a scene with known truth, or a folder of them")
    if (path / TRUE_TRAJECTORY).exists():
        return [path]
    scenes = sorted(p for p in path.iterdir() if (p / TRUE_TRAJECTORY).exists())
    if not scenes:
        raise InputError(path, f"no {TRUE_TRAJECTORY} in it or below", "scenes with known truth")
    return scenes


def _count(text: str, least: int = 1) -> int:
    if not (re.fullmatch("[0-9]{1,4}", text) and int(text) >= least):
        raise argparse.ArgumentTypeError(f"found {text!r}; expected {least} to 9999")
    return int(text)
