"""How much wider the stated scale must be, by distance, to hold on held-out renders."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from panoplan.layouts.network.data import batches
from panoplan.layouts.network.head import BOUNDARIES, LayoutNetwork
from panoplan.layouts.network.train import answer_of
from panoplan.types.arrays import FloatArray

KNOTS_CH = (0.4, 0.85, 1.2, 1.7, 2.35, 3.3, 5.0)
"""Distances, in camera heights, at which the factor is known; linear in the elevation between."""
_QUANTILE = 0.9
_LEAST_COLUMNS = 200


class Widening(nn.Module):
    """Adds to a logarithmic scale what it lacks at an elevation.

    Args:
        log_factors: at the knots.
    """

    def __init__(self, log_factors: FloatArray) -> None:
        super().__init__()
        places = torch.from_numpy(knots()).float()
        values = torch.as_tensor(np.asarray(log_factors), dtype=torch.float32)
        slopes = values.diff() / places.diff()
        bends = torch.cat([slopes[:1], slopes.diff()])
        for name, value in (("knots", places), ("first", values[:1]), ("bends", bends)):
            self.register_buffer(name, value)

    def forward(self, log_scale: Tensor, elevation: Tensor) -> Tensor:
        """(B, W) widened logarithm of scales at elevations (B, W) in rad."""
        within = torch.clamp(elevation, float(self.knots[0]), float(self.knots[-1]))
        past = torch.relu(within[..., None] - self.knots[:-1])
        return log_scale + self.first + (past * self.bends).sum(dim=-1)


@torch.inference_mode()
def widening(
    network: LayoutNetwork, folder: Path, numbers: list[int], *, tuned: bool
) -> FloatArray:
    """Logarithms of the factors at `KNOTS_CH`.

    With them nine of ten columns whose edge is told to be about so far lie at least as close as
    nine of ten draws of the stated Laplace distribution. No scale is narrowed: photographs are
    harder than renders.

    Args:
        network: trained.
        folder: of shards with features.
        numbers: of shards that were not trained on.
        tuned: False where the trunk is ImageNet's, whose features are kept.

    Returns:
        (K,); where few columns are so far, as at the knot before.
    """
    places, ratios = [], []
    for *features, targets in batches(folder, numbers, 32, None):
        answer = answer_of(network, features, tuned=tuned)
        error = (answer[:, 0] - targets[:, 0]).abs()
        places.append(answer[:, 0].flatten().numpy())
        ratios.append((error * torch.exp(-answer[:, BOUNDARIES])).flatten().numpy())
    place, ratio = np.concatenate(places), np.concatenate(ratios)
    nearest = np.abs(place[:, None] - knots()).argmin(axis=1)
    factors = [1.0]
    for k in range(len(KNOTS_CH)):
        own = ratio[nearest == k]
        if len(own) < _LEAST_COLUMNS:
            factors.append(factors[-1])
        else:
            factors.append(max(float(np.quantile(own, _QUANTILE) / -np.log(1 - _QUANTILE)), 1.0))
    return np.log(factors[1:])


def knots() -> FloatArray:
    """(K,) elevations of the knots, rad, ascending."""
    return np.asarray(-np.arctan(1 / np.array(KNOTS_CH)))
