"""Measured tables for people, made from benchmark files."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from panoplan.bench import difficulty_tables, export_tables, pose_tables
from panoplan.bench.markdown import number, pair, table
from panoplan.bench.record import METHODS, of_benchmark
from panoplan.bench.v1 import tables as v1
from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes, write_text

_MARKS = re.compile(
    r"(?P<begin><!-- measured: (?P<names>[a-z, ]+) -->\n).*?(?P<end><!-- end of measured -->)",
    re.DOTALL,
)
_LIMIT = 64 * 2**20


def update(page: Path, folder: Path) -> bool:
    """Writes tables into a page, between its marks.

    Args:
        page: Markdown with `<!-- measured: NAMES -->` and `<!-- end of measured -->`; the names,
            with commas, are of the tables that come between: buildings,
            methods, shapes, scale, sweeps, causes, difficulty, errors, flats, metric,
            home, misplaced, layouts, realism, exports, areas, model, runtime,
            walks, plans, tours, files.
        folder: of the benchmark files.

    Returns:
        Whether the page changed.

    Raises:
        InputError: the page is not readable or has no marks, or a file is no benchmark.
    """
    text = _text(page)
    new = updated(text, folder, page)
    if new != text:
        write_text(page, new)
    return new != text


def _text(page: Path) -> str:
    try:
        return read_bytes(page, _LIMIT).decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(page, "no text", "Markdown in UTF-8") from None


def updated(text: str, folder: Path, page: Path) -> str:
    """The page's text with tables made anew.

    Args:
        text: of the page.
        folder: of the benchmark files.
        page: where the text is from, for the message.

    Raises:
        InputError: as `update`.
    """
    if not _MARKS.search(text):
        wanted = "<!-- measured: flats, home, metric, runtime --> and <!-- end of measured -->"
        raise InputError(page, "no place for tables", wanted)
    files = [_read(path) for path in sorted(folder.glob("*.json"))]
    made = {
        "buildings": v1.statistics,
        "methods": v1.methods,
        "shapes": v1.shapes,
        "scale": v1.scale,
        "sweeps": v1.sweeps,
        "causes": v1.causes,
        "difficulty": difficulty_tables.figures,
        "errors": difficulty_tables.errors,
        "flats": _flats,
        "home": _home,
        "metric": _metric,
        "misplaced": _misplaced,
        "layouts": _layouts,
        "realism": _realism,
        "exports": export_tables.formats,
        "areas": export_tables.areas,
        "model": export_tables.model,
        "runtime": _runtime,
        "walks": pose_tables.walks,
        "plans": pose_tables.plans,
        "tours": pose_tables.tours,
        "files": _files,
    }

    def filled(marks: re.Match[str]) -> str:
        names = [name.strip() for name in marks["names"].split(",")]
        unknown = sorted(set(names) - set(made))
        if unknown:
            raise InputError(page, f"the table {unknown[0]}", " or ".join(made))
        parts = [made[name](files) for name in names]
        told = "\n".join(part for part in parts if part)
        return f"{marks['begin']}{told}{marks['end']}"

    return _MARKS.sub(filled, text)


def _read(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(read_bytes(path, _LIMIT))
        METHODS.index(data["settings"]["preset"])
        _ = data["benchmark"], data["figures"], data["commit"]
    except (ValueError, KeyError, TypeError):
        raise InputError(path, "no benchmark file", "what panoplan bench writes") from None
    return {**data, "file": path.name}


def _files(files: list[dict[str, Any]]) -> str:
    """Where each file is from."""
    rows = []
    for data in files:
        machine = data.get("machine")
        told = f"{machine['cores']} cores, {machine['processor']}" if machine else "–"
        preset = data["settings"]["preset"]
        rows.append([f"`{data['file']}`", preset, data["commit"] or "–", told])
    return table(["file", "settings", "commit", "machine"], rows) if rows else ""


def _flats(files: list[dict[str, Any]]) -> str:
    rows = []
    for data in of_benchmark(files, "accuracy"):
        for grade in ("mild", "hard"):
            s = data["figures"][grade]["summary"]
            scale = "given" if data["figures"]["metric"] else "recovered"
            error = "" if scale == "given" else number(s["scale_error_percent_median"], 2, " %")
            drift = f"{number(s['odometry_ate_cm'], 1)} → {number(s['ate_cm'], 1)}"
            rows.append(
                [
                    f"{data['settings']['preset']}, {grade}",
                    f"{scale} {error}".strip(),
                    f"{s['rooms'] - s['lost']} of {s['rooms']}, {s['invented']} invented",
                    number(s["mean_iou"], 3),
                    number(s["corner_true_to_predicted_cm"], 1, " cm"),
                    number(s["wall_cm"], 1, " cm"),
                    f"{number(s['walls_within_1_sigma'], 2)} / "
                    f"{number(s['walls_within_2_sigma'], 2)}",
                    _recall_precision(s["doors"]),
                    drift,
                ]
            )
    if not rows:
        return ""
    count = of_benchmark(files, "accuracy")[0]["figures"]["mild"]["summary"]["flats"]
    heads = ["preset, noise", "scale, median error", "rooms found", "mean IoU", "corners", "walls",
             "within 1 / 2 σ", "doors R / P", "camera RMSE cm"]  # fmt: skip
    title = (
        f"{count} simulated flats a grade, drifting odometry, unaligned. σ is the ± that the plan "
        "states for a wall."
    )
    return f"{title}\n\n{table(heads, rows)}"


def _home(files: list[dict[str, Any]]) -> str:
    rows = []
    for data in of_benchmark(files, "home"):
        figures, preset = data["figures"], data["settings"]["preset"]
        if figures.get("layouts", "files") != "files":
            preset += f", {figures['layouts']}"
        for name in ("metric", "recovered"):
            f = figures[name]
            rooms, corners = f["rooms"], f["corners"]
            half, seven = rooms["scores"][1:]
            scale = "given"
            if name == "recovered":
                scale = f"recovered {number(f['scale_error_percent'], 2, ' %')}"
            rows.append(
                [
                    preset,
                    scale,
                    f"{half['hits']} / {half['predicted']}",
                    f"{seven['hits']} / {seven['predicted']}",
                    number(rooms["mean_iou"], 3),
                    number(rooms["floor_iou"], 3),
                    number(corners["true_to_predicted"]["median_cm"], 1, " cm"),
                    number(rooms["overlap_m2"], 2, " m²"),
                    _recall_precision(f["doors"]) if f["doors"]["predicted"] else "–",
                    number(f["seconds"], 2, " s"),
                ]
            )
    if not rows:
        return ""
    true = of_benchmark(files, "home")[0]["figures"]["metric"]["rooms"]["true"]
    heads = ["preset", "scale, error", "rooms at IoU .5 / told", "at .7 / told", "mean IoU",
             "floor IoU", "corners", "overlap", "doors R / P", "whole walk"]  # fmt: skip
    title = (
        f"A real home (ZInD, {true} rooms split at openings): 32 photos, true poses, unaligned; "
        "a real network's layouts where no network is named. Its own time is not in the walk's."
    )
    return f"{title}\n\n{table(heads, rows)}"


def _metric(files: list[dict[str, Any]]) -> str:
    rows = []
    for data in of_benchmark(files, "metric"):
        for grade in ("mild", "hard"):
            for source, s in data["figures"][grade]["summary"].items():
                if not s["flats"]:
                    continue
                rows.append(
                    [
                        f"{source}, {grade}",
                        str(s["flats"]),
                        number(s["size_error_percent_median"], 2, " %"),
                        number(s["size_sigma_percent_median"], 2, " %"),
                        f"{number(s['size_within_1_sigma'], 2)} / "
                        f"{number(s['size_within_2_sigma'], 2)}",
                        number(s["length_error_percent_median"], 2, " %"),
                        number(s["length_error_percent_median_from_1_m"], 2, " %"),
                        pair(s.get("lengths_within_1_sigma"), s.get("lengths_within_2_sigma")),
                    ]
                )
    if not rows:
        return ""
    heads = ["metres by, noise", "flats", "size, median error", "stated ±", "within 1 / 2 σ",
             "lengths of walls, median error", "of walls from 1 m",
             "lengths within 1 / 2 σ"]  # fmt: skip
    title = (
        "Where the metres come from, on simulated flats: the size of the plan as a whole against "
        "the ± that it states, and the lengths of its walls. The camera's height is told with an "
        "error of 1 cm; the length is that of the longest wall, taped within 5 mm; the height of a "
        "door is told within 1 cm and its edge marked within 1.5 of 1,024 rows."
    )
    return f"{title}\n\n{table(heads, rows)}"


def _misplaced(files: list[dict[str, Any]]) -> str:
    rows = [
        [
            f["scene"],
            str(f["trials"]),
            str(f["found"]),
            str(f["more_than_one_innocent"]),
            str(f["moved_back"]),
            str(f["named_where_none_is_shifted"]),
        ]
        for f in (data["figures"] for data in of_benchmark(files, "misplaced"))
    ]
    if not rows:
        return ""
    heads = ["tour", "trials", "all shifted cameras named", "more than one innocent named",
             "moved back", "cameras named with none shifted"]  # fmt: skip
    return f"One room's cameras of a photo tour shifted by 2.6 m.\n\n{table(heads, rows)}"


def _layouts(files: list[dict[str, Any]]) -> str:
    rows, doubts, passages = [], [], []
    for f in (data["figures"] for data in of_benchmark(files, "layouts")):
        found = (f["spans"][name] for name in ("doors", "openings", "windows"))
        passages.append(
            [
                f["scene"],
                *(f"{number(s['recall'], 2)} / {number(s['precision'], 2)}" for s in found),
            ]
        )
        for name in ("all", "without_openings", "with_openings", "in_small_rooms"):
            part = f[name]
            if part["panoramas"]:
                rows.append(
                    [
                        f"{f['scene']}, {name.replace('_', ' ')}",
                        str(part["panoramas"]),
                        *(number(part["floor_px"][k], 1) for k in ("median", "mean")),
                        *(number(part["iou_2d"][k], 3) for k in ("median", "mean")),
                    ]
                )
        for part in f["sigma"]["bins"] if f["sigma"] else ():
            shares = (number(part[f"within_{k}"], 2) for k in (1, 2))
            doubts.append([f["scene"], number(part["from_ch"], 1), str(part["columns"]), *shares])
    if not rows:
        return ""
    heads = ["panoramas", "count", "floor px, median", "mean", "2-D IoU, median", "mean"]
    bins = ["scene", "wall from, camera heights", "columns", "within 1 σ", "within 2 σ"]
    ways = ["columns, recall / precision", "doors", "openings", "windows"]
    return (
        "Mean |Δ| a panorama of the floor boundary in rows of 512, and IoU of the floors that it "
        "encloses. Small rooms have less than 3 square camera heights, about 7 m².\n\n"
        f"{table(heads, rows)}\nWhat is seen in the walls.\n\n{table(ways, passages)}\n"
        f"How the stated σ holds.\n\n{table(bins, doubts)}"
    )


def _realism(files: list[dict[str, Any]]) -> str:
    told = []
    for f in (data["figures"] for data in of_benchmark(files, "realism")):
        rows = [
            [
                run["name"],
                *(number(run["floor_px"][k], 1) for k in ("median", "mean")),
                *(number(run[k], 1) for k in ("with_openings", "in_small_rooms")),
                _interval(run["worse_by"]),
            ]
            for run in f["runs"]
        ]
        heads = ["learnt from renders with", "floor px, median", "mean", "mean with openings",
                 "mean in small rooms", "worse by (90 %)"]  # fmt: skip
        told.append(
            f"Heads trained for {f['steps']} steps on {f['panoramas_learnt']} panoramas each, "
            f"judged on {f['panoramas_judged']} of other homes in `still` quality; the second "
            f"line tells how far chance goes.\n\n{table(heads, rows)}"
        )
    return "\n".join(told)


def _interval(change: dict[str, float] | None) -> str:
    if change is None:
        return "–"
    return f"{change['mean']:+.1f} ({change['low']:+.1f} to {change['high']:+.1f})"


def _runtime(files: list[dict[str, Any]]) -> str:
    rows = []
    for data in of_benchmark(files, "runtime"):
        f = data["figures"]
        rows.append(
            [
                data["settings"]["preset"],
                number(f["update_ms_median"], 1, " ms"),
                number(f["update_late_over_early"], 2),
                number(f["leaving_ms_median"], 0, " ms"),
                number(f["plan_ms"], 0, " ms"),
                number(f["finish_s"], 1, " s"),
                number(f["peak_memory_mb"], 0, " MB"),
                f"{data['machine']['cores']} cores, {data['machine']['processor']}",
            ]
        )
    if not rows:
        return ""
    heads = ["preset", "update()", "late / early", "leaving a room", "plan()", "finish()",
             "peak memory", "machine"]  # fmt: skip
    title = (
        "A walk of 2,000 keyframes through 40 rooms. update(): the median keyframe that completes "
        "no room. Late / early: the time that 95 of the last 100 keyframes stay below, over that "
        "of 100 early ones, from the 100th on or since the scale is known."
    )
    return f"{title}\n\n{table(heads, rows)}"


def _recall_precision(found: dict[str, float | None]) -> str:
    return pair(found["recall"], found["precision"])
