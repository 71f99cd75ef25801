"""panoplan demo: a made-up home is photographed, and its plan made from the photographs alone."""

from __future__ import annotations

import argparse
import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panoplan.cli.progress import progress

if TYPE_CHECKING:
    from panoplan.metrics.report import Report
    from panoplan.pipeline import Progress

EXIT_NO_ROOM = 3
_MOST_JOBS = 4
_OURS = {"photographs", "truth", "plan", "comparison.png"}
"""What the command makes: one that was interrupted goes on."""


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "demo",
        help="a made-up home is photographed, and its plan made from the photographs",
        description="Renders the panoramas of a walk through a small home of five rooms, finds "
        "camera poses and layouts in the panoramas alone, makes the plan, and draws it beside the "
        "truth.",
        epilog="example: panoplan demo -o demo/",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("panoplan-demo"),
        help="new folder, or that of a demo to go on with (default: panoplan-demo)",
    )
    parser.add_argument("--seed", type=int, default=5, help="of the home and its looks")
    parser.add_argument("--quiet", action="store_true", help="no progress, no summary")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.cache import Cache, cache_folder
    from panoplan.config import Config
    from panoplan.datasets.detect import read_truth
    from panoplan.errors import InputError
    from panoplan.exporters.compare import write_comparison
    from panoplan.formats.run_folder import RunFolder
    from panoplan.formats.sequence import read_sequence
    from panoplan.intake.given import Given
    from panoplan.intake.layouts import open_network
    from panoplan.intake.live import not_followed
    from panoplan.intake.open import open_input
    from panoplan.metrics.report import evaluate
    from panoplan.pipeline import RunOptions, run, summary
    from panoplan.poses.walk.features import load_pycolmap
    from panoplan.simulate.render.sample import photograph, sample_home

    place: Path = options.output
    if place.exists() and (not place.is_dir() or any(p.name not in _OURS for p in place.iterdir())):
        raise InputError(place, "something there", "a new folder, or one of this command")
    # What is missing is told before the work begins.
    open_network(None, ())
    load_pycolmap()
    photographs, truth = place / "photographs", place / "truth"
    config, folder = Config(), RunFolder(place / "plan")
    with progress("photographs", quiet=options.quiet) as report:
        home = sample_home(options.seed)
        if not photographs.exists():
            told, jobs = partial(_photographs, report), min(os.cpu_count() or 1, _MOST_JOBS)
            photograph(photographs, truth, home, options.seed, jobs=jobs, told=told)
        elif read_sequence(truth).name != home.name:
            raise InputError(photographs, "another home's", f"those of --seed {options.seed}")
        height = home.camera_height_m
        given = Given(photographs, camera_height_m=height)
        cache = Cache(cache_folder())
        scene, more = open_input(given, folder.scene, cache, report, not_followed, config)
        plan = run(scene, config, RunOptions(camera_height_m=height), folder, report)
        true = read_truth(truth)
        write_comparison(place / "comparison.png", plan, true, align="rigid")
    if not options.quiet:
        lines = [f"{len(home.keyframes)} photographs: {photographs}", *more.lines, summary(plan)]
        lines.append(_judged(evaluate(plan, true, align="rigid")))
        print("\n".join([*lines, str(folder.path / "plan.svg"), str(place / "comparison.png")]))
    return 0 if any(room.polygon is not None for room in plan.rooms) else EXIT_NO_ROOM


def _photographs(report: Progress, done: int, total: int) -> None:
    report(done, total, "photographs")


def _judged(report: Report) -> str:
    rooms = report.rooms
    (half,) = (score for score in rooms.scores if score.iou == 0.5)
    told = f"against the truth: {half.hits} of {half.true} rooms at IoU 0.5"
    return told if rooms.mean_iou is None else f"{told}, mean IoU {rooms.mean_iou:.2f}"
