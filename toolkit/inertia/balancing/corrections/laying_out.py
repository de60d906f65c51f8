"""Places laid out about what each plane has to do: where the search for a plan begins."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import FULL_TURN
from inertia.balancing.corrections.places import GAIN, Places, Spot
from inertia.balancing.unbalance import Complex

LAYOUTS = 3
"""How many layouts of a plane are followed up."""


def starts(
    places: Places, kinds: Sequence[Sequence[int]], counts: Sequence[int], shares: Complex, order: int = 0
) -> list[tuple[Spot, ...]]:
    """Return places of all planes, each plane by itself, or in an order, each beside those before.

    Parameters
    ----------
    kinds, counts : numbers of the steps of each plane, and its places
    shares : (planes, t) what each has to do in the tolerance planes, over the limits
    """
    planes = list(zip(kinds, counts, shares, strict=True))
    if order == 0:
        return [tuple(itertools.chain(*way)) for way in itertools.product(*(_layouts(places, *k) for k in planes))]
    starts: list[tuple[Spot, ...]] = [()]
    for plane in planes[::order]:
        starts = [(*start, *layout) for start in starts for layout in _layouts(places, *plane, start)]
    return starts


def _layouts(
    places: Places, kinds: Sequence[int], number: int, share: Complex, others: tuple[Spot, ...] = ()
) -> list[tuple[Spot, ...]]:
    """Return places that do nearly what a plane has to do, beside others, the best layouts first."""
    if number == 0:
        return [()]
    gain = places.middle(kinds)
    vector = complex(np.vdot(gain, share) / np.vdot(gain, gain).real)
    varies = any(places.varies(k) for k in kinds)
    layouts: list[tuple[Spot, ...]] = []
    for k in kinds:
        steps = places.steps[k]
        depths = np.unique(np.linspace(0, len(steps.settings) - 1, 9).astype(int)).tolist()
        for s, shift in itertools.product(depths, (0.0, 0.5)):
            gap = steps.tool.apart_at(float(steps.settings[s]))
            spots = _beside(places, k, s, number, float(np.angle(vector)) + shift * gap, others)
            if len(spots) == number:
                layouts.append(_filled(places, spots, vector))
        if varies and number > 1:  # shallower holes act elsewhere, fewer of them may have to be spread instead
            layouts += [way for s in depths for way in _spread(places, k, s, number, vector, others)]
    layouts += [_one_by_one(places, kinds, number, vector, share_it, others) for share_it in (True, False)]
    made = [
        (float(np.linalg.norm(share - sum(places.effect(spot) for spot in spots))), spots)
        for spots in layouts
        if len(spots) == number
    ]
    made.sort(key=lambda way: way[0])
    return list(dict.fromkeys(way for _, way in made))[: LAYOUTS**3 if varies else LAYOUTS]


def _spread(
    places: Places, k: int, s: int, number: int, vector: complex, others: tuple[Spot, ...]
) -> list[tuple[Spot, ...]]:
    """Return places at one setting that make up a vector in two groups, or in a group with one to each side of it."""
    size, middle = abs(vector), float(np.angle(vector))

    def group(count: int, angle: float, spots: tuple[Spot, ...] = ()) -> tuple[Spot, ...]:
        return (*spots, *_beside(places, k, s, count, angle, (*others, *spots)))

    reach = [abs(sum(places.vector(spot) for spot in group(count, middle))) for count in range(number + 1)]
    ways = []
    for first in range(1, number):
        one, other = (
            _aside(size, *pair)
            for pair in ((reach[first], reach[number - first]), (reach[number - first], reach[first]))
        )
        ways.append(group(number - first, middle - other, group(first, middle + one)))
    if number > 2:
        side = _aside(size - reach[number - 2], reach[1], reach[1])
        ways.append(group(1, middle - side, group(1, middle + side, group(number - 2, middle))))
    return ways


def _aside(size: float, mine: float, other: float) -> float:
    """Return the angle from a vector to one of two of these lengths that are together the vector, rad."""
    return math.acos(min(max((size**2 + mine**2 - other**2) / (2 * size * mine or 1.0), -1.0), 1.0))


def _one_by_one(
    places: Places, kinds: Sequence[int], number: int, vector: complex, share: bool, others: tuple[Spot, ...]
) -> tuple[Spot, ...]:
    """Return places put one after the other, nearest to the vector's rest or to their share of it."""
    spots: list[Spot] = []
    for n in range(number, 0, -1):
        rest = (vector - sum(places.vector(spot) for spot in spots)) / (n if share else 1)
        tried = []
        for k in kinds:
            steps = places.steps[k]
            last = np.searchsorted(steps.settings, places.room(k, [*others, *spots]) + GAIN, side="right") - 1
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


def _beside(places: Places, k: int, s: int, number: int, angle: float, others: tuple[Spot, ...]) -> tuple[Spot, ...]:
    """Return so many places, as near to an angle as may be, that keep their distance with a setting."""
    steps = places.steps[k]
    away = np.abs((steps.angles - angle + math.pi) % FULL_TURN - math.pi)
    spots: list[Spot] = []
    order = np.argsort(np.round(away, 9), kind="stable")
    for _ in range(number):
        deep = order[places.room(k, [*others, *spots])[order] + GAIN >= steps.settings[s]]
        if len(deep) == 0:
            return ()
        spots.append((k, int(deep[0]), s))
    return tuple(spots)


def _filled(places: Places, spots: Sequence[Spot], vector: complex) -> tuple[Spot, ...]:
    """Set the places up to their settings so that they leave the least of a vector."""
    size = abs(vector)
    k = spots[0][0]
    steps = places.steps[k]
    turns = np.exp(1j * steps.angles[[a for _, a, _ in spots]])
    most = np.array([steps.sizes[s] for _, _, s in spots])
    if size == 0 or steps.sizes[0] >= most.min():
        return tuple(spots)
    shares = _within_box(turns, vector, np.full(len(spots), steps.sizes[0]), most)
    return tuple(
        (k, a, min(int(np.abs(steps.sizes[: s + 1] - share).argmin()), s))
        for (_, a, s), share in zip(spots, shares.tolist(), strict=True)
    )


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
