"""Files that are either whole or not there."""

from __future__ import annotations

import contextlib
import os
import tempfile
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
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(name, 0o666 & ~mask)
            os.replace(name, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(name)
            raise
    except OSError as error:
        raise InputError(
            path, f"{error.strerror or error}", "a place that can be written"
        ) from None


def write_text(path: Path, text: str) -> None:
    """Writes a UTF-8 text file as `write_bytes` does."""
    write_bytes(path, text.encode("utf-8"))


def read_bytes(path: Path, limit: int) -> bytes:
    """Reads a file of at most `limit` bytes.

    Raises:
        InputError: it is missing, no file, not readable, empty or larger.
    """
    try:
        if path.is_dir():
            raise InputError(path, "a folder", "a file")
        size = path.stat().st_size
        if size > limit:
            raise InputError(path, f"{size} bytes", f"at most {limit}")
        data = path.read_bytes()
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
