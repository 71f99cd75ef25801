"""Checkpoints and ONNX files of other people, recognised and converted."""

from __future__ import annotations

import io
import pickle
import warnings
import zipfile
from pathlib import Path
from typing import Any

from panoplan.errors import InputError, MissingExtraError
from panoplan.formats.atomic import read_bytes, write_bytes
from panoplan.layouts.contract import METADATA_KEY, ModelSpec, Output, spec_json

_FILE_LIMIT = 2**30
_OPSET = 17
_LICENCE = "that of its authors and of the data it was trained on"
HORIZONNET = ModelSpec(
    tensor="image",
    height=512,
    width=1024,
    outputs={
        "ceiling_boundary": Output("boundary", "depression", 0),
        "floor_boundary": Output("boundary", "depression", 1),
        "corners": Output("corners", "logit"),
    },
    name="HorizonNet",
    licence=_LICENCE,
)
LGT_NET = ModelSpec(
    tensor="image",
    height=512,
    width=1024,
    outputs={
        "floor_boundary": Output("depth", "depth"),
        "ceiling_boundary": Output("ratio", "height_ratio"),
    },
    name="LGT-Net",
    licence=_LICENCE,
)


def convert(source: Path, target: Path) -> ModelSpec:
    """Converts a HorizonNet checkpoint or an LGT-Net ONNX file.

    Args:
        source: `.pth` with `kwargs` (backbone, use_rnn) and `state_dict`, read without running
            anything in it; or `.onnx` with input image and outputs depth and ratio.
        target: ONNX file to write.

    Returns:
        What the written file says about itself.

    Raises:
        InputError: neither of the two.
        MissingExtraError: what converts is not installed.
    """
    data = read_bytes(source, _FILE_LIMIT)
    spec, model = (
        _horizonnet(data, source)
        if zipfile.is_zipfile(io.BytesIO(data))
        else _lgt_net(data, source)
    )
    entries = {entry.key: entry for entry in model.metadata_props}
    entry = entries.get(METADATA_KEY) or model.metadata_props.add()
    entry.key, entry.value = METADATA_KEY, spec_json(spec)
    write_bytes(target, model.SerializeToString())
    return spec


def _horizonnet(data: bytes, source: Path) -> tuple[ModelSpec, Any]:
    onnx = _onnx()
    try:
        import torch
    except ImportError:
        raise MissingExtraError("converting a checkpoint", "torch", "train") from None
    from panoplan.layouts.convert.horizonnet import BACKBONES, HEIGHT, WIDTH, HorizonNet

    expected = "a HorizonNet checkpoint: kwargs with backbone and use_rnn, and state_dict"
    try:
        checkpoint = torch.load(io.BytesIO(data), map_location="cpu", weights_only=True)
    except (RuntimeError, pickle.UnpicklingError, EOFError, ValueError) as error:
        found = f"no plain checkpoint ({str(error).splitlines()[0][:80]})"
        raise InputError(source, found, expected) from None
    told = checkpoint.get("kwargs") if isinstance(checkpoint, dict) else None
    weights = checkpoint.get("state_dict") if isinstance(checkpoint, dict) else None
    if not isinstance(told, dict) or not isinstance(weights, dict):
        raise InputError(source, "a checkpoint of another network", expected)
    backbone, use_rnn = told.get("backbone"), told.get("use_rnn")
    if not isinstance(backbone, str) or backbone not in BACKBONES or not isinstance(use_rnn, bool):
        raise InputError(f"{source}, kwargs", repr(told)[:80], " | ".join(BACKBONES))
    network = HorizonNet(backbone, use_rnn).eval()
    try:
        network.load_state_dict(weights)
    except (RuntimeError, TypeError, AttributeError) as error:
        found = " ".join(str(error).split())[:160]
        raise InputError(
            f"{source}, state_dict", found, f"that of HorizonNet, {backbone}"
        ) from None
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        # Of the exporter's successor, which needs one package more, and of other batch sizes.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            network,
            (torch.zeros(1, 3, HEIGHT, WIDTH),),
            buffer,  # type: ignore[arg-type]
            input_names=["image"],
            output_names=["boundary", "corners"],
            opset_version=_OPSET,
            dynamo=False,
        )
    return HORIZONNET, onnx.load_from_string(buffer.getvalue())


def _lgt_net(data: bytes, source: Path) -> tuple[ModelSpec, Any]:
    onnx = _onnx()
    expected = "a HorizonNet checkpoint (.pth), or an LGT-Net ONNX file: image → depth, ratio"
    try:
        model = onnx.load_from_string(data)
        inputs = {item.name for item in model.graph.input}
        outputs = {item.name for item in model.graph.output}
    except Exception as error:
        # Protobuf's errors are no common kind.
        raise InputError(source, f"neither ({type(error).__name__})", expected) from None
    if not {"image"} <= inputs or not {"depth", "ratio"} <= outputs:
        found = f"a model from {sorted(inputs)} to {sorted(outputs)}"
        raise InputError(source, found, expected)
    return LGT_NET, model


def _onnx() -> Any:
    try:
        import onnx
    except ImportError:
        raise MissingExtraError("converting a network", "onnx", "train") from None
    return onnx
