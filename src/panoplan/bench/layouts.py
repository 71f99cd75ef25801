"""A layout network on panoramas with true layouts."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.image import Pixels, read_panorama
from panoplan.formats.layout_npz import read_layout_npz
from panoplan.formats.sequence import DESCRIPTION, TRUE_LAYOUTS, read_sequence
from panoplan.layouts.dense import layout, likely_spans
from panoplan.layouts.onnx import OnnxLayouts
from panoplan.pipeline import Progress
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.layout import Layout, Spans

ROWS = 512
UNKNOWN_ROWS = 46.0
"""What a column counts, in rows, of which the network says nothing: a constant guess's error."""
BINS_CH = (0.0, 0.7, 1.0, 1.4, 2.0, 2.7, 4.0, np.inf)
"""True distances, in camera heights, between which the uncertainty is judged."""
_FARTHEST_CH = 1e3
SMALL_CH2 = 3.0
"""Floor of a small room, about 7 m²."""
_SPANS = ("doors", "openings", "windows")
_CIRCLE = 1024

_View = tuple[str, Callable[[], Pixels], Layout]
"""Name, picture and truth of a panorama."""


def measure(folder: Path, network: OnnxLayouts, progress: Progress) -> dict[str, Any]:
    """Judges a network on a sequence folder with true layouts.

    Args:
        folder: with sequence.json, its images, and layouts_gt/ID.npz; photographs whose entry
            says `"inside": false` are left out. Or of a training, whose held-out renders are taken.
        network: what is judged.
        progress: called with panoramas done and in all.

    Returns:
        Over the panoramas, median and mean of the mean |Δ| of the floor boundary in rows of 512
        and of the 2-D IoU of the floor that it encloses, for all, for those without and with
        openings, for those in small rooms; recall and precision of the columns of doors, openings
        and windows; shares of columns within one and two of the stated σ by true distance; the mean
        log-likelihood under the stated σ and under the best constant one; CPU seconds; a line
        a panorama.

    Raises:
        InputError: the folder is not complete, or an image or layout cannot be read.
    """
    is_scene = (folder / DESCRIPTION).exists()
    views = _sequence(folder) if is_scene else _renders(folder)
    lines, columns, seconds = [], [], []
    for done, (name, image, truth) in enumerate(views, start=1):
        pixels = image()
        started = time.process_time()
        told = layout(network(pixels))
        seconds.append(time.process_time() - started)
        line, errors = _judged(told, truth)
        lines.append({"id": name, **line})
        columns.append(errors)
        progress(done, len(views))
    if not lines:
        raise InputError(folder, "no panorama", "at least one with a true layout")
    openings, small = (
        np.array([line[name] for line in lines], dtype=bool) for name in ("openings", "small")
    )
    return {
        "scene": folder.name if is_scene else "held-out renders",
        "model": network.spec.name,
        "all": _summary(lines, np.ones(len(lines), dtype=bool)),
        "without_openings": _summary(lines, ~openings),
        "with_openings": _summary(lines, openings),
        "in_small_rooms": _summary(lines, small),
        "spans": {name: _found([line["spans"][name] for line in lines]) for name in _SPANS},
        "sigma": _calibration(np.concatenate(columns)),
        "cpu_seconds": float(np.median(seconds)),
        "panoramas": lines,
    }


def _sequence(folder: Path) -> list[_View]:
    entries = [e for e in read_sequence(folder).keyframes if e.id not in _outside(folder)]
    return [
        (
            entry.id,
            partial(read_panorama, folder / entry.image),
            read_layout_npz(folder / TRUE_LAYOUTS / f"{entry.id}.npz"),
        )
        for entry in entries
    ]


def _renders(folder: Path) -> list[_View]:
    """The held-out panoramas of a training."""
    from panoplan.layouts.network.samples import TARGETS
    from panoplan.layouts.network.shards import shards

    views: list[_View] = []
    for number in shards(folder, held_out=True):
        images, targets = (
            np.load(folder / f"{name}-{number:07d}.npy", mmap_mode="r", allow_pickle=False)
            for name in ("images", "targets")
        )
        for k, rows in enumerate(targets):
            truth = dict(zip(TARGETS, rows, strict=True))
            spans = Spans(*(likely_spans(truth[name]) for name in ("door", "opening", "window")))
            told = Layout(truth["floor"], truth["ceiling"], spans=spans)
            views.append((f"{number}-{k}", partial(np.asarray, images[k]), told))
    return views


