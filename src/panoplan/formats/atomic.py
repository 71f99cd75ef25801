"""Files that are either whole or not there, and logs that grow."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import tempfile
from collections.abc import Mapping
from pathlib import Path

from panoplan.errors import InputError


def write_bytes(path: Path, data: bytes) -> None:
    """Writes a file beside its place and moves it there.

    Args:
        path: the file; its folder exists.
        data: the content.

    Raises:
        InputError: the place cannot be written.
    """
    write_together({path: data})


def write_together(files: Mapping[Path, bytes]) -> None:
    """Writes files beside their places, and moves them there when all are written.

    Args:
        files: content by path; the folders exist.

    Raises:
        InputError: a place cannot be written; then none of the files is there.
    """
    beside: dict[Path, str] = {}
    try:
        for path, data in files.items():
            handle, beside[path] = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(beside[path], 0o666 & ~mask)
            if path.is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        for path in files:
            os.replace(beside[path], path)
            del beside[path]
    except OSError as error:
        raise InputError(
            path, f"{error.strerror or error}", "a place that can be written"
        ) from None
    finally:
        for name in beside.values():
            with contextlib.suppress(OSError):
                os.unlink(name)


def write_text(path: Path, text: str) -> None:
    """Writes a UTF-8 text file as `write_bytes` does."""
    write_bytes(path, text.encode("utf-8"))


def append_text(path: Path, text: str) -> None:
    """Appends UTF-8 text to a file.

    Raises:
        InputError: the place cannot be written.
    """
    try:
        with path.open("a", encoding="utf-8") as stream:
            stream.write(text)
    except OSError as error:
        raise InputError(
            path, f"{error.strerror or error}", "a place that can be written"
        ) from None


def make_folder(path: Path) -> None:
    """Makes a folder and those above it, where they do not exist.

    Raises:
        InputError: it cannot be made, or a file stands in its place.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(path, f"{error.strerror or error}", "a folder to write to") from None


def read_bytes(path: Path, limit: int) -> bytes:
    """Reads a file of at most `limit` bytes.

    Raises:
        InputError: it is missing, no file, not readable, empty or larger.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            found = "a folder" if stat.S_ISDIR(status.st_mode) else "a device or pipe"
            raise InputError(path, found, "a file")
        if status.st_size > limit:
            raise InputError(path, f"{status.st_size} bytes", f"at most {limit}")
        with path.open("rb") as stream:
            data = stream.read(limit + 1)
        if len(data) > limit:
            raise InputError(path, f"more than {limit} bytes", f"at most {limit}")
    except FileNotFoundError:
        raise InputError(path, "nothing", "a file") from None
    except OSError as error:
        raise InputError(path, f"{error.strerror or error}", "a readable file") from None
    if not data:
        raise InputError(path, "an empty file", "content")
    return data


def read_text(path: Path, limit: int) -> str:
    """Reads a UTF-8 text file of at most `limit` bytes; raises as `read_bytes` does."""
    try:
        return read_bytes(path, limit).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(path, "bytes that are no UTF-8", "a text file") from None
