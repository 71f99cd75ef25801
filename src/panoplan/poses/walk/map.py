"""One map of a walk: registered panoramas and the points they see, kept by pycolmap.

A map has its own origin and scale; several maps of one walk are never put into one frame unless
panoramas of both see the same points.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.poses.walk.features import Features, load_pycolmap
from panoplan.types.pose import Pose

_CAMERA = 1
_SEED = 0
_TRIALS = 400


class Map:
    """Panoramas in one frame, all of one camera.

    Args:
        width: of the panoramas in px.
        height: of the panoramas in px.
        least_inliers: points of the map that a panorama must see to be registered.
    """

    def __init__(self, width: int, height: int, least_inliers: int) -> None:
        self._colmap = pycolmap = load_pycolmap()
        self.camera = pycolmap.Camera(
            camera_id=_CAMERA,
            model="EQUIRECTANGULAR",
            width=width,
            height=height,
            params=[width, height],
        )
        self._cache = pycolmap.DatabaseCache()
        self._cache.add_camera(self.camera)
        rig = pycolmap.Rig(rig_id=_CAMERA)
        rig.add_ref_sensor(self.camera.sensor_id)
        self._cache.add_rig(rig)
        self.reconstruction = pycolmap.Reconstruction()
        self._mapper = pycolmap.IncrementalMapper(self._cache)
        self._mapper.begin_reconstruction(self.reconstruction)
        self._options = _mapper_options(pycolmap, least_inliers)
        self._triangulation = pycolmap.IncrementalTriangulatorOptions()
        self._triangulation.random_seed = _SEED
        self._triangulation.ignore_two_view_tracks = False
        self._local = _adjustment(pycolmap, iterations=15, tolerance=1e-4)
        self._global = _adjustment(pycolmap, iterations=30, tolerance=1e-5)
        self.started = False

    def add(self, number: int, features: Features, geometries: Mapping[int, Any]) -> None:
        """Takes a panorama in, without a pose yet.

        Args:
            number: of the panorama, new to this map.
            features: its points.
            geometries: what it shares with panoramas that the map knows, by their numbers.
        """
        pycolmap = self._colmap
        frame = pycolmap.Frame(frame_id=number, rig_id=_CAMERA)
        frame.add_data_id(pycolmap.data_t(self.camera.sensor_id, number))
        self._cache.add_frame(frame)
        image = pycolmap.Image(str(number), features.points, _CAMERA, number)
        image.frame_id = number
        self._cache.add_image(image)
        for other, geometry in geometries.items():
            one, two = sorted((other, number))
            self._cache.correspondence_graph.add_two_view_geometry(one, two, geometry)
        self.reconstruction.add_image_with_trivial_frame(
            pycolmap.Image(str(number), features.points, _CAMERA, number)
        )
        # Counts what the graph holds, so that it comes last.
        self._mapper.observation_manager.add_image(number)

    def start(self, one: int, other: int) -> bool:
        """Makes the first two panoramas a map.

        Returns:
            Whether they see enough from far enough apart.
        """
        told = self._mapper.estimate_initial_two_view_geometry(self._options, one, other)
        if told is None:
            return False
        self._mapper.register_initial_image_pair(self._options, one, other, told)
        self._mapper.triangulate_image(self._triangulation, one)
        self._mapper.triangulate_image(self._triangulation, other)
        self._mapper.adjust_global_bundle(self._options, self._global)
        self._mapper.filter_points(self._options)
        self.started = self.reconstruction.num_reg_images() == 2
        return self.started

    def register(self, number: int) -> bool:
        """Finds the pose of a panorama from the points of the map and adjusts what is near it.

        Returns:
            Whether it was found.
        """
        if not self._mapper.register_next_image(self._options, number):
            return False
        self._mapper.triangulate_image(self._triangulation, number)
        self._mapper.iterative_local_refinement(
            1, 0.001, self._options, self._local, self._triangulation, number
        )
        return self.has(number)

    def adjust(self) -> None:
        """Adjusts all panoramas and points of the map."""
        self._mapper.iterative_global_refinement(
            2, 0.0005, self._options, self._global, self._triangulation, False
        )

    def release(self, number: int) -> None:
        """Takes a panorama's pose and observations away."""
        self._mapper.observation_manager.deregister_frame(number)

    def knows(self, number: int) -> bool:
        """Whether a panorama was taken in, with or without a pose."""
        return bool(self.reconstruction.exists_image(number))

    def has(self, number: int) -> bool:
        """Whether a panorama has a pose."""
        return self.knows(number) and bool(self.reconstruction.image(number).has_pose)

    def pose(self, number: int) -> Pose:
        """The pose of a panorama that has one."""
        world_from_cam = self.reconstruction.image(number).cam_from_world().inverse()
        return Pose(world_from_cam.rotation.matrix(), world_from_cam.translation)

    def numbers(self) -> list[int]:
        """Panoramas with a pose, in the order of their numbers."""
        return sorted(self.reconstruction.reg_image_ids())

    def points_seen(self, number: int) -> int:
        """Points of the map that a panorama sees."""
        return int(self.reconstruction.image(number).num_points3D)


def verified(
    camera: Any, one: Features, other: Features, pairs: NDArray[np.uint32], least: int
) -> Any | None:
    """The geometry of two panoramas that agrees with most of their alike points.

    Args:
        camera: of both.
        one: points of the first.
        other: points of the second.
        pairs: (K, 2) alike points.
        least: number of them that must agree.

    Returns:
        What pycolmap finds, or None.
    """
    if len(pairs) < least:
        return None
    pycolmap = load_pycolmap()
    options = pycolmap.TwoViewGeometryOptions()
    options.min_num_inliers = least
    options.detect_watermark = False
    options.ransac.random_seed = _SEED
    options.ransac.num_threads = 1
    # Enough for a third of true matches; most time would go into pairs that have none.
    options.ransac.max_num_trials = _TRIALS
    told = pycolmap.estimate_two_view_geometry(
        camera, one.points, camera, other.points, pairs, options
    )
    return told if len(told.inlier_matches) >= least else None


def _mapper_options(pycolmap: Any, least_inliers: int) -> Any:
    options = pycolmap.IncrementalMapperOptions()
    # A panorama sees parallax to its sides, whichever way the camera is carried.
    options.init_max_forward_motion = 1
    options.init_min_tri_angle = 6
    options.init_min_num_inliers = 60
    options.abs_pose_min_num_inliers = least_inliers
    options.abs_pose_refine_focal_length = False
    options.abs_pose_refine_extra_params = False
    options.abs_pose_max_error = 6
    options.random_seed = _SEED
    options.num_threads = 1
    return options


def _adjustment(pycolmap: Any, *, iterations: int, tolerance: float) -> Any:
    options = pycolmap.BundleAdjustmentOptions()
    options.print_summary = False
    options.refine_focal_length = options.refine_extra_params = False
    options.refine_sensor_from_rig = False
    ceres = options.ceres
    ceres.loss_function_type = pycolmap.LossFunctionType.SOFT_L1
    ceres.solver_options.max_num_iterations = iterations
    ceres.solver_options.function_tolerance = tolerance
    ceres.solver_options.num_threads = 1
    return options