def _outside(folder: Path) -> set[str]:
    """Ids of the cameras that stand in no room."""
    data = json.loads((folder / DESCRIPTION).read_text(encoding="utf-8"))
    return {item["id"] for item in data["keyframes"] if item.get("inside") is False}


def _judged(told: Layout, truth: Layout) -> tuple[dict[str, Any], FloatArray]:
    """One panorama: its figures, and (K, 3) error, stated σ and true range of its columns."""
    width = truth.width
    at = (np.arange(width) + 0.5) * (told.width / width) - 0.5
    place = np.arange(told.width)
    floor = np.interp(at, place, told.floor_boundary, period=told.width)
    known = np.isfinite(truth.floor_boundary)
    error = np.abs(floor - truth.floor_boundary)[known]
    missing = ~np.isfinite(error)
    rows = np.where(missing, UNKNOWN_ROWS, error * ROWS / np.pi)
    near, far = _ranges(floor[known]), _ranges(truth.floor_boundary[known])
    smaller, larger = np.minimum(near, far), np.maximum(near, far)
    line = {
        "floor_px": float(rows.mean()),
        "iou_2d": float((smaller**2).sum() / (larger**2).sum()),
        "openings": bool(truth.spans is not None and len(truth.spans.openings)),
        "small": bool(np.pi * (far**2).mean() < SMALL_CH2),
        "spans": {name: _overlap(told, truth, name) for name in _SPANS},
    }
    if told.floor_sigma is None:
        return line, np.empty((0, 3))
    sigma = np.interp(at, place, told.floor_sigma, period=told.width)[known]
    return line, np.stack([error, sigma, far], axis=1)[~missing]


def _overlap(told: Layout, truth: Layout, name: str) -> list[float] | None:
    """Shares of the circle in spans that are told and true, told, and true."""
    if told.spans is None or truth.spans is None:
        return None
    one = _covered(getattr(told.spans, name), told.width)
    other = _covered(getattr(truth.spans, name), truth.width)
    return [float(share.mean()) for share in (one & other, one, other)]


def _covered(spans: FloatArray, width: int) -> BoolArray:
    """(_CIRCLE,) the directions in spans of an image of that width."""
    at = (np.arange(_CIRCLE) + 0.5) * width / _CIRCLE
    first, past = spans[:, :1], spans[:, 1:] + 1.0
    return np.asarray(((at - first) % width < (past - first) % width).any(axis=0))


def _found(overlaps: list[list[float] | None]) -> dict[str, float | None]:
    known = [overlap for overlap in overlaps if overlap is not None]
    both, told, true = np.sum(known, axis=0) if known else np.zeros(3)
    return {
        "recall": float(both / true) if true else None,
        "precision": float(both / told) if told else None,
    }


def _ranges(elevation: FloatArray) -> FloatArray:
    """Distances in camera heights; a boundary at the horizon is far, an unknown one nowhere."""
    with np.errstate(divide="ignore"):
        distance = 1 / np.tan(-np.minimum(elevation, 0))
    return np.clip(np.nan_to_num(distance, nan=0.0, posinf=_FARTHEST_CH), 0, _FARTHEST_CH)


def _summary(lines: list[dict[str, Any]], chosen: BoolArray) -> dict[str, Any]:
    out: dict[str, Any] = {"panoramas": int(chosen.sum())}
    for name in ("floor_px", "iou_2d"):
        values = np.array([line[name] for line in lines])[chosen]
        if len(values):
            out[name] = {"median": float(np.median(values)), "mean": float(values.mean())}
    return out


def _calibration(columns: FloatArray) -> dict[str, Any] | None:
    """How the stated σ holds; Laplace's distribution, whose scale is σ/√2."""
    if len(columns) == 0:
        return None
    error, sigma, distance = columns.T
    bins = []
    for low, high in pairwise(BINS_CH):
        inside = (distance >= low) & (distance < high)
        if inside.any():
            e, s = error[inside], sigma[inside]
            bins.append(
                {
                    "from_ch": low,
                    "columns": int(inside.sum()),
                    "within_1": float((e < s).mean()),
                    "within_2": float((e < 2 * s).mean()),
                }
            )
    scale, constant = sigma / np.sqrt(2), error.mean()
    return {
        "within_1": float((error < sigma).mean()),
        "within_2": float((error < 2 * sigma).mean()),
        "log_likelihood": float(np.mean(-error / scale - np.log(2 * scale))),
        "log_likelihood_constant": float(-1 - np.log(2 * constant)),
        "bins": bins,
    }
