"""The folder of a run: settings.toml, log.jsonl, plan.json, and the state of an unfinished one.

`scene/` in it holds what was made from images: a sequence folder like any other.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from panoplan import __version__
from panoplan.config import Config, as_dict
from panoplan.errors import InputError
from panoplan.estimator.state import State, Walk
from panoplan.formats.atomic import append_text, make_folder, write_text
from panoplan.formats.plan_json import write_plan
from panoplan.formats.state import read_state, write_state
from panoplan.types.events import Event
from panoplan.types.keyframe import Keyframe
from panoplan.types.plan import FloorPlan

SETTINGS = "settings.toml"
SCENE = "scene"
_STATE = ".unfinished.npz"
_LOG = "log.jsonl"
_SAVE_EVERY_S = 5.0


def fingerprint(keyframes: Sequence[Keyframe], config: Config, walk: Walk) -> str:
    """A hash of all that a plan depends on."""
    digest = hashlib.sha256(f"{__version__} {config!r} {walk!r}".encode())
    for keyframe in keyframes:
        digest.update(repr((keyframe.id, keyframe.missing)).encode())
        digest.update(keyframe.pose.rotation.tobytes() + keyframe.pose.translation.tobytes())
        for part in (keyframe.layout, keyframe.layout and keyframe.layout.spans):
            for item in () if part is None else dataclasses.fields(part):
                value = getattr(part, item.name)
                digest.update(value.tobytes() if isinstance(value, np.ndarray) else b"-")
    return digest.hexdigest()


class RunFolder:
    """Writes what a run makes, and remembers how far it came.

    Args:
        path: made by `begin` where it does not exist.
        force: whether a folder that holds other things may be used.

    Raises:
        InputError: the path is a file, cannot be read, or holds other things.
    """

    def __init__(self, path: Path, *, force: bool = False) -> None:
        self.path = path
        try:
            names = {item.name for item in path.iterdir()} if path.exists() else set()
        except OSError as error:
            raise InputError(path, f"{error.strerror or error}", "a folder to write to") from None
        if names - {SCENE} and not force and not names & {SETTINGS, _STATE}:
            raise InputError(path, "a folder with other files", "an empty folder, or --force")
        self._fingerprint = ""
        self._saved_at = time.monotonic()

    @property
    def scene(self) -> Path:
        """Where a sequence folder made from images belongs."""
        return self.path / SCENE

    def begin(self, keyframes: Sequence[Keyframe], config: Config, walk: Walk) -> State | None:
        """Makes the folder, writes the settings; gives the state of an unfinished equal run.

        Args:
            keyframes: of the whole walk.
            config: settings.
            walk: what is known of it.

        Returns:
            The state to go on from, or None.
        """
        make_folder(self.path)
        self._fingerprint = fingerprint(keyframes, config, walk)
        write_text(self.path / SETTINGS, tomli_w.dumps(as_dict(config)))
        state = self._unfinished()
        kept = self._lines_before(0 if state is None else state.seen)
        write_text(self.path / _LOG, "".join(kept))
        return state

    def record(self, number: int, events: Sequence[Event]) -> None:
        """Appends events of keyframe `number` to log.jsonl."""
        lines = (
            {"keyframe_number": number, "event": type(event).__name__, **_plain(event)}
            for event in events
        )
        append_text(
            self.path / _LOG,
            "".join(json.dumps(line, ensure_ascii=False) + "\n" for line in lines),
        )

    def save(self, state: State, *, now: bool = False) -> None:
        """Saves the state every few seconds, or at once."""
        if now or time.monotonic() - self._saved_at >= _SAVE_EVERY_S:
            write_state(self.path / _STATE, state, self._fingerprint)
            self._saved_at = time.monotonic()

    def show(self, config: Config, plan: FloorPlan) -> None:
        """Writes settings.toml and plan.json of a walk that is not over."""
        make_folder(self.path)
        write_text(self.path / SETTINGS, tomli_w.dumps(as_dict(config)))
        write_plan(self.path / "plan.json", plan)

    def complete(self, plan: FloorPlan) -> None:
        """Writes plan.json and drops the state of the unfinished run."""
        write_plan(self.path / "plan.json", plan)
        (self.path / _STATE).unlink(missing_ok=True)

    def _unfinished(self) -> State | None:
        path = self.path / _STATE
        if not path.exists():
            return None
        try:
            state, belongs_to = read_state(path)
        except InputError:
            # Of another version, or cut short with the machine: the walk begins anew.
            return None
        return state if belongs_to == self._fingerprint else None

    def _lines_before(self, number: int) -> list[str]:
        path = self.path / _LOG
        if number == 0 or not path.exists():
            return []
        try:
            with path.open(encoding="utf-8") as stream:
                whole = [line for line in stream if line.endswith("\n")]
            return [line for line in whole if json.loads(line)["keyframe_number"] < number]
        except (OSError, ValueError, KeyError, TypeError):
            raise InputError(path, "a damaged log", "that of the unfinished run, or none") from None


def _plain(value: Any) -> Any:
    if dataclasses.is_dataclass(value):
        return {f.name: _plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [_plain(item) for item in value] if isinstance(value, tuple) else value
