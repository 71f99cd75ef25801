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
        "them and writes it; what is there already is gone on with. adapt: trains the network in "
        "the box a little further to see the images of a walk as the plan made of it has them.",
        epilog="example: panoplan model convert resnet50_rnn__zind.pth -o horizonnet.onnx",
    )
    parser.add_argument("what", choices=["convert", "show", "train", "adapt"])
    parser.add_argument(
        "input", type=Path, help="checkpoint or ONNX file; train: folder; adapt: images"
    )
    parser.add_argument(
        "-o", "--output", type=Path, help="convert, train, adapt: ONNX file to write"
    )
    parser.add_argument("--plan", type=Path, metavar="PLAN", help="adapt: plan.json of the images")
    model_train.add_arguments(parser)
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.errors import InputError

    if options.what == "train":
        return model_train.act(options)
    if options.what == "adapt":
        return _adapt(options)
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


def _adapt(options: argparse.Namespace) -> int:
    """Adapts the shipped network to a walk."""
    from panoplan.cli.progress import progress
    from panoplan.errors import InputError, MissingExtraError

    for value, what in ((options.output, "-o FILE.onnx"), (options.plan, "--plan PLAN.json")):
        if value is None:
            raise InputError("model adapt", "nothing told", what)
    try:
        import torch  # noqa: F401
    except ImportError:
        raise MissingExtraError("adapting a network", "torch", "train") from None
    from panoplan.formats.image import list_images
    from panoplan.formats.plan_json import read_plan
    from panoplan.layouts.images import image_ids
    from panoplan.layouts.network.adapt import adapt
    from panoplan.layouts.network.export import NAME, export
    from panoplan.layouts.network.reload import reload
    from panoplan.layouts.onnx import SHIPPED

    network, log_factors = reload(SHIPPED)
    images, plan = image_ids(list_images(options.input)), read_plan(options.plan)
    with progress("adapting", quiet=options.quiet) as told:
        count = adapt(network, images, plan, told)
    export(network, options.output, log_factors, f"{NAME}, adapted")
    print(f"{options.output}: learnt from {count} of {len(images)} panoramas")
    return 0
