"""Walks through painted boxes, seen by a 360° camera: pictures whose camera poses are known."""

from dataclasses import dataclass

import numpy as np
from tests.scenes import yaw

from panoplan.types.pose import Trajectory

_TEXELS_A_METRE = 40


@dataclass(frozen=True, eq=False)
class Wall:
    """A painted rectangle: a corner, its two edges, and its grey levels."""

    corner: np.ndarray
    across: np.ndarray
    down: np.ndarray
    paint: np.ndarray


def painted_wall(corner, across, down, rng, contrast=1.0):
    corner, across, down = (np.asarray(v, dtype=float) for v in (corner, across, down))
    size = [max(2, int(np.linalg.norm(edge) * _TEXELS_A_METRE)) for edge in (down, across)]
    coarse = rng.random([n // 8 + 2 for n in size]).repeat(8, axis=0).repeat(8, axis=1)
    fine = rng.random([n // 2 + 2 for n in size]).repeat(2, axis=0).repeat(2, axis=1)
    paint = (0.6 * coarse[: size[0], : size[1]] + 0.4 * fine[: size[0], : size[1]]) * contrast
    return Wall(corner, across, down, paint + (1 - contrast) / 2)


def box_room(x0, x1, z0, z1, rng, door=None, contrast=1.0):
    """Walls, floor and ceiling of a room, 1.5 m below and 1 m above the cameras.

    Args:
        x0: metres, as all.
        x1: right.
        z0: near.
        z1: far.
        rng: of the paint.
        door: (side, from, to): a gap in the wall x = x0 or x = x1.
        contrast: of the paint.
    """
    top, height = -1.0, 2.5
    walls = [
        ([x0, top, z0], [x1 - x0, 0, 0], [0, height, 0]),
        ([x0, top, z1], [x1 - x0, 0, 0], [0, height, 0]),
        ([x0, top, z0], [x1 - x0, 0, 0], [0, 0, z1 - z0]),
        ([x0, top + height, z0], [x1 - x0, 0, 0], [0, 0, z1 - z0]),
    ]
    for x in (x0, x1):
        runs = [(z0, z1)]
        if door is not None and door[0] == x:
            runs = [(z0, door[1]), (door[2], z1)]
        walls += [([x, top, a], [0, 0, b - a], [0, height, 0]) for a, b in runs]
    return [painted_wall(*wall, rng, contrast) for wall in walls]


def two_rooms(seed=0, contrast=1.0):
    """Two rooms of 4 m × 3 m side by side, joined by a door 1 m wide."""
    rng = np.random.default_rng(seed)
    door = (0.0, -0.5, 0.5)
    return [
        *box_room(-4, 0, -1.5, 1.5, rng, door, contrast),
        *box_room(0, 4, -1.5, 1.5, rng, door, contrast),
    ]


def picture(walls, rotation, position, height=256):
    """What a camera sees, (height, 2 height, 3)."""
    width = 2 * height
    heading = 2 * np.pi * (np.arange(width) + 0.5) / width - np.pi
    elevation = np.pi / 2 - np.pi * (np.arange(height) + 0.5) / height
    cos = np.cos(elevation)[:, None]
    rays = np.stack(
        [
            cos * np.sin(heading),
            np.broadcast_to(-np.sin(elevation)[:, None], (height, width)),
            cos * np.cos(heading),
        ],
        axis=-1,
    ).reshape(-1, 3)
    rays = rays @ rotation.T
    nearest = np.full(len(rays), np.inf)
    grey = np.zeros(len(rays))
    for wall in walls:
        normal = np.cross(wall.across, wall.down)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = ((wall.corner - position) @ normal) / (rays @ normal)
            at = position + rays * distance[:, None] - wall.corner
        a = at @ wall.across / (wall.across @ wall.across)
        b = at @ wall.down / (wall.down @ wall.down)
        seen = (distance > 0) & (distance < nearest) & (a >= 0) & (a < 1) & (b >= 0) & (b < 1)
        rows, columns = wall.paint.shape
        grey[seen] = wall.paint[(b[seen] * rows).astype(int), (a[seen] * columns).astype(int)]
        nearest[seen] = distance[seen]
    levels = np.rint(255 * grey).astype(np.uint8).reshape(height, width)
    return np.repeat(levels[..., None], 3, axis=2)


def path_poses(corners, step):
    """Level poses along a path of (N, 2) corners, `step` metres apart, looking ahead."""
    corners = np.asarray(corners, dtype=float)
    edges = np.diff(corners, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    at = np.arange(0, lengths.sum(), step)
    ends = np.concatenate([[0], np.cumsum(lengths)])
    x, z = (np.interp(at, ends, corners[:, k]) for k in (0, 1))
    angles = np.unwrap(np.arctan2(edges[:, 0], edges[:, 1]))
    middles = (ends[1:] + ends[:-1]) / 2
    headings = np.interp(at, middles, angles)
    rotations = np.array([yaw(h) for h in headings])
    positions = np.stack([x, np.zeros(len(x)), z], axis=1)
    return Trajectory(tuple(str(k) for k in range(len(x))), rotations, positions)
