"""A correction split among the positions of a plane: its holes, bolts or blades, with what the shop can mount there."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.corrections.correction_plane import KitWeight, angle_of
from inertia.balancing.corrections.disc_constrained_milp import Effort
from inertia.balancing.corrections.standard_weights import choose_weights
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass

_NOTHING = 1e-9  # of the whole: masses that are none
_FOLLOWED = 64  # roundings followed up
_ANYWHERE = math.radians(15.0)
_FIRM = 1e4  # weight of an equation that has to be met, beside others of 1
_CLOSE = 1e-14  # relative, of steps that count beside such an equation
_ITERATIONS = 10  # a bound, for each unknown
_OVER = 1e-6  # of a limit: what a correction that keeps it was rounded by
_LISTED = 200_000  # choices of weights that are listed at once
_MANY = 32  # weights, whose choices are not listed any more
_AT_ONCE = 4096  # of the choices found, looked at together
_EFFORT = 60_000  # of the search that follows where choices are too many to be listed: about a second
_NEIGHBOURS = 8  # pairs of weights tried for what others leave, the nearest first


@dataclass(frozen=True)
class Piece:
    """A mass (kg) at an angle (rad); of a kit, how many of which weight."""

    angle: float
    mass: float
    item: str | None = None
    pieces: int = 1

    @property
    def vector(self) -> complex:
        """The mass times its direction, kg."""
        return cmath.rect(self.mass, self.angle)


def split_among(
    vector: complex,
    angles: Sequence[float] | None,
    *,
    most: float = math.inf,
    most_in_all: float = math.inf,
    step: float = 0.0,
    kit: Sequence[KitWeight] = (),
    most_pieces: int = 1,
    enough: float = 0.0,
) -> tuple[Piece, ...]:
    """Return masses that come as near to a vector as they can, none where nothing is nearer.

    Anywhere, it is one mass. Among positions it is two beside each other where those are enough, else the least squares
    over all positions. Of a kit, it is the fewest weights that leave no more than is `enough`, and of as many those
    that leave least; where none do, or too many choices would have to be listed, the smallest residual and of those
    choices the fewest weights (`choose_weights`).

    Parameters
    ----------
    vector : kg, the mass to mount in its direction
    angles : (n,) rad, the positions; None for anywhere
    most : kg at one position
    most_in_all : kg of all of them together; steps and weights round it up no further
    step : kg, to which masses are rounded; 0 for no rounding
    kit : the weights at hand, in place of a step
    most_pieces : weights of the kit at one position
    enough : kg, what weights of a kit may leave of the vector; nothing is gained by more weights that leave less

    >>> pieces = split_among(cmath.rect(1.0, 0.3), [0.0, math.pi / 6])
    >>> [(round(math.degrees(piece.angle)), round(piece.mass, 3)) for piece in pieces]
    [(0, 0.443), (30, 0.591)]
    """
    places = None if angles is None else [angle % (2.0 * math.pi) for angle in angles]
    limit = most_in_all * (1 + _OVER)
    if places is not None and kit:
        return _of_kit(vector, places, kit, most_pieces, limit, enough)
    exact: tuple[Piece, ...]
    if places is None:
        exact, most = (Piece(angle_of(vector), min(abs(vector), most_in_all)),), math.inf
    else:
        exact = _beside(vector, places, most) or _least_squares(vector, places, most)
        if _mass(exact) > limit:
            exact = _least_squares(vector, places, most, most_in_all)
    return _rounded(vector, exact, step, most, limit)


def least_together(
    target: Complex, matrix: Complex, angles: Sequence[Sequence[float] | None], most: Float, in_all: Float
) -> Complex:
    """Return the vectors (n,) of masses, in all planes at once, that make |target + matrix · vectors|² least.

    It is the least squares over the masses of all positions, and of a plane without any over directions 15° apart; that
    masses and what is left of a limit come to that limit is an equation of great weight.

    Parameters
    ----------
    target : (m,) not zero
    matrix : (m, n) per kg, no column of it zero
    angles : rad, the positions of each plane; None for anywhere
    most : (n,) kg at one position; infinite for no limit, as
    in_all : (n,) kg of all masses of a plane together
    """
    size, planes = float(np.linalg.norm(target)), len(angles)
    units = np.minimum(in_all, size / np.linalg.norm(matrix, axis=0))
    places = [np.arange(0.0, 2.0 * np.pi, _ANYWHERE) if each is None else np.asarray(each, float) for each in angles]
    owner = np.repeat(np.arange(planes), [len(each) for each in places])
    directions = np.exp(1j * np.concatenate(places))
    effects = (matrix * units / size)[:, owner] * directions
    limits = _FIRM * (np.arange(planes)[:, None] == owner)[np.isfinite(in_all)]
    rest = _FIRM * np.eye(planes)[np.isfinite(in_all)][:, np.isfinite(in_all)]
    rows = np.block(
        [
            [effects.real, np.zeros((len(target), len(rest)))],
            [effects.imag, np.zeros((len(target), len(rest)))],
            [limits, rest],
        ]
    )
    wanted = np.concatenate([-target.real, -target.imag, _FIRM * size * (in_all / units)[np.isfinite(in_all)]]) / size
    largest = np.concatenate([(most / units)[owner], np.full(len(rest), np.inf)])
    masses = _within(rows, wanted, largest)[: len(owner)]
    parts = masses * directions
    vectors: Complex = units * np.array([parts[owner == k].sum() for k in range(planes)])
    return vectors


def _mass(pieces: Sequence[Piece]) -> float:
    return math.fsum(piece.mass for piece in pieces)


def _beside(vector: complex, places: Sequence[float], most: float) -> tuple[Piece, ...]:
    """Return masses at the positions on both sides of a vector, if they can be that large there."""
    size, angle = cmath.polar(vector)
    ahead = min(places, key=lambda place: (place - angle) % (2.0 * math.pi))
    behind = min(places, key=lambda place: (angle - place) % (2.0 * math.pi))
    gap = (ahead - behind) % (2.0 * math.pi)
    pieces: tuple[Piece, ...]
    if not 0 < gap < math.pi:
        pieces = (Piece(ahead, size),) if gap == 0 and abs(cmath.rect(size, ahead) - vector) <= _NOTHING * size else ()
    else:
        first = size * math.sin(ahead - angle) / math.sin(gap)
        second = size * math.sin(angle - behind) / math.sin(gap)
        pieces = (Piece(behind, first), Piece(ahead, second))
    pieces = tuple(piece for piece in pieces if piece.mass > _NOTHING * size)
    return pieces if all(piece.mass <= most for piece in pieces) else ()


def _least_squares(
    vector: complex, places: Sequence[float], most: float, in_all: float | None = None
) -> tuple[Piece, ...]:
    """Return the masses that leave least, those of all together where that is said: as an equation of great weight."""
    size = abs(vector) if in_all is None else in_all
    if not size:
        return ()
    matrix = np.array([np.cos(places), np.sin(places)])
    target = np.array([vector.real, vector.imag]) / size
    if in_all is not None:
        firm = _FIRM * max(1.0, abs(vector) / in_all)
        matrix = np.vstack([matrix, np.full(len(places), firm)])
        target = np.append(target, firm)
    limit = most / size
    masses = _within(matrix, target, np.full(len(places), limit))
    return tuple(
        Piece(angle, size * mass) for angle, mass in zip(places, masses.tolist(), strict=True) if mass > _NOTHING
    )


def _within(matrix: Float, target: Float, most: Float) -> Float:
    """Return the least squares from 0 to the most; equations of great weight outweigh what is left of the others."""
    from scipy.optimize import lsq_linear

    found = lsq_linear(matrix, target, (0.0, most), method="bvls", tol=_CLOSE, max_iter=_ITERATIONS * len(most))
    solution: Float = found.x
    return solution


def _rounded(vector: complex, pieces: tuple[Piece, ...], step: float, most: float, limit: float) -> tuple[Piece, ...]:
    """Round the masses up or down, one after the other, so that they stay nearest and all together within a limit."""
    ways: list[tuple[Piece, ...]] = [()]
    for piece in pieces:
        choices = [Piece(piece.angle, mass) for mass in _steps(piece.mass, step) if mass <= most * (1 + _OVER)]
        ways = [(*way, choice) for way, choice in product(ways, choices)]
        others = pieces[len(ways[0]) :]
        least = math.fsum(_steps(k.mass, step)[0] for k in others)
        ways = [way for way in ways if _mass(way) + least <= limit]
        rest = sum(k.vector for k in others)
        ways.sort(key=lambda way: abs(sum((k.vector for k in way), rest) - vector))
        del ways[_FOLLOWED:]
    return tuple(piece for piece in ways[0] if piece.mass > 0)


def _steps(mass: float, step: float) -> tuple[float, ...]:
    if not step:
        return (mass,)
    below = math.floor(mass / step)
    return tuple(float(f"{k * step:.15g}") for k in (below, below + 1))


def _of_kit(
    vector: complex, places: Sequence[float], kit: Sequence[KitWeight], most: int, limit: float, enough: float
) -> tuple[Piece, ...]:
    slots = [(angle, weight) for angle in places for weight in kit if weight.mass <= limit]
    if not slots:
        return ()
    effects = [cmath.rect(weight.mass, angle) for angle, weight in slots]
    groups: list[tuple[list[int], int]] = [
        ([k for k, slot in enumerate(slots) if slot[0] == angle], most) for angle in places
    ]
    groups += [
        ([k for k, slot in enumerate(slots) if slot[1] is weight], weight.stock)
        for weight in kit
        if weight.stock is not None
    ]
    counts = _fewest(vector, np.array(effects), groups, limit, enough) if enough > 0 else None
    if counts is None:
        most_of = [int(min(most, weight.most)) for _, weight in slots]
        counts = _smallest(vector, np.array(effects), most_of, groups, limit)
    counts = _without_idle(vector, np.array(effects), counts)
    return tuple(
        Piece(angle, count * weight.mass, weight.name, count)
        for (angle, weight), count in zip(slots, counts.tolist(), strict=True)
        if count
    )


def _smallest(
    vector: complex, effects: Complex, most: Sequence[int], groups: Sequence[tuple[Sequence[int], int]], limit: float
) -> Int:
    """Return how many weights of each effect leave least, of those the fewest, with all their masses within a limit.

    Where too many choices have to be looked at for that, what is found leaves little, but maybe not least.
    """
    heaviest = float(np.abs(effects).max())

    def chosen(*more: tuple[Sequence[int], int]) -> Int:
        return choose_weights(
            [effects],
            [-vector],
            [heaviest],
            most,
            [*groups, *more],
            aim="smallest",
            largest=[limit],
            effort=Effort(_EFFORT) if math.isfinite(limit) else None,
        ).counts

    if not math.isfinite(limit):
        return chosen()
    members, caps = _caps(effects, groups, limit)
    near = _one_by_one(vector, effects, members, caps)
    if (nearest := _nearest(vector, effects, members, caps, near)) is not None:
        return nearest
    others = chosen()
    if others @ members[:, -1] > limit:
        # So many of the heaviest are within the limit, whatever they leave.
        others = chosen((range(len(effects)), int(limit / heaviest)))
    return _better(vector, effects, near, others)


def _fewest(
    vector: complex, effects: Complex, groups: Sequence[tuple[Sequence[int], int]], limit: float, enough: float
) -> Int | None:
    """Return how many weights of each effect are the fewest that leave no more than is enough, and leave least.

    Choices of one, two, three … weights are listed, but for the last two, which are looked up among all pairs. None
    where they are too many to be listed before some are enough.
    """
    from scipy.spatial import KDTree

    members, caps = _caps(effects, groups, limit)
    heaviest = float(np.abs(effects).max())
    for number in range(max(0, math.ceil((abs(vector) - enough) / heaviest)), _MANY):
        last = min(number, 2)
        near = [(number - k) * heaviest + enough for k in range(1, number - last + 1)]
        firsts = _listed(vector, effects, members, caps, near)
        lasts = _listed(0j, effects, members, caps, [math.inf] * last)
        if firsts is None or lasts is None:
            return None
        if not len(firsts) or not len(lasts):
            continue
        missing, ends = vector - effects[firsts].sum(axis=1), effects[lasts].sum(axis=1)
        left, which = KDTree(np.column_stack([ends.real, ends.imag])).query(
            np.column_stack([missing.real, missing.imag]), k=list(range(1, min(_NEIGHBOURS, len(ends)) + 1))
        )
        order = np.argsort(left, axis=None)
        for some in np.array_split(order, -(-order.size // _AT_ONCE)):
            row, column = np.unravel_index(some, left.shape)
            chosen = np.column_stack([firsts[row], lasts[which[row, column]]])
            allowed = (members[chosen].sum(axis=1) <= caps).all(axis=1)
            allowed &= left[row, column] <= enough
            if allowed.any():
                return np.bincount(chosen[np.argmax(allowed)], minlength=len(effects))
            if left[row[-1], column[-1]] > enough:
                break
    return None


def _caps(effects: Complex, groups: Sequence[tuple[Sequence[int], int]], limit: float) -> tuple[Float, Float]:
    """Return what a weight of each effect counts in each group, and last its mass (n, g + 1), and the most of each."""
    members = np.zeros((len(effects), len(groups) + 1))
    for k, (places, _) in enumerate(groups):
        members[list(places), k] = 1
    members[:, -1] = np.abs(effects)
    return members, np.array([*(cap for _, cap in groups), limit])


def _listed(vector: complex, effects: Complex, members: Float, caps: Float, near: Sequence[float]) -> Int | None:
    """Return all ascending choices (choices, n) that after each weight are so near a vector; None of too many."""
    rows, used = np.zeros((1, 0), np.int64), np.zeros((1, len(caps)))
    for reach in near:
        if len(rows) * len(effects) > _LISTED:
            return None
        rows, used = _with_one_more(rows, used, members, caps)
        kept = np.abs(vector - effects[rows].sum(axis=1)) <= reach
        rows, used = rows[kept], used[kept]
    return rows


def _one_by_one(vector: complex, effects: Complex, members: Float, caps: Float) -> Int:
    """Return how many weights of each effect come near a vector, each in turn the one that leaves least."""
    counts, left, rounding = np.zeros(len(effects), np.int64), abs(vector), _rounding_of(vector, effects)
    while True:
        off = np.abs(vector - counts @ effects - effects)
        off[(counts @ members + members > caps).any(axis=1)] = math.inf
        k = int(np.argmin(off))
        if off[k] >= left - rounding:
            return counts
        counts[k] += 1
        left = float(off[k])


def _nearest(vector: complex, effects: Complex, members: Float, caps: Float, near: Int) -> Int | None:
    """Return how many weights of each effect are the nearest to a vector, of those the fewest; None of too many.

    What mass is left of the limit brings a choice nearer by no more than that: it is given up where that does not make
    it nearer than those that are `near`.
    """
    rows, used, best = np.zeros((1, 0), np.int64), np.zeros((1, len(caps))), np.zeros(len(effects), np.int64)
    while len(rows):
        if len(rows) * len(effects) > _LISTED:
            return None
        rows, used = _with_one_more(rows, used, members, caps)
        off: Float = np.abs(vector - effects[rows].sum(axis=1))
        if len(rows):
            best = _better(vector, effects, best, np.bincount(rows[np.argmin(off)], minlength=len(effects)))
        left = min(abs(vector - counts @ effects) for counts in (best, near)) + _rounding_of(vector, effects)
        kept = off - (caps[-1] - used[:, -1]) < left
        rows, used = rows[kept], used[kept]
    return _better(vector, effects, best, near)


def _without_idle(vector: complex, effects: Complex, counts: Int) -> Int:
    """Return a choice without the weights that can be left out together without leaving more, as opposed ones.

    Of choices of many weights, those of as few of them are tried as can be listed.
    """
    some = np.flatnonzero(counts)
    rows, used = np.zeros((1, 0), np.int64), np.zeros((1, len(some)))
    members, left = np.eye(len(some)), abs(vector - counts @ effects) + _rounding_of(vector, effects)
    best, listed = counts, 0
    while len(rows) and listed + (rows.shape[1] + 1) * len(rows) * len(some) <= _LISTED:
        rows, used = _with_one_more(rows, used, members, counts[some].astype(float))
        listed += rows.size
        off = np.abs(vector - counts @ effects + effects[some][rows].sum(axis=1))
        if len(rows) and off.min() <= left:
            best = counts - np.bincount(some[rows[np.argmin(off)]], minlength=len(counts))
    return counts if best is counts else _without_idle(vector, effects, best)


def _better(vector: complex, effects: Complex, one: Int, other: Int) -> Int:
    """Return the choice that leaves less of a vector; where that is a matter of rounding, the one of fewer weights."""
    less = abs(vector - one @ effects) - abs(vector - other @ effects)
    if abs(less) <= _rounding_of(vector, effects):
        return min(one, other, key=lambda counts: int(counts.sum()))
    return other if less > 0 else one


def _rounding_of(vector: complex, effects: Complex) -> float:
    """Return what differences of what choices leave are rounding."""
    return _NOTHING * max(abs(vector), float(np.abs(effects).max()))


def _with_one_more(rows: Int, used: Float, members: Float, caps: Float) -> tuple[Int, Float]:
    """Return ascending choices (choices, n) with each weight more that keeps the order and the caps, and what it uses.

    Parameters
    ----------
    used : (choices, g + 1) of the caps
    """
    row, slot = (k.ravel() for k in np.indices((len(rows), len(members))))
    if rows.shape[1]:
        ascending = rows[row, -1] <= slot
        row, slot = row[ascending], slot[ascending]
    within = (used[row] + members[slot] <= caps).all(axis=1)
    row, slot = row[within], slot[within]
    return np.column_stack([rows[row], slot]), used[row] + members[slot]
