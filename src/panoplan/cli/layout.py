"""panoplan layout: images become room layouts."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from panoplan.cli.progress import progress

EXIT_NO_ROOM = 3


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "layout",
        help="images become room layouts",
        description="Predicts where the floor meets the walls in equirectangular images and "
        "writes the layout files of a sequence folder.",
        epilog="example: panoplan layout photos/ -o walk/ --average flip",
    )
    parser.add_argument("images", type=Path, nargs="+", help="images, or folders of them")
    parser.add_argument("-o", "--output", type=Path, required=True, help="sequence folder")
    parser.add_argument("--quiet", action="store_true", help="no progress, no summary")
    add_network_arguments(parser)
    parser.set_defaults(act=act)


def add_network_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options that choose a layout network."""
    parser.add_argument("--model", type=Path, help="ONNX layout network instead of the shipped one")
    parser.add_argument(
        "--average",
        type=_averaging,
        default=(),
        metavar="flip,rotate",
        help="also ask the network about the mirrored panorama and quarter turns of it",
    )


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.cache import Cache, cache_folder
    from panoplan.datasets.detect import image_files
    from panoplan.errors import InputError
    from panoplan.formats.sequence import LAYOUTS
    from panoplan.intake.layouts import open_network
    from panoplan.layouts.images import image_ids, predict_layouts

    images: list[Path] = []
    for path in options.images:
        if not path.exists():
            raise InputError(path, "nothing", "an image or a folder of images")
        images += image_files(path) if path.is_dir() else [path]
    if not images:
        raise InputError(options.images[0], "no image", "images, or a folder of images")
    network = open_network(options.model, options.average)
    with progress("layouts", quiet=options.quiet) as report:
        predicted = predict_layouts(
            image_ids(images), options.output / LAYOUTS, network, Cache(cache_folder()), report
        )
    if not options.quiet:
        for name, reason in predicted.left_out:
            print(f"{name}: left out, {reason}")
        print(f"{len(predicted.files)} of {len(images)} images: {options.output / LAYOUTS}")
    return 0 if predicted.files else EXIT_NO_ROOM


def _averaging(text: str) -> tuple[str, ...]:
    words = tuple(word for word in text.split(",") if word)
    if not set(words) <= {"flip", "rotate"}:
        raise argparse.ArgumentTypeError(f"found {text}; expected flip, rotate or both")
    return words
