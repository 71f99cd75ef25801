"""Pictures of the best, the median and the worst scene of a row."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from panoplan.bench.v1.predict import Row, Task
from panoplan.bench.v1.scenes import Source
from panoplan.bench.v1.score import precision, recall
from panoplan.bench.v1.store import Store
from panoplan.exporters.compare import draw_comparison
from panoplan.exporters.png import figure_png
from panoplan.formats.atomic import make_folder, write_bytes

_LONG_SIDE_PX = 1500
_RANKS = {"best": 1.0, "median": 0.5, "worst": 0.0}


def f_score(counts: Sequence[int]) -> float:
    """Harmonic mean of recall and precision; 0 where nothing was found."""
    both = (recall(counts) or 0.0, precision(counts) or 0.0)
    return 2 * both[0] * both[1] / sum(both) if sum(both) else 0.0


def chosen(scenes: Sequence[dict[str, Any]]) -> dict[str, int]:
    """Which scenes are the best, the median and the worst.

    Args:
        scenes: rows of `score`.

    Returns:
        Place in `scenes` by rank, by the mean F score of rooms at IoU .7 and corners.
    """
    values = [
        f_score(scene["aligned"]["rooms_70"]) + f_score(scene["aligned"]["corners"])
        for scene in scenes
    ]
    order = np.argsort(values, kind="stable")
    return {name: int(order[round(rank * (len(order) - 1))]) for name, rank in _RANKS.items()}


def write_pictures(
    folder: Path,
    scenes_of: str,
    row: Row,
    scenes: Sequence[dict[str, Any]],
    sources: Sequence[Source],
    store: Store,
) -> list[Path]:
    """Draws truth, plan and both over one another.

    Args:
        folder: where to.
        scenes_of: what the scenes are of.
        row: whose plans.
        scenes: its scores, a source each.
        sources: the scenes.
        store: what is kept.

    Returns:
        The files, `v1-<scenes_of>-<rank>.png`; none of a scene without a plan.
    """
    make_folder(folder)
    paths = []
    for rank, place in chosen(scenes).items():
        plan = store.prediction(Task(sources[place], row)).plan
        if plan is None:
            continue
        figure = draw_comparison(plan, store.scene(sources[place]).truth, align="scale")
        paths.append(folder / f"v1-{scenes_of}-{rank}.png")
        write_bytes(paths[-1], figure_png(figure, _LONG_SIDE_PX))
    return paths
