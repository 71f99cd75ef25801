import json

import numpy as np
import pytest
from tests.conftest import METRES_PER_UNIT, known_to_a_run

from panoplan.datasets.folder import open_folder, read_truth
from panoplan.errors import InputError
from panoplan.formats.tum import read_tum


def ids(scene):
    return [keyframe.id for keyframe in scene.keyframes]


def assert_same(one, other):
    assert (one.name, one.kind, one.association, one.skipped, one.camera_height_m) == (
        other.name,
        other.kind,
        other.association,
        other.skipped,
        other.camera_height_m,
    )
    np.testing.assert_array_equal(one.level_rotation, other.level_rotation)
    assert ids(one) == ids(other)
    for a, b in zip(one.keyframes, other.keyframes, strict=True):
        assert a.missing == b.missing
        np.testing.assert_array_equal(a.pose.rotation, b.pose.rotation)
        np.testing.assert_array_equal(a.pose.translation, b.pose.translation)
        assert (a.layout is None) == (b.layout is None)
        for field in ("floor_boundary", "ceiling_boundary", "corners", "floor_sigma"):
            if a.layout is not None:
                np.testing.assert_array_equal(getattr(a.layout, field), getattr(b.layout, field))


def without_truth(source, target):
    """A copy of a folder with all that is truth taken away."""
    target.mkdir()
    data = json.loads((source / "sequence.json").read_text())
    known = known_to_a_run(data)
    assert known != data
    (target / "sequence.json").write_text(json.dumps(known))
    for path in source.rglob("*"):
        relative = path.relative_to(source)
        if path.is_file() and "_gt" not in str(relative) and path.name != "sequence.json":
            (target / relative).parent.mkdir(parents=True, exist_ok=True)
            (target / relative).write_bytes(path.read_bytes())
    return target


def test_a_sequence_folder(flat):
    scene = open_folder(flat)
    assert scene.name == "a flat"
    assert scene.kind == "sequence folder"
    assert scene.camera_height_m == 1.5
    assert scene.association == "3 of 3 poses matched by order"
    assert scene.skipped == ()
    assert ids(scene) == ["pano_4", "pano_9", "pano_10"]
    np.testing.assert_array_equal(scene.keyframes[2].pose.translation, [1, 0, 2])
    np.testing.assert_allclose(scene.keyframes[2].layout.floor_boundary, -0.6, atol=1e-6)


def test_truth_makes_no_difference(flat, tmp_path):
    bare = without_truth(flat, tmp_path / "bare")
    assert not list(bare.rglob("*_gt*"))
    assert_same(open_folder(flat), open_folder(bare))


def test_truth_of_the_real_home_makes_no_difference(shared_data, zind_scene_folder):
    source = shared_data / "zind_000"
    whole = open_folder(source, trajectory=zind_scene_folder / "trajectory.tum")
    assert (source / "sequence.json").read_text() != (
        zind_scene_folder / "sequence.json"
    ).read_text()
    assert_same(whole, open_folder(zind_scene_folder))


def test_the_real_home(shared_data, zind_scene_folder):
    scene = open_folder(zind_scene_folder)
    assert len(scene.keyframes) == 32
    assert all(k.layout is not None and k.layout.width == 1024 for k in scene.keyframes)
    assert ids(scene)[:2] == ["pano_2", "pano_3"]
    assert scene.camera_height_m == 1.43504
    np.testing.assert_allclose(scene.level_rotation, np.eye(3), atol=1e-6)
    truth = read_truth(shared_data / "zind_000")
    assert truth.trajectory.labels == tuple(ids(scene))
    positions = np.array([k.pose.translation for k in scene.keyframes]) * METRES_PER_UNIT
    np.testing.assert_allclose(positions, truth.trajectory.translations, atol=1e-5)
    assert len(truth.plan.rooms) == 15
    assert len(truth.plan.rooms_partial) == 19


