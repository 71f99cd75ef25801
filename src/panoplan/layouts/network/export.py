"""The trained network as a file that ONNX Runtime runs, with what it says about itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from panoplan.errors import MissingExtraError
from panoplan.formats.atomic import write_bytes
from panoplan.layouts.contract import METADATA_KEY, ModelSpec, Output, spec_json
from panoplan.layouts.network.calibration import Widening
from panoplan.layouts.network.data import MEAN, STD
from panoplan.layouts.network.head import BOUNDARIES, OUTPUTS, LayoutNetwork
from panoplan.layouts.network.samples import WIDTH
from panoplan.layouts.network.trace import onnx_bytes
from panoplan.types.arrays import FloatArray

NAME = "panoplan-layout-s"
_LARGE = 1024
_TENSOR, _SURE = "answer", "sure"


class _Calibrated(nn.Module):
    def __init__(self, network: LayoutNetwork, log_factors: FloatArray) -> None:
        super().__init__()
        self.network, self.widening = network, Widening(log_factors)

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor]:
        answer, sure = self.network(image)
        wide = self.widening(answer[:, BOUNDARIES], answer[:, 0])[:, None]
        return torch.cat([answer[:, :BOUNDARIES], wide, answer[:, BOUNDARIES + 1 :]], dim=1), sure


def spec(name: str = NAME) -> ModelSpec:
    """What the network of that name takes and gives."""

    def output(row: str, meaning: str) -> Output:
        return Output(_TENSOR, meaning, OUTPUTS.index(row))

    return ModelSpec(
        tensor="image",
        height=WIDTH // 2,
        width=WIDTH,
        outputs={
            "floor_boundary": output("floor", "elevation"),
            "ceiling_boundary": output("ceiling", "elevation"),
            "floor_sigma": output("log_floor_scale", "log_laplace_scale"),
            "corners": output("corner", "logit"),
            "doors": output("door", "logit"),
            "openings": output("opening", "logit"),
            "windows": output("window", "logit"),
            "confidence": Output(_SURE, "logit"),
        },
        mean=(MEAN,) * 3,
        std=(STD,) * 3,
        name=name,
        licence="Apache-2.0",
        extra={
            "through": {
                "tensor": _TENSOR,
                "channel": OUTPUTS.index("through"),
                "note": "floor boundary seen through open doors and openings, elevation",
            }
        },
    )


def export(network: LayoutNetwork, path: Path, log_factors: FloatArray, name: str = NAME) -> None:
    """Writes the network as ONNX, its weights as 16-bit floats.

    Args:
        network: trained.
        path: of the file.
        log_factors: what the floor's logarithmic scale lacks, as `calibration.widening` gives it.
        name: that the file tells.

    Raises:
        MissingExtraError: the package onnx is not installed.
        InputError: the place cannot be written.
    """
    try:
        import onnx
    except ImportError:
        raise MissingExtraError("exporting a network", "onnx", "train") from None
    module = _Calibrated(network, log_factors)
    model = onnx.load_from_string(onnx_bytes(module, (1, 3, WIDTH // 2, WIDTH), [_TENSOR, _SURE]))
    _halve(model, onnx)
    onnx.helper.set_model_props(model, {METADATA_KEY: spec_json(spec(name))})
    onnx.checker.check_model(model)
    write_bytes(path, model.SerializeToString())


def _halve(model: Any, onnx: Any) -> None:
    """Keeps large weights as 16-bit floats; ONNX Runtime widens them once, when it loads them."""
    casts = []
    for weight in model.graph.initializer:
        values = onnx.numpy_helper.to_array(weight)
        if values.dtype != np.float32 or values.size < _LARGE:
            continue
        name = weight.name
        weight.CopyFrom(onnx.numpy_helper.from_array(values.astype(np.float16), f"{name}.half"))
        casts.append(
            onnx.helper.make_node("Cast", [f"{name}.half"], [name], to=onnx.TensorProto.FLOAT)
        )
    nodes = list(model.graph.node)
    del model.graph.node[:]
    model.graph.node.extend([*casts, *nodes])
