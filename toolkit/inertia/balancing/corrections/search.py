"""Search for a plan: the fewest places that come within the limits, and of those plans the one that leaves the least.

Everything is stepped: a place is one of a plane's `Steps` at one of its angles and settings. Numbers of places are
tried in ascending order, those alone that a bound (`sharing`) leaves open. Where a plane's plans with so many places
can be listed, the best of all is taken (`listing`); elsewhere places are laid out about the vectors of the bound
(`laying_out`) and improved (`moving`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

from inertia.balancing.corrections.laying_out import LAYOUTS, starts
from inertia.balancing.corrections.listing import Listing
from inertia.balancing.corrections.moving import improve
from inertia.balancing.corrections.places import FINE, GAIN, Places, Spot, worst_of
from inertia.balancing.corrections.sharing import MORE, Sharing
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

AIM = 0.75
"""Share of the tolerance that is to be left at most: what the shop's work scatters has to fit into the rest."""

SECONDS = 10.0
"""How long a plan is looked for, where nothing else is said."""

_TIE = 1e-6
_NEARLY = 0.01  # of the least residual: numbers of places that come so near it are tried first
_OUT_OF_REACH = 0.3  # of the time
_FEW = 4000  # angles times settings
_LISTED_PLANES = 2  # whose plans are listed together


@dataclass(frozen=True)
class Plan:
    """What a search came to.

    Attributes
    ----------
    spots : the places
    worst : the largest |residual| over its limit
    bound : no plan with at most so many places leaves less, nor one with any number where the limits are out of reach
    lowest : no plan leaves less, whatever its number of places
    fewest : no plan with fewer places is within the limits; 0 where none is
    cut_short : the time was up before the search was through
    binding : numbers of the planes that would have to reach farther, where the limits are out of reach
    settled : as all plans were listed that the bound leaves open, none with at most so many places leaves less, and
        where it is above the limits, none with any number
    """

    spots: tuple[Spot, ...]
    worst: float
    bound: float
    lowest: float
    fewest: int
    cut_short: bool
    binding: tuple[int, ...] = ()
    settled: bool = False


def rank(aim: float, number: int, worst: float) -> tuple[int, float, float]:
    """Return what plans are ordered by: as good as asked for, or within the limits, with the fewest places.

    Parameters
    ----------
    aim : what is to be left at most, as a share of the limits; 0 for the least that the steps allow
    number : of places
    worst : the largest |residual| over its limit
    """
    if aim and worst <= max(aim, 1.0) * (1 + GAIN):
        return int(worst > aim * (1 + GAIN)), number, worst
    return 2, round(math.log(max(worst, FINE if aim == 0 else GAIN)) / _TIE), number


def best_plan(places: Places, aim: float = 1.0) -> Plan:
    """Return the best plan; `aim` is what is to be left at most, as of `rank`, if it can be."""
    search = _Search(places, aim)
    sharing, lowest = search.sharing, search.sharing.lowest
    if lowest > 1:  # what is out of reach takes no more than a share of the time
        places.seconds *= _OUT_OF_REACH
    for goal in dict.fromkeys((aim or AIM, 1.0)):
        # What misses the aim may come within the limits with fewer places than were tried for it.
        if lowest <= goal and (aim or search.worst > goal):
            search.reach(goal)
        if search.worst <= goal or search.late():
            break
    if search.worst > 1 or aim == 0:
        search.leave_least()
    spots, worst = _spared(places, search.spots, search.worst, aim)
    settled = search.settled and not (places.cut_short or sharing.cut_short) and worst > FINE
    out_of_reach = lowest > 1 or (settled and worst > 1)
    fewest = 0 if out_of_reach or worst_of(places.start) <= 1 else sharing.first(1.0)
    bound = lowest
    if settled:
        bound = worst
    elif worst <= 1:
        bound = sharing.bound(len(spots), 1.0, default=lowest)
    return Plan(
        spots,
        worst,
        bound=min(bound, worst),
        lowest=lowest,
        fewest=min(fewest, len(spots)) if worst <= 1 else fewest,
        cut_short=places.cut_short or sharing.cut_short,
        binding=sharing.binding(),
        settled=settled,
    )


