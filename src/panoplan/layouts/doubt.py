"""Whether a panorama and what a network says of it can be believed."""

from __future__ import annotations

import numpy as np

from panoplan.formats.image import Pixels, resized
from panoplan.layouts.dense import Dense

_SIZE = (512, 256)
_LEAST_RANGE = 10.0
_SEAM_RATIO = 4.0
_LEAST_STEP = 2.0
_POLE_SPREAD = 5.0
_LEAST_CONFIDENCE = 0.5
_LARGEST_SIGMA_DEG = 15.0
_LEAST_KNOWN = 0.25
_CEILING_RATIOS = (0.15, 1.25)


def image_doubt(pixels: Pixels) -> str | None:
    """Why an image cannot be a panorama of a room, from its pixels alone.

    A panorama goes on from its right edge to its left one, and each of its first and last rows
    is a single direction. Over 32 real panoramas the step across the edges is at most 3 times the
    median step between columns; a perspective photo's step is among the largest of its columns,
    and its rows vary at both poles.

    Args:
        pixels: (H, W, 3) RGB.

    Returns:
        The reason, or None.
    """
    grey = resized(pixels, *_SIZE).astype(np.float64).mean(axis=2)
    low, high = np.percentile(grey, [5, 95])
    if high - low < _LEAST_RANGE:
        return "an image of one colour"
    steps = np.abs(grey - np.roll(grey, 1, axis=1)).mean(axis=0)
    usual, large = np.percentile(steps, [50, 98])
    seam = steps[0] > max(_SEAM_RATIO * usual, large, _LEAST_STEP)
    if seam and min(grey[0].std(), grey[-1].std()) > _POLE_SPREAD:
        return "no panorama: its edges do not meet and its poles are no single colours"
    return None


def answer_doubt(dense: Dense) -> str | None:
    """Why a network's answer says nothing of a room.

    Args:
        dense: what it says of a panorama.

    Returns:
        The reason, or None.
    """
    if dense.confidence is not None and dense.confidence < _LEAST_CONFIDENCE:
        return f"the network doubts the image (confidence {dense.confidence:.2f})"
    known = np.isfinite(dense.floor) & (dense.floor < 0)
    if known.mean() < _LEAST_KNOWN:
        return f"a floor in only {100 * known.mean():.0f} % of the columns"
    if dense.sigma is not None:
        spread = float(np.degrees(np.median(dense.sigma[known])))
        if not spread <= _LARGEST_SIGMA_DEG:
            return f"the network is unsure of the floor (median sigma {spread:.0f}°)"
    if dense.ceiling is not None:
        ratio = np.nanmedian(np.tan(dense.ceiling[known]) / np.tan(-dense.floor[known]))
        if not _CEILING_RATIOS[0] <= ratio <= _CEILING_RATIOS[1]:
            return (
                f"a ceiling {ratio:.2f} times as far above the camera as the floor below: "
                "upside down?"
            )
    return None
