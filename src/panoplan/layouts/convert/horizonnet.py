"""HorizonNet in PyTorch, its parameters named as in the checkpoints that its authors give away.

Source: Sun et al., HorizonNet, CVPR 2019, Section 3; names and shapes of the public checkpoints.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn.functional import interpolate

HEIGHT, WIDTH = 512, 1024
BACKBONES: Mapping[str, tuple[bool, tuple[int, int, int, int]]] = {
    "resnet18": (False, (2, 2, 2, 2)),
    "resnet34": (False, (3, 4, 6, 3)),
    "resnet50": (True, (3, 4, 6, 3)),
    "resnet101": (True, (3, 4, 23, 3)),
    "resnet152": (True, (3, 8, 36, 3)),
}
_COLUMNS_A_STEP = 4
_HIDDEN = 512
_SQUEEZE = 8
_MEAN, _STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)


class AroundCircle(nn.Module):
    """Pads left and right with what is on the other side."""

    def __init__(self, columns: int) -> None:
        super().__init__()
        self.columns = columns

    def forward(self, x: Tensor) -> Tensor:
        """(B, C, H, W) becomes (B, C, H, W + 2 columns)."""
        return torch.cat([x[..., -self.columns :], x, x[..., : self.columns]], dim=3)


def convolution(
    inputs: int, outputs: int, size: int, stride: int | tuple[int, int] = 1, *, bias: bool = False
) -> nn.Module:
    """A convolution that keeps the size at stride 1 and goes around the circle."""
    reach = size // 2
    conv = nn.Conv2d(inputs, outputs, size, stride, padding=(reach, 0), bias=bias)
    return nn.Sequential(AroundCircle(reach), conv) if reach else conv


class Block(nn.Module):
    """A residual block of ResNet: plain (3×3, 3×3) or bottleneck (1×1, 3×3, 1×1)."""

    def __init__(self, inputs: int, width: int, stride: int, *, bottleneck: bool) -> None:
        super().__init__()
        outputs = 4 * width if bottleneck else width
        if bottleneck:
            self.conv1 = convolution(inputs, width, 1)
            self.conv2 = convolution(width, width, 3, stride)
            self.conv3 = convolution(width, outputs, 1)
            self.bn3 = nn.BatchNorm2d(outputs)
        else:
            self.conv1 = convolution(inputs, width, 3, stride)
            self.conv2 = convolution(width, width, 3)
        self.bn1, self.bn2 = nn.BatchNorm2d(width), nn.BatchNorm2d(width)
        self.bottleneck = bottleneck
        self.downsample: nn.Module | None = None
        if stride != 1 or inputs != outputs:
            self.downsample = nn.Sequential(
                convolution(inputs, outputs, 1, stride), nn.BatchNorm2d(outputs)
            )

    def forward(self, x: Tensor) -> Tensor:
        """The block's answer, added to its input."""
        shortcut = x if self.downsample is None else self.downsample(x)
        y = torch.relu(self.bn1(self.conv1(x)))
        y = self.bn2(self.conv2(y))
        if self.bottleneck:
            y = self.bn3(self.conv3(torch.relu(y)))
        return torch.relu(y + shortcut)


class Encoder(nn.Module):
    """ResNet without its head."""

    def __init__(self, backbone: str) -> None:
        super().__init__()
        bottleneck, depths = BACKBONES[backbone]
        self.conv1 = convolution(3, 64, 7, 2)
        self.bn1 = nn.BatchNorm2d(64)
        self.maxpool = nn.MaxPool2d(3, stride=2, padding=1)
        self.channels: list[int] = []
        inputs = 64
        for k, depth in enumerate(depths):
            blocks = []
            for number in range(depth):
                stride = 2 if k and not number else 1
                blocks.append(Block(inputs, 64 * 2**k, stride, bottleneck=bottleneck))
                inputs = 64 * 2**k * (4 if bottleneck else 1)
            setattr(self, f"layer{k + 1}", nn.Sequential(*blocks))
            self.channels.append(inputs)

    def forward(self, x: Tensor) -> list[Tensor]:
        """Features at a quarter, an eighth, a sixteenth and a thirty-second of the size."""
        x = self.maxpool(torch.relu(self.bn1(self.conv1(x))))
        features = []
        for k in range(4):
            x = getattr(self, f"layer{k + 1}")(x)
            features.append(x)
        return features


