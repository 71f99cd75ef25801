"""One plain array in the .npy format: bounded memory, and a header that is never evaluated."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import InputError
from panoplan.formats.atomic import read_bytes

_LIMIT = 64 * 2**20
_MAGIC = b"\x93NUMPY"
_HEADER_LIMIT = 10_000
_HEADER = re.compile(
    r"\{(?=.*'descr': *'(?P<descr>[<>|=]?[a-zA-Z?]\d{0,4})')"
    r"(?=.*'fortran_order': *(?P<fortran>True|False))"
    r"(?=.*'shape': *\((?P<shape>[\d, ]{0,200})\)).*\}\s*",
    re.DOTALL,
)


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
    start, header = _header(data, source)
    found = _HEADER.fullmatch(header)
    if found is None:
        raise InputError(source, "an array of a structured type or a broken header", "numbers")
    if found["descr"].lstrip("<>|=").startswith("O"):
        raise InputError(source, "pickled objects", "a plain array of numbers")
    try:
        dtype = np.dtype(found["descr"])
    except TypeError:
        raise InputError(source, f"the type {found['descr']}", "real numbers") from None
    if dtype.kind not in "fiu":
        raise InputError(source, f"an array of type {dtype}", "real numbers")
    shape = _shape(found["shape"], source)
    wanted, there = math.prod(shape) * dtype.itemsize, len(data) - start
    if wanted > there:
        told = f"{there} bytes for an array of shape {shape}, cut short"
        raise InputError(source, told, f"{wanted} bytes")
    flat = np.frombuffer(data, dtype, count=math.prod(shape), offset=start)
    order: Literal["F", "C"] = "F" if found["fortran"] == "True" else "C"
    with np.errstate(all="ignore"):
        # Nonsense such as signalling NaN stays for the caller to refuse.
        return np.array(flat.reshape(shape, order=order), dtype=np.float64)


def _header(data: bytes, source: str) -> tuple[int, str]:
    """Where the numbers begin, and the text before them."""
    lengths = {1: 2, 2: 4, 3: 4}
    if not data.startswith(_MAGIC) or len(data) < 12 or data[6] not in lengths:
        raise InputError(source, "no array", "a .npy array")
    begin = 8 + lengths[data[6]]
    length = int.from_bytes(data[8:begin], "little")
    if length > _HEADER_LIMIT or begin + length > len(data):
        raise InputError(source, f"no array (a header of {length} bytes)", "a .npy array")
    return begin + length, data[begin : begin + length].decode("latin-1")


def _shape(text: str, source: str) -> tuple[int, ...]:
    words = [word.strip() for word in text.split(",") if word.strip()]
    if len(words) > 8 or not all(word.isdigit() and len(word) < 40 for word in words):
        raise InputError(source, f"the shape ({text[:40]})", "a few whole numbers")
    return tuple(int(word) for word in words)
