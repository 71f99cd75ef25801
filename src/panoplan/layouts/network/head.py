"""From features to boundaries: heights are folded into channels, columns speak with all others.

Source: the idea of one token a column, with the panorama closed in itself, is HorizonNet's (Sun et
al., 2019); its recurrent layer is replaced by attention with a learned bias of the angle between.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import Tensor, nn

from panoplan.layouts.network.trunk import CHANNELS, Trunk

TOKENS = 64
"""Columns that attend to one another, for a panorama 512 wide."""
COLUMNS = 512
"""Columns of the answer."""
OUTPUTS = (
    "floor",
    "through",
    "ceiling",
    "log_floor_scale",
    "log_through_scale",
    "log_ceiling_scale",
    "corner",
    "door",
    "opening",
    "window",
)
"""Rows of the answer: elevations in rad, logarithms of Laplace scales in rad, logits."""
BOUNDARIES = 3
_DEEP_ROWS = 8
_SURE = 10.0
_DIM, _HEADS, _LAYERS = 224, 4, 3
_FOLDED = (48, 64, 96)
_START = (-0.6, -0.55, 0.5)


def wrapped(x: Tensor, border: int) -> Tensor:
    """Columns with a border of those from the other side."""
    return torch.cat([x[..., -border:], x, x[..., :border]], dim=-1)


class _Fold(nn.Module):
    """Halves the height until four rows are left, and makes channels of them."""

    def __init__(self, inputs: int, channels: int, halvings: int) -> None:
        super().__init__()
        sizes = [inputs if halvings > 1 else channels, *([channels] * halvings)]
        self.narrow = nn.Conv2d(inputs, channels, 1) if halvings == 1 else None
        self.convs = nn.ModuleList(
            nn.Conv2d(a, b, 3, stride=(2, 1), padding=(1, 0)) for a, b in pairwise(sizes)
        )

    def forward(self, x: Tensor) -> Tensor:
        if self.narrow is not None:
            x = nn.functional.relu(self.narrow(x))
        for conv in self.convs:
            x = nn.functional.relu(conv(wrapped(x, 1)))
        return x.flatten(1, 2)


class _Attention(nn.Module):
    """Self-attention of columns on a circle, and a feed-forward layer."""

    def __init__(self) -> None:
        super().__init__()
        self.norms = nn.ModuleList([nn.LayerNorm(_DIM), nn.LayerNorm(_DIM)])
        self.mix = nn.Linear(_DIM, 3 * _DIM)
        self.out = nn.Linear(_DIM, _DIM)
        self.wide = nn.Linear(_DIM, 2 * _DIM)
        self.narrow = nn.Linear(2 * _DIM, _DIM)
        self.bias = nn.Parameter(torch.zeros(_HEADS, TOKENS))
        place = torch.arange(TOKENS)
        self.register_buffer("apart", (place[None] - place[:, None]) % TOKENS, persistent=False)

    def forward(self, x: Tensor) -> Tensor:
        batch = x.shape[0]
        parts = self.mix(self.norms[0](x)).view(batch, TOKENS, 3, _HEADS, _DIM // _HEADS)
        query, key, value = parts.permute(2, 0, 3, 1, 4)
        score = query @ key.transpose(-1, -2) * (_DIM // _HEADS) ** -0.5
        share = torch.softmax(score + self.bias[:, self.apart], dim=-1)
        x = x + self.out((share @ value).transpose(1, 2).reshape(batch, TOKENS, _DIM))
        return x + self.narrow(nn.functional.gelu(self.wide(self.norms[1](x)), approximate="tanh"))


class _Widen(nn.Module):
    """Twice as many columns."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.conv = nn.Conv1d(inputs, 2 * outputs, 5)
        self.outputs = outputs

    def forward(self, x: Tensor) -> Tensor:
        batch, _, width = x.shape
        pair = self.conv(wrapped(x, 2)).view(batch, 2, self.outputs, width)
        return nn.functional.relu(pair.permute(0, 2, 3, 1).reshape(batch, self.outputs, 2 * width))


