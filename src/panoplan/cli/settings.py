"""--preset, --config, --set and --seed."""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from typing import Any

from panoplan.config import PRESETS, Config, override, preset
from panoplan.errors import ConfigError, InputError
from panoplan.formats.atomic import read_text

_LIMIT = 2**20


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options that choose settings."""
    group = parser.add_argument_group("settings")
    group.add_argument("--preset", choices=PRESETS, default=None, help="default: default")
    group.add_argument("--config", type=Path, metavar="FILE.toml", help="settings of a file")
    group.add_argument(
        "--set", action="append", default=[], metavar="a.b=c", help="one setting; may be repeated"
    )
    group.add_argument("--seed", type=int, help="seed of every random choice (default: 0)")


def resolve(options: argparse.Namespace) -> Config:
    """The settings that the options ask for: preset, then file, then --set, then --seed.

    Raises:
        InputError: an unreadable file; ConfigError: an unknown or unfitting setting.
    """
    changes: dict[str, Any] = {}
    if options.config is not None:
        try:
            changes = tomllib.loads(read_text(options.config, _LIMIT))
        except tomllib.TOMLDecodeError as error:
            raise InputError(options.config, f"broken TOML ({error})", "TOML") from None
    name = options.preset or changes.get("preset", "default")
    config = override(preset(name), changes)
    config = override(config, {"preset": name})
    for word in options.set:
        config = override(config, _assignment(word))
    return config if options.seed is None else override(config, {"seed": options.seed})


def _assignment(word: str) -> dict[str, Any]:
    key, equals, text = word.partition("=")
    if not equals or not key:
        raise ConfigError("--set", repr(word), "a.b=value")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text
    for part in reversed(key.strip().split(".")):
        value = {part: value}
    return dict(value)