def test_the_boundary_of_the_real_home_lies_on_its_walls(shared_data, zind_scene_folder):
    """A mirrored or turned reading would put most of it elsewhere."""
    shapely = pytest.importorskip("shapely")
    truth = read_truth(shared_data / "zind_000").plan
    walls = shapely.MultiLineString(
        [np.vstack([r.polygon, r.polygon[:1]]) for r in truth.rooms + truth.rooms_partial]
    )
    near = []
    for keyframe in open_folder(zind_scene_folder).keyframes:
        phi = keyframe.layout.floor_boundary[::16]
        theta = 2 * np.pi * (np.arange(0, 1024, 16) + 0.5) / 1024 - np.pi
        rays = np.stack([np.sin(theta), np.tan(-phi), np.cos(theta)], axis=1)
        rays = rays @ keyframe.pose.rotation.T
        camera = keyframe.pose.translation[[0, 2]] * METRES_PER_UNIT
        points = camera + truth.camera_height_m * rays[:, [0, 2]] / rays[:, 1:2]
        near.append(shapely.distance(walls, shapely.points(points[phi < -0.02])) < 0.1)
    assert np.mean(np.concatenate(near)) > 0.8


def test_real_levels_open_with_a_given_trajectory_and_layouts(shared_data):
    levels = sorted((shared_data / "mp3d_levels").glob("mp3d_*"))
    assert levels
    for folder in levels[:3]:
        with pytest.raises(InputError, match="no trajectory; expected trajectory"):
            open_folder(folder)
        scene = open_folder(
            folder, trajectory=folder / "trajectory_gt.tum", layouts=folder / "layouts_gt"
        )
        truth = read_truth(folder)
        assert truth.trajectory.labels == tuple(ids(scene))
        assert scene.skipped == ()


def test_the_levelled_world_is_the_tilted_one(flat):
    straight = open_folder(flat)
    # The same walk in a world tilted by 10° about its x axis.
    s, c = np.sin(np.deg2rad(5)), np.cos(np.deg2rad(5))
    tilt = np.array([[1, 0, 0], [0, c * c - s * s, -2 * s * c], [0, 2 * s * c, c * c - s * s]])
    rows = [
        f"{k} {' '.join(map(repr, (tilt @ f.pose.translation).tolist()))} {s} 0 0 {c}"
        for k, f in enumerate(straight.keyframes)
    ]
    (flat / "trajectory.tum").write_text("\n".join(rows))
    scene = open_folder(flat)
    np.testing.assert_allclose(scene.level_rotation, tilt.T, atol=1e-9)
    for a, b in zip(scene.keyframes, straight.keyframes, strict=True):
        np.testing.assert_allclose(a.pose.translation, b.pose.translation, atol=1e-9)
        np.testing.assert_allclose(a.pose.rotation, b.pose.rotation, atol=1e-9)


def test_the_walk_goes_in_the_listed_order(flat):
    (flat / "trajectory.tum").write_text(
        "pano_10 1 0 2 0 0 0 1\nextra 5 0 5 0 0 0 1\npano_4 0 0 0 0 0 0 1\npano_9 1 0 0 0 0 0 1\n"
    )
    assert ids(open_folder(flat)) == ["pano_4", "pano_9", "pano_10", "extra"]


def test_without_a_description_layouts_and_labels_must_do(flat):
    (flat / "sequence.json").unlink()
    scene = open_folder(flat)
    assert scene.name == "flat"
    assert scene.kind == "trajectory and layouts"
    assert scene.camera_height_m is None
    assert ids(scene) == ["pano_4", "pano_9", "pano_10"]  # 0, 1, 2 in natural order


def test_nothing_disappears(flat):
    (flat / "layouts_pred" / "pano_9.npz").unlink()
    (flat / "layouts_pred" / "pano_10.npz").write_bytes(b"broken")
    np.savez(flat / "layouts_pred" / "cellar.npz", floor_boundary=np.full(64, -0.5))
    (flat / "trajectory.tum").write_text(
        "pano_9 0 0 0 0 0 0 1\npano_10 1 0 0 0 0 0 1\nroof 1 0 3 0 0 0 1\npano_4 2 0 0 0 0 0 1\n"
    )
    data = json.loads((flat / "sequence.json").read_text())
    data["keyframes"].append({"id": "attic", "order": 3})
    (flat / "sequence.json").write_text(json.dumps(data))
    scene = open_folder(flat)
    told = {k.id: k.missing for k in scene.keyframes if k.layout is None}
    assert told["pano_9"] == "no layout"
    assert told["pano_10"].startswith("unreadable layout: found no readable archive")
    assert told["roof"] == "no layout for this pose"
    assert scene.skipped == (("attic", "no pose"), ("cellar", "layout of no keyframe"))


