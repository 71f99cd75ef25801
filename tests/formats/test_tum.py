import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from panoplan.errors import InputError
from panoplan.formats.tum import read_tum, write_tum
from panoplan.types.pose import Trajectory

S = 2**-0.5


def test_a_quarter_turn_to_the_right_by_hand(tmp_path):
    path = tmp_path / "t.tum"
    path.write_text(
        f"# a comment\n0 1 2 3 0 0 0 1\n\n1.5, 4,5 ,6, 0,{S},0,{S} # a turn\n2\t7 8 9 0 0 0 1"
    )
    trajectory = read_tum(path)
    assert trajectory.labels == ("0", "1.5", "2")
    np.testing.assert_array_equal(trajectory.translations, [[1, 2, 3], [4, 5, 6], [7, 8, 9]])
    # Heading 90° clockwise seen from above: the camera's z looks along the world's x.
    np.testing.assert_allclose(trajectory.rotations[1] @ [0, 0, 1], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(trajectory.rotations[1] @ [1, 0, 0], [0, 0, -1], atol=1e-12)


def test_read_of_write(tmp_path):
    rng = np.random.default_rng(0)
    scales = np.logspace(-9, 9, 20)[:, None]
    trajectory = Trajectory(
        tuple(f"{k}.25" for k in range(20)),
        Rotation.random(20, random_state=1).as_matrix(),
        rng.normal(size=(20, 3)) * scales,
    )
    write_tum(tmp_path / "t", trajectory)
    again = read_tum(tmp_path / "t")
    assert again.labels == trajectory.labels
    np.testing.assert_array_equal(again.translations, trajectory.translations)
    np.testing.assert_allclose(again.rotations, trajectory.rotations, atol=1e-14)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "an empty file"),
        ("# only a comment\n", "no pose"),
        ("0 0 0 0 0 0 0 1\n1 0 0 0 0 0", r":2: found 6 fields"),
        ("0 0 0 0 0 0 0 1 9\n", r":1: found 9 fields"),
        ("0 0 zero 0 0 0 0 1\n", r":1: .*seven numbers"),
        ("0 0 0 0 0 0 0 1\n1 0 0 0 1e200 0 0 1\n", r":2: .*at most 1e\+100"),
        ("\x1b[2J 0 0 0 0 0 0 1\n", r":1: found the label '.x1b"),
        ("a" * 201 + " 0 0 0 0 0 0 1\n", ":1: .*200 printable"),
        ("a 0 nan 0 0 0 0 1\n", "pose a: found NaN"),
        ("a 0 inf 0 0 0 0 1\n", "pose a: found NaN or infinity"),
        ("a 0 0 0 0 0 nan 1\n", "pose a: found NaN"),
        ("a 0 0 0 0 0 0 0.9\n", "pose a: found a quaternion of length 0.9"),
        ("a 0 0 0 0 0 0 0\n", "pose a: found a quaternion of length 0"),
        ("7 0 0 0 0 0 0 1\n7 1 0 0 0 0 0 1\n", "the label 7 twice"),
    ],
)
def test_bad_files(tmp_path, text, told):
    path = tmp_path / "t.tum"
    path.write_text(text)
    with pytest.raises(InputError, match=told) as caught:
        read_tum(path)
    assert str(path) in str(caught.value)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match=r"none\.tum: found nothing"):
        read_tum(tmp_path / "none.tum")


@pytest.mark.parametrize("label", ["", "a b", "a,b", "#a"])
def test_labels_that_would_not_be_read_back_are_not_written(tmp_path, label):
    trajectory = Trajectory((label,), np.eye(3)[None], np.zeros((1, 3)))
    with pytest.raises(InputError, match="label"):
        write_tum(tmp_path / "t", trajectory)
    assert not (tmp_path / "t").exists()