class Head(nn.Module):
    """Boundaries, their uncertainty, corners and spans from the trunk's features."""

    def __init__(self) -> None:
        super().__init__()
        self.folds = nn.ModuleList(
            _Fold(channels, folded, halvings)
            for channels, folded, halvings in zip(CHANNELS, _FOLDED, (3, 2, 1), strict=True)
        )
        self.join = nn.Conv1d(4 * sum(_FOLDED), _DIM, 1)
        self.near = nn.Conv1d(_DIM, _DIM, 5, groups=_HEADS)
        self.layers = nn.ModuleList(_Attention() for _ in range(_LAYERS))
        self.widen = nn.ModuleList([_Widen(_DIM, 96), _Widen(96, 48), _Widen(48, 32)])
        self.answer = nn.Conv1d(32, len(OUTPUTS), 3)
        with torch.no_grad():
            self.answer.bias.zero_()
            self.answer.bias[:BOUNDARIES] = torch.tensor(_START)
            self.answer.bias[BOUNDARIES : 2 * BOUNDARIES] = -2.5
            self.answer.bias[2 * BOUNDARIES :] = -2.0

    def forward(self, shallow: Tensor, middle: Tensor, deep: Tensor) -> Tensor:
        """(B, len(OUTPUTS), COLUMNS) from features at strides 8, 16 and 32."""
        columns = []
        for fold, x in zip(self.folds, (shallow, middle, deep), strict=True):
            y = fold(x)
            columns.append(_spread(y, TOKENS // y.shape[-1]))
        x = nn.functional.relu(self.join(torch.cat(columns, dim=1)))
        x = x + nn.functional.relu(self.near(wrapped(x, 2)))
        x = x.transpose(1, 2)
        for layer in self.layers:
            x = layer(x)
        x = x.transpose(1, 2)
        for widen in self.widen:
            x = widen(x)
        return self.answer(wrapped(x, 1))


class Heads(nn.Module):
    """Several heads that answer as one.

    Boundaries are averaged, each head's as it is sure of them; the scale tells how unsure the heads
    are and how far they disagree. Corners and spans are the last head's.

    Args:
        heads: trained apart, on the same features.
    """

    def __init__(self, heads: Sequence[nn.Module]) -> None:
        super().__init__()
        self.heads = nn.ModuleList(heads)

    def forward(self, shallow: Tensor, middle: Tensor, deep: Tensor) -> Tensor:
        """(B, len(OUTPUTS), COLUMNS) from features at strides 8, 16 and 32."""
        answers = [head(shallow, middle, deep) for head in self.heads]
        places = torch.stack([answer[:, :BOUNDARIES] for answer in answers])
        logs = torch.stack([answer[:, BOUNDARIES : 2 * BOUNDARIES] for answer in answers])
        place = (places * torch.softmax(-logs, dim=0)).sum(dim=0)
        # The variance of Laplace's distribution is twice the square of its scale.
        square = torch.exp(2 * logs).mean(dim=0) + ((places - place) ** 2).mean(dim=0) / 2
        return torch.cat([place, torch.log(square) / 2, answers[-1][:, 2 * BOUNDARIES :]], dim=1)


def _spread(x: Tensor, factor: int) -> Tensor:
    """Columns repeated with linear transitions, around the circle."""
    if factor == 1:
        return x
    border = wrapped(x, 1)
    wide = nn.functional.interpolate(
        border, scale_factor=float(factor), mode="linear", align_corners=False
    )
    return wide[..., factor : wide.shape[-1] - factor]


class LayoutNetwork(nn.Module):
    """Trunk and head, and how sure one may be that an image is what they expect.

    Args:
        trunk: the feature extractor.
        head: what reads its features, one or several.
    """

    def __init__(self, trunk: Trunk, head: Head | Heads) -> None:
        super().__init__()
        self.trunk, self.head = trunk, head
        self.sure = nn.Linear(CHANNELS[2] * _DEEP_ROWS, 1)
        # Until it is fitted, every image is believed.
        nn.init.zeros_(self.sure.weight)
        nn.init.constant_(self.sure.bias, _SURE)

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor]:
        """What it says of normalised images (B, 3, 256, 512).

        Returns:
            (B, len(OUTPUTS), COLUMNS), and (B, 1) the logit of an upright panorama of a room.
        """
        features = self.trunk.above(self.trunk.below(image))
        return self.head(*features), self.sure(self.summary(features[-1]))

    def summary(self, deep: Tensor) -> Tensor:
        """(B, channels · rows) means over the columns of the features at stride 32."""
        return deep.mean(dim=-1).flatten(1)
