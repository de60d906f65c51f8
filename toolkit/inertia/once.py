"""What is found out once about a part, within a context, however often it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, TypeVar

_Result = TypeVar("_Result")

_known: ContextVar[dict[Hashable, tuple[object, Any]] | None] = ContextVar("known", default=None)
"""What was found out in a context that looks once, each with what it is about, so that its identity stays its own."""


@contextmanager
def checking_once() -> Iterator[None]:
    """Let what `once` is asked for within this context be found out once.

    A part that is checked again in the same way has the report that it had, and what does not depend on the way is not
    looked for again either.
    """
    before = _known.get()
    token = _known.set({} if before is None else before)
    try:
        yield
    finally:
        _known.reset(token)


def once(what: Hashable, about: object, find: Callable[[], _Result]) -> _Result:
    """Return what `find` returns, or has returned in this context for `what` about the same object."""
    if (known := _known.get()) is None:
        return find()
    key = what, id(about)
    if key not in known:
        known[key] = about, find()
    result: _Result = known[key][1]
    return result
