"""Small plans and truths made by hand."""

import numpy as np

from panoplan.types.plan import (
    Aperture,
    FloorPlan,
    MetricScale,
    PlanPose,
    Room,
    ScaleEstimate,
    SharedWall,
    Skipped,
    Wall,
)
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TruePlan, TrueRoom

LEFT = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
RIGHT = np.array([[4.2, 0.0], [7.2, 0.0], [7.2, 5.0], [6.0, 5.0], [6.0, 3.0], [4.2, 3.0]])
TOP = np.array([[0.0, 3.2], [5.8, 3.2], [5.8, 5.0], [0.0, 5.0]])
FLAT = (LEFT, RIGHT, TOP)
CAMERAS = np.array([[1.0, 1.0], [3.0, 2.0], [5.0, 1.5], [6.5, 4.0], [5.0, 2.0]])


def square(x, y, side=2.0):
    return np.array([[x, y], [x + side, y], [x + side, y + side], [x, y + side]])


def turned(points, angle, shift=(0.0, 0.0), scale=1.0):
    c, s = np.cos(angle), np.sin(angle)
    return scale * points @ np.array([[c, -s], [s, c]]).T + np.asarray(shift)


def truth(rooms=FLAT, cameras=CAMERAS, *, partial=(), camera_height_m=1.5, axis=None):
    """True rooms "true_1", ... and cameras "kf0", ... at (N, 2); None for no trajectory."""

    def named(polygons):
        return tuple(TrueRoom(f"true_{k + 1}", f"hall {k}", p) for k, p in enumerate(polygons))

    trajectory = None
    if cameras is not None:
        translations = np.zeros((len(cameras), 3))
        translations[:, [0, 2]] = cameras
        labels = tuple(f"kf{k}" for k in range(len(cameras)))
        rotations = np.broadcast_to(np.eye(3), (len(cameras), 3, 3))
        trajectory = Trajectory(labels, rotations, translations)
    plan = TruePlan(named(rooms), named(partial), axis=axis, camera_height_m=camera_height_m)
    return GroundTruth(plan, trajectory)


def plan(rooms=FLAT, cameras=CAMERAS, *, unit="m", names=None, **fields):
    """A plan of polygons; None in `rooms` for a room without a shape."""
    made = []
    for k, polygon in enumerate(rooms):
        name = f"Room {k + 1}" if names is None else names[k]
        walls = ()
        if polygon is not None:
            ends = zip(polygon, np.roll(polygon, -1, axis=0), strict=True)
            walls = tuple(
                Wall(f"wall_{10 * k + j:02d}", a, b, 0.02, 0.03) for j, (a, b) in enumerate(ends)
            )
        made.append(
            Room(
                f"room_{k + 1:02d}",
                name,
                polygon,
                "no closed path" if polygon is None else None,
                ("kf0",),
                walls,
                area_sigma=None if polygon is None else 0.2,
                ceiling_height=None if polygon is None else 2.5,
                orientations=() if polygon is None else (0.0, 1.5),
                flags=("orientation_below_gate",) if k else (),
            )
        )
    settings = {
        "unit": unit,
        "level_rotation": np.eye(3),
        "scale": ScaleEstimate(
            0.5, "entropy", 0.01, (0.1, 2.0), np.array([[0.1, 3.0], [0.5, 1.25]]), False, True, 7
        ),
        "camera_height_m": 1.5 if unit == "m" else None,
        "metric": MetricScale("camera height", 0.02) if unit == "m" else None,
        "skipped": (Skipped("kf9", "wall", "seen edge-on", 3),),
        "shared_walls": (SharedWall("shared_01", ("wall_02", "wall_03"), 0.12, True, True),),
        "doors": (
            Aperture(
                "door_01",
                np.array([[4.0, 1.0], [4.0, 1.9]]),
                ("room_01", "room_02"),
                ("wall_02", "wall_03"),
                ("seen", "walked"),
            ),
        ),
        "openings": (Aperture("opening_01", np.array([[1.0, 3.0], [2.0, 3.0]])),),
        "windows": (Aperture("window_01", np.array([[0.0, 1.0], [0.0, 2.0]])),),
        "settings": {"scale": {"b": (1, 2), "a": "x"}},
        "version": "1.2.3",
    }
    trajectory = tuple(
        PlanPose(f"kf{k}", position, 0.25 * k, "room_01" if k < 2 else None)
        for k, position in enumerate(cameras)
    )
    return FloorPlan(rooms=tuple(made), trajectory=trajectory, **{**settings, **fields})
