"""A saved estimator state: one .npz of plain arrays and a JSON text. No pickle."""

from __future__ import annotations

import dataclasses
import functools
import io
import json
import types
import typing
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.errors import InputError
from panoplan.estimator.state import State
from panoplan.formats.atomic import read_bytes, write_bytes

_LIMIT = 2**31
_ARRAY = "array"


def write_state(path: Path, state: State, fingerprint: str) -> None:
    """Saves a state.

    Args:
        path: the file.
        state: the value to save.
        fingerprint: of the input and settings it belongs to.
    """
    arrays: list[NDArray[Any]] = []
    tree = {"fingerprint": fingerprint, "state": _encode(state, arrays)}
    text = np.frombuffer(json.dumps(tree).encode(), dtype=np.uint8)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, array in [("tree", text), *((str(k), a) for k, a in enumerate(arrays))]:
            with archive.open(f"{name}.npy", "w") as member:
                np.lib.format.write_array(member, np.asarray(array), allow_pickle=False)
    write_bytes(path, buffer.getvalue())


def read_state(path: Path) -> tuple[State, str]:
    """Reads what `write_state` wrote: the state and its fingerprint.

    Raises:
        InputError: not readable, or not a state of this version.
    """
    data = read_bytes(path, _LIMIT)
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            tree = json.loads(archive["tree"].tobytes().decode())
            state = _decode(State, tree["state"], lambda k: archive[str(k)])
        return state, str(tree["fingerprint"])
    except (zipfile.BadZipFile, OSError, KeyError, ValueError, TypeError, EOFError) as error:
        raise InputError(path, f"no saved state ({error})", "a state of this version") from None


def _encode(value: Any, arrays: list[NDArray[Any]]) -> Any:
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return {_ARRAY: len(arrays) - 1}
    if dataclasses.is_dataclass(value):
        return {f.name: _encode(getattr(value, f.name), arrays) for f in dataclasses.fields(value)}
    if isinstance(value, tuple):
        return [_encode(item, arrays) for item in value]
    return value


@functools.cache
def _hints(kind: type) -> dict[str, Any]:
    return typing.get_type_hints(kind)


def _decode(hint: Any, data: Any, array: Any) -> Any:
    origin = typing.get_origin(hint)
    if origin in (types.UnionType, typing.Union):
        if data is None:
            return None
        (hint,) = (option for option in typing.get_args(hint) if option is not types.NoneType)
        return _decode(hint, data, array)
    if origin is np.ndarray:
        values = array(data[_ARRAY])
        values.setflags(write=False)
        return values
    if origin is tuple:
        inner = typing.get_args(hint)
        kinds = inner[:1] * len(data) if inner[-1] is Ellipsis else inner
        return tuple(_decode(k, item, array) for k, item in zip(kinds, data, strict=True))
    if dataclasses.is_dataclass(hint):
        made = {
            name: _decode(kind, data[name], array)
            for name, kind in _hints(typing.cast(type, hint)).items()
        }
        return typing.cast(Any, hint)(**made)
    return data
