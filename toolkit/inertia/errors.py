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
