"""The errors that panoplan raises on purpose."""

from __future__ import annotations


class PanoplanError(Exception):
    """Root of every error that panoplan raises on purpose."""


class InputError(PanoplanError):
    """Something given from outside cannot be used.

    The message is one line: where, what was found, what was expected.

    Args:
        source: file, folder or argument at fault.
        found: what it holds.
        expected: what would have been accepted.
    """

    def __init__(self, source: object, found: str, expected: str) -> None:
        self.source, self.found, self.expected = str(source), found, expected
        line = f"{source}: found {found}; expected {expected}"
        super().__init__(" ".join(line.split()))

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, str]]:
        """So that it can come from another process."""
        return type(self), (self.source, self.found, self.expected)


class ConfigError(InputError):
    """A setting is unknown, of the wrong type, or outside its range."""


class MissingExtraError(PanoplanError):
    """An optional package is needed and not installed.

    Args:
        purpose: what needs it.
        package: the package that is missing.
        extra: the extra of panoplan that brings it.
    """

    def __init__(self, purpose: str, package: str, extra: str) -> None:
        self.purpose, self.package, self.extra = purpose, package, extra
        super().__init__(
            f"{purpose} needs {package}, which is not installed: pip install 'panoplan[{extra}]'"
        )

    def __reduce__(self) -> tuple[type[MissingExtraError], tuple[str, str, str]]:
        """So that it can come from another process."""
        return type(self), (self.purpose, self.package, self.extra)
