"""Tables of camera poses found in images: walks and photo tours."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from panoplan.bench.markdown import number, table
from panoplan.bench.record import of_benchmark


def walks(files: list[dict[str, Any]]) -> str:
    """How well rendered walks were followed."""
    parts = []
    for data in of_benchmark(files, "odometry"):
        rows = []
        for f in data["figures"]:
            final, given = f["final"] or {}, f["as_given"] or {}
            rows.append(
                [
                    f["scene"],
                    str(f["keyframes"]),
                    f"{sum(f['maps'])} in {len(f['maps'])}",
                    number(final.get("length_m"), 0, " m"),
                    number(final.get("ate_percent_of_length"), 3, " %"),
                    number(given.get("ate_percent_of_length"), 3, " %"),
                    number(given.get("worst_cm"), 1, " cm"),
                    number(f["keyframes_a_cpu_second"], 1),
                    number(f["cpu_s_last"]["95 %"] / f["cpu_s_first"]["95 %"], 2),
                    number(f.get("plan_lag_s", {}).get("95 %"), 1, " s"),
                ]
            )
        heads = [
            "walk", "keyframes", "with poses, maps", "way", "error", "error as given",
            "worst as given", "keyframes a CPU second", "last 50 / first 50", "plan's lag",
        ]  # fmt: skip
        parts.append(
            "Rendered walks; way and position errors of the largest map, after a similarity (root "
            "mean square, percent of the way), at the end and as each pose was given; time a "
            "keyframe at 95 %, of the last 50 and of the first; how long at 95 % a "
            "keyframe takes from its image to the live plan, "
            f"by the clock.\n\n{table(heads, rows)}"
        )
    return "\n".join(parts)


def plans(files: list[dict[str, Any]]) -> str:
    """What plans come of rendered walks whose poses were found in the images."""
    rows, sums = [], {key: np.zeros(4, dtype=int) for key in _PLANS}
    for data in of_benchmark(files, "odometry"):
        for f in data["figures"]:
            if "plans" not in f:
                continue
            told = []
            for key in _PLANS:
                figures = f["plans"][key]["rooms"]
                half, seven = (_score(figures, iou) for iou in (0.5, 0.7))
                counts = [half["hits"], seven["hits"], half["predicted"], half["true"]]
                sums[key] += counts
                told += [_found(counts), number(figures["mean_iou"], 3)]
            rows.append([f["scene"], *told])
    if not rows:
        return ""
    rows.append(["all", *(cell for counts in sums.values() for cell in (_found(counts), "–"))])
    heads = ["walk", *(head for name in _PLANS.values() for head in (name, "mean IoU"))]
    title = (
        "Plans of rendered walks: rooms found at IoU .5 / at .7 of the true ones, and rooms told; "
        "scale recovered, metres by the camera height, rigidly aligned."
    )
    return f"{title}\n\n{table(heads, rows)}"


_PLANS = {
    "true_poses_true_layouts": "true poses and layouts",
    "true_layouts": "poses from the images, true layouts",
    "images_alone": "images alone",
}


def _found(counts: Iterable[int]) -> str:
    half, seven, told, true = counts
    return f"{half} / {seven} of {true}, {told} told"


def _score(rooms: dict[str, Any], iou: float) -> dict[str, Any]:
    (score,) = (score for score in rooms["scores"] if score["iou"] == iou)
    return dict(score)


def tours(files: list[dict[str, Any]]) -> str:
    """How many photos of tours were joined, and how well."""
    parts = []
    for data in of_benchmark(files, "tour"):
        rows, whole = [], data["figures"]
        for f in whole:
            rows.append(_tour(f["scene"], f))
            rows += [_tour(f"{f['scene']}, draw {k}", d) for k, d in enumerate(f["draws"])]
        if len(whole) > 1:
            rows.append(["all", *_together(whole)])
        heads = [
            "tour", "photos", "in the largest group", "misplaced in it", "position, median",
            "90 %", "heading", "rooms of its plan", "CPU",
        ]  # fmt: skip
        asked = whole[0].get("layouts", "files")
        parts.append(
            f"Photo tours with layouts from {asked}; misplaced is more than 0.5 m or 6° off with "
            "the scale fixed, errors are after a similarity; rooms found at IoU 0.5 of all true "
            f"ones, the plan rigidly aligned.\n\n{table(heads, rows)}"
        )
    return "\n".join(parts)


def _tour(name: str, figures: dict[str, Any]) -> list[str]:
    largest = figures["groups"][0]
    median_m, p90_m = largest["median_m"], largest["p90_m"]
    return [
        name,
        str(figures["photos"]),
        str(largest["photos"]),
        str(len(largest["misplaced"])),
        number(None if median_m is None else 100 * median_m, 1, " cm"),
        number(None if p90_m is None else 100 * p90_m, 1, " cm"),
        number(largest["heading_deg"], 2, "°"),
        "–" if figures.get("plan") is None else "{} of {}".format(*_rooms(figures["plan"])),
        number(figures["cpu_seconds"], 0, " s"),
    ]


def _rooms(plan: dict[str, Any]) -> tuple[int, int]:
    """Rooms found at IoU 0.5, and true ones."""
    half = _score(plan["rooms"], 0.5)
    return half["hits"], half["true"]


def _together(tours: Sequence[dict[str, Any]]) -> list[str]:
    photos = sum(f["photos"] for f in tours)
    largest = [f["groups"][0] for f in tours]
    joined = sum(group["photos"] for group in largest)
    wrong = sum(len(group["misplaced"]) for group in largest)
    found = [_rooms(f["plan"]) for f in tours if f.get("plan") is not None]
    planless = len(tours) - len(found)
    rooms = f"{sum(hits for hits, _ in found)} of {sum(true for _, true in found)}"
    seconds = sum(f["cpu_seconds"] for f in tours)
    return [
        str(photos),
        f"{joined} ({100 * joined / photos:.0f} %)",
        f"{wrong} ({100 * wrong / max(joined, 1):.1f} %)",
        "–", "–", "–",
        (f"{rooms}, {planless} without a plan" if planless else rooms) if found else "–",
        number(seconds, 0, " s"),
    ]  # fmt: skip
