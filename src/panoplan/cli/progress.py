"""Progress on stderr, for work of over two seconds."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from panoplan.pipeline import Progress


@contextmanager
def progress(title: str, *, quiet: bool) -> Iterator[Progress]:
    """A progress bar on stderr.

    Args:
        title: what is going on.
        quiet: shows nothing.

    Yields:
        A function of (done, in all) and, where it changes, the title.
    """
    if quiet:
        yield lambda done, total, now="": None
        return
    from rich.console import Console
    from rich.progress import Progress as Bar

    console = Console(stderr=True)
    with Bar(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(title, total=None)
        yield lambda done, total, now=title: bar.update(
            task, completed=done, total=total, description=now
        )
