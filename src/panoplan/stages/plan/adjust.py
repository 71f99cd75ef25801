"""Planar bundle adjustment: cameras and walls moved until they agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from panoplan.config import AdjustConfig
from panoplan.geometry.angles import line_difference
from panoplan.geometry.hits import edge_directions
from panoplan.stages.plan.pieces import Pieces, pieces_on_walls
from panoplan.types.arrays import FloatArray, IntArray
from panoplan.types.view import Correction, RegisteredLayout


@dataclass(frozen=True)
class Stretch:
    """What is known of the scale of the odometry's first steps.

    Attributes:
        factor: on the steps, to begin with.
        sigma: standard deviation of the factor about 1; 0 where `factor` holds.
    """

    factor: float = 1.0
    sigma: float = 0.0


@dataclass(frozen=True, eq=False)
class Faces:
    """Walls that may be the two faces of one: they are parallel, robustly.

    Attributes:
        one: (F,) index of a wall, counted through room by room.
        other: (F,) index of that across.
        gap_ch: distance that all faces have in common, to begin with, camera heights; None where
            it is no prior.
    """

    one: IntArray
    other: IntArray
    gap_ch: float | None = None


@dataclass(frozen=True, eq=False)
class Adjusted:
    """What an adjustment found.

    Attributes:
        corrections: of each view.
        stretch: factor on the odometry's first steps.
        covariances: (3, 3) of (x, y, turn) of the middle view of each room, by index of the view:
            how well it is known where the room lies.
    """

    corrections: tuple[Correction, ...]
    stretch: float
    covariances: dict[int, FloatArray]


@dataclass(frozen=True, eq=False)
class _Walk:
    """The odometry.

    Attributes:
        cameras: (V, 2) positions.
        steps: (V − 1,) way between them.
        first: (3,) x, y and turn at which the first camera stays.
        prior: of the factor on its first steps.
    """

    cameras: FloatArray
    steps: FloatArray
    first: FloatArray
    prior: Stretch


@dataclass(frozen=True, eq=False)
class _Walls:
    """Lines: n(angle)·(x − middle) = offset."""

    middle: FloatArray
    angle: FloatArray
    offset: FloatArray
    gap: float
    """Between the two faces of one wall."""


@dataclass(frozen=True)
class _Multiples:
    """Of the configured sigmas of the odometry.

    Attributes:
        slip: of those of its positions.
        bend: of those of its heading and scale, which bend and stretch all that follows.
    """

    slip: float
    bend: float


@dataclass(frozen=True, eq=False)
class _Fit:
    """What agrees best if the odometry errs by some multiples.

    Attributes:
        evidence: logarithm, that it errs so, but for a constant.
        state: (V, 5) unknowns of the views.
        walls: lines.
        system: all residuals there; None to begin with.
    """

    evidence: float
    state: FloatArray
    walls: _Walls
    system: _System | None


def adjust(
    views: Sequence[RegisteredLayout],
    ways: FloatArray,
    rooms: Sequence[tuple[Sequence[int], FloatArray]],
    start: Sequence[Correction],
    stretch: Stretch,
    faces: Faces,
    reach_ch: float,
    config: AdjustConfig,
) -> Adjusted:
    """Moves cameras and walls until the layouts agree with one another and with the odometry.

    Unknown are each camera's position, heading, the factor of its ranges and that of the odometry's
    step from it, which changes slowly, and the line of each wall. Columns near a wall of their room
    pull at it, robustly; from camera to camera the odometry holds, and the first one stays. How
    much the odometry errs is taken from the data: the multiples of the configured sigmas with most
    evidence (Laplace's approximation), so that true poses stay where they are.

    Args:
        views: in the order of the walk, where the odometry has them.
        ways: (V,) way gone to each, camera heights, increasing.
        rooms: indices of the views of each room, and its outline (N, 2), as found after `start`.
        start: corrections to begin with; that of the first view is kept.
        stretch: what is known of the scale of the odometry's steps.
        faces: of the rooms' walls.
        reach_ch: columns this near to a wall take part.
        config: settings.

    Returns:
        The corrections, and how sure they are.

    Source: docs/deviations.md, "Past the paper".
    """
    pieces = pieces_on_walls(views, rooms, start, reach_ch, config)
    walls = _walls_of([ring for _, ring in rooms], faces.gap_ch or 0.0)
    count = len(views)
    if len(pieces.view) == 0 or count < 2:
        return Adjusted(tuple(start), stretch.factor, {})
    stretched = np.log(stretch.factor)
    state = np.array([(*c.shift, c.turn, np.log(c.factor), stretched) for c in start])
    cameras = np.array([view.camera for view in views])
    walk = _Walk(cameras, np.diff(ways), state[0, :3].copy(), stretch)
    found = _most_evident(_Fit(-np.inf, state, walls, None), walk, pieces, faces, config)
    assert found.system is not None
    middles = sorted({members[len(members) // 2] for members, _ in rooms if len(members)})
    return Adjusted(
        tuple(
            Correction((float(x), float(y)), float(turned), float(np.exp(factor)))
            for x, y, turned, factor, _ in found.state
        ),
        float(np.exp(found.state[0, 4])),
        dict(zip(middles, found.system.covariances(_VIEW * np.array(middles)), strict=True)),
    )


_VIEW = 5
"""Unknowns of a view: x, y, turn, log of the factor on its ranges, of that on the step from it."""


def _most_evident(
    begun: _Fit, walk: _Walk, pieces: Pieces, faces: Faces, config: AdjustConfig
) -> _Fit:
    """The fit with most evidence: first over common multiples, then over those of the bend."""

    def fitted(near: _Fit, slip: float, bend: float, iterations: int) -> _Fit:
        multiples = _Multiples(slip, bend)
        return _fitted(near, walk, pieces, faces, multiples, iterations, config)

    best = latest = begun
    slip, falling = 1.0, 0
    for multiple in config.odometry_multiples:
        latest = fitted(latest, multiple, multiple, config.iterations)
        if latest.evidence > best.evidence:
            best, slip, falling = latest, multiple, 0
        else:
            falling += 1
        if falling == _FALLING:
            break
    for factor in (_BEND_STEP, 1.0 / _BEND_STEP):
        before, bend = best, slip * factor
        for _ in range(_BEND_STEPS):
            tried = fitted(best, slip, bend, (config.iterations + 1) // 2)
            if tried.evidence <= best.evidence:
                break
            best, bend = tried, bend * factor
        if best is not before:
            break
    return best


_FALLING = 2
"""The evidence has one peak: after so many falls it is behind."""
_BEND_STEP = 2.0
_BEND_STEPS = 4
"""Multiples of the bend are tried in such steps, at most so many: a factor of 16."""


def _fitted(
    near: _Fit,
    walk: _Walk,
    pieces: Pieces,
    faces: Faces,
    multiples: _Multiples,
    iterations: int,
    config: AdjustConfig,
) -> _Fit:
    state, walls = near.state, near.walls
    for _ in range(iterations):
        system = _system(state, walls, walk, pieces, faces, multiples, config)
        state, walls = _moved(state, walls, system.solve())
    system = _system(state, walls, walk, pieces, faces, multiples, config)
    steps = len(state) - 1
    # Two sigmas of a step are of slip, two of bend.
    evidence = system.evidence() - 2 * steps * np.log(multiples.slip * multiples.bend)
    return _Fit(float(evidence), state, walls, system)


def _walls_of(rings: Sequence[FloatArray], gap: float) -> _Walls:
    """The lines of all walls as they are."""
    if not rings:
        return _Walls(np.empty((0, 2)), np.empty(0), np.empty(0), gap)
    middles = np.concatenate([(ring + np.roll(ring, -1, axis=0)) / 2 for ring in rings])
    along = np.concatenate([edge_directions(ring)[0] for ring in rings])
    angles = np.arctan2(-along[:, 0], along[:, 1])
    return _Walls(middles, angles, np.zeros(len(angles)), gap)


def _moved(state: FloatArray, walls: _Walls, step: FloatArray) -> tuple[FloatArray, _Walls]:
    views = step[: state.size].reshape(-1, _VIEW)
    lines = step[state.size : -1].reshape(-1, 2)
    return state + views, replace(
        walls,
        angle=walls.angle + lines[:, 0],
        offset=walls.offset + lines[:, 1],
        gap=walls.gap + float(step[-1]),
    )


def _system(
    state: FloatArray,
    walls: _Walls,
    walk: _Walk,
    pieces: Pieces,
    faces: Faces,
    multiples: _Multiples,
    config: AdjustConfig,
) -> _System:
    """All residuals, linearised."""
    system = _System(state.size + 2 * len(walls.angle) + 1)
    _add_walls(system, state, walls, walk.cameras, pieces, config)
    _add_odometry(system, state, walk, multiples, config)
    _add_faces(system, state.size, walls, faces, config)
    return system


class _System:
    """Sparse normal equations, gathered residual by residual."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.cost = 0.0
        self._rows: list[NDArray[np.int32]] = []
        self._columns: list[NDArray[np.int32]] = []
        self._values: list[FloatArray] = []
        self._right = np.zeros(size)

    def add(
        self, columns: IntArray, jacobian: FloatArray, residual: FloatArray, cost: float
    ) -> None:
        """Adds N residuals.

        Args:
            columns: (N, K) unknowns that each depends on.
            jacobian: (N, K) derivatives, over sigma.
            residual: (N,) over sigma.
            cost: minus twice their log-likelihood.
        """
        width = columns.shape[1]
        self.cost += cost
        small = columns.astype(np.int32)
        self._rows.append(np.repeat(small, width, axis=1).ravel())
        self._columns.append(np.tile(small, (1, width)).ravel())
        self._values.append((jacobian[:, :, None] * jacobian[:, None, :]).ravel())
        np.add.at(self._right, columns, -jacobian * residual[:, None])

    def covariances(self, firsts: IntArray) -> list[FloatArray]:
        """(3, 3) of each three unknowns in a row, by the first of them."""
        wanted = firsts[:, None] + np.arange(3)
        right = np.zeros((self.size, wanted.size))
        right[wanted.ravel(), np.arange(wanted.size)] = 1.0
        columns = self._factorised().solve(right).reshape(self.size, *wanted.shape)
        return [columns[rows, k] for k, rows in enumerate(wanted)]

    def _factorised(self) -> Any:
        rows, columns, values = (
            np.concatenate(part) for part in (self._rows, self._columns, self._values)
        )
        every = np.arange(self.size, dtype=np.int32)
        damped = np.full(self.size, _DAMPING)
        normal = coo_array(
            (
                np.concatenate([values, damped]),
                (np.concatenate([rows, every]), np.concatenate([columns, every])),
            ),
            shape=(self.size, self.size),
        ).tocsc()
        return splu(
            normal,
            permc_spec="MMD_AT_PLUS_A",
            options={"SymmetricMode": True, "Equil": False, "DiagPivotThresh": 0.0},
        )

    def solve(self) -> FloatArray:
        """The Gauss-Newton step."""
        return np.asarray(self._factorised().solve(self._right))

    def evidence(self) -> float:
        """Log of the marginal likelihood by Laplace's approximation, but for a constant."""
        spread = float(np.log(np.abs(self._factorised().U.diagonal())).sum())
        return -(self.cost + spread) / 2


_DAMPING = 1e-6


def _add_walls(
    system: _System,
    state: FloatArray,
    walls: _Walls,
    cameras: FloatArray,
    pieces: Pieces,
    config: AdjustConfig,
) -> None:
    view, wall = pieces.view, pieces.wall
    c, s = np.cos(state[view, 2])[:, None], np.sin(state[view, 2])[:, None]
    factor = np.exp(state[view, 3])[:, None]
    x, y = pieces.points[..., 0], pieces.points[..., 1]
    turned = factor[..., None] * np.stack([c * x - s * y, s * x + c * y], axis=-1)
    place = (cameras[view] + state[view, :2] - walls.middle[wall])[:, None] + turned
    normal = np.stack([np.cos(walls.angle[wall]), np.sin(walls.angle[wall])], axis=-1)[:, None]
    across = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)
    residual = (normal * place).sum(axis=-1) - walls.offset[wall][:, None]
    by_turn = (normal * np.stack([-turned[..., 1], turned[..., 0]], axis=-1)).sum(axis=-1)
    by_factor = (normal * turned).sum(axis=-1)
    by_angle = (across * place).sum(axis=-1)
    ones = np.ones_like(by_turn)
    jacobian = np.stack(
        [normal[..., 0] * ones, normal[..., 1] * ones, by_turn, by_factor, by_angle, -ones],
        axis=-1,
    )
    base = state.size
    columns = np.concatenate(
        [_VIEW * view[:, None] + np.arange(4), base + 2 * wall[:, None] + np.arange(2)], axis=1
    )
    sigma = pieces.sigma[:, None]
    _add_robustly(
        system,
        np.repeat(columns, 2, axis=0),
        (jacobian / sigma[..., None]).reshape(-1, 6),
        (residual / sigma).ravel(),
        config,
    )


