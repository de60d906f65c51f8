"""The least that so many places leave: a linear program, a bound from below that no plan beats.

What a plane's places do lies in a convex set (`capacity`) that is known by its extents in some directions, so the
program's answer is a bound whichever these are. Where settings of a plane act at different places along the shaft, its
set has four dimensions, too many for directions all around: those are added in which the program goes past it, which
its multipliers name, and it is solved again (Kelley's cutting planes).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.capacity import Capacity
from inertia.balancing.corrections.correction_plane import FULL_TURN
from inertia.balancing.unbalance import Complex

_TANGENTS = 64
_ROUNDS = 12
_RISE = 1e-4  # of the bound


def least_residual(
    capacities: Sequence[Capacity], start: Complex, counts: Sequence[int], farther: Sequence[float] | None = None
) -> tuple[float, Complex]:
    """Return a bound from below of what plans leave in the worst plane, and what each plane does (n, t) to leave it.

    Parameters
    ----------
    capacities : of each plane; directions are added to them
    start : (t,) what is there, over the limits
    counts : places of each plane, at most
    farther : how many times as far each plane is taken to reach
    """
    times = farther or [1.0] * len(capacities)
    least, shares = 0.0, np.zeros((len(capacities), len(start)), complex)
    for _ in range(_ROUNDS):
        found, coordinates, multipliers = _solved(capacities, start, counts, times)
        if not coordinates:
            break
        rose = found > least * (1 + _RISE)
        least = max(least, found)
        shares = np.array([each.basis @ at for each, at in zip(capacities, coordinates, strict=True)])
        past = [
            each.add_where_past(-(multipliers @ each.basis) / np.abs(multipliers).max(), at, count, more)
            for each, at, count, more in zip(capacities, coordinates, counts, times, strict=True)
            if each.varies and multipliers.any()
        ]
        if not any(past) or not rose:
            break
    return least, shares


def _solved(
    capacities: Sequence[Capacity], start: Complex, counts: Sequence[int], times: Sequence[float]
) -> tuple[float, list[Complex], Complex]:
    """Return the program's least, its coordinates (b,) of each plane, and its multipliers (t,); none without answer."""
    from scipy.optimize import linprog

    columns = [each.basis.shape[1] for each in capacities]
    ends = np.cumsum([0, *columns]).tolist()
    tables = [each.rows(count) for each, count in zip(capacities, counts, strict=True)]
    # Of the order of 1 in all coordinates.
    scales = [float(reach.max(initial=0.0)) or 1.0 for _, reach in tables]
    basis = np.hstack([each.basis * scale for each, scale in zip(capacities, scales, strict=True)])
    turns = np.exp(-1j * FULL_TURN * np.arange(_TANGENTS) / _TANGENTS)
    turned = (turns[:, None, None] * basis).reshape(-1, ends[-1])
    rows = [np.hstack([turned.real, -turned.imag, np.full((len(turned), 1), -1.0)])]
    high = [-(turns[:, None] * start).real.ravel()]
    for (directions, reach), scale, more, first, last in zip(tables, scales, times, ends, ends[1:], strict=False):
        row = np.zeros((len(directions), 2 * ends[-1] + 1))
        row[:, first:last], row[:, ends[-1] + first : ends[-1] + last] = directions.real, -directions.imag
        rows.append(row)
        high.append(more * reach / scale)
    cost = np.zeros(2 * ends[-1] + 1)
    cost[-1] = 1.0
    bounds = [(None, None)] * (2 * ends[-1]) + [(0.0, None)]
    solution = linprog(cost, A_ub=np.vstack(rows), b_ub=np.concatenate(high), bounds=bounds, method="highs")
    if solution.x is None:
        return 0.0, [], np.zeros(len(start), complex)
    numbers: Complex = solution.x[: ends[-1]] + 1j * solution.x[ends[-1] : 2 * ends[-1]]
    coordinates = [scale * numbers[a:b] for scale, a, b in zip(scales, ends, ends[1:], strict=False)]
    weights: Float = -np.asarray(solution.ineqlin.marginals)[: len(turned)].reshape(_TANGENTS, -1)
    return float(solution.x[-1]), coordinates, turns @ weights
