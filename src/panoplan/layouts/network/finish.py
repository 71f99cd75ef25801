"""From the checkpoint of a training to the file that is shipped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from panoplan.errors import InputError
from panoplan.layouts.network.calibration import widening
from panoplan.layouts.network.confidence import fit
from panoplan.layouts.network.export import export
from panoplan.layouts.network.head import Heads, LayoutNetwork
from panoplan.layouts.network.shards import shards
from panoplan.layouts.network.train import is_tuned, load, same

_CONFIDENCE_SHARDS = 1


def finish(
    folder: Path,
    checkpoint: Path,
    out: Path,
    told: Callable[[str], None],
    *,
    beside: Sequence[Path] = (),
) -> None:
    """Fits confidence and uncertainty of a trained network, and writes it as ONNX.

    Args:
        folder: of the shards, with features; the images of a few are needed, too.
        checkpoint: of the network.
        out: ONNX file.
        told: called with a line on the confidence.
        beside: checkpoints of other runs on the same features, whose boundaries are averaged with
            the network's own.

    Raises:
        MissingExtraError: onnx or ONNX Runtime is not installed.
        InputError: the place cannot be written, or a run with another trunk.
    """
    network = together(load(checkpoint), [(path, load(path)) for path in beside])
    held_out = shards(folder, held_out=True)
    learnt = shards(folder, held_out=False)[-_CONFIDENCE_SHARDS:]
    believed, doubted = fit(network, folder, learnt, held_out[0])
    told(f"believed: {believed:.3f} of the panoramas; doubted: {doubted:.3f} of what is spoilt")
    export(network, out, widening(network, folder, held_out, tuned=is_tuned(network)))


def together(
    network: LayoutNetwork, others: Sequence[tuple[object, LayoutNetwork]]
) -> LayoutNetwork:
    """A network that answers with the heads of several.

    Args:
        network: whose trunk, confidence, corners and spans are kept.
        others: with what each is called in messages.

    Raises:
        InputError: another one has another trunk.
    """
    if not others:
        return network
    for name, other in others:
        if not same(other.trunk, network.trunk):
            raise InputError(name, "another trunk", "a run on the same features")
    both = LayoutNetwork(network.trunk, Heads([*(one.head for _, one in others), network.head]))
    both.sure = network.sure
    return both
