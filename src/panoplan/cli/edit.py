"""panoplan edit: names, true sizes and moved walls, kept beside the plan."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from panoplan.editing.apply import Edited
    from panoplan.types.edits import Edits
    from panoplan.types.plan import FloorPlan


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "edit",
        help="names rooms, gives true sizes, moves walls",
        description="Writes what you know better into edits.json beside the plan. The estimate in "
        "plan.json stays as it is; every export applies the edits, also after a new run.",
        epilog="example: panoplan edit plan/plan.json --name room_03=Kitchen --length wall_12=3.62",
    )
    parser.add_argument("plan", type=Path, help="plan.json")
    parser.add_argument(
        "--name", action="append", default=[], metavar="ROOM=NAME", help="what a room is called"
    )
    parser.add_argument(
        "--length",
        action="append",
        default=[],
        metavar="WALL=M",
        help="true length of a wall from corner to corner: the plan becomes metric by it",
    )
    parser.add_argument(
        "--door-height",
        action="append",
        default=[],
        metavar="DOOR=M@KEYFRAME,ROW/HEIGHT",
        help="true height of a door, and the image row (of so many) of an upright panorama in "
        "which its upper edge is seen: the plan becomes metric by it",
    )
    parser.add_argument(
        "--nudge",
        action="append",
        default=[],
        metavar="WALL=M",
        help="moves a wall out of its room by so many metres, or into it",
    )
    parser.add_argument(
        "--drop", action="append", default=[], metavar="ID", help="forgets the edits of an id"
    )
    parser.add_argument("--list", action="store_true", help="prints rooms and walls with their ids")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.editing.apply import apply
    from panoplan.editing.change import changed
    from panoplan.exporters.pictures import write_plan_pictures
    from panoplan.formats.edits_json import EDITS, read_edits, write_edits
    from panoplan.formats.plan_json import read_plan

    plan, path = read_plan(options.plan), options.plan.with_name(EDITS)
    before = read_edits(path)
    edits = changed(
        before,
        plan,
        names=options.name,
        lengths=options.length,
        door_heights=options.door_height,
        nudges=options.nudge,
        drop=options.drop,
    )
    edited = apply(plan, edits)
    if options.name or options.length or options.door_height or options.nudge or options.drop:
        write_edits(path, edits)
        write_plan_pictures(options.plan.parent, edited.plan)
    print(_summary(plan, edits, edited))
    if options.list:
        print(_table(edited.plan))
    return 0


def _summary(plan: FloorPlan, edits: Edits, edited: Edited) -> str:
    counts = (
        (len(edits.names), "names"),
        (len(edits.lengths), "lengths"),
        (len(edits.door_heights), "door heights"),
        (len(edits.nudges), "nudges"),
    )
    lines = [", ".join(f"{count} {what}" for count, what in counts)]
    metric = edited.plan.metric
    if edited.factor != 1.0 and metric is not None:
        unit = "metres" if plan.unit == "m" else "camera heights"
        lines.append(f"lengths in {unit} times {edited.factor:.5f}")
    if metric is not None:
        lines.append(f"metres by {metric.source}, ± {100 * metric.sigma:.1f} %")
    return "\n".join([*lines, *(f"not applied: {what}" for what in edited.lost)])


def _table(plan: FloorPlan) -> str:
    from panoplan.exporters.labels import printable

    unit = "m" if plan.unit == "m" else "ch"
    lines = []
    for room in plan.rooms:
        lines.append(f"{room.id}  {printable(room.name)}")
        for wall in room.walls:
            length = ((wall.b - wall.a) ** 2).sum() ** 0.5
            told = "" if wall.sigma is None else f"  lies ± {wall.sigma:.3f} {unit}"
            lines.append(f"  {wall.id}  {length:.3f} {unit}{told}")
    lines += [f"{door.id}  between {' and '.join(door.rooms)}" for door in plan.doors]
    return "\n".join(lines)
