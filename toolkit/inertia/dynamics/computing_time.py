"""A limit to the time that following a motion may take, and a forecast from how far it has come.

The limit holds for all that is computed within `limited`; loops look at it by a `Watch`. Without one they run on.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from inertia.errors import FieldPath, GeometryError

_FORECAST_AFTER = 1.0  # s, before which a loop is not judged by how far it has come
_LOOK_EVERY = 0.01  # s of the clock on the wall: the clock of the process is slow to read on some systems
_BY_FAR = 5.0  # times the time that is left, which a forecast must exceed: loops do not run evenly


class _Limit:
    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.end = time.process_time() + seconds


_limit: ContextVar[_Limit | None] = ContextVar("limit of computing time", default=None)


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Let what is computed within take so many seconds, and no more."""
    token = _limit.set(_Limit(seconds))
    try:
        yield
    finally:
        _limit.reset(token)


class Watch:
    """Looks at the limit during one loop, from now on.

    Attributes
    ----------
    limits : whether there is a limit
    """

    def __init__(self) -> None:
        self._limit = _limit.get()
        self.limits = self._limit is not None
        self._began = time.process_time() if self.limits else 0.0
        self._next = 0.0

    @property
    def elapsed(self) -> float:
        """Seconds since the loop began, where there is a limit."""
        return time.process_time() - self._began

    @property
    def left(self) -> float:
        """Seconds that are left."""
        return float("inf") if self._limit is None else self._limit.end - time.process_time()

    def require(self, done: float) -> None:
        """Raise `GeometryError` where the time is up, or the fraction of the loop that is done says that it will be."""
        if self._limit is None or (now := time.perf_counter()) < self._next:
            return
        self._next = now + _LOOK_EVERY
        elapsed, left = self.elapsed, self.left
        needed = elapsed / done if done > 0 else float("inf")
        if left > 0 and (elapsed < _FORECAST_AFTER or needed - elapsed < _BY_FAR * max(left, _FORECAST_AFTER)):
            return
        seconds = self._limit.seconds
        if left <= 0:
            how = f"takes longer than {seconds:g} s of computing, which is its limit"
        elif needed < float("inf"):
            total = seconds - left + needed - elapsed  # what other loops of the run have taken counts, too
            how = f"would take some {total:.2g} s of computing on this machine, and the limit is {seconds:g} s"
        else:
            how = f"has no end in sight after {elapsed:.2g} s of computing, and the limit is {seconds:g} s"
        raise GeometryError(
            f"the run {how}: ask for a shorter ",
            FieldPath("run.duration"),
            ", for less ",
            FieldPath("run.accuracy"),
            ", or for a larger ",
            FieldPath("run.time_limit"),
            code="time_limit",
        )
