"""panoplan bench: accuracy and runtime on simulated buildings."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from panoplan.bench import accuracy, runtime
from panoplan.bench.record import record
from panoplan.cli import settings
from panoplan.cli.progress import progress
from panoplan.formats.atomic import write_text


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "bench",
        help="accuracy and runtime on simulated buildings",
        description="Measures accuracy on simulated flats, or time and memory on a long walk.",
        epilog="example: panoplan bench accuracy --flats 20 -o accuracy.json",
    )
    parser.add_argument("what", choices=["accuracy", "runtime"])
    parser.add_argument("--flats", type=int, default=20, metavar="N", help="seeds 0 to N-1 a grade")
    parser.add_argument("-o", "--output", type=Path, help="JSON file (default: stdout)")
    parser.add_argument("--quiet", action="store_true", help="no progress")
    settings.add_arguments(parser)
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    config = settings.resolve(options)
    with progress(options.what, quiet=options.quiet) as report:
        if options.what == "accuracy":
            figures: Any = accuracy.measure(range(max(1, options.flats)), config, report)
        else:
            figures = runtime.measure(config, report)
    text = json.dumps(record(options.what, config, figures), indent=1) + "\n"
    if options.output is None:
        print(text, end="")
    else:
        write_text(options.output, text)
        print(options.output)
    return 0
