"""Tables in Markdown."""

from __future__ import annotations

from collections.abc import Sequence


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table, a line break at its end."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def number(value: float | None, digits: int, unit: str = "") -> str:
    """A number with its unit; a dash where there is none."""
    return "–" if value is None else f"{value:.{digits}f}{unit}"


def pair(recall: float | None, precision: float | None) -> str:
    """Recall and precision; a dash where nothing was told."""
    if recall is None or precision is None:
        return "–"
    return f"{number(recall, 2)} / {number(precision, 2)}"
