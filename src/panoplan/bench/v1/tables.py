"""The tables of the benchmark v1 in Markdown, made from its files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from panoplan.bench.markdown import number, pair, table
from panoplan.bench.record import METHODS
from panoplan.bench.v1.differences import Difference, difference
from panoplan.bench.v1.predict import POINTS
from panoplan.bench.v1.published import TABLE_I, TABLE_II, TABLE_III
from panoplan.bench.v1.score import column
from panoplan.errors import InputError

_NAMES = {
    "mp3d-fpe": "Houses like MP3D-FPE's",
    "flat": "Flats of a real size",
    "dataset": "MP3D-FPE",
}
_COMPARED = {
    "rooms .5 R": "rooms_50 recall",
    "rooms .5 P": "rooms_50 precision",
    "rooms .7 R": "rooms_70 recall",
    "rooms .7 P": "rooms_70 precision",
    "corners R": "corners recall",
    "corners P": "corners precision",
}

Files = Sequence[dict[str, Any]]
_Shares = dict[str, dict[str, Any]]


def statistics(files: Files) -> str:
    """Table I: how large the buildings are, beside the paper's."""
    rows = [
        [f"{known.dataset} (paper)", str(known.scenes), "–", _spread(known.rooms, 1),
         _spread(known.area_m2, 0), "–"]
        for known in TABLE_I
    ]  # fmt: skip
    for scenes_of, methods in _by_family(files).items():
        scenes = next(iter(next(iter(methods.values())).values()))["scenes"]
        told = {name: [scene[name] for scene in scenes] for name in ("rooms", "area_m2")}
        rows.append(
            [
                _NAMES[scenes_of],
                str(len(scenes)),
                str(sum(told["rooms"])),
                _spread((np.mean(told["rooms"]), np.std(told["rooms"])), 1),
                _spread((np.mean(told["area_m2"]), np.std(told["area_m2"])), 0),
                f"{np.mean([scene['keyframes'] for scene in scenes]):.0f}",
            ]
        )
    if len(rows) == len(TABLE_I):
        return ""
    heads = ["scenes of", "scenes", "rooms in all", "rooms a scene", "area m²", "keyframes a scene"]
    return f"Mean ± standard deviation over scenes.\n\n{table(heads, rows)}"


def methods(files: Files) -> str:
    """Table II: a table a family, each with what the methods differ by."""
    return "\n".join(
        f"{_methods_of(scenes_of, found)}\n{_differences_of(found)}"
        for scenes_of, found in _by_family(files).items()
    )


def causes(files: Files) -> str:
    """What each stage's truth would gain, a table a family."""
    parts = []
    for data in files:
        if data["benchmark"] != "v1-ablation":
            continue
        known = data["figures"]["known"]
        before = known["nothing"]["scenes"]
        rows = []
        for name, measured in known.items():
            aligned = measured["summary"]["aligned"]
            gains = [
                difference(
                    column(measured["scenes"], "aligned", figure),
                    column(before, "aligned", figure),
                )
                for figure in _COMPARED.values()
            ]
            rows.append(
                [
                    name,
                    _found(aligned, "rooms_50"),
                    _found(aligned, "rooms_70"),
                    _found(aligned, "corners"),
                    *(map(_gain, gains) if name != "nothing" else ["–"] * len(gains)),
                ]
            )
        title = (
            f"**{_NAMES[data['figures']['scenes_of']]}**, {len(before)} scenes, "
            f"{data['settings']['preset']}, {100 * data['figures']['share']:.0f} %: recall / "
            "precision where one thing is known, and what that gains."
        )
        heads = ["known", "rooms .5", "rooms .7", "corners", *_COMPARED]
        parts.append(f"{title}\n\n{table(heads, rows)}")
    return "\n".join(parts)


def shapes(files: Files) -> str:
    """Table III: the shortest path's kinds, beside the paper's."""
    parts = []
    for data in files:
        if data["benchmark"] != "v1-ispa":
            continue
        paths = data["figures"]["paths"]
        rows = []
        for (name, measured), known in zip(paths.items(), TABLE_III, strict=True):
            aligned = measured["summary"]["aligned"]
            rows.append(
                [
                    name,
                    _found(aligned, "rooms_50"),
                    _found(aligned, "corners"),
                    number(measured["seconds_a_room"], 2, " s"),
                    f"*{pair(*known.rooms_50)}*",
                    f"*{pair(*known.corners)}*",
                    f"*{number(known.seconds, 1, ' s')}*",
                ]
            )
        count = next(iter(paths.values()))["summary"]["scenes"]
        title = (
            f"**{_NAMES[data['figures']['scenes_of']]}**, {count} scenes, "
            f"{data['settings']['preset']}, {100 * data['figures']['share']:.0f} %: the same rooms "
            "shaped in five ways."
        )
        heads = ["shortest path", "rooms .5", "corners", "CPU a room",
                 "*paper, its own data: rooms .5*", "*corners*", "*a room*"]  # fmt: skip
        parts.append(f"{title}\n\n{table(heads, rows)}")
    return "\n".join(parts)


def scale(files: Files) -> str:
    """Error of the scale by the number of layouts."""
    parts = []
    for data in files:
        if data["benchmark"] != "v1-scale":
            continue
        methods = data["figures"]["methods"]
        points = next(iter(methods.values()))["layouts"]
        rows = [
            [
                name,
                *(
                    f"{number(point['median'], 2)} / {number(point['percentile_90'], 1)}"
                    for point in measured["layouts"]
                ),
            ]
            for name, measured in methods.items()
        ]
        title = (
            f"**{_NAMES[data['figures']['scenes_of']]}**: absolute error of the scale in per cent "
            "after the first layouts of a walk, median / 90th percentile."
        )
        heads = [
            "scale of",
            *(f"{point['layouts']} layouts ({point['walks']} walks)" for point in points),
        ]
        parts.append(f"{title}\n\n{table(heads, rows)}")
    return "\n".join(parts)


