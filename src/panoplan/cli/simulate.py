"""panoplan simulate: made-up buildings, walked through."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panoplan.cli.progress import progress
from panoplan.errors import InputError

if TYPE_CHECKING:
    from panoplan.pipeline import Progress
    from panoplan.simulate.buildings import Building
    from panoplan.simulate.scene import Grade, SimulatedScene

_MOST_SCENES = 10_000
_STEP_M = 0.4
_WIDTH_PX = 1024


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "simulate",
        help="made-up buildings with their walks, layouts and truth",
        description="Makes buildings, walks through them and writes what odometry and a layout "
        "network would give, with their errors, and the truth.",
        epilog="example: panoplan simulate -o scenes/ --family mp3d-fpe --scenes 5 --grade hard",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder to write to")
    parser.add_argument(
        "--family",
        choices=["mp3d-fpe", "flat"],
        help="large houses, or flats of a real size (default: a plain flat of few kinds of rooms)",
    )
    parser.add_argument(
        "--building", type=Path, metavar="FOLDER",
        help="a walk through rooms and doors that a folder's truth has; without doors, through "
        "those that its cameras must have used",
    )  # fmt: skip
    parser.add_argument("--seed", type=int, default=0, help="of building and walk (default: 0)")
    parser.add_argument(
        "--scenes", type=int, metavar="K", help="seeds from --seed on, a folder each in the output"
    )
    parser.add_argument(
        "--grade",
        choices=["exact", "mild", "hard", "measured"],
        help="of the errors (default: measured for a family or --building, mild for a plain flat)",
    )
    parser.add_argument(
        "--storeys", type=int, default=1, metavar="N",
        help="of a family's building, each as large as one, joined by stairs (default: 1)",
    )  # fmt: skip
    parser.add_argument("--stills", action="store_true", help="sparse photos instead of a walk")
    parser.add_argument(
        "--rooms", type=int, choices=range(5, 10), metavar="5-9", help="rooms of a plain flat"
    )
    parser.add_argument(
        "--step", type=float, metavar="M", help="metres a keyframe of a plain flat (default: 0.4)"
    )
    parser.add_argument(
        "--format", choices=["sequence", "mp3d-fpe"], default="sequence", help="kind of folder"
    )
    parser.add_argument(
        "--render",
        choices=["preview", "still"],
        help="also photographs of every keyframe, their depth and true layouts (sequence only)",
    )
    parser.add_argument(
        "--image-width", type=int, metavar="PX", help="of photographs (default: 1024)"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    _check(options)
    count = options.scenes or 1
    told = []
    with progress("simulate", quiet=options.quiet) as report:
        for number in range(count):
            scene = _scene(options, options.seed + number)
            folder = options.output if options.scenes is None else options.output / scene.name
            images = _photographed(scene, folder, options, options.seed + number, report)
            _write(scene, folder, options, options.seed + number, images)
            told.append(
                f"{len(scene.truth.plan.rooms)} rooms, {len(scene.keyframes)} keyframes: {folder}"
            )
            report(number + 1, count)
    print("\n".join(told))
    return 0


def _check(options: argparse.Namespace) -> None:
    """Refuses options that are out of range or do not go together."""
    step = options.step
    if step is not None and not 0.05 <= step <= 5:
        raise InputError("--step", f"{step:g}", "0.05 to 5 metres")
    if step is not None and (options.family or options.building or options.stills):
        raise InputError("--step", "no walk through a plain flat", "one of them")
    if options.scenes is not None and not 1 <= options.scenes <= _MOST_SCENES:
        raise InputError("--scenes", str(options.scenes), f"1 to {_MOST_SCENES}")
    if options.family is not None and options.rooms is not None:
        raise InputError("--rooms", "with --family", "one of them: a family draws its rooms")
    if options.building is not None and (options.family or options.rooms):
        raise InputError("--building", "--family or --rooms", "one of them")
    if options.storeys != 1 and options.family is None:
        raise InputError("--storeys", "no --family", "a family, whose buildings are stacked")
    if options.storeys != 1 and options.render:
        raise InputError("--storeys", "--render", "one of them: photographs are of one storey")
    if options.output.exists() and (not options.output.is_dir() or any(options.output.iterdir())):
        raise InputError(options.output, "something there", "a new or an empty folder")
    if options.render and options.format != "sequence":
        raise InputError("--render", f"--format {options.format}", "--format sequence")
    width = options.image_width
    if width is not None and options.render is None:
        raise InputError("--image-width", "no --render", "photographs")
    if width is not None and (width % 2 or not 64 <= width <= 8192):
        raise InputError("--image-width", str(width), "an even number, 64 to 8192")


def _scene(options: argparse.Namespace, seed: int) -> SimulatedScene:
    from panoplan.simulate.families import simulate_in, simulate_scene
    from panoplan.simulate.scene import simulate_flat

    grade: Grade = options.grade or "measured"
    if options.building is not None:
        building = _annotated(options.building)
        return simulate_in(building, seed, grade, as_stills=options.stills)
    if options.family is not None:
        return simulate_scene(
            options.family, seed, grade, as_stills=options.stills, storeys=options.storeys
        )
    return simulate_flat(
        seed,
        options.grade or "mild",
        stills=options.stills,
        rooms=options.rooms,
        step_m=options.step or _STEP_M,
    )


def _annotated(folder: Path) -> Building:
    """The part of a folder's building that can be walked."""
    from panoplan.datasets.detect import read_truth
    from panoplan.simulate.annotated import annotated_building, largest_part

    truth = read_truth(folder)
    if truth.plan.levels is not None:
        raise InputError(folder, "several storeys", "rooms of one")
    cameras = truth.trajectory
    ways = None if cameras is None else cameras.translations[:, [0, 2]]
    return largest_part(annotated_building(folder.resolve().name, truth.plan, ways=ways))


