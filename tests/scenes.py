"""Small scenes with exact layouts, made by hand for the tests of the method."""

import numpy as np

from panoplan.types.keyframe import Keyframe
from panoplan.types.layout import Layout
from panoplan.types.pose import Pose

RECTANGLE = np.array([[-2.0, -1.5], [2.0, -1.5], [2.0, 1.5], [-2.0, 1.5]])
L_SHAPE = np.array([[-3.0, -2.0], [3.0, -2.0], [3.0, 0.0], [0.0, 0.0], [0.0, 2.0], [-3.0, 2.0]])
T_SHAPE = np.array(
    [[-3, 0], [-3, -2], [3, -2], [3, 0], [1, 0], [1, 2.5], [-1, 2.5], [-1, 0]], dtype=float
)


def yaw(beta):
    """Rotation of a level camera with heading `beta`."""
    c, s = np.cos(beta), np.sin(beta)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def ranges(polygon, camera, directions):
    """Distance from `camera` to the nearest edge along each (N, 2) unit direction.

    `polygon` is a ring, or a list of rings.
    """
    rings = polygon if isinstance(polygon, list) else [polygon]
    a = np.concatenate(rings) - camera
    edge = np.concatenate([np.roll(ring, -1, axis=0) - ring for ring in rings])
    d = directions[:, None, :]
    cross = d[..., 0] * edge[:, 1] - d[..., 1] * edge[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (a[:, 0] * edge[:, 1] - a[:, 1] * edge[:, 0]) / cross
        u = (a[:, 0] * d[..., 1] - a[:, 1] * d[..., 0]) / cross
    hit = (u >= 0) & (u <= 1) & (t > 0)
    return np.where(hit, t, np.inf).min(axis=1)


def exact_layout(polygon, camera, rotation, height=1.0, width=1024, noise=None):
    """Layout of a camera with any rotation: the floor boundary where its own columns see it."""
    world = np.linspace(-np.pi, np.pi, 8 * width, endpoint=False)
    plan = np.stack([np.sin(world), np.cos(world)], axis=1)
    distance = ranges(polygon, camera, plan)
    points = np.stack([distance * plan[:, 0], np.full(8 * width, height), distance * plan[:, 1]])
    x, y, z = rotation.T @ points
    heading, elevation = np.arctan2(x, z), -np.arctan2(y, np.hypot(x, z))
    order = np.argsort(heading)
    columns = 2 * np.pi * (np.arange(width) + 0.5) / width - np.pi
    boundary = np.interp(columns, heading[order], elevation[order], period=2 * np.pi)
    if noise is not None:
        boundary = np.minimum(boundary + noise, -0.02)
    return Layout(boundary)


def walk(polygon, cameras, *, factor=1.0, headings=None, rises=None):
    """Keyframes at (N, 2) `cameras`; translations are divided by `factor`; floor 1 below."""
    keyframes = []
    for i, camera in enumerate(cameras):
        beta = 0.3 * i if headings is None else headings[i]
        rise = 0.0 if rises is None else rises[i]
        rotation = yaw(beta)
        layout = exact_layout(polygon, camera, rotation, height=1.0 + rise)
        position = np.array([camera[0], -rise, camera[1]]) / factor
        keyframes.append(Keyframe(f"kf{i:03d}", Pose(rotation, position), layout))
    return keyframes
