"""Timing with repeats, medians and a budget for all of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from statistics import median
from typing import TypeVar

from inertia.errors import UsageError
from inertia.records import dataclass

T = TypeVar("T")

_SHARE = 0.1  # of the budget, that the repeats of one thing may take


@dataclass(frozen=True)
class Timing:
    """A time in s: the median, the fastest and the slowest of so many runs."""

    median: float
    fastest: float
    slowest: float
    runs: int


class Stopwatch:
    """Times what it is given, and knows how much of the budget is left.

    Parameters
    ----------
    repeats : runs of each thing, at least 1
    budget : s, for everything since the watch was made
    clock : tells the time in s

    Raises `UsageError` for repeats below 1 or a budget that is not positive and finite.
    """

    def __init__(self, repeats: int, budget: float, clock: Callable[[], float] = time.perf_counter) -> None:
        if isinstance(repeats, bool) or not isinstance(repeats, int) or repeats < 1:
            raise UsageError(f"the number of repeats is {repeats!r}: it must be a whole number, at least 1")
        if not 0 < budget < math.inf:
            raise UsageError(f"the budget is {budget!r} s: it must be positive and finite")
        self.repeats, self.budget, self._clock = repeats, budget, clock
        self._start = clock()

    @property
    def elapsed(self) -> float:
        """The s since the watch was made."""
        return self._clock() - self._start

    def affords(self, seconds: float) -> bool:
        """Say whether something that takes this long fits into what is left of the budget."""
        return self.elapsed + seconds <= self.budget

    def once(self, run: Callable[[], T]) -> tuple[float, T]:
        """Run once; return the time and the result."""
        begin = self._clock()
        result = run()
        return self._clock() - begin, result

    def timed(self, run: Callable[[], T], share: float = _SHARE) -> tuple[Timing, T]:
        """Run `repeats` times, or as often as a share of the budget allows, but once at least."""
        first, result = self.once(run)
        room = share * self.budget / first if first > 0 else math.inf
        runs = max(1, math.floor(min(self.repeats, room)))
        times = [first, *(self.once(run)[0] for _ in range(runs - 1))]
        return Timing(median(times), min(times), max(times), runs), result
