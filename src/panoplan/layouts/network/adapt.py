"""The network adapted to a walk of somebody's own, by the plan that was made of it.

A plan is made of all views of a room, so that it is better than what the network says of each:
put back into the panoramas it is what the network should have said.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from panoplan.errors import InputError
from panoplan.formats.image import read_panorama, resized
from panoplan.geometry.hits import first_hits
from panoplan.geometry.sphere import column_heading
from panoplan.layouts.network.data import Featuriser
from panoplan.layouts.network.head import BOUNDARIES, COLUMNS, LayoutNetwork
from panoplan.layouts.network.samples import WIDTH
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import FloorPlan

STEPS = 40
_BATCH, _RATE = 8, 2e-4
_FLOOR_RAD = 0.02
_TURNS = 16
_FAR_SIGMAS = 3.0
_FEWEST = 8


def put_back(plan: FloorPlan) -> dict[str, FloatArray]:
    """The floor boundary that level cameras would see if the plan were true.

    Args:
        plan: whose rooms are drawn, in camera heights or metres.

    Returns:
        (COLUMNS,) elevation in rad by keyframe, of those in a room that is drawn.
    """
    height = plan.camera_height_m if plan.unit == "m" else 1.0
    rooms = {room.id: room for room in plan.rooms if room.polygon is not None}
    turn = column_heading(np.arange(COLUMNS, dtype=np.float64), COLUMNS)
    floors = {}
    for pose in plan.trajectory:
        if pose.room not in rooms or height is None:
            continue
        room, angle = rooms[pose.room], pose.heading + turn
        rays = np.stack([np.sin(angle), np.cos(angle)], axis=1)
        rings = [ring for ring in (room.polygon, *room.holes) if ring is not None]
        ranges = [first_hits(pose.position, rays, ring).range for ring in rings]
        floor = -np.arctan(height / np.min(ranges, axis=0))
        if (floor < 0).all():
            floors[pose.id] = floor
    return floors


def adapt(
    network: LayoutNetwork,
    images: Mapping[str, Path],
    plan: FloorPlan,
    progress: Callable[[int, int], None],
    seed: int = 0,
) -> int:
    """Trains the network's heads, in place, to see a walk as its plan has it.

    The floor boundary follows the plan; all that it says else stays as it was. Panoramas of which
    the plan says something quite different than the network are left out: they are of another
    room, or not level.

    Args:
        network: that made the plan, or a like one.
        images: of the walk, by keyframe; level panoramas.
        plan: of the walk.
        progress: called with panoramas read and steps done, and all of them.
        seed: of their order.

    Returns:
        How many panoramas were learnt from.

    Raises:
        InputError: hardly any panorama agrees with the plan.
    """
    floors = put_back(plan)
    known = sorted(set(floors) & set(images))
    _enough(len(known), len(images))
    total = len(known) + STEPS
    featuriser = Featuriser(network.trunk)
    network.requires_grad_(False)
    views: list[tuple[list[Tensor], Tensor, Tensor]] = []
    for done, name in enumerate(known, start=1):
        image = resized(read_panorama(images[name]), WIDTH, WIDTH // 2)
        features = [torch.from_numpy(part)[None] for part in featuriser(image)]
        said, floor = network.head(*features), torch.from_numpy(floors[name]).float()[None]
        off = (said[:, 0] - floor).abs() / (np.sqrt(2) * torch.exp(said[:, BOUNDARIES]))
        if off.median() < _FAR_SIGMAS:
            views.append((features, said, floor))
        progress(done, total)
    _enough(len(views), len(images))
    rng = np.random.default_rng(seed)
    network.head.requires_grad_(True)
    optimiser = torch.optim.AdamW(network.head.parameters(), lr=_RATE, weight_decay=0.0)
    for step in range(STEPS):
        for group in optimiser.param_groups:
            group["lr"] = _RATE * 0.5 * (1 + np.cos(np.pi * step / STEPS))
        chosen = [views[k] for k in rng.choice(len(views), _BATCH, replace=False)]
        turn = int(rng.integers(_TURNS))
        loss = _loss(network.head, chosen, turn)
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.head.parameters(), 1.0)
        optimiser.step()
        progress(len(known) + step + 1, total)
    return len(views)


def _enough(count: int, images: int) -> None:
    if count < _FEWEST:
        found = f"{count} of {images} panoramas that agree with it"
        raise InputError("plan", found, f"at least {_FEWEST}, level, of the plan's keyframes")


def _loss(
    head: torch.nn.Module, views: list[tuple[list[Tensor], Tensor, Tensor]], turn: int
) -> Tensor:
    features = zip(*(view[0] for view in views), strict=True)
    parts = [_turned(torch.cat(part), turn) for part in features]
    said = _turned(torch.cat([view[1] for view in views]), turn)
    floor = _turned(torch.cat([view[2] for view in views]), turn)
    answer = head(*parts)
    away = (answer[:, 0] - floor).abs().mean() / _FLOOR_RAD
    return away + (answer[:, 1:] - said[:, 1:]).abs().mean()


def _turned(x: Tensor, turn: int) -> Tensor:
    """All columns moved by so many sixteenths of the circle, under which features turn exactly."""
    return torch.roll(x, turn * (x.shape[-1] // _TURNS), dims=-1)
