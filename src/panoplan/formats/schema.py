"""JSON read, and checked against a schema of this package."""

from __future__ import annotations

import functools
import json
import re
import sys
from collections.abc import Callable, Iterable
from importlib import resources
from pathlib import Path
from typing import Any

from panoplan.errors import InputError
from panoplan.formats.atomic import read_text

_LIMIT = 64 * 2**20
_SURROGATE = re.compile("[\ud800-\udfff]")
_LARGEST = sys.float_info.max


def read_json(path: Path) -> Any:
    """Reads a JSON file of at most 64 MiB.

    Raises:
        InputError: missing, empty, too large, or broken (with the line).
    """
    text = read_text(path, _LIMIT)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"{path}:{error.lineno}", f"broken JSON ({error.msg})", "JSON") from None
    except (RecursionError, ValueError):
        raise InputError(path, "JSON nested too deeply or a number too long", "JSON") from None


def check(data: Any, path: Path, schema: str, version: int, kind: str) -> None:
    """Refuses data that is not as a schema wants it.

    Args:
        data: what JSON was read to.
        path: of its file, for the message.
        schema: file of the schema in this folder.
        version: of the schema; data of a later one is told so.
        kind: what the file holds.

    Raises:
        InputError: of a later version, not as the schema wants it (with the JSON path), a number
            that is not finite, or a text that is no Unicode.
    """
    from jsonschema.exceptions import best_match

    told = data.get("schema") if isinstance(data, dict) else None
    if isinstance(told, int) and told > version:
        expected = f"{kind} of schema {version}: a newer panoplan reads it"
        raise InputError(f"{path}, $.schema", f"schema {str(told)[:20]}", expected)
    error = best_match(_validator(schema).iter_errors(data))
    if error is not None:
        found = error.message[:200]
        raise InputError(f"{path}, {error.json_path}", found, f"{kind} of schema {version}")
    where = not_finite(data, "$")
    if where is not None:
        raise InputError(f"{path}, {where}", "NaN or infinity", "a finite number")
    where = _first(data, "$", lambda value: isinstance(value, str) and _SURROGATE.search(value))
    if where is not None:
        raise InputError(f"{path}, {where}", "half of a character", "a text in Unicode")


def not_finite(value: Any, where: str) -> str | None:
    """JSON path of the first number that is not finite, or None."""
    return _first(
        value, where, lambda v: isinstance(v, int | float) and not -_LARGEST <= v <= _LARGEST
    )


def _first(value: Any, where: str, wrong: Callable[[Any], object]) -> str | None:
    """JSON path of the first value that is wrong, or None."""
    items: Iterable[tuple[str, Any]] = ()
    if wrong(value):
        return where
    if isinstance(value, dict):
        items = ((f"{where}.{key}", item) for key, item in value.items())
    elif isinstance(value, list):
        items = ((f"{where}[{k}]", item) for k, item in enumerate(value))
    return next((found for path, item in items if (found := _first(item, path, wrong))), None)


@functools.cache
def _validator(schema: str) -> Any:
    from jsonschema import Draft202012Validator

    text = resources.files("panoplan.formats").joinpath(schema).read_text("utf-8")
    return Draft202012Validator(json.loads(text))
