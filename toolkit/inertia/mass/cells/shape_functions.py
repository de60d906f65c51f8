"""Shape functions and their slopes at Gauss points, correct to the last bit.

Points, weights and polynomials are evaluated with 60 decimal digits, and each entry of a table is rounded to
float64 once: in an error bound it counts as one rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float
from inertia.mass.double_words import Pair
from inertia.mesh.geometry.cell_shapes import KINDS, Kind, Point, Powers, coefficients
from inertia.records import dataclass

_DIGITS = 60
_HALF, _ONE = Decimal("0.5"), Decimal(1)


@dataclass(frozen=True, eq=False)
class Table:
    """What the quadrature over one kind of cell of d dimensions and n nodes needs.

    `weights` (q,) and `values` (q, n) belong to the quadrature points. `slopes` (d, r, n) are ∂N/∂ξ at those
    points and, after them, at the corners; where they are the same everywhere, r is 1. `reach` and `steep`
    (d,) are the largest Σ|Nᵢ| and Σ|∂Nᵢ/∂ξ|.
    """

    weights: Float
    values: Float
    slopes: Float
    reach: float
    steep: Float


@lru_cache(maxsize=64)
def table(name: str, points: tuple[int, ...] | None = None) -> Table:
    """Make the table of a kind, with its own number of Gauss points unless another is given."""
    weights, values, slopes = (array.astype(np.float64) for array in _entries(name, points))
    if (slopes == slopes[:, :1]).all():
        slopes = slopes[:, :1].copy()
    return Table(
        weights,
        values,
        slopes,
        float(np.abs(values).sum(axis=1).max()),
        np.abs(slopes).sum(axis=2).max(axis=1),
    )


@lru_cache(maxsize=64)
def double_table(name: str) -> tuple[Pair, Pair, Pair]:
    """Return the weights, values and slopes of `table` as double-doubles, each entry off by a part in 2¹⁰⁶."""
    pairs = []
    with localcontext(prec=_DIGITS):
        for array in _entries(name, None):
            high = array.astype(np.float64)
            rest = [x - Decimal(y) for x, y in zip(array.ravel().tolist(), high.ravel().tolist(), strict=True)]
            pairs.append(Pair(high, np.array([float(x) for x in rest]).reshape(high.shape)))
    weights, values, slopes = pairs
    return weights, values, slopes[:, : table(name).slopes.shape[1]]


@lru_cache(maxsize=64)
def _entries(name: str, points: tuple[int, ...] | None) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Return the weights, values and slopes as decimals."""
    kind = KINDS[name]
    with localcontext(prec=_DIGITS):
        places, weights = _rule(kind, kind.points if points is None else points)
        shapes = _decimals(coefficients(kind.name))
        corners = [[_decimal(x) for x in place] for place in _corner_places(kind)]
        values = _monomials(places, kind.space) @ shapes
        slopes = [_slopes(kind, axis, places + corners) @ shapes for axis in range(len(kind.nodes[0]))]
        return np.array(weights, dtype=object), values, np.stack(slopes)


def gauss(count: int, power: int) -> tuple[list[Decimal], list[Decimal]]:
    """Return points and weights of the Gauss–Jacobi rule for ∫₀¹ tᵃ f(t) dt, a = `power`, in the current
    precision.

    The points are the zeros of Σ (−1)ᵏ C(n, k) (n + a + 1)ₖ / (a + 1)ₖ tᵏ, by Newton's method; the weights
    are proportional to 1/(t (1 − t) P′(t)²) and add up to 1/(a + 1) (Szegő, *Orthogonal Polynomials*, 4.21
    and 15.3).
    """
    coefficients = [_ONE]
    for k in range(count):
        ratio = -_decimal(Fraction((count - k) * (count + power + 1 + k), (k + 1) * (power + 1 + k)))
        coefficients.append(coefficients[-1] * ratio)
    slope = [k * c for k, c in enumerate(coefficients)][1:]
    points = []
    for i in range(1, count + 1):
        t = _HALF + _HALF * Decimal(math.cos(math.pi * (4 * i - 1) / (4 * count + 2 * power + 2)))
        for _ in range(10):
            t -= _horner(coefficients, t) / _horner(slope, t)
        points.append(t)
    weights = [1 / (t * (1 - t) * _horner(slope, t) ** 2) for t in points]
    whole = sum(weights) * (power + 1)
    return points, [w / whole for w in weights]


def _horner(coefficients: Sequence[Decimal], t: Decimal) -> Decimal:
    value = Decimal(0)
    for c in reversed(coefficients):
        value = value * t + c
    return value


def _rule(kind: Kind, counts: tuple[int, ...]) -> tuple[list[list[Decimal]], list[Decimal]]:
    """Lay out the quadrature points of a reference shape, in the coordinates of its shape functions."""
    if not counts:
        corners = [[_decimal(x) for x in node] for node in kind.nodes]
        twentieth = _decimal(Fraction(1, 120))
        return [*corners, [_HALF * _HALF] * 3], [*[twentieth] * 4, 16 * twentieth]
    powers, factor = {
        ("box", 1): ((0,), 2),
        ("box", 2): ((0, 0), 4),
        ("box", 3): ((0, 0, 0), 8),
        ("simplex", 2): ((0, 1), 1),
        ("simplex", 3): ((0, 1, 2), 1),
        ("wedge", 3): ((0, 1, 0), 2),
        ("pyramid", 3): ((0, 0, 2), 4),
    }[kind.reference, len(counts)]
    rules = [zip(*gauss(n, power), strict=True) for n, power in zip(counts, powers, strict=True)]
    places, weights = [], []
    for nodes in product(*rules):
        places.append(_place(kind.reference, [t for t, _ in nodes]))
        weights.append(math.prod((w for _, w in nodes), start=Decimal(factor)))
    return places, weights


def _place(reference: str, t: list[Decimal]) -> list[Decimal]:
    """Take a point of the unit cube to the reference shape."""
    if reference == "box":
        return [2 * x - 1 for x in t]
    if reference == "pyramid":
        return [2 * t[0] - 1, 2 * t[1] - 1, t[2]]
    triangle = [t[1] * t[0], t[1] * (1 - t[0])]
    if reference == "wedge":
        return [*triangle, 2 * t[2] - 1]
    if len(t) == 2:
        return triangle
    return [t[2] * triangle[0], t[2] * triangle[1], t[2] * (1 - t[1])]


def _corner_places(kind: Kind) -> list[Point]:
    """List the corners; a pyramid's apex once for each edge that leads to it."""
    corners = list(kind.nodes[: kind.corners])
    if kind.reference == "pyramid":
        corners[4:] = [(x, y, Fraction(0)) for x, y, _ in corners[:4]]
    return corners


def _slopes(kind: Kind, axis: int, places: list[list[Decimal]]) -> NDArray[Any]:
    """Return the monomials' derivatives at the places, (place, monomial)."""
    factors, lower = kind.derivatives(axis)
    slopes: NDArray[Any] = _monomials(places, lower) * np.array(factors, dtype=object)
    return slopes


def _monomials(places: list[list[Decimal]], space: Sequence[Powers]) -> NDArray[Any]:
    rows = [
        [math.prod((x**p for x, p in zip(place, powers, strict=True) if p), start=_ONE) for powers in space]
        for place in places
    ]
    return np.array(rows, dtype=object)


def _decimals(fractions: NDArray[Any]) -> NDArray[Any]:
    return np.array([[_decimal(x) for x in row] for row in fractions.tolist()], dtype=object)


def _decimal(x: Fraction) -> Decimal:
    return Decimal(x.numerator) / Decimal(x.denominator)