def _photographed(
    scene: SimulatedScene, folder: Path, options: argparse.Namespace, seed: int, report: Progress
) -> dict[str, str] | None:
    if options.render is None:
        return None
    from panoplan.simulate.render.record import record
    from panoplan.simulate.render.scene import QUALITIES

    return record(
        folder,
        scene,
        seed,
        QUALITIES[options.render],
        width=options.image_width or _WIDTH_PX,
        told=lambda done, total: report(done, total, f"rendering {folder.name}"),
    )


def _write(
    scene: SimulatedScene,
    folder: Path,
    options: argparse.Namespace,
    seed: int,
    images: dict[str, str] | None,
) -> None:
    from panoplan.formats.sequence import write_sequence

    if options.format == "sequence":
        write_sequence(
            folder,
            scene.name,
            scene.keyframes,
            scene.truth,
            scene.camera_height_m,
            images,
            # Those of photographs know more, and are there already.
            scene.true_layouts if images is None else None,
        )
        return
    _write_mp3d_fpe(scene, folder if options.scenes is None else folder / "0", seed)


def _write_mp3d_fpe(scene: SimulatedScene, folder: Path, seed: int) -> None:
    """Writes a scene with its cloud; keyframes of a video have the numbers of their frames."""
    import numpy as np

    from panoplan.formats.mp3d_fpe import write_mp3d_fpe
    from panoplan.formats.ply import write_ply_points
    from panoplan.simulate.scan import scanned

    numbered = [
        replace(k, id=str(n + 1 if scene.frames is None else int(k.id)))
        for n, k in enumerate(scene.keyframes)
    ]
    write_mp3d_fpe(folder, numbered, scene.truth, scene.frames)
    walked = (scene.frames or scene.truth.trajectory or scene.odometry).translations
    points = scanned(scene.building, scene.camera_height_m, seed, walked=walked)
    # The higher the lighter: there is no texture to take colours from.
    low, high = points[:, 1].max(), points[:, 1].min()
    shade = 60 + 180 * (low - points[:, 1]) / max(low - high, 1e-9)
    write_ply_points(folder / "pcl.ply", points, np.repeat(shade[:, None], 3, 1).astype(np.uint8))
