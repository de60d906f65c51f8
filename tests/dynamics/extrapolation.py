"""An independent solver of any smooth equations in mpmath: the modified midpoint rule, extrapolated (Gragg, Bulirsch,
Stoer; Hairer, Nørsett & Wanner, *Solving ODEs I*, § II.9). Nothing here is shared with the package under test.

>>> with mpmath.workdps(38):
...     turned = follow(lambda t, y: [y[1], -y[0]], [mpmath.mpf(0), mpmath.mpf(1)], [mpmath.pi / 2])
...     abs(turned[0][0] - 1) < 1e-27
True
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mpmath

Rate = Callable[[Any, list[Any]], list[Any]]

COLUMNS = 12


def follow(rate: Rate, start: Sequence[Any], times: Sequence[Any], first: float = 0.1) -> list[list[Any]]:
    """Return the states at `times`, ascending from 0, each step to all digits but ten; `first` is a guess of one."""
    tolerance = mpmath.mpf(10) ** (10 - mpmath.mp.dps)
    now, state, step = mpmath.mpf(0), [mpmath.mpf(x) for x in start], mpmath.mpf(first)
    out = []
    for target in map(mpmath.mpf, times):
        while now < target:
            length = min(step, target - now)
            ahead, error = _extrapolated(rate, now, state, length)
            share = 0.9 * float(tolerance / error) ** (0.5 / COLUMNS) if error else 2.0
            if error > tolerance:
                step = share * length
                continue
            now, state = (target, ahead) if now + length >= target else (now + length, ahead)
            if length == step:
                step *= min(share, 2.0)
        out.append(state)
    return out


def _extrapolated(rate: Rate, now: Any, state: list[Any], step: Any) -> tuple[list[Any], Any]:
    counts = [2 * (k + 1) for k in range(COLUMNS)]
    slope = rate(now, state)
    row: list[list[Any]] = []
    for j, count in enumerate(counts):
        h = step / count
        before, at = state, [y + h * k for y, k in zip(state, slope, strict=True)]
        for m in range(1, count):
            k = rate(now + m * h, at)
            before, at = at, [y + 2 * h * f for y, f in zip(before, k, strict=True)]
        fresh = [at]
        for i in range(j):
            share = mpmath.mpf(1) / ((mpmath.mpf(count) / counts[j - i - 1]) ** 2 - 1)
            fresh.append([a + share * (a - b) for a, b in zip(fresh[i], row[i], strict=True)])
        last, row = row, fresh
    error = max(abs(a - b) / (1 + abs(a)) for a, b in zip(row[-1], last[-1], strict=True))
    return row[-1], error
