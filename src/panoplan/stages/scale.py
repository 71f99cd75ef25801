"""Relative scale recovery by entropy minimisation (Section III-C, Eq. 3-4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from panoplan.config import ScaleConfig
from panoplan.geometry.density import registered_entropy
from panoplan.geometry.polar import intruding_shares, range_profile
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.plan import ScaleEstimate
from panoplan.types.view import CastLayout

_SUB_STEP_RESOLUTION = 0.002
_BEAM = 3
_AROUND = 10
_JACKKNIFE_MIN = 4
_JACKKNIFE_PARTS = 10
_JACKKNIFE_REACH = 0.05
_RIVALS = 5
_PROBES = 64
_INSIDE_CH, _INSIDE_SHARE = 0.25, 0.15
"""A point lies in a view's region where it is nearer than the boundary by this, and this share."""


@dataclass(frozen=True, eq=False)
class _Points:
    """What is computed from: N views of C columns, their regions, and fewer columns of each."""

    offsets: FloatArray
    sectors: IntArray
    sector_weights: FloatArray
    positions: FloatArray
    rises: FloatArray
    profiles: FloatArray
    probes: FloatArray


class _Objective:
    """A function of candidates in step units; each is computed once."""

    def __init__(self, function: Callable[[FloatArray], FloatArray]) -> None:
        self.function = function
        self.known: dict[float, float] = {}

    def __call__(self, candidates: FloatArray) -> FloatArray:
        fresh = np.array([k for k in candidates if k not in self.known])
        if fresh.size:
            self.known.update(zip(fresh, self.function(fresh), strict=True))
        return np.array([self.known[k] for k in candidates])


def median_step(views: Sequence[CastLayout]) -> float:
    """Median distance between successive cameras in trajectory units; 0 for fewer than two."""
    if len(views) < 2:
        return 0.0
    positions = np.array([view.position_su for view in views])
    return float(np.median(np.linalg.norm(np.diff(positions, axis=0), axis=1)))


def recover_scale(views: Sequence[CastLayout], config: ScaleConfig) -> ScaleEstimate:
    """The scale at which the registered boundaries lie most sharply on one another.

    Between optima it counts, too, how much of one view's boundary another sees through; the optimum
    itself is that of the entropy.

    Args:
        views: at least two layouts of one walk, not all from one spot.
        config: settings.

    Returns:
        The scale s in camera heights a trajectory unit with the objective's curve; `ch_per_su`
        is None where no view has a known column or the camera did not move.

    Source: Eq. 3-4; docs/deviations.md.
    """
    points = _points(views, config)
    unit = median_step(views) if config.step_unit == "keyframe_step" else 1.0
    if unit <= 0.0 or not (points.sectors >= 0).any():
        return ScaleEstimate(None, "unknown", converged=False, keyframes_used=len(views))
    windows = _windows(len(views), config)

    def entropy(windows: list[tuple[int, int]]) -> _Objective:
        return _Objective(lambda k: _mean_entropy(points, windows, k / unit, config))

    sharpness = entropy(windows)
    objective = _Objective(lambda k: sharpness(k) + _intrusion(points, windows, k / unit, config))
    low, high = _range(points, config)
    levels = _coarse_to_fine(objective if config.intrusion else sharpness, low, high, config)
    best, step = levels[-1], config.steps[-1]
    if config.combine == "mean":
        alone = (_coarse_to_fine(entropy([window]), low, high, config) for window in windows)
        best = float(np.mean([*alone]))
    if config.sub_step:
        best, step = _sub_step(sharpness, best, step, low, high)
    candidates = np.array(sorted(sharpness.known))
    curve = np.stack([candidates / unit, objective(candidates)], axis=1)
    curve.setflags(write=False)
    return ScaleEstimate(
        ch_per_su=best / unit,
        method="entropy",
        search_range=(low / unit, high / unit),
        curve=curve,
        at_edge=best <= low + step or best >= high - step,
        converged=False,
        keyframes_used=len(views),
    )


