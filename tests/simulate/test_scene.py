from dataclasses import replace

import numpy as np
import pytest
import shapely

from panoplan.errors import InputError
from panoplan.geometry.sphere import column_heading, rays
from panoplan.simulate.buildings import rectangle, single_room
from panoplan.simulate.flats import make_corridor_building, make_flat
from panoplan.simulate.noise import HARD
from panoplan.simulate.odometry import in_units
from panoplan.simulate.scene import simulate, simulate_flat, true_plan


def on_the_floor(scene, index):
    """(W, 2) a keyframe's boundary cast by its own pose, in metres, plan frame."""
    keyframe = scene.keyframes[index]
    width = keyframe.layout.width
    headings = column_heading(np.arange(width, dtype=np.float64), width)
    directions = rays(keyframe.layout.floor_boundary, headings) @ keyframe.pose.rotation.T
    camera = keyframe.pose.translation * scene.metres_per_su
    drop = scene.camera_height_m - camera[1]
    return camera[[0, 2]] + drop * directions[:, [0, 2]] / directions[:, 1:2]


def wall_distance(scene, index):
    """(W,) metres from the cast boundary to the walls of the true room."""
    polygon = scene.truth.plan.rooms[scene.keyframe_rooms[index]].polygon
    ring = shapely.Polygon(polygon).exterior
    return shapely.distance(ring, shapely.points(on_the_floor(scene, index)))


def inside_room(scene, index):
    camera = scene.truth.trajectory.translations[index, [0, 2]]
    room = shapely.Polygon(scene.truth.plan.rooms[scene.keyframe_rooms[index]].polygon)
    return room.contains(shapely.Point(camera))


@pytest.mark.parametrize("seed", [0, 2, 7])
def test_exact_layouts_cast_by_their_poses_lie_on_the_true_walls(seed):
    scene = simulate_flat(seed, "exact")
    inside = [k for k in range(len(scene.keyframes)) if inside_room(scene, k)]
    assert len(inside) > 0.8 * len(scene.keyframes)
    for k in inside[::5]:
        assert wall_distance(scene, k).max() < 1e-3


def test_the_true_layout_is_the_room_closed_at_its_doors():
    scene = simulate_flat(3, "hard", tilt_deg=1.0)
    clean = replace(
        scene,
        keyframes=tuple(
            replace(keyframe, layout=layout, pose=pose)
            for keyframe, layout, pose in zip(
                scene.keyframes,
                scene.true_layouts,
                in_units(scene.truth.trajectory, scene.metres_per_su),
                strict=True,
            )
        ),
    )
    inside = [k for k in range(len(clean.keyframes)) if inside_room(clean, k)][::5]
    off = np.concatenate([wall_distance(clean, k) for k in inside])
    assert np.quantile(off, 0.99) < 0.005
    assert np.quantile(np.concatenate([wall_distance(scene, k) for k in inside]), 0.9) > 0.1


def test_tilted_cameras_see_the_same_walls():
    scene = simulate_flat(1, "exact", tilt_deg=1.0)
    inside = [k for k in range(len(scene.keyframes)) if inside_room(scene, k)][::5]
    off = np.concatenate([wall_distance(scene, k) for k in inside])
    assert np.quantile(off, 0.99) < 0.005
    level = simulate_flat(1, "exact")
    assert off.max() > np.concatenate([wall_distance(level, k) for k in inside]).max()


@pytest.mark.parametrize(("grade", "low", "high"), [("mild", 0.01, 0.06), ("hard", 0.04, 0.25)])
def test_noisy_layouts_lie_near_the_true_walls(grade, low, high):
    scene = simulate_flat(4, grade)
    inside = [k for k in range(len(scene.keyframes)) if inside_room(scene, k)]
    off = np.concatenate([wall_distance(scene, k) for k in inside])
    assert low < np.median(off) < high


def test_the_same_seed_gives_the_same_scene():
    first, second = simulate_flat(3, "hard"), simulate_flat(3, "hard")
    assert first.metres_per_su == second.metres_per_su
    for a, b in zip(first.keyframes, second.keyframes, strict=True):
        np.testing.assert_array_equal(a.pose.translation, b.pose.translation)
        np.testing.assert_array_equal(a.layout.floor_boundary, b.layout.floor_boundary)
        np.testing.assert_array_equal(a.layout.corners, b.layout.corners)


