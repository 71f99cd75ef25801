"""panoplan model: layout networks of other people, and training of our own."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from panoplan.cli import model_train


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "model",
        help="layout networks: other people's, and training of our own",
        description="convert: a HorizonNet checkpoint (.pth) or an LGT-Net ONNX file becomes an "
        "ONNX file that `panoplan run --model` takes. show: what such a file says about itself. "
        "train: renders labelled panoramas of made-up homes into a folder, trains a network on "
        "them and writes it; what is there already is gone on with.",
        epilog="example: panoplan model convert resnet50_rnn__zind.pth -o horizonnet.onnx",
    )
    parser.add_argument("what", choices=["convert", "show", "train"])
    parser.add_argument("input", type=Path, help="checkpoint or ONNX file; train: folder")
    parser.add_argument("-o", "--output", type=Path, help="convert, train: ONNX file to write")
    model_train.add_arguments(parser)
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.errors import InputError

    if options.what == "train":
        return model_train.act(options)
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
