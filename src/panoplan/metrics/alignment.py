"""Bringing a plan onto the true one, by the cameras that both know."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from panoplan.errors import InputError
from panoplan.types.arrays import FloatArray, frozen_array
from panoplan.types.plan import Aperture, FloorPlan, PlanPose, Room, Wall
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth

Freedom = Literal["none", "scale", "rigid", "similarity"]
FREEDOMS: tuple[Freedom, ...] = ("none", "scale", "rigid", "similarity")


@dataclass(frozen=True, eq=False)
class Similarity:
    """Plane similarity true_from_plan: scale, then turn, then shift.

    Attributes:
        scale: true metres a plan unit, positive.
        rotation_rad: counter-clockwise in (x, z).
        translation_m: (2,) shift.
    """

    scale: float = 1.0
    rotation_rad: float = 0.0
    translation_m: FloatArray = field(default_factory=lambda: np.zeros(2))

    def __post_init__(self) -> None:
        """Checks the scale and copies the shift."""
        if not (np.isfinite(self.scale) and self.scale > 0):
            raise InputError("scale", f"{self.scale}", "a positive number")
        shift = frozen_array("translation_m", self.translation_m, (2,))
        object.__setattr__(self, "translation_m", shift)

    @property
    def matrix(self) -> FloatArray:
        """(2, 2) scaled rotation."""
        c, s = np.cos(self.rotation_rad), np.sin(self.rotation_rad)
        return np.asarray(self.scale * np.array([[c, -s], [s, c]]))

    def apply(self, points: FloatArray) -> FloatArray:
        """Moves points (..., 2) from the plan frame into the true one."""
        return np.asarray(points @ self.matrix.T + self.translation_m)


@dataclass(frozen=True, eq=False)
class Alignment:
    """How a plan was brought onto the true one.

    Attributes:
        freedom: what was fitted.
        true_from_plan: the transform, including metres a plan unit.
        cameras: how many cameras plan and truth have in common.
        residual_rmse_m: root mean square distance of these cameras after it, None without any.
    """

    freedom: Freedom
    true_from_plan: Similarity
    cameras: int
    residual_rmse_m: float | None


def common_cameras(plan: FloorPlan, trajectory: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Positions of the cameras that a plan and a true trajectory share, by id.

    Args:
        plan: the plan.
        trajectory: true poses in metres whose labels are keyframe ids.

    Returns:
        (K, 2) in the plan frame and unit, and (K, 2) true (x, z) in metres, in the order of the
        plan's trajectory; K may be 0.
    """
    place = {label: i for i, label in enumerate(trajectory.labels)}
    shared = [camera for camera in plan.trajectory if camera.id in place]
    rows = [place[camera.id] for camera in shared]
    positions = np.array([camera.position for camera in shared], dtype=float).reshape(-1, 2)
    return positions, trajectory.translations[rows][:, [0, 2]]


def metres_per_unit(plan: FloorPlan, true_camera_height_m: float | None = None) -> float | None:
    """Metres that the plan itself says one of its units has.

    Args:
        plan: in metres, or in camera heights.
        true_camera_height_m: used for a plan in camera heights that knows none itself.

    Returns:
        Metres a plan unit, or None where nobody knows.
    """
    if plan.unit == "m":
        return 1.0
    return plan.camera_height_m or true_camera_height_m


def fit(plan_points: FloatArray, true_points: FloatArray, freedom: Freedom) -> Similarity:
    """Least squares transform of points onto points, without reflection.

    "scale" multiplies about the origin of the plan frame, which is the trajectory's own world
    times the scale: it undoes a wrong scale and nothing else. "rigid" turns and shifts,
    "similarity" does all three, "none" is the identity.

    Args:
        plan_points: (K, 2).
        true_points: (K, 2) corresponding points in metres.
        freedom: what may change.

    Returns:
        The transform.

    Raises:
        InputError: too few points, or all at one place, or opposite ones (a scale that is not
            positive).

    Source: Umeyama 1991, in the plane, with the stated freedoms.
    """
    if freedom == "none":
        return Similarity()
    needed = 1 if freedom == "scale" else 2
    if len(plan_points) < needed:
        found = f"{len(plan_points)} cameras that plan and truth share by id"
        raise InputError("alignment", found, f"at least {needed} for {freedom!r}")
    if freedom == "scale":
        spread = float(np.sum(plan_points**2))
        factor = float(np.sum(plan_points * true_points)) / spread if spread > 0 else 0.0
        return Similarity(_positive(factor))
    centre, true_centre = plan_points.mean(axis=0), true_points.mean(axis=0)
    p, q = plan_points - centre, true_points - true_centre
    along = float(np.sum(p * q))
    across = float(np.sum(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]))
    spread = float(np.sum(p**2))
    if np.hypot(along, across) <= 1e-12 * max(spread, float(np.sum(q**2)), 1e-300):
        raise InputError("alignment", "cameras all at one place", "cameras apart from one another")
    scale = float(np.hypot(along, across)) / spread if freedom == "similarity" else 1.0
    turned = Similarity(_positive(scale), float(np.arctan2(across, along)))
    return replace(turned, translation_m=true_centre - turned.apply(centre))