def test_a_pose_without_panorama_gets_a_name_of_its_own(flat):
    data = json.loads((flat / "sequence.json").read_text())
    data["keyframes"][0]["id"] = "7"
    (flat / "sequence.json").write_text(json.dumps(data))
    (flat / "layouts_pred" / "pano_4.npz").rename(flat / "layouts_pred" / "7.npz")
    (flat / "trajectory.tum").write_text(
        "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 1 0 2 0 0 0 1\n5 1 0 3 0 0 0 1\n"
    )
    assert ids(open_folder(flat)) == ["7", "pano_9", "pano_10", "5"]
    text = (flat / "trajectory.tum").read_text().replace("5 1", "7 1")
    (flat / "trajectory.tum").write_text(text)
    assert ids(open_folder(flat)) == ["7", "pano_9", "pano_10", "pose_7"]


def test_a_layout_named_after_its_image(flat):
    data = json.loads((flat / "sequence.json").read_text())
    for item in data["keyframes"]:
        item["id"] = item["id"].replace("pano", "room")
    (flat / "sequence.json").write_text(json.dumps(data))
    scene = open_folder(flat)
    assert ids(scene) == ["room_4", "room_9", "room_10"]
    assert all(k.layout is not None for k in scene.keyframes)
    assert scene.skipped == ()


def break_all_layouts(flat):
    for path in (flat / "layouts_pred").iterdir():
        path.write_bytes(b"broken")


def remove_all_layouts(flat):
    for path in (flat / "layouts_pred").iterdir():
        path.unlink()


def rename_all_layouts(flat):
    for path in (flat / "layouts_pred").iterdir():
        path.rename(path.with_name(f"other_{path.name}"))


def stand_still(flat):
    (flat / "trajectory.tum").write_text("".join(f"{k} 1 2 3 0 0 0 1\n" for k in range(3)))


def relabel(flat):
    (flat / "trajectory.tum").write_text("a 0 0 0 0 0 0 1\nb 1 0 0 0 0 0 1\n")


def truncate(flat):
    path = flat / "trajectory.tum"
    path.write_text(path.read_text()[:-6])


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (break_all_layouts, r"layouts_pred: found no usable layout of 3 \(unreadable layout"),
        (remove_all_layouts, "layouts_pred: found no layout"),
        (rename_all_layouts, r"no usable layout of 3 \(no layout\)"),
        (stand_still, "3 cameras at one spot"),
        (relabel, "labels such as a, b that match no layout"),
        (truncate, r"trajectory\.tum:3: found 5 fields"),
        (lambda flat: (flat / "trajectory.tum").unlink(), "no trajectory; expected .*--trajectory"),
        (lambda flat: (flat / "trajectory.tum").write_text(""), "an empty file"),
        (lambda flat: (flat / "sequence.json").write_text("{"), "broken JSON"),
    ],
)
def test_bad_folders_are_told_in_one_line(flat, spoil, told):
    spoil(flat)
    with pytest.raises(InputError, match=told) as caught:
        open_folder(flat)
    assert "\n" not in str(caught.value)


def test_a_single_camera_may_stand_still(flat):
    (flat / "trajectory.tum").write_text("1 3 3 3 0 0 0 1\n")
    scene = open_folder(flat)
    assert ids(scene) == ["pano_9"]
    assert scene.skipped == (("pano_4", "no pose"), ("pano_10", "no pose"))


def test_truth_is_named_and_ordered_as_the_keyframes(flat):
    truth = read_truth(flat)
    assert truth.trajectory.labels == ("pano_4", "pano_9", "pano_10")
    np.testing.assert_array_equal(truth.trajectory.translations, [[0, 0, 0], [3, 0, 0], [3, 0, 6]])
    assert len(truth.plan.rooms) == 1
    (flat / "trajectory_gt.tum").unlink()
    assert read_truth(flat).trajectory is None


def test_the_trajectory_of_the_fixture_is_rescaled(shared_data, zind_scene_folder):
    true = read_tum(shared_data / "zind_000" / "trajectory_gt.tum")
    given = read_tum(zind_scene_folder / "trajectory.tum")
    np.testing.assert_allclose(given.translations * METRES_PER_UNIT, true.translations)
    assert not list(zind_scene_folder.rglob("*_gt*"))
