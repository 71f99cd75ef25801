"""The same four cameras, written by each format's own library or after its published schema."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from panoplan.errors import InputError
from panoplan.formats.tum import write_tum
from panoplan.poses.files import find_trajectory, read_trajectory
from panoplan.types.pose import Trajectory

NAMES = ("walk/2.jpg", "walk/9.jpg", "walk/10.jpg", "walk/11.jpg")
ROTATIONS = Rotation.from_euler(
    "yxz", [[10, 3, -2], [95, 0, 4], [170, -5, 1], [-60, 2, 2]], degrees=True
)
CENTRES = np.array([[0, 0, 0], [1.5, 0.1, -2], [3, -0.1, 4], [-2, 0, 1.0]])
CAM_FROM_WORLD = ROTATIONS.inv()
SHIFTS = -CAM_FROM_WORLD.apply(CENTRES)


def write_colmap(folder, *, binary):
    pycolmap = pytest.importorskip("pycolmap", reason="needs the extra images")
    folder.mkdir()
    reconstruction = pycolmap.Reconstruction()
    camera = pycolmap.Camera(
        camera_id=1, model="EQUIRECTANGULAR", width=1024, height=512, params=[1024, 512]
    )
    reconstruction.add_camera_with_trivial_rig(camera)
    for k, name in enumerate(NAMES):
        # The second image has points, the others have an empty line for them.
        points = np.ones((5 * (k == 1), 2))
        image = pycolmap.Image(name=name, keypoints=points, camera_id=1, image_id=len(NAMES) - k)
        pose = pycolmap.Rigid3d(pycolmap.Rotation3d(CAM_FROM_WORLD[k].as_quat()), SHIFTS[k])
        reconstruction.add_image_with_trivial_frame(image, pose)
    (reconstruction.write_binary if binary else reconstruction.write_text)(str(folder))
    return folder


def colmap_text(folder):
    return write_colmap(folder / "model", binary=False)


def colmap_binary(folder):
    return write_colmap(folder / "model", binary=True)


def kitti(folder):
    rows = np.concatenate([ROTATIONS.as_matrix(), CENTRES[:, :, None]], axis=2).reshape(4, 12)
    np.savetxt(folder / "00.txt", rows)
    return folder / "00.txt"


def tum(folder):
    write_tum(folder / "t.txt", Trajectory(tuple("0123"), ROTATIONS.as_matrix(), CENTRES))
    return folder / "t.txt"


def stella(folder):
    msgpack = pytest.importorskip("msgpack", reason="needs the extra images")
    keyframes = {
        str(k): {
            "ts": 12.5 + k,
            "cam": "360",
            "rot_cw": CAM_FROM_WORLD[k].as_quat().tolist(),
            "trans_cw": SHIFTS[k].tolist(),
            "descs": [[1, 2], [3, 4]],
        }
        for k in (2, 0, 1, 3)
    }
    data = {"cameras": {}, "frame_next_id": 9, "keyframes": keyframes, "landmarks": {}}
    (folder / "map.msg").write_bytes(msgpack.packb(data))
    return folder / "map.msg"


def opensfm(folder):
    shots = {
        name: {
            "camera": "360",
            "rotation": CAM_FROM_WORLD[k].as_rotvec().tolist(),
            "translation": SHIFTS[k].tolist(),
        }
        for k, name in enumerate(NAMES)
    }
    small = {"cameras": {}, "shots": {"x.jpg": shots[NAMES[0]]}}
    data = [small, {"cameras": {}, "shots": shots}]
    (folder / "reconstruction.json").write_text(json.dumps(data))
    return folder / "reconstruction.json"


def nerfstudio(folder):
    frames = []
    for k, name in enumerate(NAMES):
        matrix = np.eye(4)
        matrix[:3, :3] = ROTATIONS[k].as_matrix() @ np.diag([1, -1, -1])
        matrix[:3, 3] = CENTRES[k]
        frames.append({"file_path": name, "transform_matrix": matrix.tolist()})
    data = {"camera_model": "EQUIRECTANGULAR", "frames": frames}
    (folder / "transforms.json").write_text(json.dumps(data))
    return folder / "transforms.json"


@pytest.mark.parametrize(
    ("make", "kind", "labels"),
    [
        (tum, "TUM", tuple("0123")),
        (kitti, "KITTI", tuple("0123")),
        (colmap_text, "COLMAP text", NAMES),
        (colmap_binary, "COLMAP binary", NAMES),
        (stella, "stella_vslam map", ("12.500000", "13.500000", "14.500000", "15.500000")),
        (opensfm, "OpenSfM", NAMES),
        (nerfstudio, "nerfstudio", NAMES),
    ],
)
def test_the_same_cameras_are_read_from_every_format(tmp_path, make, kind, labels):
    read = read_trajectory(make(tmp_path))
    assert read.kind == kind
    assert read.trajectory.labels == labels
    np.testing.assert_allclose(read.trajectory.rotations, ROTATIONS.as_matrix(), atol=1e-9)
    np.testing.assert_allclose(read.trajectory.translations, CENTRES, atol=1e-9)


def test_a_folder_is_looked_through_by_the_usual_names(tmp_path):
    assert find_trajectory(tmp_path) is None
    opensfm(tmp_path)
    assert find_trajectory(tmp_path).name == "reconstruction.json"
    (tmp_path / "sparse").mkdir()
    write_colmap(tmp_path / "sparse" / "0", binary=True)
    assert read_trajectory(tmp_path).kind == "COLMAP binary"


@pytest.mark.parametrize(
    ("name", "data", "told"),
    [
        ("a.bin", b"\x01\0\0\0\0\0\0\0" + b"\0" * 20, "cut short"),
        ("a.bin", b"\xff" * 64, "images.bin"),
        ("a.msg", b"\x81\xa1a\xff\xff", "msgpack"),
        ("a.msg", b"\x81\xa9keyframes\x80\xc3\x00", "msgpack"),
        ("a.msg", b"\x81\xa9keyframes\x80\0", "msgpack"),
        ("a.json", b"{", "broken JSON"),
        ("a.json", b"[1, 2]", "another kind"),
        ("a.json", b'{"frames": []}', "no frame"),
        ("a.json", b'{"frames": [{"file_path": "a"}]}', "frames\\[0\\]"),
        ("a.json", b'[{"shots": {"a": {"rotation": [0, 0]}}}]', "rotation and translation"),
        ("a.txt", b"1 0 0 0 1 0 0 0 1 0 0 nan", "twelve finite"),
        ("a.txt", b"2 0 0 0 0 1 0 0 0 0 1 0", "no rotation"),
        ("a.txt", b"1 1 0 0 0 0 0 0 1 a.jpg\n\n2 1 0 0 0 0 0 0 1 a.jpg\n", "one name"),
        ("a.txt", b"1 1 0 0 0 0 0 0 1 a.jpg\n\n2 x 0 0 0 0 0 0 1 b.jpg\n", "QW QX"),
        ("a.txt", b"hello", "label tx ty tz"),
        ("a.tum", b"\xff\xfe\0", "no UTF-8"),
    ],
)
def test_broken_files_are_one_line(tmp_path, name, data, told):
    pytest.importorskip("msgpack", reason="needs the extra images")
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=told):
        read_trajectory(tmp_path / name)
