"""One plain array in the .npy format, read with bounded memory."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes

_LIMIT = 64 * 2**20


def read_npy(path: Path) -> NDArray[np.float64]:
    """Reads a .npy file of real numbers.

    Args:
        path: at most 64 MiB.

    Returns:
        The array, any shape, as float64.

    Raises:
        InputError: missing, empty, too large, or as `parse_npy`.
    """
    return parse_npy(read_bytes(path, _LIMIT), str(path))


def parse_npy(data: bytes, source: str) -> NDArray[np.float64]:
    """Reads the bytes of a .npy file of real numbers.

    The header is compared with the length of `data` before the array is made, so that a header
    cannot ask for more memory than the file itself takes (times 8 for one-byte numbers).

    Args:
        data: whole content.
        source: what it is, for the message.

    Returns:
        The array, any shape, as float64.

    Raises:
        InputError: no .npy, pickled objects, not real numbers, or cut short.
    """
    stream = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        if version == (1, 0):
            shape, _, dtype = np.lib.format.read_array_header_1_0(stream)
        elif version == (2, 0):
            shape, _, dtype = np.lib.format.read_array_header_2_0(stream)
        else:
            raise InputError(source, f"an array of format {version}", "a plain .npy array")
    except (ValueError, EOFError) as error:
        raise InputError(source, f"no array ({str(error)[:80]})", "a .npy array") from None
    if dtype.hasobject:
        raise InputError(source, "pickled objects", "a plain array of numbers")
    if dtype.kind not in "fiu":
        raise InputError(source, f"an array of type {dtype}", "real numbers")
    wanted = math.prod(shape) * dtype.itemsize
    if any(n < 0 for n in shape) or wanted > len(data) - stream.tell():
        found = f"{len(data) - stream.tell()} bytes for an array of shape {shape}, cut short"
        raise InputError(source, found, f"{wanted} bytes")
    stream.seek(0)
    array: NDArray[np.float64] = np.load(stream, allow_pickle=False).astype(np.float64)
    return array
