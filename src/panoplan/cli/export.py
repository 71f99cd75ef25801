"""panoplan export: a plan as drawings and models."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panoplan.cli.progress import progress
from panoplan.errors import InputError

if TYPE_CHECKING:
    from panoplan.types.plan import FloorPlan


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "export",
        help="a plan as drawings, CAD, BIM, 3-D model, room schedule",
        description="Writes a metric plan in formats that other programs open.",
        epilog="example: panoplan export plan/plan.json --to pdf,dxf -o plan/export/",
    )
    parser.add_argument("plan", type=Path, help="plan.json")
    parser.add_argument(
        "--to",
        required=True,
        metavar="KIND,KIND",
        help="of svg and pdf (sheets in true scale), dxf, geojson, ifc, glb, csv (room "
        "schedule), html (report)",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder to write to")
    parser.add_argument("--title", help="of the sheets (default: the name of the plan's folder)")
    parser.add_argument(
        "--paper",
        choices=["A4", "A3", "A2", "A1", "A0"],
        help="of the sheets (default: 1:50 or 1:100 on A4 or A3, larger where needed)",
    )
    parser.add_argument(
        "--north",
        type=float,
        metavar="DEG",
        help="heading of north in the plan, clockwise from its second axis (up in plan.svg)",
    )
    parser.add_argument(
        "--anchor",
        metavar="LAT,LON",
        help="degrees (WGS 84) of the plan's origin: GeoJSON on the globe, the site of the IFC; "
        "wants --north",
    )
    parser.add_argument(
        "--images",
        type=Path,
        metavar="FOLDER",
        help="upright panoramas named after their keyframes, or a scene with images: for "
        "the texture of the GLB and for the report",
    )
    parser.add_argument("--quiet", action="store_true", help="no progress")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.exporters.export import ExportOptions, export
    from panoplan.formats.edits_json import read_edited

    kinds = [kind for kind in options.to.lower().split(",") if kind]
    north = None if options.north is None else math.radians(_finite("--north", options.north))
    edited = read_edited(options.plan)
    for lost in edited.lost:
        print(f"panoplan: edit not applied: {lost}", file=sys.stderr)
    with progress("images", quiet=options.quiet or options.images is None) as report:
        told = ExportOptions(
            title=options.title or options.plan.resolve().parent.name,
            north=north,
            paper=options.paper,
            anchor=_anchor(options.anchor, north),
            images=_images(options.images, edited.plan),
            progress=report,
        )
        made = export(edited.plan, kinds, options.output, told)
    for path in made:
        print(path)
    return 0


def _images(folder: Path | None, plan: FloorPlan) -> Mapping[str, Path]:
    from panoplan.formats.panoramas import find_panoramas

    if folder is None:
        return {}
    ids = [pose.id for pose in plan.trajectory]
    found = find_panoramas(folder, ids)
    if not found:
        raise InputError(folder, "no image of any keyframe", f"images named as {ids[:1]}")
    if len(found) < len(ids):
        missing = f"{len(ids) - len(found)} of {len(ids)} keyframes"
        print(f"panoplan: {folder}: no image of {missing}", file=sys.stderr)
    return found


def _anchor(text: str | None, north: float | None) -> Any:
    from panoplan.exporters.geojson import Anchor

    if text is None:
        return None
    if north is None:
        raise InputError("--anchor", "no --north", "the heading of north in the plan beside it")
    try:
        latitude, longitude = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError("--anchor", repr(text), "LATITUDE,LONGITUDE in degrees") from None
    return Anchor(latitude, longitude, north)


def _finite(option: str, value: float) -> float:
    if not math.isfinite(value):
        raise InputError(option, f"{value}", "degrees")
    return value
