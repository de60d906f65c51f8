"""What can go wrong, and the exit code that says so.

Every message is one sentence that names what was measured, the limit, the place and the remedy.
"""

from __future__ import annotations


class InertiaError(Exception):
    """Base of every error this package raises on purpose."""

    exit_code = 1


class UsageError(InertiaError, ValueError):
    """An argument or option is not usable (exit code 2)."""

    exit_code = 2


class ReadError(InertiaError, ValueError):
    """A file cannot be read (exit code 3)."""

    exit_code = 3


class GeometryError(InertiaError, ValueError):
    """The mesh or the data cannot give an honest answer (exit code 4)."""

    exit_code = 4


def placed(error: InertiaError, place: str) -> InertiaError:
    """Return an error of the same kind whose sentence begins with a place: a file, a field.

    >>> placed(ReadError("no such file"), "rotor.toml: body[0]: ")
    ReadError('rotor.toml: body[0]: no such file')
    """
    kind = next(k for k in (UsageError, ReadError, GeometryError, InertiaError) if isinstance(error, k))
    return kind(f"{place}{error}")


def require_kind(value: object, kind: type, name: str, source: str) -> None:
    """Raise `UsageError` where an argument is of another kind than a verb takes: a path, most likely.

    >>> require_kind("bracket.stl", dict, "part", "inertia.read(path)")
    Traceback (most recent call last):
    inertia.errors.UsageError: part is a str, not a dict: give what inertia.read(path) returns
    """
    if not isinstance(value, kind):
        raise UsageError(f"{name} is a {type(value).__name__}, not a {kind.__name__}: give what {source} returns")
