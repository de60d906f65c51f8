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
_TURNS = np.exp(-1j * FULL_TURN * np.arange(_TANGENTS) / _TANGENTS)
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


def fewest_places(capacities: Sequence[Capacity], start: Complex, aim: float) -> Float | None:
    """Return how many places of each plane (n,) leave no more than an aim, where parts of a place may be taken.

    Their sum is a bound from below: n places reach no farther than n times as far as one. None where none leave so
    little. For the arguments see `least_residual`.
    """
    from scipy.optimize import linprog

    scales, left, ends = _left(capacities)
    rows, high = [_beside(left, len(capacities))], [aim - (_TURNS[:, None] * start).real.ravel()]
    for k, (each, scale) in enumerate(zip(capacities, scales, strict=True)):
        for count in (1, each.most):
            row, reach = _along(each, count, scale, ends, k)
            row = _beside(row, len(capacities))
            if count == 1:
                row[:, 2 * ends[-1] + k], reach = -reach, np.zeros_like(reach)
            rows.append(row)
            high.append(reach)
    cost = np.append(np.zeros(2 * ends[-1]), np.ones(len(capacities)))
    bounds = [(None, None)] * (2 * ends[-1]) + [(0.0, float(each.most)) for each in capacities]
    solution = linprog(cost, A_ub=np.vstack(rows), b_ub=np.concatenate(high), bounds=bounds, method="highs")
    return None if solution.x is None else np.asarray(solution.x[2 * ends[-1] :])


def _solved(
    capacities: Sequence[Capacity], start: Complex, counts: Sequence[int], times: Sequence[float]
) -> tuple[float, list[Complex], Complex]:
    """Return the program's least, its coordinates (b,) of each plane, and its multipliers (t,); none without answer."""
    from scipy.optimize import linprog

    scales, left, ends = _left(capacities, counts)
    rows, high = [np.hstack([left, np.full((len(left), 1), -1.0)])], [-(_TURNS[:, None] * start).real.ravel()]
    for k, (each, count, scale, more) in enumerate(zip(capacities, counts, scales, times, strict=True)):
        row, reach = _along(each, count, scale, ends, k)
        rows.append(_beside(row, 1))
        high.append(more * reach)
    cost = np.zeros(2 * ends[-1] + 1)
    cost[-1] = 1.0
    bounds = [(None, None)] * (2 * ends[-1]) + [(0.0, None)]
    solution = linprog(cost, A_ub=np.vstack(rows), b_ub=np.concatenate(high), bounds=bounds, method="highs")
    if solution.x is None:
        return 0.0, [], np.zeros(len(start), complex)
    numbers: Complex = solution.x[: ends[-1]] + 1j * solution.x[ends[-1] : 2 * ends[-1]]
    coordinates = [scale * numbers[a:b] for scale, a, b in zip(scales, ends, ends[1:], strict=False)]
    weights: Float = -np.asarray(solution.ineqlin.marginals)[: len(left)].reshape(_TANGENTS, -1)
    return float(solution.x[-1]), coordinates, _TURNS @ weights


def _left(capacities: Sequence[Capacity], counts: Sequence[int] | None = None) -> tuple[list[float], Float, list[int]]:
    """Return scales of the planes' coordinates, so that all are of the order of 1, and the rows of what is left.

    These say how far what is done goes in each direction of each tolerance plane. Last where each plane's coordinates
    begin among the columns: their real parts, and then as many imaginary ones.
    """
    far = [each.rows(each.most if counts is None else counts[k])[1] for k, each in enumerate(capacities)]
    scales = [float(reach.max(initial=0.0)) or 1.0 for reach in far]
    basis = np.hstack([each.basis * scale for each, scale in zip(capacities, scales, strict=True)])
    turned = (_TURNS[:, None, None] * basis).reshape(-1, basis.shape[1])
    ends = np.cumsum([0, *(each.basis.shape[1] for each in capacities)]).tolist()
    return scales, np.hstack([turned.real, -turned.imag]), ends


def _along(each: Capacity, count: int, scale: float, ends: Sequence[int], number: int) -> tuple[Float, Float]:
    """Return the rows of a plane's coordinates along its directions, and how far so many places reach, over a scale."""
    directions, reach = each.rows(count)
    first, last = ends[number : number + 2]
    row = np.zeros((len(directions), 2 * ends[-1]))
    row[:, first:last], row[:, ends[-1] + first : ends[-1] + last] = directions.real, -directions.imag
    return row, reach / scale


def _beside(rows: Float, more: int) -> Float:
    """Return rows with so many columns of zeros after them."""
    return np.pad(rows, ((0, 0), (0, more)))
