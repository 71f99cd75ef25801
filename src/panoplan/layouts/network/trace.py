"""Torch modules as ONNX."""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence

import torch
from torch import nn

_OPSET = 17


def onnx_bytes(module: nn.Module, shape: Sequence[int], outputs: Sequence[str]) -> bytes:
    """A module as an ONNX file with one input, `image`.

    Args:
        module: to be traced; it has no branches that depend on values.
        shape: of the input.
        outputs: names of its outputs.
    """
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        # The exporter without tracing needs a package more and writes the same graph.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            module.eval(),
            (torch.zeros(*shape),),
            buffer,
            input_names=["image"],
            output_names=list(outputs),
            opset_version=_OPSET,
            dynamo=False,
        )
    return buffer.getvalue()
