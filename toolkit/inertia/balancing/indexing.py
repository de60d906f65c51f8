"""The angles and places at which the parts of a rotor are best put together: index positions, the order of blades.

A part that is turned about the shaft by α turns what it brings to each tolerance plane by e^{iα}; one that changes
places brings what it has there. With one whole number for each position (1 where it is taken) this is an integer
program: the largest |Σ v| over its limit is made least.

It is solved by meeting in the middle: the choices are divided in two halves, all sums of each half are written down,
and of the two lists the pair that cancels best is looked for in a k-d tree, in the norm max_k |u_k| itself, so that no
other is better (Horowitz and Sahni, Journal of the ACM 21, 1974, 277). Where the halves are too long for that, parts
are turned, and exchanged, one by one and in pairs from several beginnings, and the integer program with tangents in
place of the circles (`scipy.optimize.milp`), searched for a stated number of nodes, gives what no way leaves less than.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.arrangement import Answer, Choice, by_turning, sums_of
from inertia.balancing.arrangement_program import by_program
from inertia.balancing.shop_units import decimals_needed
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

_ROWS = 1_000_000  # sums that are written down
_WRITTEN = 9  # places whose orders are written down one by one; of more, their halves
_PAIRS = 20_000_000  # that are looked at one by one
_FEW = 1 << 14  # pairs that are looked at without a tree
_AT_ONCE = 1 << 20
_FINE = 0.005  # degrees, of turns that have no end of digits
_SAME = 1e-13  # of all vectors together: sums that are no farther apart count as one


@dataclass(frozen=True, eq=False)
class Indexing:
    """How the parts of a rotor are put together.

    Attributes
    ----------
    turns : (b,) rad, by which each is turned from where its file has it
    left, as_filed : the largest |unbalance| over its limit, as put together and as the files have it
    bound : no way leaves less
    ways : how many there are
    names : (b,) what is turned
    moves : (part, the one whose place it takes), of those that change places
    planes_as_filed, planes_left : (k,) kg m, what is in each tolerance plane as the files have it, and as put together
    """

    turns: tuple[float, ...]
    left: float
    as_filed: float
    bound: float
    ways: int
    names: tuple[str, ...] = ()
    moves: tuple[tuple[str, str], ...] = ()
    planes_as_filed: tuple[complex, ...] = ()
    planes_left: tuple[complex, ...] = ()

    @property
    def degrees(self) -> tuple[str, ...]:
        """By how many degrees each is turned, to the digits of its steps."""
        turns = [(turn, decimals_needed(turn, _FINE)) for turn in map(math.degrees, self.turns)]
        return tuple(f"{round(turn, decimals) % 360.0:.{decimals}f}" for turn, decimals in turns)

    @property
    def proven(self) -> bool:
        """Whether no way is better."""
        return self.bound >= self.left * (1 - 1e-9)

    @property
    def sentence(self) -> str:
        """How near to the best it is."""
        if self.proven:
            return f"the best of {self.ways} ways, none leaves less"
        gap = f"{100 * (self.left - self.bound):.2g} % of the limit"
        least = f"{100 * self.bound:.3g} % of the limit" if self.bound else "nothing"
        return f"of {self.ways} ways the best found: no way leaves less than {least}, a gap of {gap}"


def best_indexing(
    vectors: Complex, fixed: Complex, limits: Sequence[float], angles: Sequence[Sequence[float]]
) -> Indexing:
    """Return the best way to put bodies together that are turned about the shaft.

    Parameters
    ----------
    vectors : (b, k) kg m, what each body brings to each plane as its file has it
    fixed : (k,) kg m, what does not turn
    limits : (k,) kg m
    angles : of each body, those that it may be turned by, rad

    >>> two = best_indexing(np.array([[1.0 + 0j], [1.0 + 0j]]), np.zeros(1, complex), [1.0], [[0.0], [0.0, math.pi]])
    >>> round(two.left, 9), two.as_filed, two.ways
    (0.0, 2.0, 2)
    """
    scale = np.asarray(limits)
    scaled, start = vectors / scale, fixed / scale
    options = tuple(each * np.exp(1j * np.asarray(turns))[:, None] for each, turns in zip(scaled, angles, strict=True))
    choice = Choice(start, options)
    answer = best_answer(choice)
    filed = start + scaled.sum(axis=0)
    return Indexing(
        turns=tuple(float(turns[k]) for turns, k in zip(angles, answer.positions, strict=True)),
        left=answer.left,
        as_filed=float(np.abs(filed).max()),
        bound=answer.bound,
        ways=choice.ways,
        planes_as_filed=tuple((filed * scale).tolist()),
        planes_left=tuple((choice.sum(answer.positions, answer.places) * scale).tolist()),
    )


def best_answer(choice: Choice) -> Answer:
    """Return the best way, with a bound that no way beats; the two are equal where that is proven.

    >>> three = np.array([3.0, 4.0, 5.0])[:, None, None] * np.exp(2j * np.pi / 3 * np.arange(3))[None, :, None]
    >>> answer = best_answer(Choice(np.array([math.sqrt(3) + 0j]), (), (three,)))
    >>> round(answer.left, 9), answer.bound == answer.left
    (0.896575472, True)
    """
    size = float(np.abs(choice.start).max())
    size += sum(float(np.abs(each).max()) for each in choice.options)
    size += sum(float(np.abs(each).max(axis=(1, 2)).sum()) for each in choice.orders)
    same = _SAME * size
    best = by_turning(choice)
    filed = choice.answer([0] * len(choice.options), [range(len(order)) for order in choice.orders])
    halves = _halves(choice)
    if halves is None:
        return by_program(choice, best)
    exact = False  # of ways that are as good, the one that is written down first
    for half in halves:
        first = sums_of(choice.start, [block.rows for block in half.first])
        second = sums_of(np.zeros_like(choice.start), [block.rows for block in half.second])
        met = _met(first, second, best.left + same, same)
        if met is None:
            return by_program(choice, best)
        if met[1] < best.left - same or (met[1] <= best.left + same and not exact):
            best, exact = half.answer(met[0], choice), True
    best = filed if filed.left <= best.left + same else best
    return replace(best, bound=best.left)


class _Block(NamedTuple):
    """Sums that one of a half's choices makes.

    Attributes
    ----------
    rows : (n, k), one for each way
    number : of the part that is turned, or of the set whose parts change places
    ways : (n, m), of the second: which of `parts` is at each place from `offset` on
    """

    rows: Complex
    number: int
    ways: Int | None = None
    parts: tuple[int, ...] = ()
    offset: int = 0


class _Half(NamedTuple):
    """Two lists of blocks; a sum of the first and one of the second make a way."""

    first: tuple[_Block, ...]
    second: tuple[_Block, ...]

    def answer(self, pair: tuple[int, int], choice: Choice) -> Answer:
        """Return the way that the sums of these numbers make."""
        positions = [0] * len(choice.options)
        places = [[0] * len(order) for order in choice.orders]
        for number, blocks in zip(pair, self, strict=True):
            for block, k in zip(blocks, np.unravel_index(number, [len(k.rows) for k in blocks] or [1]), strict=False):
                if block.ways is None:
                    positions[block.number] = int(k)
                    continue
                for place, part in enumerate(block.ways[k].tolist(), block.offset):
                    places[block.number][block.parts[part]] = place
        return choice.answer(positions, places)


def _halves(choice: Choice) -> Iterator[_Half] | None:
    """Return the halves whose pairs are all ways; None where they are too long."""
    long = [number for number, order in enumerate(choice.orders) if len(order) > _WRITTEN]
    blocks = [_Block(option, number) for number, option in enumerate(choice.options)]
    blocks += [
        _ordered(number, order, range(len(order)), 0)
        for number, order in enumerate(choice.orders)
        if len(order) <= _WRITTEN
    ]
    if not long:
        first: list[_Block] = []
        second: list[_Block] = []
        for block in sorted(blocks, key=lambda block: -len(block.rows)):
            (first if _size(first) <= _size(second) else second).append(block)
        return iter([_Half(tuple(first), tuple(second))]) if _size(first) + _size(second) <= _ROWS else None
    number, order = long[0], choice.orders[long[0]]
    count, middle = len(order), len(order) // 2
    rows = _size(blocks) * math.factorial(middle) + math.factorial(count - middle)
    if len(long) > 1 or math.comb(count, middle) * rows > 2 * _ROWS:
        return None
    return (
        _Half(
            (*blocks, _ordered(number, order, front, 0)),
            (_ordered(number, order, [part for part in range(count) if part not in front], middle),),
        )
        for front in itertools.combinations(range(count), middle)
    )


def _size(blocks: Sequence[_Block]) -> int:
    return math.prod(len(block.rows) for block in blocks)


def _ordered(number: int, order: Complex, parts: Sequence[int], offset: int) -> _Block:
    """Return the sums of all orders of some parts at the places from `offset` on."""
    ways = _permutations(len(parts))
    rows: Complex = order[np.asarray(parts)[ways], offset + np.arange(len(parts))].sum(axis=1)
    return _Block(rows, number, ways, tuple(parts), offset)


def _permutations(count: int) -> Int:
    """Return all orders of `count` things, (count!, count), in lexicographic order."""
    ways = np.zeros((1, 0), np.int8)
    for k in range(count):
        others = [np.insert(ways + (ways >= first), 0, first, axis=1) for first in range(k + 1)]
        ways = np.concatenate(others)
    return ways.astype(np.intp)


def _met(first: Complex, second: Complex, best: float, same: float) -> tuple[tuple[int, int], float] | None:
    """Return the pair of sums that leaves least, and how much; inf where none is below `best`, None if too many are.

    |u|₂ ≤ √k max |u_k|: what leaves less than the best is within √k times that of the other list, in the plain
    distance of k-d trees.
    """
    if min(len(first), len(second)) == 1 or len(first) * len(second) <= _FEW:
        worst: Float = np.abs(first[:, None] + second[None]).max(axis=2)
        pair = np.unravel_index(int((worst <= worst.min() + same).argmax()), worst.shape)
        return (int(pair[0]), int(pair[1])), float(worst[pair])
    from scipy.spatial import cKDTree

    (a, a_numbers), (b, b_numbers) = _distinct(first, same), _distinct(second, same)
    if len(a) > len(b):
        met = _met(second, first, best, same)
        return met and (met[0][::-1], met[1])
    targets, reach = _real(-a), math.sqrt(a.shape[1]) * (1 + 1e-9)
    tree = cKDTree(_real(b))
    result = ((0, 0), math.inf)

    def look(i: Int, j: Int) -> None:
        nonlocal result, best
        left: Float = np.abs(a[i] + b[j]).max(axis=1)
        if len(left) and left.min() < best:
            ties = np.flatnonzero(left <= left.min() + same)
            k = ties[(a_numbers[i[ties]] * len(second) + b_numbers[j[ties]]).argmin()]
            best = float(left[k])
            result = (int(a_numbers[i[k]]), int(b_numbers[j[k]])), best

    distance, nearest = tree.query(targets, distance_upper_bound=reach * best)
    near = np.flatnonzero(np.isfinite(distance))
    look(near, nearest[near])
    near = near[distance[near] <= reach * best]
    counts = tree.query_ball_point(targets[near], reach * best, return_length=True)
    if int(counts.sum()) > _PAIRS:
        return None
    for some in np.array_split(near, 1 + int(counts.sum()) // _AT_ONCE):
        lists = tree.query_ball_point(targets[some], reach * best)
        look(np.repeat(some, [len(k) for k in lists]), np.fromiter(itertools.chain.from_iterable(lists), np.intp))
    return result


def _distinct(rows: Complex, same: float) -> tuple[Complex, Int]:
    """Return rows that are not the same, and the number of each in the list."""
    if not same:
        return rows, np.arange(len(rows))
    _, first = np.unique(np.round(_real(rows) / (4 * same)), axis=0, return_index=True)
    return rows[first], first


def _real(rows: Complex) -> Float:
    return np.ascontiguousarray(rows).view(np.float64)
