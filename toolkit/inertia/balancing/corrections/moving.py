"""Places of a plan moved one by one and in pairs, each time to the best that the steps allow."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.corrections.correction_plane import FULL_TURN
from inertia.balancing.corrections.places import FINE, GAIN, Places, Spot, largest, worst_of
from inertia.balancing.unbalance import Complex

_PAIRED = 300_000  # pairs that are tried at once
_FOLLOWED = 100  # of them, the best
_WINDOW = 7  # steps of angle to each side of a place, in pairs
_ROUNDS = 2  # of a setting by its lever, and the lever by the setting


def improve(
    places: Places, spots: tuple[Spot, ...], kinds: Sequence[Sequence[int]], enough: float = FINE, *, pairs: bool = True
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
    worst = worst_of(places.rest(spots))
    while not places.late():
        before = worst
        for i in range(0 if places.late() else len(spots)):
            spots, worst = _moved(places, spots, worst, i, options[i])
        if worst < before * (1 - 1e-3):
            continue
        if not pairs:
            break
        for i, j in itertools.combinations(range(len(spots)), 2):
            if worst <= enough or places.late():
                return spots, worst
            spots, worst = _pair_moved(places, spots, worst, (i, j), (options[i], options[j]))
        if worst >= before * (1 - 1e-3):
            break
    return spots, worst


def _moved(
    places: Places, spots: tuple[Spot, ...], worst: float, i: int, options: Sequence[int]
) -> tuple[tuple[Spot, ...], float]:
    """Move one place to the best there is."""
    others = [*spots[:i], *spots[i + 1 :]]
    rest = places.rest(others)
    best = spots[i]
    for k in options:
        steps = places.steps[k]
        last = np.searchsorted(steps.settings, places.room(k, others) + GAIN, side="right") - 1
        at = np.flatnonzero(last >= 0)
        if len(at) == 0:
            continue
        turns, above = np.exp(1j * steps.angles[at])[:, None], last[at]
        for _ in range(_ROUNDS if places.varies(k) else 1):
            effects = places.gains[k][np.clip(above, 0, last[at])] * turns
            ideal = _best_sizes(rest, effects, steps.sizes[0], steps.sizes[last[at]])
            above = np.searchsorted(steps.sizes, ideal)
            for s in (np.clip(above, 0, last[at]), np.clip(above - 1, 0, last[at])):
                left = largest(rest[:, None] + places.effects(k, at, s))
                place = int(left.argmin())
                if left[place] < worst * (1 - GAIN):
                    best, worst = (k, int(at[place]), int(s[place])), float(left[place])
    return (*spots[:i], best, *spots[i + 1 :]), worst


def _pair_moved(
    places: Places,
    spots: tuple[Spot, ...],
    worst: float,
    pair: tuple[int, int],
    options: tuple[Sequence[int], Sequence[int]],
) -> tuple[tuple[Spot, ...], float]:
    """Move two places together to the best that is found near one of them and anywhere for the other."""
    i, j = pair
    others = [spot for n, spot in enumerate(spots) if n not in pair]
    rest = places.rest(others)
    found: list[tuple[float, Spot, Spot]] = []
    for k in options[0]:
        near = _spots(places, k, others, around=spots[i] if len(places.steps[k].settings) > 1 else None)
        for m in options[1]:
            found += _partners(places, rest, near, m, others, worst)
    for left, one, other in sorted(found)[:_FOLLOWED]:
        if left >= worst * (1 - GAIN):
            break
        moved = tuple(one if n == i else other if n == j else spot for n, spot in enumerate(spots))
        if places.fits(moved):
            return moved, left
    return spots, worst


def _spots(places: Places, k: int, others: Sequence[Spot], around: Spot | None) -> tuple[int, Int, Int]:
    """Return the numbers of angles and settings that are open to steps, about a place's angle or anywhere."""
    steps = places.steps[k]
    open_places = steps.settings <= places.room(k, others)[:, None] + GAIN
    if around is not None and steps.count > 4000:
        angle = places.steps[around[0]].angles[around[1]]
        away = np.abs((steps.angles - angle + math.pi) % FULL_TURN - math.pi)
        open_places[np.argsort(away, kind="stable")[2 * _WINDOW + 1 :]] = False
    a, s = np.nonzero(open_places)
    return k, a, s


def _partners(
    places: Places, rest: Complex, near: tuple[int, Int, Int], m: int, others: Sequence[Spot], worst: float
) -> list[tuple[float, Spot, Spot]]:
    """Return the best places of steps m for each of the places near, where they are better than what there is."""
    k, a, s = near
    steps, gains = places.steps[m], places.gains[m].T
    lefts = rest[:, None] + places.effects(k, a, s)
    if len(a) == 0:
        return []
    if len(a) * steps.count <= _PAIRED:
        _, b, t = _spots(places, m, others, None)
        effects = places.effects(m, b, t)
        tried = largest(left[:, None] + effect for left, effect in zip(lefts, effects, strict=True))
        one, other = np.nonzero(tried < worst * (1 - GAIN))
        left = tried[one, other]
        best = np.argpartition(left, _FOLLOWED)[:_FOLLOWED] if len(left) > _FOLLOWED else np.arange(len(left))
        return [
            (float(left[n]), (k, int(a[one[n]]), int(s[one[n]])), (m, int(b[other[n]]), int(t[other[n]])))
            for n in best.tolist()
        ]
    last = np.searchsorted(steps.settings, places.room(m, others) + GAIN, side="right") - 1
    at = np.flatnonzero(last >= 0)
    found: list[tuple[float, Spot, Spot]] = []
    above = np.full(len(a), len(steps.sizes))
    for _ in range((_ROUNDS if places.varies(m) else 1) if len(at) else 0):
        gain = gains[:, np.minimum(above, len(steps.sizes) - 1)]
        ideal = -(lefts * gain.conj()).sum(axis=0) / (np.abs(gain) ** 2).sum(axis=0)
        beside = np.searchsorted(steps.angles[at], np.angle(ideal) % FULL_TURN)
        above = np.searchsorted(steps.sizes, np.abs(ideal))
        for aside, up in itertools.product((0, 1), (0, 1)):
            b = at[(beside - aside) % len(at)]
            t = np.clip(above - up, 0, last[b])
            tried = largest(lefts + places.effects(m, b, t))
            better = np.flatnonzero(tried < worst * (1 - GAIN))
            if len(better) > _FOLLOWED:
                better = better[np.argpartition(tried[better], _FOLLOWED)[:_FOLLOWED]]
            found += [(float(tried[x]), (k, int(a[x]), int(s[x])), (m, int(b[x]), int(t[x]))) for x in better.tolist()]
    return found


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
    left = largest(rest[j] + tried * effects[:, j] for j in range(len(rest)))
    best: Float = tried[left.argmin(axis=0), np.arange(len(effects))]
    return best
