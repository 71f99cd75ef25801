"""Features of rendered panoramas, computed once and kept beside them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from panoplan.errors import MissingExtraError
from panoplan.formats.image import Pixels
from panoplan.layouts.network.samples import WIDTH
from panoplan.layouts.network.trace import onnx_bytes
from panoplan.layouts.network.trunk import Trunk

MEAN, STD = 127.0, 128.0
"""Normalisation that the trunk's weights were trained with, of pixels 0-255."""
_PARTS = ("shallow", "middle", "deep")
_STEP = 16
"""Turns of the panorama under which the features turn with it exactly: one column at stride 32."""

Batch = tuple[Tensor, Tensor, Tensor, Tensor]
"""Features at strides 8, 16 and 32, and targets."""


class _Features(nn.Module):
    def __init__(self, trunk: Trunk) -> None:
        super().__init__()
        self.trunk = trunk

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        return self.trunk.above(self.trunk.below(image))


class Featuriser:
    """The trunk by ONNX Runtime, which takes a third of the time of torch's.

    Args:
        trunk: whose features.

    Raises:
        MissingExtraError: ONNX Runtime is not installed.
    """

    def __init__(self, trunk: Trunk) -> None:
        try:
            import onnxruntime
        except ImportError:
            raise MissingExtraError("computing features", "onnxruntime", "train") from None
        model = onnx_bytes(_Features(trunk), (1, 3, WIDTH // 2, WIDTH), _PARTS)
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        self._session = onnxruntime.InferenceSession(
            model, options, providers=["CPUExecutionProvider"]
        )

    def __call__(self, image: Pixels) -> list[NDArray[np.float32]]:
        """Features at strides 8, 16 and 32 of a panorama (WIDTH / 2, WIDTH, 3)."""
        pixels = (image.astype(np.float32) - MEAN) / STD
        batch = np.ascontiguousarray(pixels.transpose(2, 0, 1)[None])
        return [value[0] for value in self._session.run(None, {"image": batch})]

    def shard(self, folder: Path, number: int) -> None:
        """Computes the features of a rendered shard, unless they are there."""
        if (folder / f"deep-{number:07d}.npy").exists():
            return
        images = np.load(folder / f"images-{number:07d}.npy", mmap_mode="r", allow_pickle=False)
        rows: dict[str, list[np.ndarray]] = {part: [] for part in _PARTS}
        for image in images:
            for part, value in zip(_PARTS, self(image), strict=True):
                rows[part].append(value.astype(np.float16))
        for part in _PARTS:
            unfinished = folder / f".{part}-{number:07d}.npy"
            np.save(unfinished, np.array(rows[part]))
            unfinished.rename(folder / f"{part}-{number:07d}.npy")


def ready(folder: Path, numbers: list[int]) -> list[int]:
    """Those of some shards whose features are computed."""
    return [n for n in numbers if (folder / f"deep-{n:07d}.npy").exists()]


def batches(
    folder: Path, numbers: list[int], size: int, rng: np.random.Generator | None
) -> Iterator[Batch]:
    """One pass over some shards.

    Args:
        folder: that holds them.
        numbers: of the shards.
        size: of a batch.
        rng: shuffles, and turns each batch; as they lie where None.

    Yields:
        Batches; what does not fill one is left out where shuffled.
    """
    names = (*_PARTS, "targets")
    order = list(numbers) if rng is None else [numbers[k] for k in rng.permutation(len(numbers))]
    for number in order:
        arrays = [
            np.load(folder / f"{name}-{number:07d}.npy", allow_pickle=False) for name in names
        ]
        count = len(arrays[0])
        places = np.arange(count) if rng is None else rng.permutation(count)
        end = count if rng is None else count - count % size
        for start in range(0, end, size):
            chosen = places[start : start + size]
            parts = [torch.from_numpy(a[chosen].astype(np.float32)) for a in arrays]
            turn = 0 if rng is None else int(rng.integers(_STEP))
            shallow, middle, deep, targets = (
                torch.roll(part, turn * (part.shape[-1] // _STEP), dims=-1) for part in parts
            )
            yield shallow, middle, deep, targets
