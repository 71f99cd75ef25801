"""Training of the layout network: first its head, then the trunk's 1×1 convolutions with it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from panoplan.errors import InputError
from panoplan.layouts.network.data import Batch, batches, ready
from panoplan.layouts.network.head import BOUNDARIES, OUTPUTS, Head, LayoutNetwork
from panoplan.layouts.network.shards import shards
from panoplan.layouts.network.trunk import SHALLOW, pretrained

SPANS = OUTPUTS[-3:]
CHECKPOINT, LOG = "checkpoint.pt", "training.jsonl"
_BOUNDARY_WEIGHTS = (1.0, 0.5, 0.5)
_CHANCE_WEIGHT = 8.0
"""Of each of corners and spans: their gradients are smaller than those of the boundaries by so much
that with a weight below 1 the shared layers learn nothing of them."""
_EVENNESS = 0.5
_LEAST_LOG_SCALE, _MOST_LOG_SCALE = -6.0, 1.0
_ROWS = 512
_HALF = 0.5
_CHECKPOINT_S = 600


@dataclass(frozen=True)
class Plan:
    """How a run of the training goes.

    Attributes:
        minutes: of the run; the learning rate falls to nothing over them.
        steps: after which it ends at the latest; such a run is the same again by its seed.
        rate: highest learning rate of the head.
        trunk_rate: of the trunk's 1×1 convolutions above stride 8; 0 leaves the trunk as it is.
        batch: panoramas a step.
        average: decay of the running mean of the weights, which is what is kept.
        seed: of a fresh head and of the order of the panoramas.
        warm_up: steps over which the learning rate rises.
        shards: numbers of those that are drawn; None for all that there are.
        mixing: share of the steps whose panoramas borrow one another's looks, 0-1; where the trunk
            is tuned, at stride 8 only.
    """

    minutes: float
    steps: int | None = None
    rate: float = 1.5e-3
    trunk_rate: float = 0.0
    batch: int = 32
    average: float = 0.998
    seed: int = 0
    warm_up: int = 200
    shards: tuple[int, ...] | None = None
    mixing: float = 0.0


def head_plan(minutes: float, seed: int = 0, mixing: float = 0.0) -> Plan:
    """A first run: the trunk stays as it is."""
    return Plan(minutes, seed=seed, mixing=mixing)


def tuned_plan(minutes: float, seed: int = 0) -> Plan:
    """A later run: the trunk's deeper 1×1 convolutions follow."""
    return Plan(minutes, rate=6e-4, trunk_rate=3e-4, seed=seed)


def train(folder: Path, out: Path, plan: Plan, told: Callable[[str], None]) -> None:
    """Trains for a while; goes on from the checkpoint in `out` where there is one.

    Shards are drawn one by one; those that appear in `folder` meanwhile are taken up as well.

    Args:
        folder: of shards with features.
        out: gets the checkpoint and a log, a line an evaluation.
        plan: how.
        told: called with a line at every evaluation.

    Raises:
        InputError: no shard for training or none held out.
    """
    torch.manual_seed(plan.seed)
    network = load(out / CHECKPOINT) if (out / CHECKPOINT).exists() else fresh()
    mean = _copy(network)
    tuned = plan.trunk_rate > 0 or is_tuned(network)
    optimiser = torch.optim.AdamW(_groups(network, plan), weight_decay=0.02, betas=(0.9, 0.98))
    peaks = [group["lr"] for group in optimiser.param_groups]
    rng = np.random.default_rng(plan.seed)
    start = last = time.monotonic()
    step = 0
    while True:
        numbers = ready(folder, shards(folder, held_out=False))
        if plan.shards is not None:
            numbers = [number for number in numbers if number in plan.shards]
        if not numbers:
            raise InputError(folder, "no shard with features", "rendered shards")
        for batch in batches(folder, [int(rng.choice(numbers))], plan.batch, rng):
            share = (time.monotonic() - start) / (60 * plan.minutes)
            share = max(share, step / plan.steps if plan.steps else 0.0)
            if share >= 1:
                _keep(mean, tuned, folder, out, {"step": step, "shards": len(numbers)}, told)
                return
            for group, peak in zip(optimiser.param_groups, peaks, strict=True):
                group["lr"] = (
                    peak * min(1, (step + 1) / plan.warm_up) * 0.5 * (1 + np.cos(np.pi * share))
                )
            if plan.mixing > 0 and rng.random() < plan.mixing:
                shallow, middle, deep = mixed(batch[:3], rng)
                batch = (shallow, middle, deep, batch[3])
            loss = _loss(network, batch, tuned=tuned)
            optimiser.zero_grad(set_to_none=True)
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), 1.0)
            optimiser.step()
            step += 1
            _follow(mean, network, min(plan.average, 1 - 1 / (1 + step / 4)))
            if time.monotonic() - last > _CHECKPOINT_S:
                _keep(mean, tuned, folder, out, {"step": step, "shards": len(numbers)}, told)
                last = time.monotonic()


