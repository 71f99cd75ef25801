"""A layout network on panoramas with true layouts."""

from __future__ import annotations

import json
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.image import read_panorama
from panoplan.formats.layout_npz import read_layout_npz
from panoplan.formats.sequence import DESCRIPTION, read_sequence
from panoplan.layouts.dense import layout
from panoplan.layouts.onnx import OnnxLayouts
from panoplan.pipeline import Progress
from panoplan.types.arrays import BoolArray, FloatArray
from panoplan.types.layout import Layout

TRUE_LAYOUTS = "layouts_gt"
ROWS = 512
UNKNOWN_ROWS = 46.0
"""What a column counts, in rows, of which the network says nothing: a constant guess's error."""
BINS_CH = (0.0, 0.7, 1.0, 1.4, 2.0, 2.7, 4.0, np.inf)
"""True distances, in camera heights, between which the uncertainty is judged."""
_FARTHEST_CH = 1e3


def measure(folder: Path, network: OnnxLayouts, progress: Progress) -> dict[str, Any]:
    """Judges a network on a sequence folder with true layouts.

    Args:
        folder: with sequence.json, its images, and layouts_gt/ID.npz; photographs whose entry
            says `"inside": false` are left out.
        network: what is judged.
        progress: called with panoramas done and in all.

    Returns:
        Over the panoramas, median and mean of the mean |Δ| of the floor boundary in rows of 512
        and of the 2-D IoU of the floor that it encloses, for all, for those without and with
        openings; shares of columns within one and two of the stated σ by true distance; the mean
        log-likelihood under the stated σ and under the best constant one; CPU seconds; a line
        a panorama.

    Raises:
        InputError: the folder is not complete, or an image or layout cannot be read.
    """
    entries = [e for e in read_sequence(folder).keyframes if e.id not in _outside(folder)]
    lines, columns, seconds = [], [], []
    for done, entry in enumerate(entries, start=1):
        truth = read_layout_npz(folder / TRUE_LAYOUTS / f"{entry.id}.npz")
        pixels = read_panorama(folder / entry.image)
        started = time.process_time()
        told = layout(network(pixels))
        seconds.append(time.process_time() - started)
        line, errors = _judged(told, truth)
        lines.append({"id": entry.id, **line})
        columns.append(errors)
        progress(done, len(entries))
    if not lines:
        raise InputError(folder, "no panorama", "at least one with a true layout")
    openings = np.array([line["openings"] for line in lines], dtype=bool)
    return {
        "scene": folder.name,
        "model": network.spec.name,
        "all": _summary(lines, np.ones(len(lines), dtype=bool)),
        "without_openings": _summary(lines, ~openings),
        "with_openings": _summary(lines, openings),
        "sigma": _calibration(np.concatenate(columns)),
        "cpu_seconds": float(np.median(seconds)),
        "panoramas": lines,
    }


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
    }
    if told.floor_sigma is None:
        return line, np.empty((0, 3))
    sigma = np.interp(at, place, told.floor_sigma, period=told.width)[known]
    return line, np.stack([error, sigma, far], axis=1)[~missing]


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
