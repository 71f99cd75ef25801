"""A painted room, and panoramas of it by ray casting."""

import numpy as np
from PIL import Image
from tests.metrics.plans import plan

LOW, HIGH = np.array([0.0, 0.0, -3.0]), np.array([4.0, 2.5, 0.0])
"""Of the room in the model frame: 4 m by 3 m, 2.5 m high."""

ROOM = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
CAMERAS = np.array([[1.0, 1.2], [3.0, 1.8]])
HEIGHT = 1.4


def painted_plan(cameras=CAMERAS):
    """The room with its cameras, nothing else."""
    return plan(
        (ROOM,), cameras, camera_height_m=HEIGHT, doors=(), openings=(), windows=(), shared_walls=()
    )


def paint(points):
    """(N, 3) colours of (N, 3) points on the room's surfaces: smooth, all different."""
    x, y, z = points.T
    return np.stack(
        [
            128 + 100 * np.sin(1.7 * x + z),
            128 + 100 * np.sin(2.1 * y),
            128 + 100 * np.cos(1.3 * z - y),
        ],
        axis=1,
    )


def directions(width):
    """(W / 2, W, 3) of an upright panorama's pixels whose heading is 0, model frame."""
    azimuth = (np.arange(width) + 0.5) / width * 2 * np.pi - np.pi
    elevation = np.pi / 2 - (np.arange(width // 2) + 0.5) / (width // 2) * np.pi
    a, e = np.meshgrid(azimuth, elevation)
    return np.stack([np.cos(e) * np.sin(a), np.sin(e), -np.cos(e) * np.cos(a)], axis=-1)


def turned(rays, heading):
    """Rays of a camera with a heading, from the plan's second axis towards its first."""
    c, s = np.cos(heading), np.sin(heading)
    x, y, z = np.moveaxis(rays, -1, 0)
    return np.stack([c * x - s * z, y, s * x + c * z], axis=-1)


def panorama(place, heading, width, tripod_deg=None):
    """(W / 2, W, 3) what a camera in the room sees; red below so many degrees of depression."""
    rays = turned(directions(width), heading).reshape(-1, 3)
    with np.errstate(divide="ignore"):
        far = np.where(rays > 0, (HIGH - place) / rays, (LOW - place) / rays).min(axis=1)
    colours = paint(place + far[:, None] * rays)
    if tripod_deg is not None:
        colours[np.degrees(np.arcsin(-rays[:, 1])) > tripod_deg] = (255, 0, 0)
    return np.rint(colours).astype(np.uint8).reshape(width // 2, width, 3)


def write_panoramas(folder, made, width=1024, tripod_deg=None):
    """Writes kf0.png, ... and gives the files by keyframe."""
    files = {}
    for pose in made.trajectory:
        x, y = pose.position
        image = panorama(np.array([x, HEIGHT, -y]), pose.heading, width, tripod_deg)
        files[pose.id] = folder / f"{pose.id}.png"
        Image.fromarray(image).save(files[pose.id])
    return files
