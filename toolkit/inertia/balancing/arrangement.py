"""Ways to put the parts of a rotor together: positions and places, what each way leaves, and better ones nearby."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

_BEGINNINGS = 24
_GAIN = 1e-12  # relative: what leaves less by so little is no better


@dataclass(frozen=True, eq=False)
class Choice:
    """What is left open of a rotor, in parts of the limits.

    Attributes
    ----------
    start : (k,) what is fixed
    options : for each part that may be turned (n, k), what it brings at each of its positions
    orders : for each set of parts that may change places (m, m, k), what part i brings at place j
    """

    start: Complex
    options: tuple[Complex, ...]
    orders: tuple[Complex, ...] = ()

    @property
    def ways(self) -> int:
        """How many there are."""
        return math.prod(len(k) for k in self.options) * math.prod(math.factorial(len(k)) for k in self.orders)

    def sum(self, positions: Sequence[int], places: Sequence[Sequence[int] | Int]) -> Complex:
        """Return what a way leaves, (k,)."""
        result: Complex = self.start.copy()
        for option, k in zip(self.options, positions, strict=True):
            result += option[k]
        for order, place in zip(self.orders, places, strict=True):
            result += order[np.arange(len(order)), place].sum(axis=0)
        return result

    def answer(self, positions: Sequence[int], places: Sequence[Sequence[int] | Int]) -> Answer:
        """Return a way as an answer, nothing proven."""
        left = float(np.abs(self.sum(positions, places)).max())
        return Answer(tuple(positions), tuple(tuple(map(int, place)) for place in places), left, 0.0)


@dataclass(frozen=True, eq=False)
class Answer:
    """A way to put parts together: the position of each, the place of each part of each set, what is left, a bound."""

    positions: tuple[int, ...]
    places: tuple[tuple[int, ...], ...]
    left: float
    bound: float


def sums_of(start: Complex, blocks: Sequence[Complex]) -> Complex:
    """Return the sums (n, k) of one row of each block (n_b, k), the last block's running fastest."""
    sums: Complex = start[None]
    for rows in blocks:
        sums = (sums[:, None] + rows[None]).reshape(-1, len(start))
    return sums


def by_turning(choice: Choice) -> Answer:
    """Turn parts, and exchange them, one by one and in pairs, from several beginnings, while that leaves less."""
    draw, best = np.random.default_rng(0), None
    for beginning in range(_BEGINNINGS):
        positions = [int(draw.integers(len(option))) if beginning else 0 for option in choice.options]
        places = [draw.permutation(len(order)) if beginning else np.arange(len(order)) for order in choice.orders]
        _improve(choice, positions, places)
        answer = choice.answer(positions, places)
        if best is None or answer.left < best.left * (1 - _GAIN):
            best = answer
    assert best is not None
    return best


def _improve(choice: Choice, positions: list[int], places: list[Int]) -> None:
    """Improve a way in place."""
    options, parts, left = choice.options, range(len(choice.options)), math.inf
    groups = [*itertools.combinations(parts, 1), *itertools.combinations(parts, 2)]
    while True:
        before, whole = left, choice.sum(positions, places)
        left = float(np.abs(whole).max())
        for group in groups:
            rest = whole - sum(options[n][positions[n]] for n in group)
            sums = sums_of(rest, [options[n] for n in group])
            worst: Float = np.abs(sums).max(axis=1)
            if worst.min() < left * (1 - _GAIN):
                left, whole = float(worst.min()), sums[int(worst.argmin())]
                taken = np.unravel_index(int(worst.argmin()), [len(options[n]) for n in group])
                for n, k in zip(group, taken, strict=True):
                    positions[n] = int(k)
        for order, place in zip(choice.orders, places, strict=True):
            every = np.arange(len(order))
            for i in every:
                sums = whole - order[i, place[i]] - order[every, place] + order[i, place] + order[every, place[i]]
                sums[i] = whole
                worst = np.abs(sums).max(axis=1)
                if worst.min() < left * (1 - _GAIN):
                    j = int(worst.argmin())
                    left, whole = float(worst[j]), sums[j]
                    place[i], place[j] = place[j], place[i]
        if not left < before * (1 - 1e-6):
            return
