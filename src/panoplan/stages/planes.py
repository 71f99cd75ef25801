"""Wall planes from one layout (Section III-E)."""

from __future__ import annotations

import numpy as np

from panoplan.config import PlanesConfig
from panoplan.geometry.angles import line_angle
from panoplan.geometry.lines import LineFit, farthest_from_chord, ransac_line
from panoplan.types.arrays import BoolArray, FloatArray, IntArray
from panoplan.types.room import RejectedPiece, WallPiece
from panoplan.types.view import RegisteredLayout

# A boundary that runs away from the camera along the line of sight is the edge of an occlusion.
_EDGE_ON_SIN = np.sin(np.deg2rad(4.0))
# Neighbouring columns whose ranges differ by more than this factor lie on different walls.
_JUMP = 1.2


def wall_pieces(
    view: RegisteredLayout, config: PlanesConfig, rng: np.random.Generator
) -> tuple[tuple[WallPiece, ...], tuple[RejectedPiece, ...]]:
    """Splits a boundary into walls, fits a plane to each and rejects what fits none.

    Args:
        view: the registered layout.
        config: settings.
        rng: draws RANSAC's pairs.

    Returns:
        The pieces that lie on a plane, and those rejected with the reason.

    Source: Section III-E.
    """
    walls: list[WallPiece] = []
    rejected: list[RejectedPiece] = []
    columns_needed = max(2, round(config.min_columns * len(view.boundary) / 1024))
    pending = split(view, config)[::-1]
    while pending:
        columns = pending.pop()
        points = view.boundary[columns]
        span = (int(columns[0]), int(columns[-1]))
        if len(columns) < columns_needed:
            rejected.append(RejectedPiece(view.keyframe, span, "too few columns"))
            continue
        if np.median(np.linalg.norm(points - view.camera, axis=1)) > config.max_range_ch:
            rejected.append(RejectedPiece(view.keyframe, span, "too far"))
            continue
        pairs = rng.integers(0, len(points), size=(config.iterations, 2))
        fit = ransac_line(points, pairs, config.max_residual_ch)
        if fit is None or fit.inliers.mean() < config.min_inlier_ratio:
            halves = _halves(columns, points, config) if config.resplit else []
            if halves:
                pending.extend(half for half in reversed(halves))
            else:
                rejected.append(RejectedPiece(view.keyframe, span, "no plane fits"))
            continue
        wall = _wall(view, points, fit)
        if wall is None:
            rejected.append(RejectedPiece(view.keyframe, span, "seen edge-on"))
        else:
            walls.append(wall)
    return tuple(walls), tuple(rejected)


def split(view: RegisteredLayout, config: PlanesConfig) -> list[IntArray]:
    """Column runs S_0, ..., S_k between corners, unknown columns and jumps of range.

    Args:
        view: the registered layout; without corners the run is one, to be split by curvature.
        config: settings; corners may be merged.

    Returns:
        Runs of neighbouring columns in image order; a run may wrap around the image's edge.
    """
    width = len(view.boundary)
    distance = np.linalg.norm(view.boundary - view.camera, axis=1)
    with np.errstate(invalid="ignore"):
        known: BoolArray = np.isfinite(distance)
        ratio = distance / np.roll(distance, 1)
        cut = ~known | ~np.roll(known, 1) | (ratio > _JUMP) | (ratio < 1 / _JUMP)
    if view.corners is not None:
        nearer = config.merge_corners_columns * width / 1024
        cut[np.ceil(merged_corners(view.corners, nearer, width)).astype(int) % width] = True
    starts = np.flatnonzero(cut)
    if len(starts) == 0:
        starts = np.array([int(np.argmax(distance))])
    runs = []
    for first, last in zip(starts, np.append(starts[1:], starts[0] + width), strict=True):
        columns = np.arange(first, last) % width
        columns = columns[known[columns]]
        if len(columns):
            runs.append(columns)
    return runs


def merged_corners(corners: FloatArray, nearer: float, width: int) -> FloatArray:
    """Corners, each run of neighbours nearer than `nearer` columns replaced by its mean.

    Args:
        corners: (K,) columns in [0, width), sorted.
        nearer: columns; 0 merges none.
        width: of the image, at whose edge columns go on.

    Returns:
        (M,) columns in [0, width), sorted.
    """
    if nearer <= 0 or len(corners) < 2:
        return corners
    gaps = np.diff(corners, append=corners[0] + width)
    # Counted from behind the widest gap, no run crosses the image's edge.
    first = (int(np.argmax(gaps)) + 1) % len(corners)
    rolled = np.roll(corners, -first)
    rolled = np.where(rolled < rolled[0], rolled + width, rolled)
    runs = np.split(rolled, np.flatnonzero(np.diff(rolled) >= nearer) + 1)
    return np.sort(np.array([run.mean() for run in runs]) % width)


def _halves(columns: IntArray, points: FloatArray, config: PlanesConfig) -> list[IntArray]:
    at, bend = farthest_from_chord(points)
    if bend <= config.max_residual_ch or at in (0, len(points) - 1):
        return []
    return [columns[:at], columns[at:]]


def _wall(view: RegisteredLayout, points: FloatArray, fit: LineFit) -> WallPiece | None:
    inliers = points[fit.inliers]
    distance = abs(float(fit.normal @ view.camera) - fit.offset)
    middle = inliers.mean(axis=0) - view.camera
    if distance < _EDGE_ON_SIN * float(np.linalg.norm(middle)):
        return None
    along = np.array([-fit.normal[1], fit.normal[0]])
    reach = inliers @ along
    ends = fit.offset * fit.normal + np.array([[reach[0]], [reach[-1]]]) * along
    return WallPiece(
        keyframe=view.keyframe,
        ends=ends,
        direction=float(line_angle(np.arctan2(along[1], along[0]))),
        distance=distance,
        points=inliers,
    )