def _add_odometry(
    system: _System,
    state: FloatArray,
    walk: _Walk,
    multiples: _Multiples,
    config: AdjustConfig,
) -> None:
    count = len(state)
    step = np.diff(walk.cameras, axis=0)
    # A random walk: variances grow with the way.
    way = np.sqrt(np.maximum(walk.steps, _SHORTEST_CH))
    weight = 1.0 / (multiples.slip * config.odometry_ch * way)
    before, after = np.arange(count - 1), np.arange(1, count)
    stretch = np.exp(state[:-1, 4])
    c, s = stretch * np.cos(state[:-1, 2]), stretch * np.sin(state[:-1, 2])
    turned = np.stack([c * step[:, 0] - s * step[:, 1], s * step[:, 0] + c * step[:, 1]], axis=-1)
    slip = state[1:, :2] - state[:-1, :2] - (turned - step)
    by_turn = np.stack([turned[:, 1], -turned[:, 0]], axis=-1)
    ones = np.ones(count - 1)
    for k in (0, 1):
        columns = _VIEW * np.stack([before, after, before, before], axis=1) + (k, k, 2, 4)
        jacobian = np.stack([-ones, ones, by_turn[:, k], -turned[:, k]], axis=1)
        _add(system, columns, weight[:, None] * jacobian, weight * slip[:, k])
    for unknown, sigma in ((2, np.deg2rad(config.odometry_deg)), (4, config.odometry_scale)):
        weight = 1.0 / (multiples.bend * sigma * way)
        columns = _VIEW * np.stack([before, after], axis=1) + unknown
        change = state[1:, unknown] - state[:-1, unknown]
        _add(system, columns, np.stack([-weight, weight], axis=1), weight * change)
    factor = np.full((count, 1), 1.0 / config.factor_sigma)
    every = np.arange(count)[:, None]
    _add(system, _VIEW * every + 3, factor, state[:, 3] / config.factor_sigma)
    sure = 1.0 / (walk.prior.sigma or _HELD)
    about = 0.0 if walk.prior.sigma else np.log(walk.prior.factor)
    off = sure * (state[:1, 4] - about)
    _add(system, np.array([[4]]), np.array([[sure]]), off)
    first = np.full((3, 1), 1.0 / _FIRST)
    _add(system, np.arange(3)[:, None], first, (state[0, :3] - walk.first) / _FIRST)


