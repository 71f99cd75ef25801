"""The network as torch modules again, from the file that it was exported to."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from panoplan.errors import InputError, MissingExtraError
from panoplan.formats.atomic import read_bytes
from panoplan.layouts.network.calibration import knots
from panoplan.layouts.network.head import Head, Heads, LayoutNetwork
from panoplan.layouts.network.trunk import Trunk
from panoplan.types.arrays import FloatArray

_LIMIT = 2**28
_HALF = ".half"
_OUTER = "network."
_MATRIX = re.compile(r"/network/(?P<path>[a-z0-9_./]+)/MatMul")
_HEADS = re.compile(r"head\.heads\.(\d+)\.")


def reload(path: Path) -> tuple[LayoutNetwork, FloatArray]:
    """The network in a file that `export.export` wrote.

    Args:
        path: ONNX file.

    Returns:
        The network, its weights as exact as the file has them, and the logarithmic factors of its
        floor's scale.

    Raises:
        MissingExtraError: the package onnx is not installed.
        InputError: another network, or no ONNX file.
    """
    try:
        import onnx
    except ImportError:
        raise MissingExtraError("reading a network's weights", "onnx", "train") from None
    expected = "a network that panoplan model train wrote"
    data = read_bytes(path, _LIMIT)
    try:
        graph = onnx.load_from_string(data).graph
        weights = _weights(graph, onnx)
        heads = {int(found[1]) for found in map(_HEADS.match, weights) if found}
        made = [Head() for _ in range(max(len(heads), 1))]
        network = LayoutNetwork(Trunk(), Heads(made) if heads else made[0])
        network.load_state_dict({k: v for k, v in weights.items() if "widening" not in k})
        first, bends = (weights[f"widening.{name}"].numpy() for name in ("first", "bends"))
    except Exception as error:
        # Protobuf's errors are no common kind, and torch's tell of every weight.
        raise InputError(path, f"another file ({type(error).__name__})", expected) from None
    rises = np.cumsum(bends) * np.diff(knots())
    return network, np.concatenate([first, first + np.cumsum(rises)]).astype(np.float64)


def _weights(graph: Any, onnx: Any) -> dict[str, Tensor]:
    """The tensors by the names that they have in the modules."""
    named = {
        item.name.removesuffix(_HALF): onnx.numpy_helper.to_array(item).astype(np.float32)
        for item in graph.initializer
    }
    weights = {
        name.removeprefix(_OUTER): torch.from_numpy(values)
        for name, values in named.items()
        if name.startswith((_OUTER, "widening."))
    }
    for node in graph.node:
        found = _MATRIX.fullmatch(node.name)
        # The exporter keeps matrices of linear layers transposed, and without their name.
        if found and node.input[1] in named:
            name = found["path"].replace("/", ".") + ".weight"
            weights[name] = torch.from_numpy(named[node.input[1]].T.copy())
    return weights
