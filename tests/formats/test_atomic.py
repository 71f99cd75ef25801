import os

import pytest

from panoplan.errors import InputError
from panoplan.formats import atomic


def test_text_is_read_as_written(tmp_path):
    atomic.write_text(tmp_path / "a.txt", "größer\n")
    assert atomic.read_text(tmp_path / "a.txt", 100) == "größer\n"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    atomic.write_text(path, "old")

    def refuse(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(InputError, match="No space left"):
        atomic.write_text(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_written_files_have_the_rights_of_any_new_file(tmp_path):
    (tmp_path / "plain").write_bytes(b"x")
    atomic.write_bytes(tmp_path / "ours", b"x")
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize(
    ("make", "found"),
    [
        (lambda p: None, "nothing"),
        (lambda p: p.mkdir(), "a folder"),
        (lambda p: p.write_bytes(b""), "an empty file"),
        (lambda p: p.write_bytes(b"x" * 101), "101 bytes"),
        (os.mkfifo, "a device or pipe"),
        (lambda p: p.write_bytes(b"\xff\xfe\x00"), "no UTF-8"),
    ],
)
def test_what_cannot_be_read(tmp_path, make, found):
    make(tmp_path / "f")
    with pytest.raises(InputError, match=found) as caught:
        atomic.read_text(tmp_path / "f", 100)
    assert "\n" not in str(caught.value)


def test_a_folder_where_a_file_stands(tmp_path):
    (tmp_path / "f").write_text("x")
    with pytest.raises(InputError, match="folder to write to"):
        atomic.make_folder(tmp_path / "f")
    with pytest.raises(InputError, match="can be written"):
        atomic.write_text(tmp_path / "none" / "f", "x")
