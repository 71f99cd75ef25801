"""One picture of a surface from several views of it: no seams, no holes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from panoplan.types.arrays import BoolArray, FloatArray

_CHOOSE = 8.0
"""Power of the weights by which detail is chosen: nearly all of it from the best view."""

_COARSE = 16
"""Texels a block of the coarse pictures: what is larger is blended softly."""


@dataclass(frozen=True, eq=False)
class SurfaceView:
    """A surface as one camera shows it.

    Attributes:
        colours: (H, W, 3) 0-255.
        weights: (H, W) how good a view of each texel it is, 0 where it shows it not.
    """

    colours: FloatArray
    weights: FloatArray


def blended(views: Sequence[SurfaceView]) -> tuple[FloatArray, BoolArray]:
    """Joins views: brightness and tint softly over all of them, detail from the best.

    Args:
        views: one or more of one size.

    Returns:
        (H, W, 3) colours, and (H, W) where any view shows the surface.
    """
    best = np.max([view.weights for view in views], axis=0)
    seen = best > 0
    share = np.where(seen, best, 1.0)
    soft = np.zeros(best.shape)
    hard = np.zeros(best.shape)
    base, detail = np.zeros((*best.shape, 3)), np.zeros((*best.shape, 3))
    for view in views:
        shown = view.weights > 0
        coarse = low_pass(view.colours, shown)
        relative = view.weights / share
        soft += relative
        base += relative[..., None] * coarse
        chosen = relative**_CHOOSE
        hard += chosen
        detail += chosen[..., None] * np.where(shown[..., None], view.colours - coarse, 0.0)
    colours = base / np.maximum(soft, 1e-12)[..., None]
    colours += detail / np.maximum(hard, 1e-12)[..., None]
    return np.clip(colours, 0.0, 255.0), seen


def filled(colours: FloatArray, known: BoolArray) -> FloatArray:
    """(H, W, 3) colours with what is not known taken from around it, softly.

    Args:
        colours: (H, W, 3).
        known: (H, W), somewhere true.
    """
    out = np.where(known[..., None], colours, 0.0)
    holes = ~known
    if not holes.any():
        return out
    # The nearest known colour, then the softer the farther inside the hole.
    nearest = ndimage.distance_transform_edt(holes, return_distances=False, return_indices=True)
    out = out[tuple(nearest)]
    soft = low_pass(out, np.ones_like(known))
    inside = np.clip(ndimage.distance_transform_edt(holes) / _COARSE, 0.0, 1.0)[..., None]
    return np.asarray(np.where(holes[..., None], (1 - inside) * out + inside * soft, out))


def low_pass(colours: FloatArray, known: BoolArray) -> FloatArray:
    """(H, W, 3) smooth colours over the known ones, also a little beyond them."""
    height, width = known.shape
    rows, columns = (-(-size // _COARSE) for size in (height, width))
    # Colours times how much is known, and that itself beside them.
    values = np.zeros((rows * _COARSE, columns * _COARSE, 4))
    values[:height, :width, :3] = np.where(known[..., None], colours, 0.0)
    values[:height, :width, 3] = known
    blocks = values.reshape(rows, _COARSE, columns, _COARSE, 4).mean(axis=(1, 3))
    total = ndimage.gaussian_filter(blocks, (1.0, 1.0, 0.0))
    mean = total[..., :3] / np.maximum(total[..., 3:], 1e-9)
    v = np.clip((np.arange(height) + 0.5) / _COARSE - 0.5, 0, rows - 1)
    u = np.clip((np.arange(width) + 0.5) / _COARSE - 0.5, 0, columns - 1)
    return _upsampled(mean, v, u)


def _upsampled(coarse: FloatArray, v: FloatArray, u: FloatArray) -> FloatArray:
    """Bilinear values of a coarse picture at rows v and columns u."""
    i, j = np.floor(v).astype(np.intp), np.floor(u).astype(np.intp)
    below, right = np.minimum(i + 1, len(coarse) - 1), np.minimum(j + 1, coarse.shape[1] - 1)
    b, a = (v - i)[:, None, None], (u - j)[None, :, None]
    between = coarse[i] * (1 - b) + coarse[below] * b
    return np.asarray(between[:, j] * (1 - a) + between[:, right] * a)
