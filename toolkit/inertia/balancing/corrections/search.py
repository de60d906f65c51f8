"""Search for a plan: the fewest places that come within the limits, and of those plans the one that leaves the least.

Everything is stepped: a place is one of a plane's `Steps` at one of its angles and settings. Numbers of places are
tried in ascending order, those alone that a bound (`capacity`) leaves open. Where a plane's plans with so many places
can be listed, the best of all is taken; elsewhere places are laid out about the vectors of the bound and improved, one
by one and in pairs, each time to the best that the steps allow.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from time import thread_time

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.corrections.capacity import extents, least_residual
from inertia.balancing.corrections.correction_plane import FULL_TURN
from inertia.balancing.corrections.standard_weights import WeightTool
from inertia.balancing.corrections.steps import Steps, allowed, room_beside
from inertia.balancing.unbalance import Complex

AIM = 0.75
"""Share of the tolerance that is to be left at most: what the shop's work scatters has to fit into the rest."""

SECONDS = 10.0
"""How long a plan is looked for, where nothing else is said."""

Spot = tuple[int, int, int]
"""Steps, angle and setting of a place, by their numbers."""

_FINE = 0.002  # of the limit: plans that leave less than this are as good as each other
_GAIN = 1e-9
_TIE = 1e-6
_FAR = 4.0  # of what has to be made up: no plane need reach farther
_NEARLY = 0.01  # of the least residual: numbers of places that come so near it are tried first
_LISTED = 700_000  # plans of one plane that are listed
_SPOTS = 700_000  # places of one plane that are listed
_PAIRED = 300_000  # pairs that are tried at once
_FOLLOWED = 100  # of them, the best
_OUT_OF_REACH = 0.3  # of the time
_MORE = 6  # places more than the bound asks for
_LAYOUTS = 3  # of a plane that are followed up
_WINDOW = 7  # steps of angle to each side of a place, in pairs


@dataclass(frozen=True)
class Plan:
    """What a search came to.

    Attributes
    ----------
    spots : the places
    worst : the largest |residual| over its limit
    bound : no plan with at most so many places leaves less, nor one with any number where the limits are out of reach
    fewest : no plan with fewer places is within the limits; 0 where none is
    cut_short : the time was up before the search was through
    binding : numbers of the planes that would have to reach farther, where the limits are out of reach
    """

    spots: tuple[Spot, ...]
    worst: float
    bound: float
    fewest: int
    cut_short: bool
    binding: tuple[int, ...] = ()


