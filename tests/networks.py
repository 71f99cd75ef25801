"""Small layout networks whose answers are known."""

import json

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from panoplan.layouts.contract import METADATA_KEY

HEIGHT, WIDTH = 32, 64


def metadata(**changes):
    """What the network of `brightness_network` says about itself, with changes."""
    told = {
        "format": 1,
        "name": "brightness",
        "licence": "CC0-1.0",
        "input": {"tensor": "image", "height": HEIGHT, "width": WIDTH},
        "outputs": {
            "floor_boundary": {"tensor": "rows", "channel": 1, "meaning": "depression"},
            "ceiling_boundary": {"tensor": "rows", "channel": 2, "meaning": "elevation"},
            "corners": {"tensor": "rows", "channel": 0, "meaning": "probability"},
        },
    }
    return {**told, **changes}


def brightness_network(path, told=None):
    """An ONNX file that answers with the mean of each column of each colour, 0..1.

    The red mean is a corner's probability, the green one the floor's depression in rad, the blue
    one the ceiling's elevation.
    """
    image = helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, HEIGHT, WIDTH])
    rows = helper.make_tensor_value_info("rows", TensorProto.FLOAT, [1, 3, WIDTH])
    axes = numpy_helper.from_array(np.array([2], dtype=np.int64), "axes")
    node = helper.make_node("ReduceMean", ["image", "axes"], ["rows"], keepdims=0)
    graph = helper.make_graph([node], "brightness", [image], [rows], [axes])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=9)
    entry = model.metadata_props.add()
    entry.key, entry.value = METADATA_KEY, json.dumps(metadata() if told is None else told)
    onnx.save(model, str(path))
    return path


def painted(floor, *, ceiling=None, corners=(), height=256):
    """A panorama to which `brightness_network` answers with these depressions and elevations.

    Args:
        floor: (64,) floor depression in rad, below 1.
        ceiling: (64,) elevation in rad, half of the floor's where omitted.
        corners: columns of 64 with a corner.
        height: of the image in px, at least 256.
    """
    colours = np.zeros((WIDTH, 3))
    colours[list(corners), 0] = 1
    colours[:, 1] = floor
    colours[:, 2] = np.asarray(floor) / 2 if ceiling is None else ceiling
    row = np.repeat(colours * 255, 2 * height // WIDTH, axis=0)
    # Grain, as without it only the columns at the blocks' edges would differ at all.
    grain = np.random.default_rng(0).uniform(-6, 6, (height, 2 * height, 1))
    return np.clip(np.rint(row + grain), 0, 255).astype(np.uint8)
