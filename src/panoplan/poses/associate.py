"""Which panorama belongs to which pose."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

import numpy as np

from panoplan.errors import InputError
from panoplan.formats.names import natural_order

_ENDINGS = {".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff", ".npz", ".npy", ".json"}


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


Matches = tuple[Panorama | None, ...]


@dataclass(frozen=True)
class Association:
    """Poses and panoramas that belong together.

    Attributes:
        panoramas: one a pose, in the order of the poses; None where a pose has none.
        rule: how they were matched, in words.
    """

    panoramas: Matches
    rule: str


def associate(labels: Sequence[str], panoramas: Sequence[Panorama], source: object) -> Association:
    """Matches the labels of a trajectory with panoramas.

    Rules: by id; by file stem (of the image, or the id); by order (a whole number that a panorama
    lists; where none lists one and there are as many panoramas as poses with rising numbers, the
    first to the first); by time (nearest within half the median interval of the poses). A rule
    that would give one panorama to two poses is none. The rule that matches most poses is used; a
    rule that disagrees with it makes the match ambiguous, unless the first one matches all poses
    or all panoramas and the other one does not.

    Args:
        labels: N first columns of the trajectory.
        panoramas: what there is a layout or an entry for.
        source: the trajectory's name, for messages.

    Returns:
        The association.

    Raises:
        InputError: a label or an id twice; no rule matches; or the match is ambiguous.
    """
    _check_unique(labels, "poses labelled", source)
    _check_unique([p.id for p in panoramas], "panoramas named", source)
    matches = _all_matches(labels, panoramas)
    best = max(matches, key=lambda rule: _count(matches[rule]), default="id")
    most = _count(matches[best]) if matches else 0
    if most == 0:
        shown = ", ".join(p.id for p in panoramas[:3]) or "(there are none)"
        raise InputError(
            source,
            f"labels such as {', '.join(labels[:3])} that match no layout",
            f"ids, file stems, orders or times of layouts such as {shown}",
        )
    complete = most == min(len(labels), len(panoramas))
    for rule, other in matches.items():
        if complete and _count(other) < most:
            continue
        k = _first_conflict(matches[best], other)
        if k is not None:
            here, there = (_told(m[k]) for m in (matches[best], other))
            raise InputError(
                source,
                f"the label {labels[k]}, which is {here} by {best} and {there} by {rule}",
                "labels that fit the layouts in one way",
            )
    return Association(matches[best], f"{most} of {len(labels)} poses matched by {best}")


def _all_matches(labels: Sequence[str], panoramas: Sequence[Panorama]) -> dict[str, Matches]:
    candidates = {
        "id": _by_key(labels, [p.id for p in panoramas], panoramas),
        "file stem": _by_key(
            [_stem(label) for label in labels],
            [_stem(p.image or p.id) for p in panoramas],
            panoramas,
        ),
        "order": _by_order(labels, panoramas),
        "time": _by_time(labels, panoramas),
    }
    return {rule: found for rule, found in candidates.items() if _count(found) and _single(found)}


def _count(matches: Matches) -> int:
    return sum(p is not None for p in matches)


def _single(matches: Matches) -> bool:
    """Whether no panorama is given to two poses."""
    ids = [p.id for p in matches if p is not None]
    return len(set(ids)) == len(ids)


def _first_conflict(one: Matches, other: Matches) -> int | None:
    """The first pose that two rules give to different panoramas."""
    pairs = enumerate(zip(one, other, strict=True))
    return next((k for k, (a, b) in pairs if a is not None and b is not None and a != b), None)


def _told(panorama: Panorama | None) -> str:
    return "none" if panorama is None else panorama.id


def _by_key(labels: Sequence[str], keys: Sequence[str], panoramas: Sequence[Panorama]) -> Matches:
    known = dict(zip(keys, panoramas, strict=True))
    if len(known) < len(keys):
        return ()
    return tuple(known.get(label) for label in labels)


def _by_order(labels: Sequence[str], panoramas: Sequence[Panorama]) -> Matches:
    """By the listed order; without one, first to first where there are as many of both."""
    known = {p.order: p for p in panoramas if p.order is not None}
    if known:
        numbers = [int(s) if re.fullmatch(r"\d{1,18}", s) else None for s in labels]
        return tuple(None if n is None else known.get(n) for n in numbers)
    values = [_number(label) for label in labels]
    rising = None not in values and np.all(np.diff(np.array(values, dtype=float)) > 0)
    if rising and len(labels) == len(panoramas):
        return tuple(sorted(panoramas, key=lambda p: natural_order(p.id)))
    return ()


def _by_time(labels: Sequence[str], panoramas: Sequence[Panorama]) -> Matches:
    """By the nearest time stamp within half the median interval of the poses."""
    times, stamps = [_time(label) for label in labels], [_time(_stem(p.id)) for p in panoramas]
    if len(labels) < 2 or not stamps or None in times or None in stamps:
        return ()
    at, have = np.array(times, dtype=float), np.array(stamps, dtype=float)
    reach = float(np.median(np.diff(np.sort(at)))) / 2
    found: list[Panorama | None] = [None] * len(labels)
    # From the panoramas, which may be far fewer than the poses.
    for stamp, panorama in zip(have, panoramas, strict=True):
        nearest = int(np.argmin(np.abs(at - stamp)))
        if abs(at[nearest] - stamp) <= reach:
            if found[nearest] is not None:
                return ()
            found[nearest] = panorama
    return tuple(found)


def _check_unique(names: Sequence[str], what: str, source: object) -> None:
    for name, count in Counter(names).items():
        if count > 1:
            raise InputError(source, f"two {what} {name}", "each name once")


def _stem(name: str) -> str:
    """The last part of a path without the ending of an image or layout; a time keeps its dot."""
    path = PurePosixPath(name)
    return path.stem if path.suffix.lower() in _ENDINGS else path.name


def _number(label: str) -> float | None:
    return float(label) if re.fullmatch(r"\d{1,20}(\.\d{1,20})?(e\+?\d{1,2})?", label) else None


def _time(label: str) -> float | None:
    """A number that can be a time: with decimals, or nine digits and more."""
    return _number(label) if re.fullmatch(r"\d{9,20}|\d{1,20}\.\d.*", label) else None
