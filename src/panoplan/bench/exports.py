"""What each export of a plan takes, and whether other libraries read the plan in it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from panoplan.bench import readback
from panoplan.bench.estimate import metric_plan, true_poses
from panoplan.config import Config
from panoplan.datasets.detect import read_truth
from panoplan.errors import InputError
from panoplan.exporters.export import KINDS
from panoplan.exporters.sheet.dimensions import wall_length
from panoplan.exporters.storeys import metric_storeys, room_area
from panoplan.formats.panoramas import find_panoramas
from panoplan.formats.plan_json import write_plan
from panoplan.metrics.report import evaluate
from panoplan.metrics.rooms import region
from panoplan.pipeline import Progress
from panoplan.types.plan import FloorPlan
from panoplan.types.truth import GroundTruth

_RUNS = 2


def measure(folder: Path, config: Config, progress: Progress) -> dict[str, Any]:
    """Exports the plan of a scene in every format, a command each, and reads the files back.

    Args:
        folder: a scene with trajectory_gt.tum, predicted layouts and a true plan; with images the
            model is textured and the report has panoramas.
        config: settings of the plan.
        progress: called with formats done and in all.

    Returns:
        By format: seconds of the whole command, start of the process included, the lesser of two
        runs, by the clock and of CPU; bytes; the largest error of a room's area read back. What
        the readers of DXF and IFC complain of, and how far DXF dimensions are off the walls; and
        the area of each room against the true one.

    Raises:
        InputError: the folder is not complete, or an export failed; MissingExtraError: what reads
            the files back is not installed.
    """
    plan = metric_plan(true_poses(folder), config)
    wanted = [float(room_area(room).area) for floor in metric_storeys(plan) for room in floor.rooms]
    images = len(find_panoramas(folder, [pose.id for pose in plan.trajectory]))
    figures: dict[str, Any] = {
        "scene": folder.name, "rooms": len(wanted), "images": images, "formats": {},
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "plan.json"
        write_plan(path, plan)
        for number, kind in enumerate(KINDS):
            files, seconds, cpu = _exported(path, kind, folder if images else None)
            read = readback.AREAS[kind](files)
            error = readback.largest_error(read, wanted)
            figures["formats"][kind] = {
                "seconds": seconds,
                "cpu_seconds": cpu,
                "bytes": sum(file.stat().st_size for file in files),
                "area_error_percent": None if error is None else 100 * error,
            }
            if kind == "dxf":
                figures["dxf"] = _dxf(files, plan)
            if kind == "ifc":
                figures["ifc"] = {"errors": readback.ifc(files)[1]}
            progress(number + 1, len(KINDS))
    figures["areas"] = _areas(plan, read_truth(folder))
    return figures


def _exported(plan: Path, kind: str, images: Path | None) -> tuple[list[Path], float, float]:
    """The files of an export, and the seconds that its command took by the clock and of CPU."""
    out = plan.parent / kind
    words = ["export", str(plan), "--to", kind, "-o", str(out), "--quiet"]
    words += [] if images is None else ["--images", str(images)]
    runs = []
    for _ in range(_RUNS):
        before, started = os.times(), time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-m", "panoplan", *words], capture_output=True, text=True, check=False
        )
        seconds, after = time.perf_counter() - started, os.times()
        if done.returncode:
            raise InputError(f"export --to {kind}", done.stderr.strip(), "files")
        user = after.children_user - before.children_user
        runs.append((seconds, user + after.children_system - before.children_system))
    seconds, cpu = (min(column) for column in zip(*runs, strict=True))
    return sorted(out.iterdir()), seconds, cpu


def _dxf(files: list[Path], plan: FloorPlan) -> dict[str, Any]:
    _, lengths, faults = readback.dxf(files)
    walls = [wall_length(wall) for room in plan.rooms for wall in room.walls]
    pairs = zip(sorted(lengths), sorted(walls), strict=True)
    return {
        "faults": faults,
        "dimensions": len(lengths),
        "dimension_error_mm": 1000 * max(abs(read - length) for read, length in pairs),
    }


def _areas(plan: FloorPlan, truth: GroundTruth) -> list[dict[str, Any]]:
    """A line a true room: its area, and that of the room found for it with its ±."""
    report = evaluate(plan, truth, rooms="rooms_partial", align="none")
    rooms = {room.id: room for room in plan.rooms}
    found = {pair.true: rooms[pair.predicted] for pair in report.rooms.pairs}
    lines = []
    for true in truth.plan.rooms_partial or truth.plan.rooms:
        room = found.get(true.id)
        lines.append(
            {
                "room": true.id,
                "label": true.label,
                "true_m2": float(region(true.polygon, true.holes).area),
                "area_m2": None if room is None else float(room_area(room).area),
                "area_sigma_m2": None if room is None else room.area_sigma,
            }
        )
    return lines
