"""Level pictures: written once where the poses stay, again where they were adjusted."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from panoplan.formats.image import read_panorama
from panoplan.geometry.panorama import turned
from panoplan.intake.level_images import LevelImages
from panoplan.poses.level import level
from panoplan.poses.walk.follow import Seen
from panoplan.types.pose import Pose, Trajectory

TILT = Rotation.from_rotvec([np.deg2rad(8), 0, np.deg2rad(-5)]).as_matrix()


def quiet(done, total, title=""):
    pass


@pytest.fixture(scope="module")
def stripes():
    """A level panorama: dark below the horizon, light above, one heading marked."""
    pixels = np.full((256, 512, 3), 220, dtype=np.uint8)
    pixels[128:] = 40
    pixels[:, 250:262] //= 2
    return pixels


def walk(count):
    """Poses with headings of their own in a world that is tilted by 10° and more."""
    world = Rotation.from_euler("x", 12, degrees=True).as_matrix()
    turns = Rotation.from_euler("y", np.linspace(0, 40, count)[:, None], degrees=True).as_matrix()
    rotations = world @ turns
    rotations[-1] = rotations[-1] @ TILT
    positions = np.column_stack([np.arange(count), np.zeros(count), np.zeros(count)])
    return Trajectory(tuple("abcdefgh"[:count]), rotations, positions)


def seen_of(poses, stripes):
    """What each camera sees of the striped world about it."""
    _, world = level(poses)
    for name, rotation in zip(poses.labels, world @ poses.rotations, strict=True):
        yield Seen(name, turned(stripes, rotation))


def test_pictures_of_steady_poses_are_written_once(tmp_path, stripes):
    poses = walk(6)
    images = LevelImages(tmp_path)
    for k, seen in enumerate(seen_of(poses, stripes)):
        images.add(seen, Pose(poses.rotations[k], poses.translations[k]))
    upright = read_panorama(tmp_path / "f.jpg").astype(int)
    # The tilted camera's horizon is level again.
    assert upright[20:124, :120].min() > 180
    assert upright[132:230, :120].max() < 80

    def none():
        raise AssertionError("nothing is to be written")
        yield

    images.complete(none(), level(poses)[0], quiet)


def test_a_picture_of_an_adjusted_pose_is_written_anew_and_a_lost_one_goes(tmp_path, stripes):
    poses = walk(6)
    images = LevelImages(tmp_path)
    panoramas = list(seen_of(poses, stripes))
    wrong = Rotation.from_euler("z", 3, degrees=True).as_matrix()
    for k, seen in enumerate(panoramas):
        rotation = poses.rotations[k] @ wrong if seen.name == "f" else poses.rotations[k]
        images.add(seen, Pose(rotation, poses.translations[k]))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    kept = Trajectory(poses.labels[1:], poses.rotations[1:], poses.translations[1:])
    images.complete(panoramas, level(kept)[0], quiet)
    after = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert set(before) - set(after) == {"a.jpg"}
    assert [name for name in after if after[name] != before[name]] == ["f.jpg"]


def test_an_earlier_run_s_turns_give_the_same_pictures(tmp_path, stripes):
    poses = walk(6)
    panoramas = list(seen_of(poses, stripes))
    first = LevelImages(tmp_path / "a")
    for k, seen in enumerate(panoramas):
        first.add(seen, Pose(poses.rotations[k], poses.translations[k]))
    again = LevelImages(tmp_path / "b")
    again.turns = dict(first.turns)
    again.complete(panoramas, level(poses)[0], quiet)
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()
