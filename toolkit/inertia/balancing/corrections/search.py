"""Search for a plan: the fewest places that come within the limits, and of those plans the one that leaves the least.

Everything is stepped: a place is one of a plane's `Steps` at one of its angles and settings. Numbers of places are
tried in ascending order, those alone that a bound (`sharing`) leaves open. Where a plane's plans with so many places
can be listed, the best of all is taken (`listing`); elsewhere places are laid out about the vectors of the bound
(`laying_out`) and improved (`moving`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

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
    """

    spots: tuple[Spot, ...]
    worst: float
    bound: float
    lowest: float
    fewest: int
    cut_short: bool
    binding: tuple[int, ...] = ()


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
    sharing, listing = Sharing(places), Listing(places)
    lowest = sharing.lowest
    best = Plan((), worst_of(places.start), lowest, lowest, 0, False)
    solved: set[tuple[int, ...]] = set()
    fewest = 0

    def attempt(number: int, open_below: float, below: float) -> Plan:
        result = best
        if result.spots and places.late():  # however little time there is, one plan is made
            return result
        for counts, least, shares in sharing.ways(number, open_below):
            if counts not in solved and least <= below * (1 + _TIE) and not (result.spots and places.late()):
                solved.add(counts)
                spots, worst = _with_counts(places, sharing, listing, counts, shares, least, below)
                if math.isfinite(worst) and rank(aim, len(spots), worst) < rank(aim, len(result.spots), result.worst):
                    result = replace(result, spots=spots, worst=worst)
                if result.worst <= FINE:
                    break
        return result

    if lowest > 1:  # what is out of reach takes no more than a share of the time
        places.seconds *= _OUT_OF_REACH
    for goal in dict.fromkeys((aim, 1.0)) if aim else ():
        if lowest <= goal < best.worst:
            first = sharing.first(goal)
            fewest = first if goal == 1.0 or not fewest else fewest
            for number in range(first, first + MORE + 1):
                best = attempt(number, goal, goal if number < len(best.spots) else max(best.worst, goal))
                if best.worst <= goal or places.late():
                    break
        if best.worst <= goal or places.late():
            break
    if best.worst > 1 or aim == 0:
        # Any number of places may leave the least; first those from where more of them add nothing.
        first = sharing.first(max(1.0, lowest * (1 + _NEARLY)))
        last = first + MORE if lowest <= 1 < best.worst else min(sum(sharing.most), first + MORE)
        for number in (*range(first, last + 1), *range(first - 1, 0, -1)):
            if best.worst <= max(FINE, lowest * (1 + _TIE)):
                break
            best = attempt(number, best.worst, best.worst)
    best = _spared(places, best, aim)
    bound = lowest
    if best.worst <= 1:
        bound = sharing.bound(len(best.spots), 1.0, default=lowest)
        fewest = min(sharing.first(1.0) if worst_of(places.start) > 1 else 0, len(best.spots))
    return replace(
        best,
        bound=min(bound, best.worst),
        fewest=fewest,
        cut_short=places.cut_short,
        binding=sharing.binding(),
    )


def _spared(places: Places, plan: Plan, aim: float) -> Plan:
    """Return the plan without the places that it is better without: a search that was cut short may leave some."""
    while plan.spots:
        rests = [plan.spots[:k] + plan.spots[k + 1 :] for k in range(len(plan.spots))]
        worst, spots = min((worst_of(places.rest(spots)), spots) for spots in rests)
        if rank(aim, len(spots), worst) >= rank(aim, len(plan.spots), plan.worst):
            break
        plan = replace(plan, spots=spots, worst=worst)
    return plan


def _with_counts(
    places: Places,
    sharing: Sharing,
    listing: Listing,
    counts: Sequence[int],
    shares: Complex,
    least: float,
    below: float,
) -> tuple[tuple[Spot, ...], float]:
    """Return the best plan with so many places in each plane."""
    kinds = sharing.kinds
    busy = [(group, n) for group, n in zip(kinds, counts, strict=True) if n]
    if not busy:
        return (), worst_of(places.start)
    listed = [listing.of(group, n) for group, n in busy] if len(busy) <= 2 else [None]
    every = [k for k in listed if k is not None]
    if len(every) == len(listed):
        return listing.best_of(every, below) or ((), math.inf)
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
