"""A benchmark's result: figures with what they were measured with."""

from __future__ import annotations

import json
import math
import os
import platform
import subprocess
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from panoplan import __version__

METHODS = ("points", "paper", "released", "sound", "default")
"""In the order of tables: the baseline from a scan, and the presets."""


def record(name: str, settings: Mapping[str, Any], figures: Any) -> dict[str, Any]:
    """The figures with version, commit, machine and settings.

    Args:
        name: of the benchmark.
        settings: it ran with, plain values, "preset" among them.
        figures: plain values.
    """
    return {
        "benchmark": name,
        "version": __version__,
        "commit": commit(),
        "machine": {
            "processor": _processor(),
            "cores": os.cpu_count(),
            "python": platform.python_version(),
            "system": platform.system(),
        },
        "figures": figures,
        "settings": dict(settings),
    }


def to_json(data: Mapping[str, Any]) -> str:
    """The text of a benchmark's file.

    Args:
        data: plain values.

    Returns:
        JSON, a line break at its end; NaN, which it cannot tell, is null.

    Raises:
        ValueError: something is infinite.
    """
    return json.dumps(_told(data), indent=1, allow_nan=False) + "\n"


def _told(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _told(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_told(item) for item in value]
    return None if isinstance(value, float) and math.isnan(value) else value


def of_benchmark(records: Sequence[dict[str, Any]], name: str) -> list[dict[str, Any]]:
    """The records of one benchmark, in the order of their presets."""
    chosen = [data for data in records if data["benchmark"] == name]
    return sorted(chosen, key=lambda data: METHODS.index(data["settings"]["preset"]))


@cache
def commit() -> str | None:
    """The commit of the code, "-dirty" where it was changed since; None where nobody knows.

    It is that of the first call: who calls it before a long measurement learns what was measured,
    even if the tree goes on meanwhile.
    """
    here = Path(__file__).parent
    try:
        done = subprocess.run(
            ["git", "-C", str(here), "describe", "--always", "--dirty", "--abbrev=12"],
            capture_output=True, text=True, check=True, timeout=10,
        )  # fmt: skip
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() or None


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
