"""All plans of a plane with so many places, where they can be listed, and the best of one plane or two."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import field

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.corrections.places import GAIN, Places, Spot
from inertia.balancing.corrections.standard_weights import WeightTool
from inertia.balancing.corrections.steps import allowed
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

_LISTED = 700_000  # plans of one plane that are listed
_SPOTS = 700_000  # places of one plane that are listed
_AT_ONCE = 2000  # plans of one plane that are held against those of another


@dataclass(frozen=True, eq=False)
class _Plans:
    """Plans of a plane, numbers (p, n) of its spots (m, 3), and what each adds (p, t), over the limits."""

    spots: Int
    numbers: Int
    sums: Complex

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, plan: int) -> tuple[Spot, ...]:
        return tuple((k, a, s) for k, a, s in self.spots[self.numbers[plan]].tolist())


@dataclass(eq=False)
class Listing:
    """The plans of each plane, listed once; a plane is given by the numbers of its steps."""

    places: Places
    _plans: dict[tuple[int, int], _Plans | None] = field(default_factory=dict, init=False)
    _together: dict[int, Bool] = field(default_factory=dict, init=False)
    _indexes: dict[tuple[int, int], _Index] = field(default_factory=dict, init=False)
    _most: dict[int, int] = field(default_factory=dict, init=False)

    def lists(self, kinds: Sequence[int], number: int) -> bool:
        """Say whether all plans of a plane with so many places are listed."""
        return self._of(kinds, number) is not None

    def most(self, kinds: Sequence[int]) -> int:
        """Return the most places of a plane up to which all plans are listed, as long as there are any, and time."""
        if kinds[0] not in self._most:
            ends = (n for n in itertools.count(1) if self.places.late() or not self._of(kinds, n))
            self._most[kinds[0]] = next(ends) - 1
        return self._most[kinds[0]]

    def complete(self, kinds: Sequence[int]) -> bool:
        """Say whether all plans of a plane are listed, whatever the number of their places."""
        most = self.most(kinds)
        return not self.places.late() and self.lists(kinds, most + 1)

    def best_of(self, chosen: Sequence[tuple[Sequence[int], int]], below: float) -> tuple[tuple[Spot, ...], float]:
        """Return the best plan of one plane or two, all of whose plans are listed, and what it leaves.

        Parameters
        ----------
        chosen : the kinds of each plane, and its places
        below : of two planes, a plan that leaves more is of no use
        """
        listed = [plans for kinds, n in chosen if (plans := self._of(kinds, n))]
        if len(listed) < len(chosen):
            return (), math.inf
        if len(listed) == 1:
            left = np.abs(self.places.start + listed[0].sums).max(axis=1)
            best = int(left.argmin())
            return listed[0][best], float(left[best])
        one, other = listed

        kinds, number = chosen[1]

        def beside(plan: int, others: Int) -> int | None:
            spots = one[plan]
            if not self.places.fits((*spots, *other[int(others[0])])):
                free = self._beside(kinds, other.spots, spots)
                others = others[free[other.numbers[others]].all(axis=1)]
            return next((k for k in others.tolist() if self.places.fits((*spots, *other[k]))), None)

        if (kinds[0], number) not in self._indexes:
            self._indexes[kinds[0], number] = _Index(other.sums, self.places.middle(kinds))
        wanted = -(self.places.start + one.sums)
        pair, worst = self._indexes[kinds[0], number].best(wanted, below, beside, self.places.late)
        return ((*one[pair[0]], *other[pair[1]]), worst) if pair else ((), math.inf)

    def _of(self, kinds: Sequence[int], number: int) -> _Plans | None:
        """Return all plans of a plane with so many places; None where they are too many."""
        key = kinds[0], number
        if key not in self._plans:
            self._plans[key] = self._singles(kinds) if number == 1 else self._with_one_more(kinds, number)
        return self._plans[key]

    def _singles(self, kinds: Sequence[int]) -> _Plans | None:
        tables, sums = [], []
        for k in kinds:
            a, s = np.nonzero(allowed(self.places.steps[k]))
            tables.append(np.column_stack([np.full(len(a), k), a, s]))
            sums.append(self.places.effects(k, a, s).T)
        spots = np.concatenate(tables)
        return _Plans(spots, np.arange(len(spots))[:, None], np.concatenate(sums)) if len(spots) <= _SPOTS else None

    def _with_one_more(self, kinds: Sequence[int], number: int) -> _Plans | None:
        fewer, singles = self._of(kinds, number - 1), self._of(kinds, 1)
        if fewer is None or singles is None or max(len(fewer), len(singles)) * len(singles) > 10 * _LISTED:
            return None
        before = fewer.numbers
        follows = self._side_by_side(kinds, singles.spots)[before].all(axis=1)
        follows &= np.arange(len(singles)) >= before[:, -1:]
        plan, last = np.nonzero(follows)
        numbers = np.column_stack([before[plan], last])
        keeps = self._within_stock(singles.spots, numbers)
        if np.count_nonzero(keeps) > _LISTED:
            return None
        return _Plans(singles.spots, numbers[keeps], fewer.sums[plan[keeps]] + singles.sums[last[keeps]])

    def _within_stock(self, spots: Int, numbers: Int) -> Bool:
        """Say which plans (p, n) have no more of their last weight than there are, and than go at its position."""
        keeps = np.ones(len(numbers), bool)
        kind, angle, last = spots[numbers, 0], spots[numbers, 1], spots[numbers[:, -1], 0]
        for k in np.unique(last).tolist():
            tool, mine = self.places.steps[k].tool, last == k
            if isinstance(tool, WeightTool):
                keeps[mine] = (kind[mine] == k).sum(axis=1) <= tool.weight.most
                keeps[mine] &= (angle[mine] == angle[mine, -1:]).sum(axis=1) <= tool.plane.most_per_position
        return keeps

    def _beside(self, kinds: Sequence[int], spots: Int, others: Sequence[Spot]) -> Bool:
        """Return which places (m, 3) of a plane are not in the way of others."""
        free = np.empty(len(spots), bool)
        for k in kinds:
            mine = spots[:, 0] == k
            free[mine] = (
                self.places.room(k, others)[spots[mine, 1]] + GAIN >= self.places.steps[k].settings[spots[mine, 2]]
            )
        return free

    def _side_by_side(self, kinds: Sequence[int], spots: Int) -> Bool:
        """Return which places (m, 3) of a plane go beside which, (m, m)."""
        if kinds[0] not in self._together:
            depth = np.concatenate([self.places.steps[k].settings[spots[spots[:, 0] == k, 2]] for k in kinds])
            fits = np.empty((len(spots), len(spots)))
            for k in kinds:
                mine = np.flatnonzero(spots[:, 0] == k)
                beside = [self.places.beside_one(k, (j, a, s)) for j, a, s in spots.tolist()]
                fits[:, mine] = np.array(beside)[:, spots[mine, 1]]
            together = fits + GAIN >= depth
            self._together[kinds[0]] = together & together.T
        return self._together[kinds[0]]


class _Index:
    """Plans of a plane, to be found by what they do (q, t).

    Along what a unit vector of the plane does, and across it: there plans differ only as their settings' levers do.
    """

    def __init__(self, sums: Complex, gain: Complex) -> None:
        from scipy.spatial import KDTree

        self._sums = sums
        self._turned = np.linalg.qr(gain[:, None], mode="complete")[0].conj()
        points = sums @ self._turned
        self._across = float(np.linalg.norm(points[:, 1:], axis=1).max())
        self._flat = self._across <= GAIN * float(np.abs(points).max())
        self._columns = 1 if self._flat else len(gain)
        self._tree = KDTree(_real(points[:, : self._columns]))

    def best(
        self, wanted: Complex, below: float, beside: Callable[[int, Int], int | None], late: Callable[[], bool]
    ) -> tuple[tuple[int, int] | None, float]:
        """Return which of what is wanted (p, t), and which plan that goes beside it, leave the least, and that least.

        Parameters
        ----------
        below : what leaves more is of no use
        beside : the first of plans that goes beside a number of what is wanted, None where none does
        """
        ideal = wanted @ self._turned
        # What no plan can take away, at least 1/√t of which is left in the worst plane.
        aside = np.maximum(np.linalg.norm(ideal[:, 1:], axis=1) - self._across, 0.0)
        outside = aside if self._flat else np.zeros(len(wanted))
        root = math.sqrt(wanted.shape[1])
        order = np.argsort(aside, kind="stable")
        pair, best = None, below * (1 + GAIN)
        for chunk in np.array_split(order, max(1, len(order) // _AT_ONCE)):
            if aside[chunk[0]] > root * best or late():
                break
            points = _real(ideal[chunk, : self._columns])
            distance, nearest = self._tree.query(points)
            apart = np.hypot(outside[chunk], distance)
            for place in np.argsort(apart, kind="stable").tolist():
                if apart[place] > root * best or late():
                    break
                number = int(chunk[place])
                for first in (True, False):  # what the nearest leaves says how far others may lie
                    reach = math.sqrt(max((root * best) ** 2 - outside[number] ** 2, 0.0)) * (1 + GAIN)
                    near = [nearest[place]] if first else self._tree.query_ball_point(points[place], reach)
                    plans = self._better(wanted[number], np.array(near, int), best)
                    if len(plans) and (plan := beside(number, plans)) is not None:
                        pair, best = (number, plan), float(np.abs(wanted[number] - self._sums[plan]).max())
        return pair, best

    def _better(self, wanted: Complex, plans: Int, best: float) -> Int:
        """Return those of plans that leave no more than the best of what is wanted (t,), the least first."""
        left = np.abs(wanted - self._sums[plans]).max(axis=1)
        ranked = np.argsort(left, kind="stable")
        better: Int = plans[ranked[left[ranked] <= best]]
        return better


def _real(numbers: Complex) -> Float:
    return np.hstack([numbers.real, numbers.imag])
