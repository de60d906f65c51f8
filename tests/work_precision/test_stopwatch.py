"""Repeats, medians and the budget, by a clock that only moves when it is told to."""

import math
from collections.abc import Callable

import pytest

from inertia.errors import UsageError
from inertia.work_precision.stopwatch import Stopwatch, Timing


class Clock:
    """Stands still but for `work`, which takes the next of the durations."""

    def __init__(self, *durations: float) -> None:
        self.now, self.durations = 100.0, list(durations)

    def __call__(self) -> float:
        return self.now

    def work(self) -> str:
        self.now += self.durations.pop(0)
        return "done"


@pytest.mark.parametrize(
    ("durations", "timing"),
    [
        ((1.0,), Timing(1.0, 1.0, 1.0, 1)),
        ((3.0, 1.0, 2.0), Timing(2.0, 1.0, 3.0, 3)),
        ((4.0, 1.0, 2.0, 16.0), Timing(3.0, 1.0, 16.0, 4)),
    ],
)
def test_the_median_and_the_spread(durations: tuple[float, ...], timing: Timing) -> None:
    clock = Clock(*durations)
    assert Stopwatch(len(durations), 1000.0, clock).timed(clock.work) == (timing, "done")


def test_a_run_is_timed_alone() -> None:
    clock = Clock(2.0, 3.0)
    watch = Stopwatch(5, 1000.0, clock)
    clock.work()
    assert watch.once(clock.work) == (3.0, "done")


@pytest.mark.parametrize(("each", "runs"), [(0.5, 5), (1.0, 5), (2.0, 2), (4.0, 1), (99.0, 1)])
def test_repeats_take_a_tenth_of_the_budget_at_most(each: float, runs: int) -> None:
    clock = Clock(*[each] * 5)
    timing, _ = Stopwatch(5, 50.0, clock).timed(clock.work)
    assert (timing.runs, timing.median) == (runs, each)


def test_a_clock_too_coarse_to_see_a_run_ends_it_all_the_same() -> None:
    clock = Clock(0.0, 0.0, 0.0)
    assert Stopwatch(3, 1.0, clock).timed(clock.work)[0] == Timing(0.0, 0.0, 0.0, 3)


def test_what_is_afforded_shrinks_with_the_time_spent() -> None:
    clock = Clock(6.0)
    watch = Stopwatch(1, 10.0, clock)
    assert (watch.affords(10.0), watch.affords(10.5)) == (True, False)
    watch.once(clock.work)
    assert (watch.affords(4.0), watch.affords(4.5)) == (True, False)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Stopwatch(0, 1.0),
        lambda: Stopwatch(-3, 1.0),
        lambda: Stopwatch(2.5, 1.0),
        lambda: Stopwatch(True, 1.0),
    ],
)
def test_repeats_are_counted_from_one(make: Callable[[], Stopwatch]) -> None:
    with pytest.raises(UsageError, match="repeats"):
        make()


@pytest.mark.parametrize("budget", [0.0, -1.0, math.nan, math.inf])
def test_a_budget_is_positive_and_finite(budget: float) -> None:
    with pytest.raises(UsageError, match="budget"):
        Stopwatch(1, budget)
