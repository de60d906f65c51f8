"""All plans of a plane with so many places, where they can be listed, and the best of one plane or two."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import field

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.corrections.places import GAIN, Places, Spot
from inertia.balancing.corrections.standard_weights import WeightTool
from inertia.balancing.corrections.steps import allowed
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

_LISTED = 700_000  # plans of one plane that are listed
_SPOTS = 700_000  # places of one plane that are listed


@dataclass(eq=False)
class Listing:
    """The plans of each plane, listed once."""

    places: Places
    _lists: dict[tuple[int, int], Int | None] = field(default_factory=dict, init=False)

    def of(self, kinds: Sequence[int], number: int) -> Int | None:
        """Return all plans (p, number, 3) of a plane with so many places; None where they are too many."""
        key = kinds[0], number
        if key not in self._lists:
            self._lists[key] = self._list(kinds, number)
        return self._lists[key]

    def _list(self, kinds: Sequence[int], number: int) -> Int | None:
        tables = []
        for k in kinds:
            a, s = np.nonzero(allowed(self.places.steps[k]))
            tables.append(np.column_stack([np.full(len(a), k), a, s]))
        singles = np.concatenate(tables)
        if number == 1:
            return singles[:, None] if len(singles) <= _SPOTS else None
        fewer = self.of(kinds, number - 1)
        if fewer is None or len(fewer) * len(singles) > 10 * _LISTED or len(singles) ** 2 > 10 * _LISTED:
            return None
        spots: list[Spot] = [(k, a, s) for k, a, s in singles.tolist()]
        column = np.array([kinds.index(k) for k, _, _ in spots])
        depth = np.array([self.places.steps[k].settings[s] for k, _, s in spots])
        fits = np.empty((len(spots), len(spots)))
        for c, k in enumerate(kinds):
            mine = np.flatnonzero(column == c)
            fits[:, mine] = np.array([self.places.beside_one(k, spot) for spot in spots])[:, singles[mine, 1]]
        together = fits + GAIN >= depth
        together &= together.T
        number_of = {spot: n for n, spot in enumerate(spots)}
        before = np.array([[number_of[k, a, s] for k, a, s in plan] for plan in fewer.tolist()], int).reshape(
            -1, number - 1
        )
        follows = together[before].all(axis=1) & (np.arange(len(spots)) >= before[:, -1:])
        plan, last = np.nonzero(follows)
        plans = np.column_stack([before[plan], last])
        tools = [self.places.steps[k].tool for k in kinds]
        for kind, tool in enumerate(tools):
            if isinstance(tool, WeightTool) and tool.weight.stock is not None:
                plans = plans[(column[plans] == kind).sum(axis=1) <= tool.weight.stock]
        if isinstance(tools[0], WeightTool):
            places = np.array([a for _, a, _ in spots])[plans]
            used = (places[:, :, None] == places[:, None]).sum(axis=2).max(axis=1)
            plans = plans[used <= tools[0].plane.most_per_position]
        return singles[plans.reshape(-1, number)] if len(plans) <= _LISTED else None

    def best_of(self, listed: Sequence[Int], below: float) -> tuple[tuple[Spot, ...], float] | None:
        """Return the best combination of the plans of one plane or two."""
        sums = [self.places.sums(plans) for plans in listed]
        if not all(len(k) for k in sums):
            return None
        if len(sums) == 1:
            left = np.abs(self.places.start + sums[0]).max(axis=1)
            best = int(left.argmin())
            return _spots(listed[0][best]), float(left[best])
        result = None
        middle = self.places.middle(np.unique(listed[1][..., 0]).tolist())
        for plans, worst in self._combinations(sums[0], sums[1], middle, below):
            spots = (*_spots(listed[0][plans[0]]), *_spots(listed[1][plans[1]]))
            if (result is None or worst < result[1]) and self.places.fits(spots):
                result = spots, worst
        return result

    def _combinations(
        self, one: Complex, other: Complex, gain: Complex, below: float
    ) -> Iterator[tuple[tuple[int, int], float]]:
        """Yield pairs of plans of two planes, by what they add (p, t), that leave less and less.

        Parameters
        ----------
        gain : (t,) what a unit vector of the other plane does, at a setting in the middle
        """
        from scipy.spatial import KDTree

        wanted = -(self.places.start + one)
        # Along what the other plane does, and across it: there its plans differ only as its settings' levers do.
        turned = np.linalg.qr(gain[:, None], mode="complete")[0].conj()
        ideal, points = wanted @ turned, other @ turned
        across = np.linalg.norm(points[:, 1:], axis=1).max()
        away = np.linalg.norm(ideal[:, 1:], axis=1)
        # What no plan of the other plane can take away, at least 1/√t of which is left in the worst plane.
        aside = np.maximum(away - across, 0.0)
        flat = across <= GAIN * np.abs(points).max()
        columns = 1 if flat else len(gain)
        outside = aside if flat else np.zeros(len(one))
        ideal, points = _real(ideal[:, :columns]), _real(points[:, :columns])
        root = math.sqrt(len(gain))
        order = np.argsort(aside, kind="stable")
        tree = KDTree(points)
        best = below * (1 + GAIN)
        for chunk in np.array_split(order, max(1, len(order) // 2000)):
            if aside[chunk[0]] > root * best or self.places.late():
                break
            distance, nearest = tree.query(ideal[chunk])
            for number, apart, k in zip(chunk.tolist(), distance.tolist(), nearest.tolist(), strict=True):
                radius = root * best
                if outside[number] ** 2 + apart**2 > radius**2:
                    continue
                near = [k]
                if math.isfinite(radius):
                    reach = math.sqrt(max(radius**2 - outside[number] ** 2, 0.0))
                    near = tree.query_ball_point(ideal[number], reach * (1 + GAIN)) or near
                left = np.abs(wanted[number] - other[near]).max(axis=1)
                for place in np.argsort(left, kind="stable").tolist():
                    if left[place] > best:
                        break
                    best = float(left[place])
                    yield (number, int(near[place])), best


def _real(numbers: Complex) -> Float:
    return np.hstack([numbers.real, numbers.imag])


def _spots(plan: Int) -> tuple[Spot, ...]:
    return tuple((k, a, s) for k, a, s in plan.tolist())
