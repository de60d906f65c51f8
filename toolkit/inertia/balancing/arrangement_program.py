"""The integer program of how parts are put together, searched for a stated number of nodes, and its bound."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.balancing.arrangement import Answer, Choice
from inertia.balancing.corrections.quiet_stdout import quiet_stdout
from inertia.balancing.unbalance import Complex

NODES = 200
"""Nodes that a search looks at, at most."""

_TANGENTS = 64
_ROUNDS = 20
_ENOUGH = 1e-5  # of the limit, between a way and the bound
_SLOW = 0.9  # of the gap before: another round is not worth its while
_INSIDE = 1e-6  # what HiGHS takes for satisfied


def by_program(choice: Choice, best: Answer) -> Answer:
    """Return the better of an answer and those of the integer program, and the program's bound.

    Minimise t with |start + Σ y v| ≤ t in each plane, each part at one position, each place with one part. Tangents
    stand for the circles, which leaves too much rather than too little in: the bound holds. Where a solution is
    outside a circle, the tangent there is added.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp

    blocks = [*choice.options, *(order.reshape(-1, order.shape[-1]) for order in choice.orders)]
    effects: Complex = np.concatenate(blocks)
    count, planes = len(effects), range(len(choice.start))
    rows, low, high = _once(choice, count)
    bounds = Bounds(np.zeros(count + 1), np.append(np.ones(count), np.inf))
    bound, gap = 0.0, math.inf
    cuts = [(k, turn) for turn in np.exp(2j * np.pi * np.arange(_TANGENTS) / _TANGENTS) for k in planes]
    for _ in range(_ROUNDS):
        for k, turn in cuts:
            rows.append(np.append((turn * effects[:, k]).real, -1.0))
            low.append(-np.inf)
            high.append(-float((turn * choice.start[k]).real))
        with quiet_stdout():
            solution = milp(
                np.append(np.zeros(count), 1.0),
                integrality=np.append(np.ones(count), 0.0),
                bounds=bounds,
                constraints=LinearConstraint(np.array(rows), low, high),
                options={"mip_rel_gap": 0.0, "node_limit": NODES},
            )
        bound = max(bound, float(solution.mip_dual_bound or 0.0) - _INSIDE)
        if solution.x is None:
            break
        answer = _read(choice, solution.x)
        best = min(best, answer, key=lambda each: each.left)
        vectors = choice.sum(answer.positions, answer.places)
        cuts = [(k, complex(np.exp(-1j * np.angle(vectors[k])))) for k in planes]
        before, gap = gap, best.left - bound
        if gap <= _ENOUGH or answer.left <= solution.x[-1] + _INSIDE or gap > _SLOW * before:
            break
    return replace(best, bound=min(bound, best.left))


def _once(choice: Choice, count: int) -> tuple[list[Float], list[float], list[float]]:
    """Return the rows of the program that put each part at one position, and one part at each place."""
    rows, begin = [], 0
    for option in choice.options:
        rows.append(np.zeros(count + 1))
        rows[-1][begin : begin + len(option)] = 1.0
        begin += len(option)
    for order in choice.orders:
        size = len(order)
        for k in range(size):
            for taken in (slice(begin + k * size, begin + (k + 1) * size), slice(begin + k, begin + size**2, size)):
                rows.append(np.zeros(count + 1))
                rows[-1][taken] = 1.0
        begin += size**2
    return rows, [1.0] * len(rows), [1.0] * len(rows)


def _read(choice: Choice, x: Float) -> Answer:
    """Return what the program's solution says."""
    begin, positions, places = 0, [], []
    for option in choice.options:
        positions.append(int(x[begin : begin + len(option)].argmax()))
        begin += len(option)
    for order in choice.orders:
        size = len(order)
        places.append(x[begin : begin + size**2].reshape(size, size).argmax(axis=1))
        begin += size**2
    return choice.answer(positions, places)
