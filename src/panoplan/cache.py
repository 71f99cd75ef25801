"""What was computed before, by content: a key is a hash of the bytes and settings it came from."""

from __future__ import annotations

import contextlib
import hashlib
import os
from pathlib import Path

from panoplan.errors import InputError
from panoplan.formats.atomic import make_folder, read_bytes, write_bytes

ENVIRONMENT = "PANOPLAN_CACHE"
_ENTRY_LIMIT = 2**30
_SIZE_LIMIT = 4 * 2**30


def cache_folder() -> Path:
    """$PANOPLAN_CACHE, or panoplan/ in $XDG_CACHE_HOME or in ~/.cache."""
    told = os.environ.get(ENVIRONMENT)
    if told:
        return Path(told)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "panoplan"


def content_key(stage: str, *parts: bytes | str) -> str:
    """The key of a result.

    Args:
        stage: name and version of the code that computes it.
        parts: all that the result depends on.

    Returns:
        64 hexadecimal digits; other parts, or the same ones cut elsewhere, give other digits.
    """
    digest = hashlib.sha256(stage.encode())
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + hashlib.sha256(data).digest())
    return digest.hexdigest()


class Cache:
    """Results by key, one file each; the oldest go when all together exceed 4 GiB.

    A cache that cannot be read or written is an empty one: the work is done again.

    Args:
        folder: made when the first result is written; None for no cache.
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder

    def read(self, key: str) -> bytes | None:
        """The result, or None where there is none."""
        if self.folder is None:
            return None
        path = self._path(key)
        try:
            data = read_bytes(path, _ENTRY_LIMIT)
        except InputError:
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return data

    def write(self, key: str, data: bytes) -> None:
        """Keeps a result."""
        if self.folder is None:
            return
        path = self._path(key)
        with contextlib.suppress(InputError):
            make_folder(path.parent)
            write_bytes(path, data)

    def entries(self) -> list[tuple[Path, int]]:
        """File and size in bytes of each result, the one used longest ago first."""
        if self.folder is None or not self.folder.is_dir():
            return []
        found = []
        for path in self.folder.glob("??/*"):
            with contextlib.suppress(OSError):
                status = path.stat()
                found.append((status.st_mtime, path, status.st_size))
        return [(path, size) for _, path, size in sorted(found)]

    def trim(self, limit: int = _SIZE_LIMIT) -> int:
        """Removes results used longest ago until the rest has at most `limit` bytes.

        Returns:
            Bytes removed.
        """
        entries = self.entries()
        total = sum(size for _, size in entries)
        removed = 0
        for path, size in entries:
            if total - removed <= limit:
                break
            with contextlib.suppress(OSError):
                path.unlink()
                removed += size
        return removed

    def _path(self, key: str) -> Path:
        assert self.folder is not None
        return self.folder / key[:2] / key[2:]