@dataclass(eq=False)
class Search:
    """A search among steps.

    Attributes
    ----------
    steps : of all planes
    gains : (k, t) what a unit vector of each of the steps does in the tolerance planes, over their limits
    start : (t,) what is there, over the limits
    aim : what is to be left at most, as a share of the limits, if it can be; 0 for the least that the steps allow
    seconds : how long it may take
    """

    steps: Sequence[Steps]
    gains: Complex
    start: Complex
    aim: float = 1.0
    seconds: float = math.inf
    cut_short: bool = field(default=False, init=False)
    _begun: float = field(default_factory=thread_time, init=False)
    _lists: dict[tuple[int, int], Int | None] = field(default_factory=dict, init=False)
    _rooms: dict[tuple[int, Spot], Float] = field(default_factory=dict, init=False)

    def plan(self) -> Plan:
        """Return the best plan."""
        planes = sorted({each.plane for each in self.steps})
        kinds = [[k for k, each in enumerate(self.steps) if each.plane == plane] for plane in planes]
        gains = np.column_stack([self.gains[group[0]] for group in kinds])
        enough = _FAR * float(np.abs(np.linalg.pinv(gains) @ self.start).max())
        reach = [extents([self.steps[k] for k in group], enough) for group in kinds]
        most = [len(k) - 1 for k in reach]
        lowest, _ = least_residual(gains, self.start, [k[-1] for k in reach])
        binding = tuple(plane for n, plane in enumerate(planes) if self._binds(n, gains, reach, lowest))
        best = Plan((), _worst(self.start), lowest, 0, False)
        solved: set[tuple[int, ...]] = set()
        fewest = 0

        def attempt(number: int, open_below: float, below: float) -> Plan:
            result = best
            for counts, least, vectors in self._counts(number, most, reach, gains, open_below):
                if counts not in solved and least <= below * (1 + _TIE) and not self._late():
                    solved.add(counts)
                    spots, worst = self._with_counts(kinds, counts, vectors, least, below)
                    if math.isfinite(worst) and self.rank(len(spots), worst) < self.rank(
                        len(result.spots), result.worst
                    ):
                        result = replace(result, spots=spots, worst=worst)
                    if result.worst <= _FINE:
                        break
            return result

        if lowest > 1:  # what is out of reach takes no more than a share of the time
            self.seconds *= _OUT_OF_REACH
        for goal in dict.fromkeys((self.aim, 1.0)) if self.aim else ():
            if lowest <= goal < best.worst:
                first = self._first(most, reach, gains, goal)
                fewest = first if goal == 1.0 or not fewest else fewest
                for number in range(first, min(sum(most), first + _MORE) + 1):
                    best = attempt(number, goal, goal if number < len(best.spots) else max(best.worst, goal))
                    if best.worst <= goal or self._late():
                        break
            if best.worst <= goal or self._late():
                break
        if best.worst > 1 or self.aim == 0:
            # Any number of places may leave the least; first those from where more of them add nothing.
            first = self._first(most, reach, gains, max(1.0, lowest * (1 + _NEARLY)))
            last = min(sum(most), first + _MORE)
            for number in (*range(first, last + 1), *range(first - 1, 0, -1)):
                if best.worst <= max(_FINE, lowest * (1 + _TIE)):
                    break
                best = attempt(number, best.worst, best.worst)
        bound = lowest
        if best.worst <= 1:
            bound = min((k for _, k, _ in self._counts(len(best.spots), most, reach, gains, 1.0)), default=lowest)
            fewest = min(self._first(most, reach, gains, 1.0) if _worst(self.start) > 1 else 0, len(best.spots))
        return replace(best, bound=min(bound, best.worst), fewest=fewest, cut_short=self.cut_short, binding=binding)

    def bound(self, number: int) -> float:
        """Return what plans with so many places leave at least."""
        planes = sorted({each.plane for each in self.steps})
        kinds = [[k for k, each in enumerate(self.steps) if each.plane == plane] for plane in planes]
        gains = np.column_stack([self.gains[group[0]] for group in kinds])
        enough = _FAR * float(np.abs(np.linalg.pinv(gains) @ self.start).max())
        reach = [extents([self.steps[k] for k in group], enough) for group in kinds]
        return min(
            (k for _, k, _ in self._counts(number, [len(k) - 1 for k in reach], reach, gains, math.inf)), default=0.0
        )

    def rank(self, number: int, worst: float) -> tuple[int, float, float]:
        """Return what plans are ordered by: as good as asked for, or within the limits, with the fewest places."""
        if self.aim and worst <= max(self.aim, 1.0) * (1 + _GAIN):
            return int(worst > self.aim * (1 + _GAIN)), number, worst
        return 2, round(math.log(max(worst, _FINE if self.aim == 0 else _GAIN)) / _TIE), number

    def _binds(self, plane: int, gains: Complex, reach: Sequence[Float], lowest: float) -> bool:
        if lowest <= 1:
            return False
        farther = [2.0 * k[-1] if n == plane else k[-1] for n, k in enumerate(reach)]
        return least_residual(gains, self.start, farther)[0] < lowest * (1 - 1e-6)

    def _late(self) -> bool:
        if thread_time() - self._begun > self.seconds:
            self.cut_short = True
        return self.cut_short

    def _first(self, most: Sequence[int], reach: Sequence[Float], gains: Complex, aim: float) -> int:
        """Return the least number of places that the bound leaves open, by halving."""
        low, high = 0, sum(most)
        while low + 1 < high:
            middle = (low + high) // 2
            if any(True for _ in self._counts(middle, most, reach, gains, aim)):
                high = middle
            else:
                low = middle
        return high

    def _counts(
        self, number: int, most: Sequence[int], reach: Sequence[Float], gains: Complex, aim: float
    ) -> list[tuple[tuple[int, ...], float, Complex]]:
        """Return how so many places may be shared by the planes, with the bound and the vectors, the best first."""
        ways = []
        for counts in _shares(number, most):
            least, vectors = least_residual(gains, self.start, [k[n] for k, n in zip(reach, counts, strict=True)])
            if least <= aim * (1 + _GAIN):
                ways.append((counts, least, vectors))
        return sorted(ways, key=lambda way: (round(way[1], 3), -min(way[0], default=0), way[0]))

    def _with_counts(
        self, kinds: Sequence[Sequence[int]], counts: Sequence[int], vectors: Complex, least: float, below: float
    ) -> tuple[tuple[Spot, ...], float]:
        """Return the best plan with so many places in each plane."""
        busy = [(group, n) for group, n in zip(kinds, counts, strict=True) if n]
        if not busy:
            return (), _worst(self.start)
        spots: tuple[Spot, ...] = ()
        worst = math.inf
        listed = [self._listed(group, n) for group, n in busy] if len(busy) <= 2 else [None]
        every = [k for k in listed if k is not None]
        if len(every) == len(listed):
            return self._best_of(every, below) or ((), math.inf)
        starts = [start for start in self._starts(kinds, counts, vectors) if self._fits(start)]
        for order in (1, -1) if not starts else ():  # the planes' places would be in each other's way
            starts += self._starts(kinds, counts, vectors, order)
        starts.sort(key=lambda k: _worst(self.rest(k)))
        enough = max(_FINE, least * (1 + _NEARLY))
        singly = []
        for start in starts[: _LAYOUTS**2]:
            singly.append(self.improve(start, kinds, enough, pairs=False))
            if self._late():
                break
        for start, _ in sorted(singly, key=lambda way: way[1])[:_LAYOUTS]:
            improved, left = self.improve(start, kinds, enough)
            if left < worst:
                spots, worst = improved, left
            if worst <= enough or self._late():
                break
        return spots, worst

    # Places and what they do.

    def effect(self, spot: Spot) -> Complex:
        """Return what a place adds in the tolerance planes, over the limits."""
        k, a, s = spot
        steps = self.steps[k]
        effect: Complex = self.gains[k] * (steps.sizes[s] * np.exp(1j * steps.angles[a]))
        return effect

    def rest(self, spots: Sequence[Spot]) -> Complex:
        """Return what is left with these places."""
        return sum((self.effect(k) for k in spots), self.start)

    def _fits(self, spots: Sequence[Spot]) -> bool:
        return all(
            self.steps[k].settings[s] <= self._room(k, [*spots[:i], *spots[i + 1 :]])[a] + _GAIN
            for i, (k, a, s) in enumerate(spots)
        )

    def _room(self, k: int, others: Sequence[Spot]) -> Float:
        """Return the greatest setting at each angle beside other places."""
        steps = self.steps[k]
        room = steps.most
        for other in others:
            room = np.minimum(room, self._beside_one(k, other))
        if isinstance(steps.tool, WeightTool):
            room = np.where(self._taken(k, others), -math.inf, room)
        return room

    def _beside_one(self, k: int, other: Spot) -> Float:
        if (k, other) not in self._rooms:
            steps, (there, a, s) = self.steps[k], other
            beside = self.steps[there]
            angle, setting = float(beside.angles[a]), float(beside.settings[s])
            self._rooms[k, other] = room_beside(steps.tool, steps.angles, beside.tool, angle, setting)
        return self._rooms[k, other]

    def _taken(self, k: int, others: Sequence[Spot]) -> Bool:
        """Return where no more weights of a kind can be put."""
        steps = self.steps[k]
        tool = steps.tool
        assert isinstance(tool, WeightTool)
        used = Counter(float(self.steps[j].angles[a]) for j, a, _ in others if self.steps[j].plane == steps.plane)
        full = np.isin(steps.angles, [angle for angle, n in used.items() if n >= tool.plane.most_per_position])
        spent = tool.weight.stock is not None and sum(j == k for j, _, _ in others) >= tool.weight.stock
        return full | spent

    # Laying out.

    def _starts(
        self, kinds: Sequence[Sequence[int]], counts: Sequence[int], vectors: Complex, order: int = 0
    ) -> list[tuple[Spot, ...]]:
        """Return places of all planes, each plane by itself, or in an order, each beside those before."""
        planes = list(zip(kinds, counts, vectors.tolist(), strict=True))
        if order == 0:
            return [tuple(itertools.chain(*way)) for way in itertools.product(*(self._layouts(*k) for k in planes))]
        starts: list[tuple[Spot, ...]] = [()]
        for plane in planes[::order]:
            starts = [(*start, *layout) for start in starts for layout in self._layouts(*plane, start)]
        return starts

    def _layouts(
        self, kinds: Sequence[int], number: int, vector: complex, others: tuple[Spot, ...] = ()
    ) -> list[tuple[Spot, ...]]:
        """Return places about a vector that make it up nearly, beside others, the best layouts first."""
        if number == 0:
            return [()]
        layouts: list[tuple[float, tuple[Spot, ...]]] = []
        for k in kinds:
            steps = self.steps[k]
            depths = np.unique(np.linspace(0, len(steps.settings) - 1, 9).astype(int)).tolist()
            for s, shift in itertools.product(depths, (0.0, 0.5)):
                gap = steps.tool.apart_at(float(steps.settings[s]))
                spots = self._beside(k, s, number, float(np.angle(vector)) + shift * gap, others)
                if len(spots) == number:
                    filled = self._filled(spots, vector)
                    made = sum(self._vector(spot) for spot in filled)
                    layouts.append((abs(vector - made), filled))
        for share in (True, False):
            spots = self._one_by_one(kinds, number, vector, share, others)
            if len(spots) == number:
                layouts.append((abs(vector - sum(self._vector(spot) for spot in spots)), spots))
        layouts.sort(key=lambda way: way[0])
        return list(dict.fromkeys(way for _, way in layouts))[:_LAYOUTS]

    def _one_by_one(
        self, kinds: Sequence[int], number: int, vector: complex, share: bool, others: tuple[Spot, ...]
    ) -> tuple[Spot, ...]:
        """Return places put one after the other, nearest to the vector's rest or to their share of it."""
        spots: list[Spot] = []
        for n in range(number, 0, -1):
            rest = (vector - sum(self._vector(spot) for spot in spots)) / (n if share else 1)
            tried = []
            for k in kinds:
                steps = self.steps[k]
                last = np.searchsorted(steps.settings, self._room(k, [*others, *spots]) + _GAIN, side="right") - 1
                turns = np.exp(1j * steps.angles)
                above = np.searchsorted(steps.sizes, (rest * turns.conj()).real)
                for s in (np.clip(above, 0, np.maximum(last, 0)), np.clip(above - 1, 0, np.maximum(last, 0))):
                    away = np.where(last >= 0, np.abs(rest - steps.sizes[s] * turns), math.inf)
                    a = int(away.argmin())
                    if math.isfinite(away[a]):
                        tried.append((float(away[a]), (k, a, int(s[a]))))
            if not tried:
                return ()
            spots.append(min(tried)[1])
        return tuple(spots)

    def _vector(self, spot: Spot) -> complex:
        k, a, s = spot
        return complex(self.steps[k].sizes[s] * np.exp(1j * self.steps[k].angles[a]))

    def _beside(self, k: int, s: int, number: int, angle: float, others: tuple[Spot, ...]) -> tuple[Spot, ...]:
        """Return so many places, as near to an angle as may be, that keep their distance with a setting."""
        steps = self.steps[k]
        away = np.abs((steps.angles - angle + math.pi) % FULL_TURN - math.pi)
        spots: list[Spot] = []
        order = np.argsort(np.round(away, 9), kind="stable")
        for _ in range(number):
            deep = order[self._room(k, [*others, *spots])[order] + _GAIN >= steps.settings[s]]
            if len(deep) == 0:
                return ()
            spots.append((k, int(deep[0]), s))
        return tuple(spots)

    def _filled(self, spots: Sequence[Spot], vector: complex) -> tuple[Spot, ...]:
        """Set the places up to their settings so that they leave the least of a vector."""
        size = abs(vector)
        k = spots[0][0]
        steps = self.steps[k]
        turns = np.exp(1j * steps.angles[[a for _, a, _ in spots]])
        most = np.array([steps.sizes[s] for _, _, s in spots])
        if size == 0 or steps.sizes[0] >= most.min():
            return tuple(spots)
        shares = _within_box(turns, vector, np.full(len(spots), steps.sizes[0]), most)
        return tuple(
            (k, a, min(int(np.abs(steps.sizes[: s + 1] - share).argmin()), s))
            for (_, a, s), share in zip(spots, shares.tolist(), strict=True)
        )

    # Improving.

    def improve(
        self, spots: tuple[Spot, ...], kinds: Sequence[Sequence[int]], enough: float = _FINE, *, pairs: bool = True
    ) -> tuple[tuple[Spot, ...], float]:
        """Move places one by one and in pairs, each time to the best that the steps allow, while that helps.

        Parameters
        ----------
        spots : the places
        kinds : groups of steps, by number; a place may take any of its group
        enough : what may be left
        pairs : whether places are moved in pairs as well
        """
        of_plane = {k: group for group in kinds for k in group}
        options = [of_plane[spot[0]] for spot in spots]
        worst = _worst(self.rest(spots))
        while not self._late():
            before = worst
            for i in range(0 if self._late() else len(spots)):
                spots, worst = self._moved(spots, worst, i, options[i])
            if worst < before * (1 - 1e-3):
                continue
            if not pairs:
                break
            for i, j in itertools.combinations(range(len(spots)), 2):
                if worst <= enough or self._late():
                    return spots, worst
                spots, worst = self._pair_moved(spots, worst, (i, j), (options[i], options[j]))
            if worst >= before * (1 - 1e-3):
                break
        return spots, worst

    def _moved(
        self, spots: tuple[Spot, ...], worst: float, i: int, options: Sequence[int]
    ) -> tuple[tuple[Spot, ...], float]:
        """Move one place to the best there is."""
        others = [*spots[:i], *spots[i + 1 :]]
        rest = self.rest(others)
        best = spots[i]
        for k in options:
            steps = self.steps[k]
            last = np.searchsorted(steps.settings, self._room(k, others) + _GAIN, side="right") - 1
            at = np.flatnonzero(last >= 0)
            if len(at) == 0:
                continue
            effects = self.gains[k] * np.exp(1j * steps.angles[at])[:, None]
            ideal = _best_sizes(rest, effects, steps.sizes[0], steps.sizes[last[at]])
            above = np.searchsorted(steps.sizes, ideal)
            for s in (np.clip(above, 0, last[at]), np.clip(above - 1, 0, last[at])):
                left = _largest(rest[j] + effects[:, j] * steps.sizes[s] for j in range(len(rest)))
                place = int(left.argmin())
                if left[place] < worst * (1 - _GAIN):
                    best, worst = (k, int(at[place]), int(s[place])), float(left[place])
        return (*spots[:i], best, *spots[i + 1 :]), worst

    def _pair_moved(
        self,
        spots: tuple[Spot, ...],
        worst: float,
        pair: tuple[int, int],
        options: tuple[Sequence[int], Sequence[int]],
    ) -> tuple[tuple[Spot, ...], float]:
        """Move two places together to the best that is found near one of them and anywhere for the other."""
        i, j = pair
        others = [spot for n, spot in enumerate(spots) if n not in pair]
        rest = self.rest(others)
        found: list[tuple[float, Spot, Spot]] = []
        for k in options[0]:
            near = self._spots(k, others, around=spots[i] if len(self.steps[k].settings) > 1 else None)
            for m in options[1]:
                found += self._partners(rest, near, m, others, worst)
        for left, one, other in sorted(found)[:_FOLLOWED]:
            if left >= worst * (1 - _GAIN):
                break
            moved = tuple(one if n == i else other if n == j else spot for n, spot in enumerate(spots))
            if self._fits(moved):
                return moved, left
        return spots, worst

    def _spots(self, k: int, others: Sequence[Spot], around: Spot | None) -> tuple[int, Int, Int]:
        """Return the numbers of angles and settings that are open to steps, about a place's angle or anywhere."""
        steps = self.steps[k]
        open_places = steps.settings <= self._room(k, others)[:, None] + _GAIN
        if around is not None and steps.count > 4000:
            angle = self.steps[around[0]].angles[around[1]]
            away = np.abs((steps.angles - angle + math.pi) % FULL_TURN - math.pi)
            open_places[np.argsort(away, kind="stable")[2 * _WINDOW + 1 :]] = False
        a, s = np.nonzero(open_places)
        return k, a, s

    def _partners(
        self, rest: Complex, near: tuple[int, Int, Int], m: int, others: Sequence[Spot], worst: float
    ) -> list[tuple[float, Spot, Spot]]:
        """Return the best places of steps m for each of the places near, where they are better than what there is."""
        k, a, s = near
        steps, gain = self.steps[m], self.gains[m]
        lefts = rest + self.gains[k] * (self.steps[k].sizes[s] * np.exp(1j * self.steps[k].angles[a]))[:, None]
        if len(a) == 0:
            return []
        if len(a) * steps.count <= _PAIRED:
            _, b, t = self._spots(m, others, None)
            vectors = steps.sizes[t] * np.exp(1j * steps.angles[b])
            tried = _largest(lefts[:, None, j] + gain[j] * vectors for j in range(len(gain)))
            one, other = np.nonzero(tried < worst * (1 - _GAIN))
            left = tried[one, other]
            best = np.argpartition(left, _FOLLOWED)[:_FOLLOWED] if len(left) > _FOLLOWED else np.arange(len(left))
            return [
                (float(left[n]), (k, int(a[one[n]]), int(s[one[n]])), (m, int(b[other[n]]), int(t[other[n]])))
                for n in best.tolist()
            ]
        last = np.searchsorted(steps.settings, self._room(m, others) + _GAIN, side="right") - 1
        ideal = -(lefts @ gain.conj()) / np.vdot(gain, gain).real
        beside = np.searchsorted(steps.angles, np.angle(ideal) % FULL_TURN)
        above = np.searchsorted(steps.sizes, np.abs(ideal))
        found = []
        for b, up in itertools.product((beside, beside - 1), (0, 1)):
            b = b % len(steps.angles)
            t = np.clip(above - up, 0, np.maximum(last[b], 0))
            vectors = steps.sizes[t] * np.exp(1j * steps.angles[b])
            tried = _largest(lefts[:, j] + gain[j] * vectors for j in range(len(gain)))
            tried = np.where(last[b] >= 0, tried, math.inf)
            better = np.flatnonzero(tried < worst * (1 - _GAIN))
            if len(better) > _FOLLOWED:
                better = better[np.argpartition(tried[better], _FOLLOWED)[:_FOLLOWED]]
            found += [(float(tried[x]), (k, int(a[x]), int(s[x])), (m, int(b[x]), int(t[x]))) for x in better.tolist()]
        return found

    # Listing.

    def _listed(self, kinds: Sequence[int], number: int) -> Int | None:
        """Return all plans (p, number, 3) of a plane with so many places; None where they are too many."""
        key = kinds[0], number
        if key not in self._lists:
            self._lists[key] = self._list(kinds, number)
        return self._lists[key]

    def _list(self, kinds: Sequence[int], number: int) -> Int | None:
        tables = []
        for k in kinds:
            a, s = np.nonzero(allowed(self.steps[k]))
            tables.append(np.column_stack([np.full(len(a), k), a, s]))
        singles = np.concatenate(tables)
        if number == 1:
            return singles[:, None] if len(singles) <= _SPOTS else None
        fewer = self._listed(kinds, number - 1)
        if fewer is None or len(fewer) * len(singles) > 10 * _LISTED or len(singles) ** 2 > 10 * _LISTED:
            return None
        spots: list[Spot] = [(k, a, s) for k, a, s in singles.tolist()]
        column = np.array([kinds.index(k) for k, _, _ in spots])
        depth = np.array([self.steps[k].settings[s] for k, _, s in spots])
        fits = np.empty((len(spots), len(spots)))
        for c, k in enumerate(kinds):
            mine = np.flatnonzero(column == c)
            fits[:, mine] = np.array([self._beside_one(k, spot) for spot in spots])[:, singles[mine, 1]]
        together = fits + _GAIN >= depth
        together &= together.T
        number_of = {spot: n for n, spot in enumerate(spots)}
        before = np.array([[number_of[k, a, s] for k, a, s in plan] for plan in fewer.tolist()], int).reshape(
            -1, number - 1
        )
        follows = together[before].all(axis=1) & (np.arange(len(spots)) >= before[:, -1:])
        plan, last = np.nonzero(follows)
        plans = np.column_stack([before[plan], last])
        tools = [self.steps[k].tool for k in kinds]
        for kind, tool in enumerate(tools):
            if isinstance(tool, WeightTool) and tool.weight.stock is not None:
                plans = plans[(column[plans] == kind).sum(axis=1) <= tool.weight.stock]
        if isinstance(tools[0], WeightTool):
            places = np.array([a for _, a, _ in spots])[plans]
            used = (places[:, :, None] == places[:, None]).sum(axis=2).max(axis=1)
            plans = plans[used <= tools[0].plane.most_per_position]
        return singles[plans.reshape(-1, number)] if len(plans) <= _LISTED else None

    def _best_of(self, listed: Sequence[Int], below: float) -> tuple[tuple[Spot, ...], float] | None:
        """Return the best combination of the plans of one plane or two."""
        gains = [self.gains[plans[0, 0, 0]] if len(plans) else 0 * self.start for plans in listed]
        sums = [self._vectors(plans) for plans in listed]
        if not all(len(k) for k in sums):
            return None
        if len(sums) == 1:
            left = _largest(at + sums[0] * gain for at, gain in zip(self.start, gains[0], strict=True))
            best = int(left.argmin())
            return _spots(listed[0][best]), float(left[best])
        result = None
        for plans, worst in self._combinations(sums, gains, below):
            spots = (*_spots(listed[0][plans[0]]), *_spots(listed[1][plans[1]]))
            if (result is None or worst < result[1]) and self._fits(spots):
                result = spots, worst
        return result

    def _vectors(self, plans: Int) -> Complex:
        """Return what plans (p, n, 3) of a plane make up, (p,) kg m."""
        total = np.zeros(len(plans), complex)
        for k in np.unique(plans[..., 0]).tolist():
            steps = self.steps[k]
            vectors = steps.sizes[plans[..., 2] % len(steps.sizes)] * np.exp(
                1j * steps.angles[plans[..., 1] % len(steps.angles)]
            )
            total += np.where(plans[..., 0] == k, vectors, 0).sum(axis=1)
        return total

    def _combinations(
        self, sums: Sequence[Complex], gains: Sequence[Complex], below: float
    ) -> Iterator[tuple[tuple[int, int], float]]:
        """Yield pairs of plans of two planes that leave less and less."""
        from scipy.spatial import KDTree

        one, other = sums
        gain, size = gains[1], np.vdot(gains[1], gains[1]).real
        wanted = -(self.start + one[:, None] * gains[0])
        ideal = wanted @ gain.conj() / size
        # What no vector of the other plane can take away, at least 1/√t of which is left in the worst plane.
        aside = np.linalg.norm(wanted - ideal[:, None] * gain, axis=1)
        root = math.sqrt(len(self.start))
        order = np.argsort(aside, kind="stable")
        tree = KDTree(np.column_stack([other.real, other.imag]))
        best = below * (1 + _GAIN)
        for chunk in np.array_split(order, max(1, len(order) // 2000)):
            if aside[chunk[0]] > root * best or self._late():
                break
            distance, nearest = tree.query(np.column_stack([ideal.real, ideal.imag])[chunk])
            for number, apart, k in zip(chunk.tolist(), distance.tolist(), nearest.tolist(), strict=True):
                radius = root * best
                if aside[number] ** 2 + apart**2 * size > radius**2:
                    continue
                near = [k]
                if math.isfinite(radius):
                    reach = math.sqrt(max(radius**2 - aside[number] ** 2, 0.0) / size)
                    near = tree.query_ball_point([ideal[number].real, ideal[number].imag], reach * (1 + _GAIN)) or near
                left = np.abs(wanted[number] - other[near][:, None] * gain).max(axis=1)
                for place in np.argsort(left, kind="stable").tolist():
                    if left[place] > best:
                        break
                    best = float(left[place])
                    yield (number, int(near[place])), best


def _spots(plan: Int) -> tuple[Spot, ...]:
    return tuple((k, a, s) for k, a, s in plan.tolist())


def _worst(rest: Complex) -> float:
    return float(np.abs(rest).max(initial=0.0))


def _largest(vectors: Iterable[Complex]) -> Float:
    """Return the largest magnitude of arrays, place by place."""
    return reduce(np.maximum, (np.abs(each) for each in vectors))


def _within_box(turns: Complex, vector: complex, low: Float, high: Float) -> Float:
    """Return u (n,) between limits for which Σ u turns comes near a vector, as far from the limits as can be.

    Those that would go past a limit are put on it, and the others make up the rest, the least moved of all from the
    middle.
    """
    shares = 0.5 * (low + high)
    free = np.ones(len(turns), bool)
    rows = np.stack([turns.real, turns.imag])
    for _ in range(len(turns)):
        rest = vector - complex((shares * turns).sum())
        matrix = rows[:, free] * (high - low)[free]
        moves, *_ = np.linalg.lstsq(matrix, np.array([rest.real, rest.imag]), rcond=1e-9)
        wanted = shares[free] + moves * (high - low)[free]
        shares[free] = np.clip(wanted, low[free], high[free])
        past = (wanted < low[free]) | (wanted > high[free])
        if not past.any():
            break
        free[np.flatnonzero(free)[past]] = False
        if not free.any():
            break
    return shares


def _shares(number: int, most: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Yield all ways to share a number among planes that take so many at most."""
    if len(most) == 1:
        if number <= most[0]:
            yield (number,)
        return
    for n in range(min(number, most[0]) + 1):
        for rest in _shares(number - n, most[1:]):
            yield (n, *rest)


def _best_sizes(rest: Complex, effects: Complex, low: float, high: Float) -> Float:
    """Return the u (m,) between low and high for which max |rest + u effects| (m, t) is least."""
    flat = [np.full(len(effects), low), high]
    square = np.abs(effects) ** 2
    slope = (effects.conj() * rest).real
    for j in range(len(rest)):
        flat.append(-slope[:, j] / np.where(square[:, j] > 0, square[:, j], 1.0))
        for i in range(j):
            a = square[:, i] - square[:, j]
            b = slope[:, i] - slope[:, j]
            c = abs(rest[i]) ** 2 - abs(rest[j]) ** 2
            root = np.sqrt(np.maximum(b**2 - a * c, 0.0))
            linear = -0.5 * c / np.where(b == 0, 1.0, b)
            flat += [np.where(a != 0, (sign * root - b) / np.where(a == 0, 1.0, a), linear) for sign in (1.0, -1.0)]
    tried = np.clip(np.array(flat), low, high)
    left = _largest(rest[j] + tried * effects[:, j] for j in range(len(rest)))
    best: Float = tried[left.argmin(axis=0), np.arange(len(effects))]
    return best