def sweeps(files: Files) -> str:
    """What more and less of each error does."""
    parts = []
    for data in files:
        if data["benchmark"] != "v1-sweeps":
            continue
        rows = []
        for point in data["figures"]["points"]:
            means = point["summary"]
            aligned = means["aligned"]
            rows.append(
                [
                    f"{point['swept']} × {point['factor']:g}",
                    number(point["keyframes_a_room"], 0),
                    *(_found(aligned, name) for name in ("rooms_50", "rooms_70", "corners")),
                    _found(aligned, "doors"),
                    number(aligned["mean_iou"], 3),
                    number(means["scale_error_percent_median"], 2, " %"),
                ]
            )
        count = data["figures"]["points"][0]["summary"]["scenes"]
        title = (
            f"**{_NAMES[data['figures']['scenes_of']]}**, {count} scenes, "
            f"{data['settings']['preset']}, {100 * data['figures']['share']:.0f} %: factors on "
            "one kind of error, or on the number of keyframes."
        )
        heads = ["changed", "keyframes a room", "rooms .5", "rooms .7", "corners", "doors",
                 "mean IoU", "scale error, median"]  # fmt: skip
        parts.append(f"{title}\n\n{table(heads, rows)}")
    return "\n".join(parts)


def _methods_of(scenes_of: str, found: dict[str, _Shares]) -> str:
    rows = [
        [f"*{known.name}, paper, its own data*", *(pair(*p) for p in known.rooms),
         pair(*known.corners), *["–"] * 7]
        for known in TABLE_II
    ]  # fmt: skip
    count = 0
    for method, shares in found.items():
        for share, measured in sorted(shares.items(), key=lambda item: float(item[0])):
            summary = measured["summary"]
            aligned, unaligned = summary["aligned"], summary["unaligned"]
            count = summary["scenes"]
            rows.append(
                [
                    _row((method, share)),
                    *(_found(aligned, f"rooms_{iou}") for iou in (30, 50, 70)),
                    _found(aligned, "corners"),
                    *(_found(unaligned, f"rooms_{iou}") for iou in (50, 70)),
                    _found(unaligned, "corners"),
                    "–" if not aligned["doors recall"] else _found(aligned, "doors"),
                    number(summary["scale_error_percent_median"], 2, " %"),
                    str(summary["failures"]),
                    number(summary["cpu_seconds"] / count, 1, " s"),
                ]
            )
    heads = ["method, keyframes for the scale", "rooms .3", "rooms .5", "rooms .7", "corners",
             "unaligned: rooms .5", "rooms .7", "corners", "doors", "scale error, median",
             "failed", "CPU a scene"]  # fmt: skip
    title = (
        f"**{_NAMES[scenes_of]}**, {count} scenes: recall / precision, mean over scenes, scale "
        "aligned by poses as in the paper."
    )
    return f"{title}\n\n{table(heads, rows)}"


def _differences_of(found: dict[str, _Shares]) -> str:
    pairs = [
        (("default", "0.2"), (method, "1" if method == POINTS else "0.2"))
        for method in found
        if method != "default"
    ]
    pairs += [((method, "1"), (method, "0.2")) for method in ("paper", "default")]
    rows = []
    for this, that in pairs:
        one, other = (found.get(method, {}).get(share) for method, share in (this, that))
        if one is None or other is None:
            continue
        _same_scenes(one, other)
        gains = [
            difference(
                column(one["scenes"], "aligned", name), column(other["scenes"], "aligned", name)
            )
            for name in _COMPARED.values()
        ]
        rows.append([f"{_row(this)} less {_row(that)}", *map(_gain, gains)])
    if not rows:
        return ""
    title = (
        "Scene by scene on the same walks: mean difference in points with its 95 % interval "
        "(bootstrap over scenes)."
    )
    return f"{title}\n\n{table(['methods', *_COMPARED], rows)}"


def _row(of: tuple[str, str]) -> str:
    method, share = of
    return method if method == POINTS else f"{method} {100 * float(share):.0f} %"


def _same_scenes(one: dict[str, Any], other: dict[str, Any]) -> None:
    names = [[scene["scene"] for scene in measured["scenes"]] for measured in (one, other)]
    if names[0] != names[1]:
        found = f"{len(names[0])} and {len(names[1])} scenes that are not the same"
        raise InputError("files of bench v1", found, "one run's, of the same seeds")


def _gain(made: Difference | None) -> str:
    if made is None:
        return "–"
    told = f"{100 * made.mean:+.1f}"
    if made.low is None or made.high is None:
        return told
    return f"{told} [{100 * made.low:+.1f}, {100 * made.high:+.1f}]"


def _by_family(files: Files) -> dict[str, dict[str, _Shares]]:
    """Shares of each method of each family, both in the order of their tables."""
    found: dict[str, dict[str, _Shares]] = {}
    for scenes_of in _NAMES:
        own = {
            data["settings"]["preset"]: data["figures"]["shares"]
            for data in files
            if data["benchmark"] == "v1" and data["figures"]["scenes_of"] == scenes_of
        }
        if own:
            found[scenes_of] = {name: own[name] for name in METHODS if name in own}
    return found


def _found(means: dict[str, float | None], name: str) -> str:
    return pair(means[f"{name} recall"], means[f"{name} precision"])


def _spread(values: tuple[float, float], digits: int) -> str:
    mean, deviation = values
    return f"{mean:,.{digits}f} ± {deviation:,.{digits}f}"
