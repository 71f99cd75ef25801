"""panoplan cache: what is kept of earlier runs."""

from __future__ import annotations

import argparse
from typing import Any


def add_parser(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "cache",
        help="what is kept of earlier runs",
        description="Tells where results about images are kept, and how much they take up. They "
        "are found by the content of the images; those used longest ago go by themselves.",
        epilog="example: panoplan cache --clear",
    )
    parser.add_argument("--clear", action="store_true", help="remove all of it")
    parser.set_defaults(act=act)


def act(options: argparse.Namespace) -> int:
    """Runs the command."""
    from panoplan.cache import Cache, cache_folder

    cache = Cache(cache_folder())
    entries = cache.entries()
    size_mb = sum(size for _, size in entries) / 1e6
    if options.clear:
        cache.trim(0)
        print(f"{cache.folder}: {len(entries)} results of {size_mb:.1f} MB removed")
    else:
        print(f"{cache.folder}: {len(entries)} results, {size_mb:.1f} MB")
    return 0
