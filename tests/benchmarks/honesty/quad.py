"""Equations of motion integrated in quadruple precision, 113 bits, by heyoka's Taylor series: the truth of a case.

Every equation is integrated twice, with tolerances that take other orders and other steps, and what the two are apart
is the error that is stated. Equations are compiled once, with parameters for all figures. Nothing here is shared with
the package under test.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import heyoka
import mpmath
import numpy as np

Quad = heyoka.real128
TOLERANCES = "1e-31", "1e-27"
MOST_STEPS = 4000
DIGITS = 50


class TooLongError(Exception):
    """The motion takes more steps than a case may."""


@dataclass(frozen=True)
class Answer:
    """States (n, m) in quadruple precision, and by how much (n,) the coarser run is off, component by component."""

    states: np.ndarray
    apart: np.ndarray


@dataclass(frozen=True)
class Span:
    """A span of time with its parameters: `end` and they in units of the flow."""

    end: Any
    parameters: Sequence[Any]


class Flow:
    """Equations with parameters, compiled for two tolerances: `equations` takes `par` and returns (variable, rate)s."""

    def __init__(self, equations: Callable[[Any], list[tuple[Any, Any]]]) -> None:
        class Counted:
            most = 0

            def __getitem__(self, index: int) -> Any:
                self.most = max(self.most, index + 1)
                return heyoka.par[index]

        counted = Counted()
        system = equations(counted)
        self.parameters = counted.most
        state = np.array([Quad(0)] * len(system))
        pars = np.array([Quad(0)] * max(counted.most, 1))
        self.integrators = [
            heyoka.taylor_adaptive(
                system, state=state, pars=pars[: counted.most], fp_type=Quad, tol=Quad(each), compact_mode=True
            )
            for each in TOLERANCES
        ]

    def follow(self, start: Sequence[Any], spans: Sequence[Span], times: np.ndarray) -> Answer:
        """Return the states at `times` (n,) in quadruple precision, ascending from 0, and how far the runs differ."""
        one, other = (self._states(each, start, spans, times) for each in self.integrators)
        return Answer(one, np.array([max(abs(float(x)) for x in row) for row in one - other]))

    def _states(self, run: Any, start: Sequence[Any], spans: Sequence[Span], times: np.ndarray) -> np.ndarray:
        run.time = Quad(0)
        run.state[:] = np.array([quad(x) for x in start])
        states = np.tile(np.array(run.state), (len(times), 1))
        first = int(np.searchsorted(times, Quad(0), side="right"))
        for span in spans:
            end = quad(span.end)
            stop = len(times) if span is spans[-1] else int(np.searchsorted(times, end, side="right"))
            run.pars[:] = np.array([quad(x) for x in span.parameters])
            grid = [Quad(run.time), *times[first:stop]]
            if grid[-1] < end:
                grid.append(end)
            if len(grid) > 1:
                result = run.propagate_grid(np.array(grid), max_steps=MOST_STEPS)
                if result[0] != heyoka.taylor_outcome.time_limit:
                    raise TooLongError(str(result[0]))
                states[first:stop] = result[5][1 : 1 + stop - first]
            first = stop
        return states


def quad(x: Any) -> Any:
    """Return a number, an mpf among them, in quadruple precision."""
    if isinstance(x, Quad):
        return x
    if isinstance(x, float | int | np.floating):
        return Quad(float(x))
    total = Quad(0)
    with mpmath.workdps(DIGITS):
        for _ in range(3):
            part = float(x)
            total += Quad(part)
            x = x - part
    return total
