"""Runs the benchmark: what is not kept is made, everything is scored."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from panoplan.bench.parallel import Workers, mapped
from panoplan.bench.record import record, to_json
from panoplan.bench.v1.predict import Row, Task, predict
from panoplan.bench.v1.scenes import Recording, Source
from panoplan.bench.v1.score import score, summary
from panoplan.bench.v1.store import Store
from panoplan.formats.atomic import write_text
from panoplan.pipeline import Progress


def run(
    sources: Sequence[Source],
    rows: Sequence[Row],
    store: Store,
    workers: Workers,
    scorers: Workers,
    progress: Progress,
) -> dict[str, dict[str, Any]]:
    """Predicts what is not kept and scores all.

    Stopped at any time, it goes on where it stopped.

    Args:
        sources: scenes.
        rows: of Table II.
        store: what is kept.
        workers: make scenes and predictions; they need not see the store.
        scorers: score; they do.
        progress: called with (done, in all) and what is going on; predictions are counted in
            keyframes.

    Returns:
        For each row's name the summary and each scene's scores.

    Raises:
        InputError: a scene that is not complete; WorkerLostError: as the workers.
    """
    _keep_scenes(sources, store, workers, progress)
    tasks = [Task(source, row) for row in rows for source in sources]
    _keep_predictions(tasks, store, workers, progress)

    def told(done: int, total: int) -> None:
        progress(done, total, "scores")

    scored = mapped(partial(_scored, store=store), tasks, scorers, told)
    figures: dict[str, dict[str, Any]] = {}
    for row in rows:
        scenes = [made for task, made in zip(tasks, scored, strict=True) if task.row == row]
        figures[row.name] = {"summary": summary(scenes), "scenes": scenes}
    return figures


def write_methods(
    figures: dict[str, dict[str, Any]], scenes_of: str, rows: Sequence[Row], folder: Path
) -> list[Path]:
    """Writes one file a method.

    Args:
        figures: of `run`.
        scenes_of: what the scenes are of: a family, or "dataset".
        rows: of `run`.
        folder: where to.

    Returns:
        The files, `v1-<scenes_of>-<method>.json`.
    """
    paths = []
    for method in dict.fromkeys(row.method for row in rows):
        own = [row for row in rows if row.method == method]
        told = {"shares": {f"{row.share:g}": figures[row.name] for row in own}}
        paths.append(write_figures("v1", own[0].settings, scenes_of, told, folder))
    return paths


def write_figures(
    benchmark: str,
    settings: dict[str, Any],
    scenes_of: str,
    figures: dict[str, Any],
    folder: Path,
) -> Path:
    """Writes figures with settings, commit and machine, as the tables are made from.

    Args:
        benchmark: "v1", or "v1-" and a study's name.
        settings: of the method, "preset" its name.
        scenes_of: what the scenes are of.
        figures: plain values.
        folder: where to.

    Returns:
        The file, `<benchmark>-<scenes_of>-<method>.json`.
    """
    path = folder / f"{benchmark}-{scenes_of}-{settings['preset']}.json"
    data = record(benchmark, settings, {"scenes_of": scenes_of, **figures})
    write_text(path, to_json(data))
    return path


def _keep_scenes(
    sources: Sequence[Source], store: Store, workers: Workers, progress: Progress
) -> None:
    missing = [source for source in sources if not store.has_scene(source)]
    for done, (number, recording) in enumerate(workers(_opened, missing)):
        store.keep_scene(missing[number], recording)
        progress(done + 1, len(missing), "scenes")


def _opened(source: Source) -> Recording:
    """Without its layouts, which are large."""
    return source.open().bare


def _keep_predictions(
    tasks: Sequence[Task], store: Store, workers: Workers, progress: Progress
) -> None:
    length = {task.source.name: store.scene(task.source).keyframes for task in tasks}
    missing: dict[str, list[Task]] = {}
    for task in tasks:
        if not store.has_prediction(task):
            missing.setdefault(task.source.name, []).append(task)
    # The longest walks first, so that no process is left alone with one.
    names = sorted(missing, key=lambda name: -length[name])
    work = [missing[name] for name in names]
    total = sum(length[name] * len(missing[name]) for name in names)
    done = 0
    for number, made in workers(predict, work):
        for task, prediction in zip(work[number], made, strict=True):
            store.keep_prediction(task, prediction)
        done += length[names[number]] * len(made)
        progress(done, total, "predictions")


def _scored(task: Task, store: Store) -> dict[str, Any]:
    made = store.prediction(task)
    return {"scene": task.source.name, **score(store.scene(task.source), made)}
