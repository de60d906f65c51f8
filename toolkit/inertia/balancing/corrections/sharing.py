"""How many places each plane may take: the shares of a number that a bound leaves open, and what each has to leave."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from inertia.balancing.corrections.capacity import Capacity
from inertia.balancing.corrections.least_residual import fewest_places, least_residual
from inertia.balancing.corrections.places import GAIN, Places
from inertia.balancing.unbalance import Complex

_ANY = 1 << 30  # places: as many as there can be
_FAR = 4.0  # of what has to be made up: no plane need reach farther
_FARTHER = 2.0  # where it is asked whether a plane's reach binds
_SHARE = 0.1  # of the time: what looking for the ways to share a number may take
_ROUNDED = 1e-6  # of a place

MORE = 6
"""Places more than a bound asks for that are tried: what lies within reach may still lie between the steps."""

Way = tuple[tuple[int, ...], float, Complex]
"""Places of each plane, the bound of what plans with them leave, and what each does (planes, t) that would leave it."""


class Sharing:
    """The planes of a plan, and how far each reaches with so many places.

    Attributes
    ----------
    planes : their numbers, ascending; all else is in this order
    kinds : the numbers of each plane's steps
    most : places of each plane that reach farther than fewer of them, or far enough
    cut_short : whether ways were left out as they are too many for the time
    """

    def __init__(self, places: Places) -> None:
        self.cut_short = False
        self._places = places
        self.planes = sorted({each.plane for each in places.steps})
        self.kinds = [[k for k, each in enumerate(places.steps) if each.plane == plane] for plane in self.planes]
        gains = np.column_stack([places.middle(group) for group in self.kinds])
        enough = _enough(gains, places.start)
        self._capacities = [Capacity.of(places, group, enough) for group in self.kinds]
        self.most = [each.most for each in self._capacities]
        self._start = places.start
        self._known: dict[tuple[int, ...], tuple[float, Complex]] = {}
        self._nearest: dict[float, list[float]] = {}

    @cached_property
    def lowest(self) -> float:
        """What any plan leaves at least."""
        return self._least((_ANY,) * len(self.planes))[0]

    def binding(self) -> tuple[int, ...]:
        """Return the planes that would have to reach farther, where the limits are out of reach."""
        if self.lowest <= 1:
            return ()
        return tuple(plane for n, plane in enumerate(self.planes) if self._binds(n))

    def _binds(self, plane: int) -> bool:
        farther = [_FARTHER if n == plane else 1.0 for n in range(len(self.planes))]
        counts = (_ANY,) * len(self.planes)
        return least_residual(self._capacities, self._start, counts, farther)[0] < self.lowest * (1 - 1e-6)

    def first(self, aim: float) -> int:
        """Return the least number of places that the bound leaves open, or one below it where the time is up before."""
        until, last = self._until(), sum(self.most)
        number = max(1, math.ceil(sum(self._near(aim)) - _ROUNDED))
        while number < last and not any(self._open(number, aim, until)):
            if self._places.elapsed > until:
                break
            number += 1
        return min(number, last)

    def ways(self, number: int, aim: float, most: Sequence[int] | None = None) -> list[Way]:
        """Return how so many places may be shared by the planes, with the bound and what each does, the best first.

        Where there are too many ways for the time, they are those near what leaves the aim with the fewest places.

        Parameters
        ----------
        most : places of each plane; not many more than are useful without it
        """
        until = self._until()
        ways = list(self._open(number, aim, until, most))
        if not ways and self._places.elapsed > until:
            counts = tuple(math.ceil(n - _ROUNDED) for n in self._near(aim))
            ways = [(counts, *self._least(counts))] if any(counts) else []
        return sorted(ways, key=lambda way: (round(way[1], 3), -min(way[0], default=0), way[0]))

    def _open(self, number: int, aim: float, until: float, most: Sequence[int] | None = None) -> Iterator[Way]:
        """Yield the ways to share a number that the bound leaves open, as long as there is time."""
        for counts in _shares(number, most or [useful + MORE for useful in self.most], self._near(aim)):
            if self._places.elapsed > until:
                self.cut_short = True
                return
            least, shares = self._least(counts)
            if least <= aim * (1 + GAIN):
                yield counts, least, shares

    def _until(self) -> float:
        return min(self._places.elapsed + _SHARE * self._places.seconds, self._places.seconds)

    def _near(self, aim: float) -> list[float]:
        """Return the places of each plane, and parts of some, that leave an aim; all of them where none do."""
        if aim not in self._nearest:
            found = fewest_places(self._capacities, self._start, min(aim, float(np.abs(self._start).max())))
            self._nearest[aim] = [float(n) for n in self.most] if found is None else found.tolist()
        return self._nearest[aim]

    def _least(self, counts: tuple[int, ...]) -> tuple[float, Complex]:
        # More places than reach farther do no more, where all of them act at one place along the shaft.
        each = zip(counts, self._capacities, self.most, strict=True)
        counts = tuple(n if plane.varies else min(n, useful) for n, plane, useful in each)
        if counts not in self._known:
            self._known[counts] = least_residual(self._capacities, self._start, counts)
        return self._known[counts]

    def bound(self, number: int, aim: float = math.inf, default: float = 0.0) -> float:
        """Return what plans with so many places leave at least; `default` where none comes within `aim`."""
        ways = self.ways(number, aim)
        return self.lowest if self.cut_short else min((least for _, least, _ in ways), default=default)


def _enough(gains: Complex, start: Complex) -> float:
    """Return the largest vector (kg m) of a plane that is of use, by the gains (t, planes) and what is there (t,).

    What leaves no more than there is, |start + gains w| ≤ max |start|, is no longer; of more planes than t, of which
    some may work against others, several times what has to be made up is taken for enough.
    """
    inverse = np.linalg.pinv(gains)
    left = math.sqrt(len(start)) * float(np.abs(start).max())
    longest = float(np.linalg.norm(inverse, 2)) * (float(np.linalg.norm(start)) + left)
    return max(longest, _FAR * float(np.abs(inverse @ start).max()))


def _shares(number: int, most: Sequence[int], near: Sequence[float]) -> Iterator[tuple[int, ...]]:
    """Yield all ways to share a number among planes that take so many at most, about from those near one on.

    >>> list(_shares(2, [2, 2], [1.9, 0.1]))
    [(2, 0), (1, 1), (0, 2)]
    """
    first = [min(int(n), high) for n, high in zip(near, most, strict=True)]
    for step in (-1, 1):  # one by one, where it strays least
        while step * (number - sum(first)) > 0:
            free = [k for k, n in enumerate(first) if (n > 0 if step < 0 else n < most[k])]
            if not free:
                return
            first[max(free, key=lambda k: step * (near[k] - first[k]))] += step
    waiting, seen = [(0.0, tuple(first))], {tuple(first)}
    while waiting:
        _, counts = heapq.heappop(waiting)
        yield counts
        for more in range(len(counts)):
            for less in range(len(counts)):
                if more != less and counts[less] > 0 and counts[more] < most[more]:
                    moved = tuple(n + (k == more) - (k == less) for k, n in enumerate(counts))
                    if moved not in seen:
                        seen.add(moved)
                        astray = math.fsum((n - wanted) ** 2 for n, wanted in zip(moved, near, strict=True))
                        heapq.heappush(waiting, (astray, moved))