def scale_sigma(
    views: Sequence[CastLayout], estimate: ScaleEstimate, config: ScaleConfig
) -> float | None:
    """How uncertain a recovered scale is.

    Jackknife: the scale is found anew without one stretch of the walk at a time, near the one
    found with all of it, or at another optimum where that is then the better one.

    Args:
        views: those that the scale was recovered from.
        estimate: as `recover_scale` gave it, with a scale.
        config: settings.

    Returns:
        Relative standard deviation; None for fewer than four views, too few to leave any out, and
        where `sub_step` is off: then the step of the search says more than the data.

    Source: docs/deviations.md; not in the paper.
    """
    if len(views) < _JACKKNIFE_MIN or not config.sub_step:
        return None
    assert estimate.ch_per_su is not None
    near = 1.0 + _JACKKNIFE_REACH * np.linspace(-1.0, 1.0, 17)
    rivals = _rivals(estimate)
    ratios = np.concatenate([near, rivals])
    found = []
    for left_out in np.array_split(np.arange(len(views)), min(_JACKKNIFE_PARTS, len(views))):
        rest = [view for k, view in enumerate(views) if k not in left_out]
        points, windows = _points(rest, config), _windows(len(rest), config)
        scales = estimate.ch_per_su * ratios
        sharpness = _mean_entropy(points, windows, scales, config)
        objective = sharpness + _intrusion(points, windows, scales, config)
        best = int(np.argmin(objective))
        found.append(ratios[best] if best >= len(near) else _vertex(near, sharpness[: len(near)]))
    off = np.array(found) - 1.0
    # Where the parts agree with one another and not with the whole, that is no certainty.
    if abs(off.mean()) < _JACKKNIFE_REACH / 2:
        off -= off.mean()
    return float(np.sqrt((len(off) - 1) * np.mean(off**2)))


def _rivals(estimate: ScaleEstimate) -> FloatArray:
    """The lowest optima of the objective elsewhere, relative to the scale found."""
    assert estimate.curve is not None
    assert estimate.ch_per_su is not None
    ratios, values = estimate.curve[:, 0] / estimate.ch_per_su, estimate.curve[:, 1]
    before, after = np.roll(values, 1), np.roll(values, -1)
    before[0] = after[-1] = np.inf
    lowest = (values <= before) & (values <= after) & (np.abs(ratios - 1.0) > _JACKKNIFE_REACH)
    optima = np.flatnonzero(lowest)
    return np.asarray(ratios[optima[np.argsort(values[optima], kind="stable")[:_RIVALS]]])


def _vertex(at: FloatArray, values: FloatArray) -> float:
    """Lowest point of a parabola through the values around the smallest one."""
    middle = int(np.clip(np.argmin(values), 3, len(at) - 4))
    part = slice(middle - 3, middle + 4)
    a, b, _ = np.polyfit(at[part] - at[middle], values[part], 2)
    lowest = at[middle] - b / (2 * a) if a > 0 else at[int(np.argmin(values))]
    return float(np.clip(lowest, at[0], at[-1]))


def _points(views: Sequence[CastLayout], config: ScaleConfig) -> _Points:
    offsets, sectors, shares = [], [], []
    for view in views:
        width = len(view.offsets)
        tangent = _tangent(view.offsets)
        keep = np.unique(
            np.linspace(0, width, min(config.columns, width), endpoint=False).astype(int)
        )
        near = np.hypot(view.offsets[:, 0], view.offsets[:, 1]) <= config.max_range_ch
        facing = np.mod(tangent, 2 * np.pi) * config.facings / (2 * np.pi)
        usable = near & np.isfinite(facing)
        first = np.where(usable, np.floor(np.where(usable, facing, 0.0)), -1.0)
        offsets.append(view.offsets[keep])
        sectors.append(np.where(first >= config.facings, 0, first)[keep].astype(np.int64))
        shares.append(
            np.where(usable, 1.0 - (facing - first), 0.0)[keep]
            if config.facings > 1
            else np.ones(len(keep))
        )
    return _Points(
        offsets=np.array(offsets),
        sectors=np.array(sectors),
        sector_weights=np.array(shares),
        positions=np.array([view.position_su for view in views]),
        rises=np.array([view.rise_su for view in views]),
        profiles=np.array([range_profile(view.offsets) for view in views]),
        probes=np.array([_probes(view.offsets, config) for view in views]),
    )


def _probes(offsets: FloatArray, config: ScaleConfig) -> FloatArray:
    """A few columns spread over a view, NaN where unknown or too far."""
    few = offsets[np.linspace(0, len(offsets), _PROBES, endpoint=False).astype(int)]
    near = np.hypot(few[:, 0], few[:, 1]) <= config.max_range_ch
    return np.where(near[:, None], few, np.nan)


