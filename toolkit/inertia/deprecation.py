"""Warnings before something public goes, for two minor versions, with what to use in its place (docs/stability.md)."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

MINOR_VERSIONS = 2
"""For so many it warns."""

last: dict[str, tuple[int, int]] = {}
"""What warns, by its public name, and the last minor version that has it."""


def deprecated(
    name: str, *, since: str, instead: str
) -> Callable[[Callable[Arguments, Result]], Callable[Arguments, Result]]:
    """Let a public function warn that it goes.

    Parameters
    ----------
    name : as users write it
    since : the first minor version that warns, as "0.2"
    instead : what to use, as users write it

    >>> @deprecated("inertia.cone", since="0.2", instead="inertia.cylinder")
    ... def cone(): ...
    >>> last.pop("inertia.cone")
    (0, 3)
    """
    major, minor = map(int, since.split("."))
    last[name] = major, minor + MINOR_VERSIONS - 1
    text = f"{name} is deprecated since {since} and may go after {major}.{last[name][1]}: use {instead}"

    def warning(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
        @functools.wraps(function)
        def call(*arguments: Arguments.args, **options: Arguments.kwargs) -> Result:
            warnings.warn(text, DeprecationWarning, stacklevel=2)
            return function(*arguments, **options)

        return call

    return warning