def fresh() -> LayoutNetwork:
    """A network with ImageNet's trunk and an untrained head."""
    return LayoutNetwork(pretrained(), Head())


def load(path: Path) -> LayoutNetwork:
    """The network of a checkpoint."""
    network = fresh()
    network.load_state_dict(torch.load(path, map_location="cpu", weights_only=True))
    return network


def is_tuned(network: LayoutNetwork) -> bool:
    """Whether the trunk is no longer ImageNet's."""
    return not same(network.trunk, pretrained())


def loss_of(answer: Tensor, targets: Tensor) -> Tensor:
    """Mean negative log-likelihood.

    Args:
        answer: (B, len(OUTPUTS), COLUMNS).
        targets: (B, len(TARGETS), COLUMNS).

    Returns:
        Laplace's for the boundaries, Bernoulli's for corners and spans, weighted.

    Source: columns of which the network is unsure would count little by their likelihood alone;
        they are weighted by a power of the stated scale (Seitzer et al., On the pitfalls of
        heteroscedastic uncertainty estimation, 2022).
    """
    places, logs = answer[:, :BOUNDARIES], answer[:, BOUNDARIES : 2 * BOUNDARIES]
    scales = logs.clamp(_LEAST_LOG_SCALE, _MOST_LOG_SCALE)
    error = (places - targets[:, :BOUNDARIES]).abs()
    counts = torch.exp(_EVENNESS * scales.detach())
    nll = ((error * torch.exp(-scales) + scales) * counts).mean(dim=(0, 2)) / counts.mean(
        dim=(0, 2)
    )
    chances = nn.functional.binary_cross_entropy_with_logits(
        answer[:, 2 * BOUNDARIES :], targets[:, BOUNDARIES:], reduction="none"
    ).mean(dim=(0, 2))
    weights = torch.tensor(_BOUNDARY_WEIGHTS)
    return (nll * weights).sum() + _CHANCE_WEIGHT * chances.sum()


@torch.inference_mode()
def evaluate(network: LayoutNetwork, folder: Path, *, tuned: bool = True) -> dict[str, float]:
    """How good a network is on the held-out panoramas.

    Args:
        network: to be judged.
        folder: of the shards.
        tuned: False where the trunk is ImageNet's, whose features are kept.

    Returns:
        Median and mean over panoramas of the mean |Δ| of the floor boundary, in rows of 512;
        the same of the others; shares of columns within 1 and 2 of its own σ; mean loss; F1 of the
        columns of doors, openings and windows.

    Raises:
        InputError: no shard is held out.
    """
    numbers = ready(folder, shards(folder, held_out=True))
    if not numbers:
        raise InputError(folder, "no held-out shard with features", "one for choosing models")
    errors, within, losses, counts = [], [], [], []
    for *features, targets in batches(folder, numbers, 32, None):
        answer = answer_of(network, features, tuned=tuned)
        error = (answer[:, :BOUNDARIES] - targets[:, :BOUNDARIES]).abs()
        sigma = np.sqrt(2) * torch.exp(answer[:, BOUNDARIES : 2 * BOUNDARIES])
        errors.append(error.mean(dim=2).numpy() * _ROWS / np.pi)
        within.append([(error[:, 0] < k * sigma[:, 0]).float().mean().item() for k in (1, 2)])
        losses.append(loss_of(answer, targets).item())
        likely, there = answer[:, -len(SPANS) :] > 0, targets[:, -len(SPANS) :] > _HALF
        counts.append(torch.stack([x.sum(dim=(0, 2)) for x in (likely & there, likely, there)]))
    rows = np.concatenate(errors)
    told = {"loss": float(np.mean(losses))}
    for k, name in enumerate(("floor", "through", "ceiling")):
        told[f"{name}_median"], told[f"{name}_mean"] = (
            float(np.median(rows[:, k])),
            float(rows[:, k].mean()),
        )
    told["within_1"], told["within_2"] = (float(x) for x in np.mean(within, axis=0))
    both, likely, there = torch.stack(counts).sum(dim=0).double()
    for name, f1 in zip(SPANS, (2 * both / (likely + there)).tolist(), strict=True):
        told[f"{name}_f1"] = f1
    return told


