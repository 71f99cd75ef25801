"""panoplan simulate: a made-up flat, walked through."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from panoplan.errors import InputError


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "simulate",
        help="a made-up flat with its walk, layouts and truth",
        description="Makes a flat, walks through it and writes what odometry and a layout network "
        "would give, with their errors, and the truth.",
        epilog="example: panoplan simulate -o flat/ --seed 7 --grade hard",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder to write to")
    parser.add_argument("--seed", type=int, default=0, help="of the flat and its walk (default: 0)")
    parser.add_argument("--grade", choices=["exact", "mild", "hard"], default="mild")
    parser.add_argument("--stills", action="store_true", help="sparse photos instead of a walk")
    parser.add_argument(
        "--rooms", type=int, choices=range(5, 10), metavar="5-9", help="rooms (default: drawn)"
    )
    parser.add_argument("--step", type=float, default=0.4, metavar="M", help="metres a keyframe")
    parser.add_argument(
        "--format", choices=["sequence", "mp3d-fpe"], default="sequence", help="kind of folder"
    )
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.formats.mp3d_fpe import write_mp3d_fpe
    from panoplan.formats.sequence import write_sequence
    from panoplan.simulate.scene import simulate_flat

    if not 0.05 <= options.step <= 5:
        raise InputError("--step", f"{options.step:g}", "0.05 to 5 metres")
    if options.output.exists() and (not options.output.is_dir() or any(options.output.iterdir())):
        raise InputError(options.output, "something there", "a new or an empty folder")
    scene = simulate_flat(
        options.seed,
        options.grade,
        stills=options.stills,
        rooms=options.rooms,
        step_m=options.step,
    )
    if options.format == "sequence":
        write_sequence(
            options.output, scene.name, scene.keyframes, scene.truth, scene.camera_height_m
        )
    else:
        numbered = [replace(k, id=str(n + 1)) for n, k in enumerate(scene.keyframes)]
        write_mp3d_fpe(options.output, numbered, scene.truth)
    print(
        f"{len(scene.truth.plan.rooms)} rooms, {len(scene.keyframes)} keyframes: {options.output}"
    )
    return 0