def _add_faces(
    system: _System, first: int, walls: _Walls, faces: Faces, config: AdjustConfig
) -> None:
    one, other = faces.one, faces.other
    ones = np.ones(len(one))
    columns = first + 2 * np.stack([one, other], axis=1)
    over = line_difference(walls.angle[one], walls.angle[other]) / np.deg2rad(config.faces_deg)
    jacobian = np.stack([ones, -ones], axis=1) / np.deg2rad(config.faces_deg)
    _add_robustly(system, columns, jacobian, over, config)
    if faces.gap_ch is None:
        return
    normal = np.stack([np.cos(walls.angle), np.sin(walls.angle)], axis=-1)
    across = np.stack([-normal[one, 1], normal[one, 0]], axis=-1)
    # From the middle of the one to that of the other, where it is now.
    away = walls.middle[other] + walls.offset[other, None] * normal[other] - walls.middle[one]
    gap = (normal[one] * away).sum(axis=-1) - walls.offset[one]
    common = np.full(len(one), system.size - 1)
    columns = np.stack([columns[:, 0], columns[:, 0] + 1, columns[:, 1] + 1, common], axis=1)
    facing = (normal[one] * normal[other]).sum(axis=-1)
    jacobian = np.stack([(across * away).sum(axis=-1), -ones, facing, -ones], axis=1)
    sigma = config.gap_sigma_ch
    _add_robustly(system, columns, jacobian / sigma, (gap - walls.gap) / sigma, config)
    about = np.array([(walls.gap - faces.gap_ch) / sigma])
    _add(system, np.array([[system.size - 1]]), np.array([[1.0 / sigma]]), about)


def _add_robustly(
    system: _System,
    columns: IntArray,
    jacobian: FloatArray,
    over: FloatArray,
    config: AdjustConfig,
) -> None:
    """Adds residuals over sigma of which large ones pull less and less (Cauchy)."""
    limit = config.robust_sigmas
    weight = 1.0 / np.sqrt(1.0 + (over / limit) ** 2)
    cost = float((limit**2 * np.log1p((over / limit) ** 2)).sum())
    system.add(columns, weight[:, None] * jacobian, weight * over, cost)


def _add(system: _System, columns: IntArray, jacobian: FloatArray, residual: FloatArray) -> None:
    system.add(columns, jacobian, residual, float(residual @ residual))


_FIRST = 1e-4
"""The first camera stays."""
_HELD = 1e-8
"""So does a scale that is given."""
_SHORTEST_CH = 0.02
"""Who turns on the spot errs as on so much way."""