class _Search:
    """A search under way.

    Attributes
    ----------
    spots, worst : the best plan so far, and what it leaves
    settled : all plans of the shop that the bound left open were listed, so that none with so many places leaves less
    """

    def __init__(self, places: Places, aim: float) -> None:
        self.sharing = Sharing(places)
        self.spots: tuple[Spot, ...] = ()
        self.worst = worst_of(places.start)
        self.settled = all(steps.complete for steps in places.steps)
        self._places, self._aim, self._listing = places, aim, Listing(places)
        self._tried: set[tuple[int, ...]] = set()

    def late(self) -> bool:
        """Say whether the time is up; however little there is, one plan is made of a rotor out of tolerance."""
        return bool(self.spots or self.worst <= 1) and self._places.late()

    def reach(self, goal: float) -> None:
        """Look for the fewest places that leave no more than a goal."""
        first = self.sharing.first(goal)
        for number in itertools.chain(range(first, first + MORE + 1), self._beyond(first + MORE)):
            if (self.worst <= goal and number > len(self.spots)) or self.late():
                break
            self._try(number, goal, max(self.worst, goal), listed=number > first + MORE)

    def leave_least(self) -> None:
        """Look for the least that can be left, with any number of places."""
        lowest = self.sharing.lowest
        # First those from where more of them add nothing.
        first = self.sharing.first(max(1.0, lowest * (1 + _NEARLY)))
        last = first + MORE if lowest <= 1 < self.worst else min(sum(self.sharing.most), first + MORE)
        for number in itertools.chain(range(first, last + 1), range(first - 1, 0, -1), self._beyond(last)):
            if self.worst <= max(FINE, lowest * (1 + _TIE)) or self.late():
                return
            self._try(number, self.worst, self.worst, listed=number > last)
        self.settled &= all(self._listing.complete(group) for group in self.sharing.kinds)

    def _beyond(self, last: int) -> Iterator[int]:
        """Yield the numbers of places beyond a last one with which there are plans that can be listed."""
        most = sorted(self._listing.most(group) for group in self.sharing.kinds)
        yield from range(last + 1, sum(most[-_LISTED_PLANES:]) + 1)

    def _try(self, number: int, open_below: float, below: float, *, listed: bool) -> None:
        """Look for a better plan with so many places, of those alone that the bound leaves open.

        Parameters
        ----------
        open_below, below : what a bound, and a plan, may leave to be of use
        listed : whether only plans that can be listed are looked at
        """
        most = [self._most(number, *each) for each in zip(self.sharing.kinds, self.sharing.most, strict=True)]
        for counts, least, shares in self.sharing.ways(number, open_below, most):
            if self.worst <= FINE or self.late():
                break
            if counts in self._tried or least > below * (1 + _TIE):
                continue
            busy = [(group, n) for group, n in zip(self.sharing.kinds, counts, strict=True) if n]
            at_once = len(busy) <= _LISTED_PLANES and not self._places.late()
            if at_once and all(self._listing.lists(*each) for each in busy):
                spots, worst = self._listing.best_of(busy, below)
            else:
                self.settled = False
                if listed:
                    continue
                spots, worst = _laid_out(self._places, self.sharing.kinds, counts, shares, least)
            self._tried.add(counts)
            if math.isfinite(worst) and self._rank(spots, worst) < self._rank(self.spots, self.worst):
                self.spots, self.worst = spots, worst

    def _rank(self, spots: Sequence[Spot], worst: float) -> tuple[int, float, float]:
        return rank(self._aim, len(spots), worst)

    def _most(self, number: int, group: Sequence[int], useful: int) -> int:
        """Return how many of so many places a plane may take: not many more than are useful, or as can be listed."""
        if number <= useful + MORE:
            return number
        self.settled &= self._listing.complete(group)
        return max(useful + MORE, self._listing.most(group))


def _spared(places: Places, spots: tuple[Spot, ...], worst: float, aim: float) -> tuple[tuple[Spot, ...], float]:
    """Return a plan without the places that it is better without: a search that was cut short may leave some."""
    while spots:
        rests = [spots[:k] + spots[k + 1 :] for k in range(len(spots))]
        left, fewer = min((worst_of(places.rest(rest)), rest) for rest in rests)
        if rank(aim, len(fewer), left) >= rank(aim, len(spots), worst):
            break
        spots, worst = fewer, left
    return spots, worst


def _laid_out(
    places: Places, kinds: Sequence[Sequence[int]], counts: Sequence[int], shares: Complex, least: float
) -> tuple[tuple[Spot, ...], float]:
    """Return the best plan that is found with so many places in each plane, laid out about its share and moved."""
    begun = [start for start in starts(places, kinds, counts, shares) if places.fits(start)]
    for order in (1, -1) if not begun else ():  # the planes' places would be in each other's way
        begun += starts(places, kinds, counts, shares, order)
    begun.sort(key=lambda k: worst_of(places.rest(k)))
    enough = max(FINE, least * (1 + _NEARLY))
    tried, followed = _thoroughness(places)
    singly: dict[tuple[Spot, ...], tuple[tuple[Spot, ...], float]] = {}
    for start in begun[:tried]:
        moved, left = improve(places, start, kinds, enough, pairs=False)
        singly.setdefault(tuple(sorted(moved)), (moved, left))
        if places.late():
            break
    spots: tuple[Spot, ...] = ()
    worst = math.inf
    for start, _ in sorted(singly.values(), key=lambda way: way[1])[:followed]:
        improved, left = improve(places, start, kinds, enough)
        if left < worst:
            spots, worst = improved, left
        if worst <= enough or places.late():
            break
    return spots, worst


def _thoroughness(places: Places) -> tuple[int, int]:
    """Return how many layouts are improved singly, and how many of them in pairs as well."""
    if not any(places.varies(k) for k in range(len(places.steps))):
        return LAYOUTS**2, LAYOUTS
    # What does most where levers differ is none of the layouts that make up the vector best.
    few = sum(each.count for each in places.steps) <= _FEW
    return (LAYOUTS**3, LAYOUTS**3) if few else (LAYOUTS**2, 2 * LAYOUTS)
