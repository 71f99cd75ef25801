"""panoplan eval: a plan against the truth."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any


def add_truth_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what says which plan is compared with which truth, and how."""
    parser.add_argument("plan", type=Path, help="plan.json")
    parser.add_argument("truth", type=Path, help="folder with floorplan_gt.json")
    parser.add_argument(
        "--rooms", choices=["rooms", "rooms_partial"], default="rooms",
        help="complete true rooms, or those split at openings",
    )  # fmt: skip
    parser.add_argument(
        "--align", choices=["none", "scale", "rigid", "similarity"], default="none",
        help="what is fitted to the true camera positions first (default: none)",
    )  # fmt: skip


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "eval",
        help="scores of a plan against the truth",
        description="Scores a plan against the truth: the paper's figures and a surveyor's.",
        epilog="example: panoplan eval plan/plan.json home/ --rooms rooms_partial",
    )
    add_truth_arguments(parser)
    parser.add_argument(
        "--visited", type=Path, metavar="TRAJECTORY",
        help="TUM file of true positions that say which rooms were visited (default: the truth's)",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="prints JSON instead of a table")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.datasets.detect import read_truth
    from panoplan.formats.plan_json import read_plan
    from panoplan.formats.tum import read_tum
    from panoplan.metrics.presentation import as_dict, as_table
    from panoplan.metrics.report import evaluate

    visited = None
    if options.visited is not None:
        visited = read_tum(options.visited).translations
    report = evaluate(
        read_plan(options.plan),
        read_truth(options.truth),
        rooms=options.rooms,
        visited=visited,
        align=options.align,
    )
    print(json.dumps(as_dict(report), indent=1) if options.json else as_table(report))
    return 0