def _tangent(offsets: FloatArray) -> FloatArray:
    """Direction of the boundary at each column (rad), along which the room lies on one side."""
    reach = max(1, len(offsets) // 128)
    along = np.roll(offsets, -reach, axis=0) - np.roll(offsets, reach, axis=0)
    return np.asarray(np.arctan2(along[:, 1], along[:, 0]))


def _windows(count: int, config: ScaleConfig) -> list[tuple[int, int]]:
    if count <= config.window:
        return [(0, count)]
    last = count - config.window
    starts = [*range(0, last, config.window_stride), last]
    return [(start, start + config.window) for start in starts]


def _mean_entropy(
    points: _Points, windows: list[tuple[int, int]], scales: FloatArray, config: ScaleConfig
) -> FloatArray:
    total = np.zeros(len(scales))
    for start, stop in windows:
        for cell in config.cells_ch:
            for sign in (1, -1) if config.control else (1,):
                total += sign * registered_entropy(
                    points.offsets[start:stop],
                    points.sectors[start:stop],
                    points.sector_weights[start:stop],
                    sign * (points.positions[start:stop] - points.positions[start]),
                    points.rises[start:stop],
                    scales,
                    cell,
                    config.facings,
                    config.smooth,
                    config.saturation,
                )
    return total / (len(windows) * len(config.cells_ch))


def _intrusion(
    points: _Points, windows: list[tuple[int, int]], scales: FloatArray, config: ScaleConfig
) -> FloatArray:
    """Share of the points that another view of their window sees through, by its weight."""
    total = np.zeros(len(scales))
    if config.intrusion == 0.0:
        return total
    for start, stop in windows:
        total += intruding_shares(
            points.probes[start:stop],
            points.profiles[start:stop],
            points.positions[start:stop],
            points.rises[start:stop],
            scales,
            _INSIDE_CH,
            _INSIDE_SHARE,
        )
    return config.intrusion * total / len(windows)


def _range(points: _Points, config: ScaleConfig) -> tuple[float, float]:
    """Search range in step units.

    Above, two successive views no longer see a common wall: their cameras are farther apart than
    twice the upper quartile of the ranges.
    """
    if config.step_unit == "absolute":
        return config.absolute_range
    ranges = np.linalg.norm(points.offsets, axis=2)[points.sectors >= 0]
    return config.steps[-1], float(2 * np.percentile(ranges, 75))


def _coarse_to_fine(
    objective: Callable[[FloatArray], FloatArray], low: float, high: float, config: ScaleConfig
) -> list[float]:
    """Best candidate of each level; each level searches around the best few of the last."""
    around: list[float] | None = None
    best = []
    for level, step in enumerate(config.steps):
        multiples = np.arange(np.ceil(low / step), np.floor(high / step) + 1)
        candidates = np.unique(np.concatenate([[low, high], multiples * step]))
        if around is not None:
            reach = config.steps[level - 1] + step / 2
            # Below one coarse step the coarse level has seen nothing.
            below = low + config.steps[0] if level == 1 else -np.inf
            mask = candidates <= below
            for centre in around:
                mask |= np.abs(candidates - centre) <= reach
            candidates = candidates[mask]
        values = objective(candidates)
        order = np.argsort(values, kind="stable")
        best.append(float(candidates[order[0]]))
        around = [float(candidates[i]) for i in order[:_BEAM]]
    return best


def _sub_step(
    objective: Callable[[FloatArray], FloatArray], best: float, step: float, low: float, high: float
) -> tuple[float, float]:
    """Refines below the last step, then takes the vertex of a parabola through the bottom."""
    around = np.clip(step * (round(best / step) + np.arange(-_AROUND, _AROUND + 1)), low, high)
    best = float(around[np.argmin(objective(around))])
    while step > _SUB_STEP_RESOLUTION * best:
        fine = step / 4
        candidates = np.clip(best + fine * np.arange(-5, 6), low, high)
        best = float(candidates[np.argmin(objective(candidates))])
        step = fine
    nearby = np.clip(best + step * np.arange(-4, 5), low, high)
    values = objective(nearby)
    if len(np.unique(nearby)) == len(nearby):
        a, b, _ = np.polyfit(nearby - best, values, 2)
        if a > 0 and abs(b / (2 * a)) <= 4 * step:
            best -= float(b / (2 * a))
    return best, step