class Squeeze(nn.Module):
    """Halves the height once."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            convolution(inputs, outputs, 3, (2, 1), bias=True),
            nn.BatchNorm2d(outputs),
            nn.ReLU(),
        )

    def forward(self, x: Tensor) -> Tensor:
        """(B, C, H, W) becomes (B, C', H/2, W)."""
        squeezed: Tensor = self.layers(x)
        return squeezed


class Columns(nn.Module):
    """Features of one scale, squeezed four times and widened to the number of steps."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        sizes = [channels, channels // 2, channels // 2, channels // 4, channels // _SQUEEZE]
        self.layer = nn.Sequential(*(Squeeze(a, b) for a, b in pairwise(sizes)))

    def forward(self, x: Tensor, steps: int) -> Tensor:
        """(B, C, H, W) becomes (B, C', steps)."""
        x = self.layer(x)
        factor = steps // x.shape[3]
        x = torch.cat([x[..., -1:], x, x[..., :1]], dim=3)
        size = (x.shape[2], steps + 2 * factor)
        x = interpolate(x, size=size, mode="bilinear", align_corners=False)
        return x[..., factor:-factor].flatten(1, 2)


class AllScales(nn.Module):
    """The columns of all four scales."""

    def __init__(self, channels: list[int]) -> None:
        super().__init__()
        self.ghc_lst = nn.ModuleList([Columns(c) for c in channels])

    def forward(self, features: list[Tensor], steps: int) -> Tensor:
        """(B, C, steps)."""
        return torch.cat(
            [columns(x, steps) for columns, x in zip(self.ghc_lst, features, strict=True)], dim=1
        )


class Features(nn.Module):
    """Holds the encoder under the name that checkpoints have."""

    def __init__(self, backbone: str) -> None:
        super().__init__()
        self.encoder = Encoder(backbone)


class HorizonNet(nn.Module):
    """Boundaries and corners of a panorama.

    Args:
        backbone: one of `BACKBONES`.
        use_rnn: whether columns are read by an LSTM in both directions.
    """

    mean: Tensor
    std: Tensor

    def __init__(self, backbone: str = "resnet50", use_rnn: bool = True) -> None:
        super().__init__()
        self.feature_extractor = Features(backbone)
        channels = self.feature_extractor.encoder.channels
        self.reduce_height_module = AllScales(channels)
        # Four halvings leave 8, 4, 2 and 1 rows of the four scales.
        size = sum(c // _SQUEEZE * rows for c, rows in zip(channels, (8, 4, 2, 1), strict=True))
        outputs = 3 * _COLUMNS_A_STEP
        self.use_rnn = use_rnn
        if use_rnn:
            self.bi_rnn = nn.LSTM(size, _HIDDEN, num_layers=2, bidirectional=True)
            self.linear: nn.Module = nn.Linear(2 * _HIDDEN, outputs)
        else:
            self.linear = nn.Sequential(
                nn.Linear(size, _HIDDEN), nn.ReLU(), nn.Identity(), nn.Linear(_HIDDEN, outputs)
            )
        self.register_buffer("mean", torch.tensor(_MEAN)[None, :, None, None], persistent=False)
        self.register_buffer("std", torch.tensor(_STD)[None, :, None, None], persistent=False)

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor]:
        """Looks at panoramas.

        Args:
            image: (B, 3, 512, 1024) RGB 0..1.

        Returns:
            (B, 2, 1024) ceiling and floor boundary in rad, positive downwards; (B, 1, 1024) logit
            of a corner.
        """
        features = self.feature_extractor.encoder((image - self.mean) / self.std)
        columns = self.reduce_height_module(features, WIDTH // _COLUMNS_A_STEP).permute(2, 0, 1)
        if self.use_rnn:
            columns, _ = self.bi_rnn(columns)
        answer = self.linear(columns)
        answer = answer.unflatten(2, (3, _COLUMNS_A_STEP)).permute(1, 2, 0, 3).flatten(2)
        return answer[:, 1:], answer[:, :1]
