"""What a layout network's file says about itself: its input, and the meaning of its outputs.

An ONNX file carries it as JSON under the metadata key `panoplan.layout`; docs/models.md has the
same table for people who train networks.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from panoplan.errors import InputError

METADATA_KEY = "panoplan.layout"
FORMAT = 1
BOUNDARY = ("elevation", "depression")
CHANCE = ("probability", "logit")
MEANINGS: Mapping[str, tuple[str, ...]] = {
    "floor_boundary": (*BOUNDARY, "depth"),
    "ceiling_boundary": (*BOUNDARY, "height_ratio"),
    "floor_sigma": ("sigma", "log_sigma", "laplace_scale", "log_laplace_scale"),
    "corners": CHANCE,
    "doors": CHANCE,
    "openings": CHANCE,
    "windows": CHANCE,
    "confidence": CHANCE,
}
_LARGEST_SIDE = 8192
_TEXT_LIMIT = 64 * 1024


@dataclass(frozen=True)
class Output:
    """One output of a network.

    Attributes:
        tensor: name of the ONNX output.
        meaning: one of `MEANINGS` of what it gives.
        channel: row of the tensor, read as (channels, columns).
    """

    tensor: str
    meaning: str
    channel: int = 0


@dataclass(frozen=True)
class ModelSpec:
    """What a layout network takes and gives.

    Attributes:
        tensor: name of the ONNX input, (1, 3, height, width) float32, RGB.
        height: of the input in px.
        width: of the input in px, twice the height.
        outputs: by what they give; `floor_boundary` is always there.
        mean: of each channel, taken off the pixels 0..255.
        std: of each channel, divides what is left.
        pixel_centre: output column u of W looks along 2π(u + pixel_centre)/W − π.
        name: of the network.
        licence: of its weights.
    """

    tensor: str
    height: int
    width: int
    outputs: Mapping[str, Output]
    mean: tuple[float, float, float] = (0.0, 0.0, 0.0)
    std: tuple[float, float, float] = (255.0, 255.0, 255.0)
    pixel_centre: float = 0.5
    name: str = "unnamed"
    licence: str = "not stated"
    extra: Mapping[str, Any] = field(default_factory=dict)


def parse_spec(text: str, source: object) -> ModelSpec:
    """Reads the metadata of a layout network.

    Args:
        text: JSON object of `format` 1; `input` with tensor, height, width and optionally mean
            and std; `outputs` with tensor, meaning and optionally channel of each; optionally
            pixel_centre, name, licence. Other fields are kept in `extra`.
        source: the model file, for messages.

    Returns:
        What the network takes and gives.

    Raises:
        InputError: broken JSON, a format not known, a field missing or of the wrong kind, an
            unknown output or meaning, or no floor boundary.
    """
    where = f"{source}, {METADATA_KEY}"
    try:
        data = json.loads(text) if len(text) <= _TEXT_LIMIT else None
    except (ValueError, RecursionError):
        data = None
    if not isinstance(data, dict):
        raise InputError(where, "no JSON object", "one, as docs/models.md has it")
    if data.pop("format", None) != FORMAT:
        raise InputError(where, "another format", f"format {FORMAT}")
    taken = _field(data, "input", dict, where)
    outputs = _outputs(_field(data, "outputs", dict, where), where)
    centre = _number(data.pop("pixel_centre", 0.5), f"{where}, pixel_centre")
    return ModelSpec(
        tensor=_field(taken, "tensor", str, f"{where}, input"),
        height=_side(taken, "height", where),
        width=_side(taken, "width", where),
        outputs=outputs,
        mean=_channels(taken.get("mean", [0, 0, 0]), f"{where}, mean"),
        std=_channels(taken.get("std", [255, 255, 255]), f"{where}, std", positive=True),
        pixel_centre=centre,
        name=str(data.pop("name", "unnamed"))[:200],
        licence=str(data.pop("licence", "not stated"))[:200],
        extra=data,
    )


def spec_json(spec: ModelSpec) -> str:
    """The metadata text of a layout network, as `parse_spec` reads it."""
    outputs = {
        name: {"tensor": item.tensor, "meaning": item.meaning, "channel": item.channel}
        for name, item in spec.outputs.items()
    }
    taken = {
        "tensor": spec.tensor,
        "height": spec.height,
        "width": spec.width,
        "mean": list(spec.mean),
        "std": list(spec.std),
    }
    return json.dumps(
        {
            "format": FORMAT,
            "name": spec.name,
            "licence": spec.licence,
            "input": taken,
            "outputs": outputs,
            "pixel_centre": spec.pixel_centre,
            **spec.extra,
        }
    )


def _outputs(items: dict[str, Any], where: str) -> dict[str, Output]:
    outputs = {}
    for name, item in items.items():
        place = f"{where}, outputs.{name}"
        if name not in MEANINGS:
            raise InputError(place, "an output not known", " | ".join(MEANINGS))
        if not isinstance(item, dict):
            raise InputError(place, type(item).__name__, "an object")
        meaning = item.get("meaning")
        if meaning not in MEANINGS[name]:
            raise InputError(place, f"the meaning {meaning!r}", " | ".join(MEANINGS[name]))
        channel = item.get("channel", 0)
        if type(channel) is not int or channel < 0:
            raise InputError(place, f"the channel {channel!r}", "0, 1, ...")
        outputs[name] = Output(_field(item, "tensor", str, place), meaning, channel)
    if "floor_boundary" not in outputs:
        raise InputError(f"{where}, outputs", "no floor_boundary", "floor_boundary")
    return outputs


def _field(data: dict[str, Any], name: str, kind: type, where: str) -> Any:
    value = data.pop(name, None)
    if not isinstance(value, kind):
        found = "nothing" if value is None else type(value).__name__
        raise InputError(f"{where}, {name}", found, kind.__name__)
    return value


def _side(data: dict[str, Any], name: str, where: str) -> int:
    value = data.get(name)
    if type(value) is not int or not 16 <= value <= _LARGEST_SIDE:
        raise InputError(f"{where}, input.{name}", repr(value), f"16 to {_LARGEST_SIDE} px")
    return value


def _channels(values: Any, where: str, *, positive: bool = False) -> tuple[float, float, float]:
    if not isinstance(values, list) or len(values) != 3:
        raise InputError(where, repr(values)[:60], "three numbers, red, green, blue")
    red, green, blue = (_number(value, where) for value in values)
    if positive and min(red, green, blue) <= 0:
        raise InputError(where, repr(values)[:60], "numbers above 0")
    return red, green, blue


def _number(value: Any, where: str) -> float:
    if type(value) not in (int, float) or not abs(value) < 1e6:
        raise InputError(where, repr(value)[:60], "a number")
    return float(value)
