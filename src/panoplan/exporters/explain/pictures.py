"""The pictures of an explanation, as files."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from panoplan.errors import InputError
from panoplan.exporters.explain.floors import floors_figure
from panoplan.exporters.explain.rooms import rooms_figure
from panoplan.exporters.explain.scale import scale_figure
from panoplan.exporters.explain.views import views_figure
from panoplan.exporters.explain.walls import rounds_figure, walls_figure
from panoplan.exporters.png import figure_png
from panoplan.formats.atomic import make_folder, write_bytes
from panoplan.types.explain import ExplainedRoom, Explanation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = "explain"
_DOTS_PER_INCH = 160
_OURS = re.compile(r"[1-4]_(scale|rooms|views|walls|floors|rounds)(_\w+)?\.png")


def write_explanation(
    folder: Path,
    explanation: Explanation,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Path, ...]:
    """Writes a picture a stage; those of an earlier explanation go.

    These are 1_scale.png and 2_rooms.png, then for fused rooms 3_views.png and 4_floors.png, for
    rooms by iSPA 3_walls.png and 4_rounds_ROOM.png; where the rooms or levels do not fit on one,
    numbered ones.

    Args:
        folder: made where it does not exist.
        explanation: what is drawn.
        progress: called with (pictures done, pictures in all).

    Returns:
        The files written.

    Raises:
        InputError: the place cannot be written.
    """
    forget_explanation(folder)
    make_folder(folder)
    drawn = _pictures(explanation)
    written = []
    for done, (name, draw) in enumerate(drawn):
        progress(done, len(drawn))
        figure = draw()
        long_side = _DOTS_PER_INCH * float(max(figure.get_size_inches()))
        write_bytes(folder / name, figure_png(figure, round(long_side)))
        written.append(folder / name)
    return tuple(written)


def forget_explanation(folder: Path) -> None:
    """Removes the pictures of an earlier explanation, and the folder if nothing else is in it.

    Raises:
        InputError: they cannot be removed.
    """
    if not folder.is_dir():
        return
    try:
        names = list(folder.iterdir())
        ours = [path for path in names if _OURS.fullmatch(path.name)]
        for path in ours:
            path.unlink()
        if ours == names:
            folder.rmdir()
    except OSError as error:
        raise InputError(
            folder, f"{error.strerror or error}", "a folder that can be written"
        ) from None


def _pictures(explanation: Explanation) -> list[tuple[str, Callable[[], Figure]]]:
    """Names and how to draw them, so that only one figure is held at a time."""
    rooms, groupings = explanation.rooms, explanation.groupings
    found: list[tuple[str, Callable[[], Figure]]] = [
        ("1_scale.png", partial(scale_figure, explanation)),
        *_paged("2_rooms", 20, partial(rooms_figure, explanation), rooms),
    ]
    for grouping in groupings:
        level = f"_level_{grouping.level}" if len(groupings) > 1 else ""
        found.append((f"3_views{level}.png", partial(views_figure, explanation, grouping)))
    by_ispa = [room for room in rooms if room.walls]
    found += _paged("3_walls", 12, partial(walls_figure, explanation), by_ispa)
    fused = [room for room in rooms if room.floor]
    found += _paged("4_floors", 12, partial(floors_figure, explanation), fused)
    found += [
        (f"4_rounds_{room.id}.png", partial(rounds_figure, explanation, room))
        for room in by_ispa
        if room.walls and room.walls.rounds
    ]
    return found


def _paged(
    stem: str,
    per_page: int,
    draw: Callable[[Sequence[ExplainedRoom]], Figure],
    rooms: Sequence[ExplainedRoom],
) -> list[tuple[str, Callable[[], Figure]]]:
    pages = [rooms[k : k + per_page] for k in range(0, len(rooms), per_page)]
    names = [f"{stem}_{k + 1}.png" if len(pages) > 1 else f"{stem}.png" for k in range(len(pages))]
    return [(name, partial(draw, page)) for name, page in zip(names, pages, strict=True)]
