"""panoplan run: poses and layouts become a floor plan."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panoplan.cli import settings
from panoplan.cli.layout import add_network_arguments
from panoplan.cli.progress import progress
from panoplan.errors import InputError

if TYPE_CHECKING:
    from panoplan.datasets.scene import Scene
    from panoplan.pipeline import Watcher

EXIT_NO_ROOM = 3


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "run",
        help="images, or poses and layouts, become a floor plan",
        description="Turns a 360° video, a folder of panoramas, or a folder of camera poses and "
        "room layouts into a floor plan. What is missing is found; what was found is kept.",
        epilog="example: panoplan run walk.mp4 -o plan/ --camera-height 1.5; with --explain it "
        "also writes plan/explain/1_scale.png, 2_rooms.png, ...",
    )
    parser.add_argument("input", type=Path, help="video, folder of images or scene")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder to write to")
    parser.add_argument(
        "--trajectory", type=Path, help="TUM, KITTI, COLMAP, ... instead of the folder's"
    )
    parser.add_argument("--layouts", type=Path, help="folder instead of the folder's")
    parser.add_argument("--version", help="of an MP3D-FPE scene that has several")
    parser.add_argument("--trajectory-unit", choices=["m", "unknown"], default="unknown")
    parser.add_argument("--camera-height", type=_metres, metavar="M", help="metres above the floor")
    parser.add_argument(
        "--explain",
        action="store_true",
        help="also write a picture a stage into OUTPUT/explain: scale, rooms, then views and fused "
        "floors, or wall planes and the rounds of iSPA, as the preset has it",
    )
    parser.add_argument(
        "--live",
        nargs="?",
        const="",
        metavar="FILE.rrd",
        help="shows the run as it goes in the Rerun viewer, or writes it into a file for it",
    )
    parser.add_argument("--force", action="store_true", help="write into a folder of other files")
    parser.add_argument("--quiet", action="store_true", help="no progress, no summary")
    add_network_arguments(parser)
    settings.add_arguments(parser)
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.cache import Cache, cache_folder
    from panoplan.estimator.state import Walk
    from panoplan.formats.run_folder import RunFolder
    from panoplan.intake.given import Given, recognise
    from panoplan.intake.live import LivePlan
    from panoplan.intake.open import open_input
    from panoplan.pipeline import RunOptions, run, summary

    config = settings.resolve(options)
    given = Given(
        options.input,
        options.trajectory,
        options.layouts,
        options.version,
        options.model,
        options.average,
        options.camera_height,
    )
    if options.trajectory_unit == "m" and recognise(given) in ("video", "images"):
        raise InputError(
            "--trajectory-unit m",
            "no trajectory: poses are to be found from the pictures, in no unit",
            "--camera-height, or --trajectory",
        )
    folder = RunFolder(options.output, force=options.force)
    known = RunOptions(options.trajectory_unit, options.camera_height, options.explain)
    with progress("keyframes", quiet=options.quiet) as report:
        walk = Walk(camera_height_m=options.camera_height)
        live = partial(LivePlan, config, walk, partial(folder.show, config))
        cache = Cache(cache_folder())
        scene, told = open_input(given, folder.scene, cache, report, live, config)
        if told.trajectory_unit == "m":
            known = replace(known, trajectory_unit="m")
        images = [path for path in (options.input, folder.scene) if path.is_dir()]
        with _watcher(options.live, images, scene) as watcher:
            plan = run(scene, config, known, folder, report, watcher)
    if not options.quiet:
        lines = [f"{scene.kind}: {scene.association}", *told.lines, summary(plan)]
        print("\n".join([*lines, str(folder.path / "plan.json")]))
    return 0 if any(room.polygon is not None for room in plan.rooms) else EXIT_NO_ROOM


@contextmanager
def _watcher(live: str | None, images: Sequence[Path], scene: Scene) -> Iterator[Watcher | None]:
    if live is None:
        yield None
        return
    from panoplan.formats.panoramas import find_panoramas
    from panoplan.viewers.live import LiveView

    ids = [keyframe.id for keyframe in scene.keyframes]
    found: dict[str, Path] = {}
    for folder in images:
        found = {**find_panoramas(folder, ids), **found}
    view = LiveView(Path(live) if live else None, found)
    try:
        yield view
    finally:
        view.close()


def _metres(text: str) -> float:
    value = float(text)
    if not 0.05 <= value <= 100:
        raise argparse.ArgumentTypeError(f"found {text}; expected 0.05 to 100 metres")
    return value
