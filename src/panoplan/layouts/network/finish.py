"""From the checkpoint of a training to the file that is shipped."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from panoplan.layouts.network.calibration import widening
from panoplan.layouts.network.confidence import fit
from panoplan.layouts.network.export import export
from panoplan.layouts.network.shards import shards
from panoplan.layouts.network.train import is_tuned, load

_CONFIDENCE_SHARDS = 1


def finish(folder: Path, checkpoint: Path, out: Path, told: Callable[[str], None]) -> None:
    """Fits confidence and uncertainty of a trained network, and writes it as ONNX.

    Args:
        folder: of the shards, with features; the images of a few are needed, too.
        checkpoint: of the network.
        out: ONNX file.
        told: called with a line on the confidence.

    Raises:
        MissingExtraError: onnx or ONNX Runtime is not installed.
        InputError: the place cannot be written.
    """
    network = load(checkpoint)
    held_out = shards(folder, held_out=True)
    learnt = shards(folder, held_out=False)[-_CONFIDENCE_SHARDS:]
    believed, doubted = fit(network, folder, learnt, held_out[0])
    told(f"believed: {believed:.3f} of the panoramas; doubted: {doubted:.3f} of what is spoilt")
    export(network, out, widening(network, folder, held_out, tuned=is_tuned(network)))
