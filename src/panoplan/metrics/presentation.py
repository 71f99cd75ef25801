"""A report as plain data and as a table."""

from __future__ import annotations

from typing import Any

import numpy as np

from panoplan.metrics.corners import CornerDistances
from panoplan.metrics.report import Report
from panoplan.metrics.rooms import Score
from panoplan.metrics.walls import WallFigures


def as_dict(report: Report) -> dict[str, Any]:
    """The report as plain data for JSON: dicts, lists, numbers, strings and None."""
    room, corner, moved = report.rooms, report.corners, report.alignment.true_from_plan
    return {
        "truth": report.truth,
        "alignment": {
            "freedom": report.alignment.freedom,
            "metres_per_plan_unit": moved.scale,
            "rotation_deg": float(np.rad2deg(moved.rotation_rad)),
            "translation_m": [float(value) for value in moved.translation_m],
            "cameras": report.alignment.cameras,
            "residual_rmse_m": report.alignment.residual_rmse_m,
        },
        "rooms": {
            **_plain(room),
            "scores": [_score(score) for score in room.scores],
            "scores_visited": (
                None
                if room.scores_visited is None
                else [_score(score) for score in room.scores_visited]
            ),
            "pairs": [_plain(pair) for pair in room.pairs],
        },
        "corners": {
            "metres_per_px": corner.metres_per_px,
            "paper": _score(corner.paper),
            "paper_visited": _score(corner.paper_visited),
            "released": _score(corner.released),
            "released_visited": _score(corner.released_visited),
            "within": [{"cm": cm, **(_score(score) or {})} for cm, score in corner.within],
            "true_to_predicted": _distances(corner.true_to_predicted),
            "predicted_to_true": _distances(corner.predicted_to_true),
        },
        "walls": _plain(report.walls),
        "doors": _score(report.doors),
        "openings": _score(report.openings),
        "windows": _score(report.windows),
        "storeys": _score(report.storeys),
        "trajectory": None if report.trajectory is None else _plain(report.trajectory),
        "scale_error_percent": report.scale_error_percent,
    }


def _plain(value: object) -> dict[str, Any]:
    return dict(vars(value))


def _score(score: Score | None) -> dict[str, Any] | None:
    if score is None:
        return None
    return {**_plain(score), "recall": score.recall, "precision": score.precision}


def _distances(distances: CornerDistances) -> dict[str, Any]:
    within = [{"cm": limit, "share": share} for limit, share in distances.within]
    return {"count": distances.count, "median_cm": distances.median_cm, "within": within}


def as_table(report: Report) -> str:
    """The report as a text table, one figure a line, without a line break at its end."""
    rows = [*_head_rows(report), *_score_rows(report), *_shape_rows(report)]
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def _head_rows(report: Report) -> list[tuple[str, str]]:
    room, moved = report.rooms, report.alignment.true_from_plan
    visited = "" if room.visited is None else f" ({room.visited} visited)"
    none = f", {room.without_polygon} without shape" if room.without_polygon else ""
    turned = f", turned {np.rad2deg(moved.rotation_rad):+.2f}°"
    shift = f", shifted {np.hypot(*moved.translation_m):.3f} m"
    free = report.alignment.freedom
    motion = turned + shift if free in ("rigid", "similarity") else ""
    rows = [
        ("true rooms", f"{room.true}{visited}, {report.truth}"),
        ("predicted rooms", f"{room.predicted}{none}, {room.matching_none} matching none"),
        ("alignment", f"{free}: {moved.scale:.4f} m a plan unit{motion}"),
    ]
    if report.storeys is not None:
        rows.insert(2, ("storeys", _recall_precision(report.storeys)))
    if report.trajectory is not None:
        ate = report.trajectory
        share = _number(ate.rmse_percent_of_length, ".2f", " % of the path")
        found = f"RMSE {ate.rmse_cm:.1f} cm ({share}), median {ate.median_cm:.1f} cm"
        rows.append(("camera positions", f"{found}, {ate.cameras} cameras"))
    if report.scale_error_percent is not None:
        rows.append(("scale error", f"{report.scale_error_percent:+.2f} %"))
    return rows


def _score_rows(report: Report) -> list[tuple[str, str]]:
    room, corner = report.rooms, report.corners
    rows = [(f"rooms, IoU {score.iou}", _recall_precision(score)) for score in room.scores]
    for score in room.scores_visited or ():
        rows.append((f"visited rooms, IoU {score.iou}", _recall_precision(score)))
    rows.append(("corners, paper", _recall_precision(corner.paper)))
    if corner.paper_visited is not None:
        rows.append(("corners, paper, visited", _recall_precision(corner.paper_visited)))
    rows.append(("corners, released", _recall_precision(corner.released)))
    if corner.released_visited is not None:
        rows.append(("corners, released, visited", _recall_precision(corner.released_visited)))
    rows += [(f"corners within {cm:.0f} cm", _recall_precision(s)) for cm, s in corner.within]
    return rows


def _shape_rows(report: Report) -> list[tuple[str, str]]:
    room, corner = report.rooms, report.corners
    there, back = corner.true_to_predicted.median_cm, corner.predicted_to_true.median_cm
    one, other = room.outline_true_to_predicted_cm, room.outline_predicted_to_true_cm
    median, mean = room.area_error_median_percent, room.area_error_mean_abs_percent
    outline = f"{_cm(room.outline_cm)} (from true {_cm(one)}, from predicted {_cm(other)})"
    return [
        ("floor IoU", f"{room.floor_iou:.3f}"),
        ("mean IoU of matched rooms", _number(room.mean_iou, ".3f")),
        ("corner distance, median", f"from true {_cm(there)}, from predicted {_cm(back)}"),
        ("outline distance, mean", outline),
        (
            "area error",
            f"median {_number(median, '+.1f', ' %')}, mean absolute {_number(mean, '.1f', ' %')}",
        ),
        ("overlap of predicted rooms", f"{room.overlap_m2:.3f} m²"),
        ("wall distance, median", _walls(report.walls)),
        ("doors", _recall_precision(report.doors)),
        ("openings", _recall_precision(report.openings)),
        ("windows", _recall_precision(report.windows)),
    ]


def _walls(walls: WallFigures) -> str:
    told = f"{_cm(walls.median_cm)} ({walls.compared} of {walls.predicted})"
    if walls.within_1_sigma is None:
        return told
    shares = f"{walls.within_1_sigma:.2f} within 1, {_number(walls.within_2_sigma, '.2f')} within 2"
    return f"{told}; {shares} of the stated ±"


def _recall_precision(score: Score) -> str:
    recall = _number(score.recall, ".3f")
    return (
        f"recall {recall}  precision {score.precision:.3f}"
        f"  ({score.hits} of {score.true} true, {score.predicted} predicted)"
    )


def _cm(value: float | None) -> str:
    return _number(value, ".1f", " cm")


def _number(value: float | None, form: str, unit: str = "") -> str:
    return "–" if value is None else f"{value:{form}}{unit}"