def answer_of(network: LayoutNetwork, features: list[Tensor], *, tuned: bool) -> Tensor:
    """The network's answer from kept features, in 16-bit floats where that is safe.

    Args:
        network: that answers.
        features: at strides 8, 16 and 32, as ImageNet's trunk gives them.
        tuned: False where the trunk is that one.

    Returns:
        (B, len(OUTPUTS), COLUMNS).
    """
    with torch.autocast("cpu", torch.bfloat16):
        parts = network.trunk.above(features[0]) if tuned else features
        answer: Tensor = network.head(*parts)
    return answer.float()


def mixed(features: Sequence[Tensor], rng: np.random.Generator) -> list[Tensor]:
    """Features of panoramas that borrow the looks of others of their batch.

    Args:
        features: (B, C, H, W) at each stride.
        rng: of who borrows from whom, and how much.

    Returns:
        The same, mean and standard deviation of each channel moved towards another panorama's.

    Source: Zhou et al., Domain generalization with MixStyle, 2021.
    """
    count = len(features[0])
    other = torch.from_numpy(rng.permutation(count))
    own = torch.from_numpy(rng.beta(_MIXED, _MIXED, (count, 1, 1, 1)).astype(np.float32))
    told = []
    for x in features:
        mean, spread = x.mean((2, 3), keepdim=True), x.std((2, 3), keepdim=True) + _LEAST_SPREAD
        towards = own * mean + (1 - own) * mean[other], own * spread + (1 - own) * spread[other]
        told.append((x - mean) / spread * towards[1] + towards[0])
    return told


_MIXED, _LEAST_SPREAD = 0.3, 1e-4


def _loss(network: LayoutNetwork, batch: Batch, *, tuned: bool) -> Tensor:
    *features, targets = batch
    return loss_of(answer_of(network, features, tuned=tuned), targets)


def _groups(network: LayoutNetwork, plan: Plan) -> list[dict[str, object]]:
    """What is trained: the head, and above stride 8 the trunk's 1×1 convolutions.

    The gradients of depthwise weights and of biases would take more time than all others.
    """
    for parameter in network.trunk.parameters():
        parameter.requires_grad_(False)
    groups: list[dict[str, object]] = [{"params": list(network.head.parameters()), "lr": plan.rate}]
    if plan.trunk_rate > 0:
        pointwise = [
            module.weight
            for module in network.trunk.modules()
            if isinstance(module, nn.Conv2d) and module.kernel_size == (1, 1)
        ]
        below = {id(w) for b in network.trunk.blocks[:SHALLOW] for w in b.parameters()}
        chosen = [w.requires_grad_(True) for w in pointwise if id(w) not in below]
        groups.append({"params": chosen, "lr": plan.trunk_rate})
    return groups


def _copy(network: LayoutNetwork) -> LayoutNetwork:
    mean = fresh()
    mean.load_state_dict(network.state_dict())
    return mean.requires_grad_(False)


@torch.no_grad()
def _follow(mean: LayoutNetwork, network: LayoutNetwork, decay: float) -> None:
    for a, b in zip(mean.parameters(), network.parameters(), strict=True):
        if b.requires_grad:
            a.lerp_(b, 1 - decay)


def same(one: nn.Module, other: nn.Module) -> bool:
    """Whether two modules of one kind have the same weights."""
    pairs = zip(one.parameters(), other.parameters(), strict=True)
    return all(torch.equal(a, b) for a, b in pairs)


def _keep(
    network: LayoutNetwork,
    tuned: bool,
    folder: Path,
    out: Path,
    progress: dict[str, float],
    told: Callable[[str], None],
) -> None:
    """Writes the network, and how good it is."""
    out.mkdir(parents=True, exist_ok=True)
    unfinished = out / f".{CHECKPOINT}"
    torch.save(network.state_dict(), unfinished)
    unfinished.rename(out / CHECKPOINT)
    figures = {**progress, **evaluate(network, folder, tuned=tuned)}
    line = json.dumps({k: round(v, 4) for k, v in figures.items()})
    with (out / LOG).open("a", encoding="utf-8") as log:
        log.write(line + "\n")
    told(line)
