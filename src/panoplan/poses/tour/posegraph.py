"""Poses that fit all relative headings, directions and lengths best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from panoplan.geometry.angles import wrapped
from panoplan.types.arrays import FloatArray

_GAUGE_SIGMA = 1e-4
"""The first camera keeps its pose to so much."""
_LEAST_LENGTH = 1e-3


@dataclass(frozen=True, eq=False)
class Edge:
    """What two panoramas tell of one another.

    Attributes:
        a: key of the first camera.
        b: key of the second one.
        told: (3,) yaw of the second camera in the frame of the first one, its direction there,
            and the logarithm of its distance (NaN where unknown).
        root: (3, 3) square root of their inverse covariance, upper triangular.
    """

    a: int
    b: int
    told: FloatArray
    root: FloatArray


def optimised(
    poses: Mapping[int, FloatArray], edges: Sequence[Edge], scale: float
) -> dict[int, FloatArray]:
    """Robust least squares over a pose graph.

    Args:
        poses: (3,) x, z, heading of each camera by key; the start.
        edges: between them.
        scale: of the Cauchy loss, in standard deviations.

    Returns:
        The poses; the first one has not moved.
    """
    if not edges or len(poses) < 2:
        return dict(poses)
    keys = list(poses)
    place = {key: k for k, key in enumerate(keys)}
    start = np.array([poses[key] for key in keys])
    rows_a = np.array([place[e.a] for e in edges])
    rows_b = np.array([place[e.b] for e in edges])
    told = np.array([e.told for e in edges])
    roots = np.array([e.root for e in edges])
    known = np.isfinite(told)
    told = np.where(known, told, 0.0)

    def residuals(flat: FloatArray) -> FloatArray:
        x = flat.reshape(-1, 3)
        a, b = x[rows_a], x[rows_b]
        moved = b[:, :2] - a[:, :2]
        length = np.maximum(np.hypot(*moved.T), _LEAST_LENGTH)
        off = np.column_stack(
            [
                wrapped(b[:, 2] - a[:, 2] - told[:, 0]),
                wrapped(np.arctan2(moved[:, 0], moved[:, 1]) - a[:, 2] - told[:, 1]),
                np.log(length) - told[:, 2],
            ]
        )
        off = np.einsum("nij,nj->ni", roots, np.where(known, off, 0.0))
        return np.concatenate([off.ravel(), (x[0] - start[0]) / _GAUGE_SIGMA])

    def jacobian(flat: FloatArray) -> FloatArray:
        x = flat.reshape(-1, 3)
        moved = x[rows_b, :2] - x[rows_a, :2]
        square = np.maximum((moved**2).sum(axis=1), _LEAST_LENGTH**2)
        count = len(edges)
        local = np.zeros((count, 3, 6))
        local[:, 0, 2], local[:, 0, 5] = -1, 1
        local[:, 1, 3], local[:, 1, 4] = moved[:, 1] / square, -moved[:, 0] / square
        local[:, 1, 2] = -1
        local[:, 2, 3], local[:, 2, 4] = moved[:, 0] / square, moved[:, 1] / square
        local[:, 1:, 0:2] = -local[:, 1:, 3:5]
        local = np.einsum("nij,njk->nik", roots, np.where(known[:, :, None], local, 0.0))
        out = np.zeros((3 * count + 3, flat.size))
        row = np.arange(count)[:, None, None] * 3 + np.arange(3)[None, :, None]
        for rows, part in ((rows_a, local[:, :, :3]), (rows_b, local[:, :, 3:])):
            out[row, rows[:, None, None] * 3 + np.arange(3)] = part
        out[-3:, :3] = np.eye(3) / _GAUGE_SIGMA
        return out

    found = least_squares(
        residuals, start.ravel(), jacobian, loss="cauchy", f_scale=scale, max_nfev=50
    )
    solved = found.x.reshape(-1, 3)
    solved[:, 2] = wrapped(solved[:, 2])
    return {key: solved[k] for key, k in place.items()}