def _positive(factor: float) -> float:
    if not (np.isfinite(factor) and factor > 1e-12):
        raise InputError(
            "alignment", f"a scale of {factor:.3g}", "cameras that give a positive one"
        )
    return factor


def align(plan: FloorPlan, truth: GroundTruth, freedom: Freedom) -> Alignment:
    """The transform that brings a plan onto the truth.

    Cameras correspond by keyframe id. For "none" and "rigid" a plan in camera heights is first
    made metric by its own camera height, or else by the true one.

    Args:
        plan: the plan.
        truth: the truth; its trajectory is needed for every freedom but "none".
        freedom: what may be fitted.

    Returns:
        The alignment.

    Raises:
        InputError: unknown freedom; no true trajectory; too few common cameras; no unit known.

    Source: "we align the estimated poses with ground truth poses to recover the real scale",
        Sec. V of the paper, which is "scale".
    """
    if freedom not in FREEDOMS:
        raise InputError("align", repr(freedom), "one of " + ", ".join(FREEDOMS))
    unit = 1.0
    if freedom in ("none", "rigid"):
        known = metres_per_unit(plan, truth.plan.camera_height_m)
        if known is None:
            raise InputError(
                f"align {freedom!r}",
                "a plan in camera heights and no camera height known",
                "metres",
            )
        unit = known
    if truth.trajectory is None:
        if freedom != "none":
            raise InputError(f"align {freedom!r}", "no true trajectory", "true camera positions")
        return Alignment("none", Similarity(unit), 0, None)
    ours, true = common_cameras(plan, truth.trajectory)
    fitted = fit(unit * ours, true, freedom)
    transform = replace(fitted, scale=unit * fitted.scale)
    rmse = None
    if len(ours):
        rmse = float(np.sqrt(np.mean(np.sum((transform.apply(ours) - true) ** 2, axis=1))))
    return Alignment(freedom, transform, len(ours), rmse)


def transformed(plan: FloorPlan, transform: Similarity) -> FloorPlan:
    """The plan moved by a similarity, in metres.

    Polygons, walls, segments, cameras, directions and heights move; `scale`, `level_rotation` and
    `camera_height_m` go on telling how the plan was made.
    """

    def moved(items: tuple[Aperture, ...]) -> tuple[Aperture, ...]:
        return tuple(replace(item, segment=transform.apply(item.segment)) for item in items)

    return replace(
        plan,
        unit="m",
        rooms=tuple(_moved_room(room, transform) for room in plan.rooms),
        trajectory=tuple(_moved_camera(camera, transform) for camera in plan.trajectory),
        shared_walls=tuple(
            replace(wall, thickness=transform.scale * wall.thickness) for wall in plan.shared_walls
        ),
        doors=moved(plan.doors),
        openings=moved(plan.openings),
        windows=moved(plan.windows),
    )


def _moved_camera(camera: PlanPose, transform: Similarity) -> PlanPose:
    # The heading turns clockwise, the rotation counter-clockwise.
    heading = camera.heading - transform.rotation_rad
    heading = float((heading + np.pi) % (2 * np.pi) - np.pi)
    return replace(camera, position=transform.apply(camera.position), heading=heading)


def _moved_wall(wall: Wall, transform: Similarity) -> Wall:
    sigma = None if wall.sigma is None else transform.scale * wall.sigma
    return replace(wall, a=transform.apply(wall.a), b=transform.apply(wall.b), sigma=sigma)


def _moved_room(room: Room, transform: Similarity) -> Room:
    height = None if room.ceiling_height is None else transform.scale * room.ceiling_height
    area_sigma = None if room.area_sigma is None else transform.scale**2 * room.area_sigma
    return replace(
        room,
        polygon=None if room.polygon is None else transform.apply(room.polygon),
        holes=tuple(transform.apply(hole) for hole in room.holes),
        walls=tuple(_moved_wall(wall, transform) for wall in room.walls),
        area_sigma=area_sigma,
        ceiling_height=height,
        orientations=tuple(float((o + transform.rotation_rad) % np.pi) for o in room.orientations),
    )
