"""What so many places can do at best: bounds that no plan can beat, whatever its angles and settings are.

The vectors that n places of a plane make up lie in a convex set, whose extent in a direction φ is the largest
Σ uᵢ cos(θᵢ − φ) over n places that keep their distances. That is found going once around, place after place, with the
settings in a few classes: a place counts with the largest setting of its class, and keeps the distance of the smallest.
The least residual with the planes' vectors in their sets is then a linear program, a bound from below.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.corrections.correction_plane import FULL_TURN
from inertia.balancing.corrections.milling import ArcCutter
from inertia.balancing.corrections.standard_weights import WeightTool
from inertia.balancing.corrections.steps import Steps
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

DIRECTIONS = 36
_TANGENTS = 64
_CLASSES = 5
_MOST_CLASSES = 16
_MOST_PLACES = 64
_GROWS = 1e-9


def extents(steps: Sequence[Steps], enough: float = math.inf) -> Float:
    """Return how far 0, 1, ... places of one plane reach in each of `DIRECTIONS` directions, (n + 1, directions), kg m.

    As many places are counted as there can be, or as add something, or as reach far enough.

    Parameters
    ----------
    steps : of the plane's tools
    enough : kg m
    """
    plane = steps[0].tool.plane
    alike = plane.angles == "free" and all(np.ptp(k.most) == 0 for k in steps if np.isfinite(k.most).any())
    directions = FULL_TURN * np.arange(1 if alike else DIRECTIONS) / DIRECTIONS
    if plane.method == "kit" and plane.angles != "free":
        reach = [_of_weights(steps, direction, enough) for direction in directions.tolist()]
    else:
        classes = _classes(steps)
        reach = [_of_places(steps, direction, enough, classes) for direction in directions.tolist()]
    longest = max(len(k) for k in reach)
    table = np.array([np.concatenate([k, np.full(longest - len(k), k[-1])]) for k in reach]).T
    return np.tile(table, (1, DIRECTIONS)) if alike else table


def _of_weights(steps: Sequence[Steps], direction: float, enough: float) -> Float:
    plane = steps[0].tool.plane
    values, kinds = [], []
    for number, each in enumerate(steps):
        along = each.sizes[0] * np.cos(each.angles[np.isfinite(each.most)] - direction)
        along = np.repeat(along[along > 0], plane.most_per_position)
        assert isinstance(each.tool, WeightTool)
        along = np.sort(along)[::-1][: each.tool.weight.stock]
        values.append(along)
        kinds.append(np.full(len(along), number))
    best = np.sort(np.concatenate(values))[::-1][:_MOST_PLACES]
    reach = np.concatenate([[0.0], np.cumsum(best)])
    return reach[: int(np.searchsorted(reach, enough)) + 1]


@dataclass(frozen=True, eq=False)
class _Classes:
    """Settings in classes: of which steps, first and last; what class each counts as, and how far two keep apart."""

    of: list[tuple[int, int, int]]
    group: Int
    gaps: Float


def _classes(steps: Sequence[Steps]) -> _Classes:
    of: list[tuple[int, int, int]] = []
    sines: list[list[float]] = []
    for number, each in enumerate(steps):
        ends = np.unique(np.linspace(0, len(each.settings), min(_CLASSES, len(each.settings)) + 1).astype(int))
        of += [(number, low, high) for low, high in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)]
    shallow = [float(steps[n].settings[low]) for n, low, _ in of]
    for n, _, _ in of:
        tool = steps[n].tool
        own = isinstance(tool, ArcCutter)  # holes that run towards the shaft may be nearer beside one less deep
        settings = [shallow[len(sines)]] * len(of) if own else np.minimum(shallow, shallow[len(sines)]).tolist()
        apart = {k: math.sin(min(0.5 * tool.apart_at(min(k, tool.greatest)), 0.5 * math.pi)) for k in set(settings)}
        sines.append([apart[k] for k in settings])
    halves = np.array(sines)
    gaps = 2.0 * np.arcsin(np.minimum(0.5 * (halves + halves.T), 1.0))
    group = np.arange(len(of))
    if len(of) > _MOST_CLASSES:
        # Classes that are nearly as wide count as one, with the unbalance of the largest and the distance of the least.
        order = np.argsort(halves.diagonal(), kind="stable")
        group[order] = np.arange(len(of)) * _MOST_CLASSES // len(of)
        merged = np.full((_MOST_CLASSES, _MOST_CLASSES), math.inf)
        np.minimum.at(merged, (group[:, None], group[None, :]), gaps)
        gaps = merged
    return _Classes(of, group, gaps)


def _of_places(steps: Sequence[Steps], direction: float, enough: float, classes: _Classes) -> Float:
    relative = (steps[0].angles - direction + math.pi) % FULL_TURN - math.pi
    order = np.argsort(relative, kind="stable")
    order = order[np.abs(relative[order]) < 0.5 * math.pi]
    angles = relative[order]
    if not len(angles):
        return np.zeros(1)
    count = len(classes.gaps)
    value = np.full((len(angles), count), -math.inf)
    for (number, low, high), group in zip(classes.of, classes.group.tolist(), strict=True):
        each = steps[number]
        last = np.searchsorted(each.settings, each.most[order] + 1e-9, side="right") - 1
        along = each.sizes[np.clip(last, 0, high - 1)] * np.cos(angles)
        value[:, group] = np.maximum(value[:, group], np.where(last >= low, along, -math.inf))
    # Of each class of the place before, for all angles and classes: where to look in `upto`.
    before = np.searchsorted(angles, angles[:, None] - classes.gaps.T[:, None] + 1e-9, side="right")
    before = before * count + np.arange(count)[:, None, None]
    best, reach = value, [0.0]
    for _ in range(_MOST_PLACES):
        most = float(best.max())
        if most <= reach[-1] * (1 + _GROWS):
            break
        reach.append(most)
        if most > enough:
            break
        upto = np.vstack([np.full(count, -math.inf), np.maximum.accumulate(best, axis=0)])
        best = value + np.take(upto, before).max(axis=0)
    return np.array(reach)


def least_residual(gains: Complex, start: Complex, reach: Sequence[Float]) -> tuple[float, Complex]:
    """Return a bound from below of max |start + gains w|, and the w (n,) of the planes that it is for.

    Parameters
    ----------
    gains : (t, n) what a unit vector in each plane does, over the limits
    start : (t,) over the limits
    reach : of each plane, how far it reaches in each direction
    """
    from scipy.optimize import linprog

    count = gains.shape[1]
    scale = max((float(k.max()) for k in reach), default=0.0) or 1.0
    turns = np.exp(-1j * FULL_TURN * np.arange(_TANGENTS) / _TANGENTS)
    turned = (turns[:, None, None] * gains * scale).reshape(-1, count)
    rows = [np.hstack([turned.real, -turned.imag, np.full((len(turned), 1), -1.0)])]
    high = [-(turns[:, None] * start).real.ravel()]
    ways = FULL_TURN * np.arange(DIRECTIONS) / DIRECTIONS
    for k in range(count):
        row = np.zeros((DIRECTIONS, 2 * count + 1))
        row[:, k], row[:, count + k] = np.cos(ways), np.sin(ways)
        rows.append(row)
        high.append(reach[k] / scale)
    cost = np.zeros(2 * count + 1)
    cost[-1] = 1.0
    bounds = [(None, None)] * (2 * count) + [(0.0, None)]
    solution = linprog(cost, A_ub=np.vstack(rows), b_ub=np.concatenate(high), bounds=bounds, method="highs")
    if solution.x is None:
        return 0.0, np.zeros(count, complex)
    vectors: Complex = scale * (solution.x[:count] + 1j * solution.x[count : 2 * count])
    return float(solution.x[-1]), vectors
