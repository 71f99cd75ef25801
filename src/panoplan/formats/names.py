"""Names of files."""

from __future__ import annotations

import re


def natural_order(name: str) -> list[tuple[int, int, str]]:
    """A sort key that has numbers within names in the order of their values."""
    parts = re.split(r"(\d+)", name)
    return [(0, int(s[:1000]), "") if s.isdecimal() else (1, 0, s) for s in parts]