def test_the_grade_changes_neither_flat_nor_way_nor_unit():
    scenes = [simulate_flat(6, grade) for grade in ("exact", "mild", "hard")]
    for scene in scenes[1:]:
        assert scene.metres_per_su == scenes[0].metres_per_su
        np.testing.assert_array_equal(
            scene.truth.trajectory.translations, scenes[0].truth.trajectory.translations
        )
        for a, b in zip(scene.truth.plan.rooms, scenes[0].truth.plan.rooms, strict=True):
            np.testing.assert_array_equal(a.polygon, b.polygon)


@pytest.mark.parametrize(("grade", "drift"), [("exact", 0.0), ("mild", 0.05), ("hard", 0.4)])
def test_odometry_drifts_from_the_first_keyframe_on(grade, drift):
    scene = simulate_flat(5, grade)
    true = scene.truth.trajectory
    off = scene.odometry.translations * scene.metres_per_su - true.translations
    distance = np.hypot(off[:, 0], off[:, 2])
    assert distance[0] == pytest.approx(0.0, abs=1e-12)
    assert distance.max() == pytest.approx(drift, abs=1e-6)
    np.testing.assert_allclose(scene.keyframes[0].pose.rotation, true.rotations[0], atol=1e-12)


def test_units_are_spread_over_two_decades_or_as_given():
    room = single_room(rectangle(4, 3))
    units = [simulate(room, s, "exact", as_stills=True).metres_per_su for s in range(200)]
    assert min(units) > 0.1
    assert max(units) < 10
    assert np.log10(units).std() == pytest.approx(2 / np.sqrt(12), rel=0.15)
    given = simulate(room, 0, "exact", metres_per_su=2.5)
    assert given.metres_per_su == 2.5
    first_m = given.camera_height_m - given.truth.trajectory.translations[0, 1]
    assert given.ch_per_su == pytest.approx(2.5 / first_m)


def test_hard_views_leak_through_doors_and_openings():
    flat = make_flat(8, opening_share=0.5)
    leaky = replace(HARD, bins=(), occluder_share=0.0, height_jitter=0.0, scale_std=0.0)
    leaky = replace(leaky, scale_outlier_share=0.0, drift_m=0.0, name="leaks only")
    scene = simulate(flat, 8, leaky)
    beyond = [
        (wall_distance(scene, k) > 0.05).any()
        for k in range(len(scene.keyframes))
        if inside_room(scene, k)
    ]
    assert 0.1 < np.mean(beyond) < 0.7


def test_stills_are_a_few_a_room():
    scene = simulate_flat(2, "mild", stills=True)
    rooms = len(scene.truth.plan.rooms)
    assert rooms <= len(scene.keyframes) <= 3 * rooms
    assert set(scene.keyframe_rooms) == set(range(rooms))
    assert "stills" in scene.name


def test_truth_and_keyframes_go_together():
    scene = simulate_flat(9, "mild", keyframes_per_room=12)
    assert [k.id for k in scene.keyframes] == list(scene.truth.trajectory.labels)
    assert [int(k.id) for k in scene.keyframes] == list(range(len(scene.keyframes)))
    assert scene.truth.plan.camera_height_m == scene.camera_height_m
    assert np.bincount(scene.keyframe_rooms).min() >= 10


def test_true_plan_lists_both_faces_of_every_passage():
    flat = make_flat(3, opening_share=0.4)
    plan = true_plan(flat, 1.5)
    assert len(plan.doors) == 2 * len(flat.doors)
    assert len(plan.openings) == 2 * len(flat.openings)
    assert len(plan.windows) == len(flat.windows)
    assert np.hypot(*plan.axis) == pytest.approx(1.0)


def test_a_long_walk_for_timing():
    scene = simulate(make_corridor_building(40, 0), 0, "mild", keyframes_per_room=20)
    assert len(scene.keyframes) > 1800
    assert all(k.layout is not None for k in scene.keyframes)


def test_mistakes_are_told():
    room = single_room(rectangle(4, 3))
    with pytest.raises(InputError, match="grade"):
        simulate(room, 0, "harsh")
    with pytest.raises(InputError, match="metres_per_su"):
        simulate(room, 0, metres_per_su=-1.0)
