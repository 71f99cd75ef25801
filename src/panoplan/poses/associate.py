"""Which layout belongs to which pose."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

import numpy as np

from panoplan.errors import InputError


@dataclass(frozen=True)
class Panorama:
    """A panorama that a folder lists.

    Attributes:
        id: its name.
        image: path of its image within the folder, may be empty.
        order: its place in the walk, None where the folder does not say.
    """

    id: str
    image: str = ""
    order: int | None = None


@dataclass(frozen=True)
class Association:
    """Poses and panoramas that belong together.

    Attributes:
        panoramas: one a pose, in the order of the poses; None where a pose has none.
        rule: how they were matched, in words.
    """

    panoramas: tuple[Panorama | None, ...]
    rule: str


def associate(labels: Sequence[str], panoramas: Sequence[Panorama], source: str) -> Association:
    """Matches the labels of a trajectory with panoramas.

    By id, by file stem, by order and by time; the rule that matches most poses is used.

    Args:
        labels: N first columns of the trajectory.
        panoramas: what there is a layout or an entry for.
        source: the trajectory's name, for messages.

    Returns:
        The association.

    Raises:
        InputError: two panoramas with one id; no rule matches; two rules match equally many poses
            and disagree.
    """
    ids = [p.id for p in panoramas]
    for name in ids:
        if ids.count(name) > 1:
            raise InputError(source, f"two panoramas named {name}", "one panorama an id")
    matches = {
        "id": _by_key(labels, [p.id for p in panoramas], panoramas),
        "file stem": _by_key(
            [PurePosixPath(label).stem for label in labels],
            [PurePosixPath(p.image).stem or p.id for p in panoramas],
            panoramas,
        ),
        "order": _by_order(labels, panoramas),
        "time": _by_time(labels, panoramas),
    }
    counts = {rule: sum(p is not None for p in found) for rule, found in matches.items()}
    most = max(counts.values())
    if most == 0:
        shown = ", ".join(ids[:3])
        raise InputError(
            source,
            f"labels such as {labels[0]!r} that match no layout",
            f"ids, file stems, orders or times of layouts such as {shown}",
        )
    best = [rule for rule, count in counts.items() if count == most]
    for rule in best[1:]:
        if matches[rule] != matches[best[0]]:
            here, there = (
                _first_difference(matches[a], matches[b])
                for a, b in ((best[0], rule), (rule, best[0]))
            )
            raise InputError(
                source,
                f"labels that fit by {best[0]} ({here}) and by {rule} ({there})",
                "labels that fit the layouts in one way",
            )
    return Association(
        tuple(matches[best[0]]), f"{most} of {len(labels)} poses matched by {best[0]}"
    )


def _first_difference(one: Sequence[Panorama | None], other: Sequence[Panorama | None]) -> str:
    for k, (a, b) in enumerate(zip(one, other, strict=True)):
        if a != b:
            return f"pose {k + 1} is {a.id if a else 'none'}"
    return ""


def _by_key(
    labels: Sequence[str], keys: Sequence[str], panoramas: Sequence[Panorama]
) -> list[Panorama | None]:
    known = dict(zip(keys, panoramas, strict=True))
    if len(known) < len(keys):
        return [None] * len(labels)
    return [known.get(label) for label in labels]


def _by_order(labels: Sequence[str], panoramas: Sequence[Panorama]) -> list[Panorama | None]:
    """By the listed order; without one, first to first where there are as many of both."""
    known = {p.order: p for p in panoramas if p.order is not None}
    numbers = [_whole(label) for label in labels]
    if known:
        return [None if n is None else known.get(n) for n in numbers]
    counted = all(n is not None for n in numbers)
    if counted and len(labels) == len(panoramas):
        return [*sorted(panoramas, key=lambda p: _natural(p.id))]
    return [None] * len(labels)


def _by_time(labels: Sequence[str], panoramas: Sequence[Panorama]) -> list[Panorama | None]:
    """By the nearest time stamp within half the median interval of the poses."""
    found: list[Panorama | None] = [None] * len(labels)
    times, stamps = [_decimal(label) for label in labels], [_decimal(p.id) for p in panoramas]
    if len(labels) < 2 or None in times or None in stamps:
        return found
    at = np.array(times, dtype=float)
    have = np.array(stamps, dtype=float)
    reach = float(np.median(np.abs(np.diff(at)))) / 2
    for k, time in enumerate(at):
        nearest = int(np.argmin(np.abs(have - time)))
        if abs(have[nearest] - time) <= reach:
            found[k] = panoramas[nearest]
    taken = [p.id for p in found if p is not None]
    return found if len(set(taken)) == len(taken) else [None] * len(labels)


def _whole(label: str) -> int | None:
    return int(label) if re.fullmatch(r"\d{1,18}", label) else None


def _decimal(label: str) -> float | None:
    return float(label) if re.fullmatch(r"\d{1,20}\.\d{1,20}", label) else None


def _natural(name: str) -> list[tuple[int, int | str]]:
    parts = re.split(r"(\d+)", name)
    return [(0, int(part)) if part.isdigit() else (1, part) for part in parts]
