"""The `panoplan` command."""

from __future__ import annotations

import argparse
import sys
import traceback
from collections.abc import Sequence

from panoplan import __version__
from panoplan.cli import (
    bench,
    cache,
    compare,
    demo,
    edit,
    evaluate,
    export,
    layout,
    model,
    run,
    simulate,
)
from panoplan.errors import PanoplanError

EXIT_BUG = 1
EXIT_INPUT = 2
EXIT_INTERRUPTED = 130


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    top = argparse.ArgumentParser(
        prog="panoplan",
        description="Turns a walk with a 360° camera into a floor plan.",
        epilog="exit codes: 0 done, 1 a bug of ours, 2 bad input or usage, 3 ran but found no "
        "room, 130 interrupted. Each command has --help with an example.",
    )
    top.add_argument("--version", action="version", version=f"panoplan {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in (
        demo,
        run,
        layout,
        edit,
        export,
        evaluate,
        compare,
        simulate,
        bench,
        model,
        cache,
    ):
        module.add_parser(commands)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command.

    Args:
        arguments: as after the program's name; the process's own where omitted.

    Returns:
        The exit code.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    options = parser().parse_args(words)
    try:
        return int(options.act(options))
    except PanoplanError as error:
        print(f"panoplan: {error}", file=sys.stderr)
        return EXIT_INPUT
    except KeyboardInterrupt:
        again = " ".join(["panoplan", *words])
        print(f"\npanoplan: interrupted; goes on with: {again}", file=sys.stderr)
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except Exception:
        traceback.print_exc()
        print("panoplan: this is a bug of ours; please report the lines above", file=sys.stderr)
        return EXIT_BUG


if __name__ == "__main__":
    sys.exit(main())
