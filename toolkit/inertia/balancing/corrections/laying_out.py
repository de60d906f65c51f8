"""Places laid out about the vectors that a plan has to make up: where the search for a plan begins."""

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
    places: Places, kinds: Sequence[Sequence[int]], counts: Sequence[int], vectors: Complex, order: int = 0
) -> list[tuple[Spot, ...]]:
    """Return places of all planes, each plane by itplaces, or in an order, each beside those before."""
    planes = list(zip(kinds, counts, vectors.tolist(), strict=True))
    if order == 0:
        return [tuple(itertools.chain(*way)) for way in itertools.product(*(_layouts(places, *k) for k in planes))]
    starts: list[tuple[Spot, ...]] = [()]
    for plane in planes[::order]:
        starts = [(*start, *layout) for start in starts for layout in _layouts(places, *plane, start)]
    return starts


def _layouts(
    places: Places, kinds: Sequence[int], number: int, vector: complex, others: tuple[Spot, ...] = ()
) -> list[tuple[Spot, ...]]:
    """Return places about a vector that make it up nearly, beside others, the best layouts first."""
    if number == 0:
        return [()]
    layouts: list[tuple[float, tuple[Spot, ...]]] = []
    for k in kinds:
        steps = places.steps[k]
        depths = np.unique(np.linspace(0, len(steps.settings) - 1, 9).astype(int)).tolist()
        for s, shift in itertools.product(depths, (0.0, 0.5)):
            gap = steps.tool.apart_at(float(steps.settings[s]))
            spots = _beside(places, k, s, number, float(np.angle(vector)) + shift * gap, others)
            if len(spots) == number:
                filled = _filled(places, spots, vector)
                made = sum(places.vector(spot) for spot in filled)
                layouts.append((abs(vector - made), filled))
    for share in (True, False):
        spots = _one_by_one(places, kinds, number, vector, share, others)
        if len(spots) == number:
            layouts.append((abs(vector - sum(places.vector(spot) for spot in spots)), spots))
    layouts.sort(key=lambda way: way[0])
    return list(dict.fromkeys(way for _, way in layouts))[:LAYOUTS]


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
