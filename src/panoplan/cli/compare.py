"""panoplan compare: a picture of a plan beside and over the truth."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from panoplan.cli.evaluate import add_truth_arguments


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "compare",
        help="a picture of a plan and the truth",
        description="Draws truth and plan side by side and over one another.",
        epilog="example: panoplan compare plan/plan.json home/ -o figure.png",
    )
    add_truth_arguments(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, help=".png or .svg")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.datasets.detect import read_truth
    from panoplan.exporters.compare import write_comparison
    from panoplan.formats.plan_json import read_plan

    write_comparison(
        options.output,
        read_plan(options.plan),
        read_truth(options.truth),
        rooms=options.rooms,
        align=options.align,
    )
    print(options.output)
    return 0
