"""Whether an image is an upright panorama of a room: a linear reading of the trunk's features."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from scipy.spatial.transform import Rotation
from torch import Tensor, nn

from panoplan.formats.image import Pixels, resized
from panoplan.geometry.panorama import turned
from panoplan.layouts.network.data import Featuriser
from panoplan.layouts.network.head import LayoutNetwork

_LEAST_TILT_RAD = np.deg2rad(40.0)
_CROP = (0.25, 0.5)
_DECAY = 0.02
_STEPS = 60


def spoilt(image: Pixels, rng: np.random.Generator) -> Pixels:
    """What should not be believed: a panorama upside down or on its side, a part of one, noise.

    Args:
        image: (H, W, 3) an upright panorama.
        rng: of the kind and its measure.

    Returns:
        (H, W, 3).
    """
    height, width = image.shape[:2]
    kind = rng.random()
    if kind < 0.45:
        return np.ascontiguousarray(image[::-1, ::-1])
    if kind < 0.65:
        angles = [rng.uniform(-np.pi, np.pi), rng.uniform(_LEAST_TILT_RAD, np.pi)]
        return turned(image, Rotation.from_euler("yz", angles).as_matrix())
    if kind < 0.85:
        share = float(rng.uniform(*_CROP))
        rows, columns = int(share * height), int(share * width)
        top = int(rng.integers(height // 4, 3 * height // 4 - rows + 1))
        left = int(rng.integers(width - columns + 1))
        return resized(image[top : top + rows, left : left + columns], width, height)
    level, spread = rng.uniform(40, 215, 3), float(rng.exponential(20.0))
    coarse = int(rng.choice([1, 8, 32]))
    noise = rng.normal(level, spread, (height // coarse, width // coarse, 3))
    return resized(np.clip(noise, 0, 255).astype(np.uint8), width, height)


def fit(
    network: LayoutNetwork, folder: Path, numbers: list[int], held_out: int, seed: int = 0
) -> tuple[float, float]:
    """Fits the network's confidence, in place, to rendered panoramas and what is spoilt of them.

    Args:
        network: whose trunk is as it will stay.
        folder: of rendered shards.
        numbers: of the shards that are learnt from.
        held_out: number of the shard that is judged on.
        seed: of what is spoilt.

    Returns:
        On the held-out shard, shares of the panoramas that are believed and of the spoilt ones that
        are not.
    """
    featuriser, rng = Featuriser(network.trunk), np.random.default_rng(seed)
    known = [_pairs(network, featuriser, folder, number, rng) for number in numbers]
    good, bad = (torch.cat(side) for side in zip(*known, strict=True))
    _regress(network.sure, good, bad)
    with torch.inference_mode():
        right, wrong = _pairs(network, featuriser, folder, held_out, rng)
        return (
            float((network.sure(right) > 0).double().mean()),
            float((network.sure(wrong) < 0).double().mean()),
        )


def _pairs(
    network: LayoutNetwork,
    featuriser: Featuriser,
    folder: Path,
    number: int,
    rng: np.random.Generator,
) -> tuple[Tensor, Tensor]:
    """Summaries of a shard's panoramas as they are, and spoilt."""
    images = np.load(folder / f"images-{number:07d}.npy", mmap_mode="r", allow_pickle=False)

    def summary(change: Callable[[Pixels], Pixels]) -> Tensor:
        deep = np.array([featuriser(change(np.asarray(image)))[-1] for image in images])
        return network.summary(torch.from_numpy(deep))

    return summary(lambda image: image), summary(lambda image: spoilt(image, rng))


def _regress(sure: nn.Linear, good: Tensor, bad: Tensor) -> None:
    """Logistic regression on standardised summaries, which is then folded into the weights."""
    both = torch.cat([good, bad])
    mean, std = both.mean(dim=0), both.std(dim=0) + 1e-3
    x = (both - mean) / std
    y = torch.cat([torch.ones(len(good)), torch.zeros(len(bad))])
    weight = torch.zeros(x.shape[1], requires_grad=True)
    bias = torch.zeros((), requires_grad=True)
    optimiser = torch.optim.LBFGS([weight, bias], max_iter=_STEPS, line_search_fn="strong_wolfe")

    def loss() -> Tensor:
        optimiser.zero_grad()
        value = nn.functional.binary_cross_entropy_with_logits(x @ weight + bias, y)
        value = value + _DECAY * weight.square().sum()
        value.backward()
        return value

    optimiser.step(loss)
    with torch.no_grad():
        sure.weight.copy_((weight / std)[None])
        sure.bias.copy_(bias - (weight * mean / std).sum())
