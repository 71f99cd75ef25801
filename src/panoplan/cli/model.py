"""panoplan model: layout networks of other people."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "model",
        help="layout networks of other people",
        description="convert: a HorizonNet checkpoint (.pth) or an LGT-Net ONNX file becomes an "
        "ONNX file that `panoplan run --model` takes. show: what such a file says about itself.",
        epilog="example: panoplan model convert resnet50_rnn__zind.pth -o horizonnet.onnx",
    )
    parser.add_argument("what", choices=["convert", "show"])
    parser.add_argument("input", type=Path, help="checkpoint or ONNX file")
    parser.add_argument("-o", "--output", type=Path, help="convert: ONNX file to write")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.errors import InputError

    if options.what == "show":
        from panoplan.layouts.onnx import OnnxLayouts

        spec, path = OnnxLayouts(options.input).spec, options.input
    else:
        from panoplan.layouts.convert.checkpoints import convert

        if options.output is None:
            raise InputError("model convert", "no output", "-o FILE.onnx")
        spec, path = convert(options.input, options.output), options.output
    print(f"{path}: {spec.name}, {spec.width}×{spec.height} px; licence: {spec.licence}")
    for name, output in spec.outputs.items():
        print(f"  {name}: {output.meaning} ({output.tensor}, channel {output.channel})")
    return 0
