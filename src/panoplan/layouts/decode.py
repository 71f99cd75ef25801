"""A network's tensors in the terms of this package, by what its file says they mean."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.horizonnet import at_columns
from panoplan.layouts.contract import ModelSpec
from panoplan.layouts.dense import Dense
from panoplan.types.arrays import FloatArray

_CHANCES = ("corners", "doors", "openings", "windows")


def decode(spec: ModelSpec, tensors: Mapping[str, Any], source: object) -> Dense:
    """Reads what a network answered.

    Args:
        spec: what its outputs mean.
        tensors: outputs by name.
        source: the model, for messages.

    Returns:
        The answer with column u of W at heading 2π(u + ½)/W − π.

    Raises:
        InputError: a tensor without the channel it should have, outputs of different widths, or
            a width that is no multiple of 4, at least 16.
    """
    rows = {name: _row(spec, name, tensors, source) for name in spec.outputs}
    width = len(rows["floor_boundary"])
    if width % 4 or width < 16:
        raise InputError(source, f"{width} columns", "a multiple of 4, at least 16")
    at = np.arange(width, dtype=np.float64) + (0.5 - spec.pixel_centre)
    for name, values in rows.items():
        single = spec.outputs[name].meaning == "height_ratio" or name == "confidence"
        if len(values) != (1 if single else width):
            expected = "one number" if single else f"{width}, as the floor"
            raise InputError(source, f"{name} of {len(values)} columns", expected)
        if not single and spec.pixel_centre != 0.5:
            rows[name] = at_columns(values, at)
    floor = _elevation(rows["floor_boundary"], spec.outputs["floor_boundary"].meaning)
    ceiling = sigma = confidence = None
    if "ceiling_boundary" in rows:
        meaning = spec.outputs["ceiling_boundary"].meaning
        if meaning == "height_ratio":
            ceiling = np.arctan(rows["ceiling_boundary"] * np.tan(-floor))
        else:
            ceiling = _elevation(rows["ceiling_boundary"], meaning)
    if "floor_sigma" in rows:
        sigma = _sigma(rows["floor_sigma"], spec.outputs["floor_sigma"].meaning)
    if "confidence" in rows:
        chance = _chance(rows["confidence"], spec.outputs["confidence"].meaning)
        confidence = float(chance[0])
    chances = {n: _chance(rows[n], spec.outputs[n].meaning) for n in _CHANCES if n in rows}
    return Dense(floor, ceiling, sigma, chances, confidence)


def _row(spec: ModelSpec, name: str, tensors: Mapping[str, Any], source: object) -> FloatArray:
    item = spec.outputs[name]
    values = np.asarray(tensors[item.tensor], dtype=np.float64)
    rows: FloatArray = values.reshape(-1, values.shape[-1] if values.ndim else 1)
    if item.channel >= len(rows):
        found = f"{item.tensor} of shape {values.shape}"
        raise InputError(source, found, f"a channel {item.channel}")
    return np.array(rows[item.channel])


def _elevation(values: FloatArray, meaning: str) -> FloatArray:
    if meaning == "depth":
        # Horizontal distance from a camera of height 1; nothing below 0 is a distance.
        values = -np.arctan2(1.0, np.where(values > 0, values, np.nan))
    elif meaning == "depression":
        values = -values
    return np.where(np.abs(values) <= np.pi / 2, values, np.nan)


def _sigma(values: FloatArray, meaning: str) -> FloatArray:
    if meaning.startswith("log_"):
        values = np.exp(np.clip(values, -20, 3))
    return np.sqrt(2.0) * values if meaning.endswith("laplace_scale") else values


def _chance(values: FloatArray, meaning: str) -> FloatArray:
    if meaning == "logit":
        values = 1 / (1 + np.exp(-np.clip(values, -50, 50)))
    return np.clip(np.nan_to_num(values), 0, 1)
