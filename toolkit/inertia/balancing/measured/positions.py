"""A correction split among the positions of a plane: its holes, bolts or blades, with what the shop can mount there."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from inertia.balancing.corrections.correction_plane import KitWeight, angle_of
from inertia.balancing.corrections.standard_weights import choose_weights
from inertia.records import dataclass

_NOTHING = 1e-9  # of the whole: masses that are none
_FOLLOWED = 64  # roundings followed up
_OVER = 1e-6  # of a limit: what a correction that keeps it was rounded by


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
) -> tuple[Piece, ...]:
    """Return masses that come as near to a vector as they can, none where nothing is nearer.

    Anywhere, it is one mass. Among positions it is two beside each other where those are enough, else the least squares
    over all positions; of a kit, the smallest residual and of those choices the fewest weights (`choose_weights`).

    Parameters
    ----------
    vector : kg, the mass to mount in its direction
    angles : (n,) rad, the positions; None for anywhere
    most : kg at one position
    most_in_all : kg, the size of the vector that they make together; steps and weights round it up no further
    step : kg, to which masses are rounded; 0 for no rounding
    kit : the weights at hand, in place of a step
    most_pieces : weights of the kit at one position

    >>> pieces = split_among(cmath.rect(1.0, 0.3), [0.0, math.pi / 6])
    >>> [(round(math.degrees(piece.angle)), round(piece.mass, 3)) for piece in pieces]
    [(0, 0.443), (30, 0.591)]
    """
    places = None if angles is None else [angle % (2.0 * math.pi) for angle in angles]
    limit = most_in_all * (1 + _OVER)
    if places is not None and kit:
        return _of_kit(vector, places, kit, most_pieces, limit)
    size = abs(vector)
    within = vector * (most_in_all / size) if size > limit else vector
    exact: tuple[Piece, ...]
    if places is None:
        exact, most = (Piece(angle_of(within), abs(within)),), math.inf
    else:
        exact = _beside(within, places, most) or _least_squares(within, places, most)
    return _rounded(vector, exact, step, most, limit)


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


def _least_squares(vector: complex, places: Sequence[float], most: float) -> tuple[Piece, ...]:
    from scipy.optimize import lsq_linear

    size = abs(vector)
    if not size:
        return ()
    matrix = np.array([np.cos(places), np.sin(places)])
    target = np.array([vector.real, vector.imag]) / size
    limit = most / size
    masses = lsq_linear(matrix, target, (0.0, limit if math.isfinite(limit) else np.inf), method="bvls").x
    return tuple(
        Piece(angle, size * mass) for angle, mass in zip(places, masses.tolist(), strict=True) if mass > _NOTHING
    )


def _rounded(vector: complex, pieces: tuple[Piece, ...], step: float, most: float, limit: float) -> tuple[Piece, ...]:
    """Round the masses up or down, one after the other, so that the whole stays nearest and its size within a limit."""
    ways: list[tuple[Piece, ...]] = [()]
    for piece in pieces:
        choices = [Piece(piece.angle, mass) for mass in _steps(piece.mass, step) if mass <= most * (1 + _OVER)]
        ways = [(*way, choice) for way, choice in product(ways, choices)]
        rest = sum(k.vector for k in pieces[len(ways[0]) :])
        ways.sort(key=lambda way: abs(sum((k.vector for k in way), rest) - vector))
        del ways[_FOLLOWED:]
    ways.append(())
    nearest = next(way for way in ways if abs(sum(piece.vector for piece in way)) <= limit)
    return tuple(piece for piece in nearest if piece.mass > 0)


def _steps(mass: float, step: float) -> tuple[float, ...]:
    if not step:
        return (mass,)
    below = math.floor(mass / step)
    return tuple(float(f"{k * step:.15g}") for k in (below, below + 1))


def _of_kit(
    vector: complex, places: Sequence[float], kit: Sequence[KitWeight], most: int, limit: float
) -> tuple[Piece, ...]:
    slots = [(angle, weight) for angle in places for weight in kit]
    groups: list[tuple[list[int], int]] = [
        ([k for k, slot in enumerate(slots) if slot[0] == angle], most) for angle in places
    ]
    groups += [
        ([k for k, slot in enumerate(slots) if slot[1] is weight], weight.stock)
        for weight in kit
        if weight.stock is not None
    ]
    choice = choose_weights(
        [[cmath.rect(weight.mass, angle) for angle, weight in slots]],
        [-vector],
        [max(weight.mass for weight in kit)],
        [min(most, weight.most) for _, weight in slots],
        groups,
        aim="smallest",
        largest=[limit],
    )
    return tuple(
        Piece(angle, count * weight.mass, weight.name, count)
        for (angle, weight), count in zip(slots, choice.counts.tolist(), strict=True)
        if count
    )
