"""Zeroth, first and second moments of a body, as exact rationals with bounds.

Everything after the sums over the mesh is done in rational arithmetic: shifting (Steiner), adding bodies, the unit,
the density. Each result is rounded to float64 once. So the only errors are those of the sums, and those have bounds.

`second` holds ∫ x xᵀ, the *positive* second moments; the sign of the tensor's products enters in `inertia_tensor`
only: I_xx = ∫(y² + z²), I_xy = −∫xy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, isqrt, sqrt

import numpy as np

from inertia.mass.kernels import BLOCK, DEPTH, LANES
from inertia.mass.sums import Sums
from inertia.mesh.part import Float

Vector = tuple[Fraction, Fraction, Fraction]
Six = tuple[Fraction, Fraction, Fraction, Fraction, Fraction, Fraction]

PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
"""The axes of the six second moments: xx, yy, zz, yz, zx, xy."""

ZERO = Fraction(0)


@dataclass(frozen=True)
class Moments:
    """Moments about `origin`, and bounds on the error of each.

    `zeroth` is a volume, an area, a length or a mass; `first` is ∫x, `second` is ∫x xᵀ (xx, yy, zz, yz, zx, xy),
    with x measured from `origin`. The bounds are absolute. Lengths are in any one unit.
    """

    origin: Vector
    zeroth: Fraction
    first: Vector
    second: Six
    zeroth_bound: Fraction = ZERO
    first_bound: Vector = (ZERO, ZERO, ZERO)
    second_bound: Six = (ZERO, ZERO, ZERO, ZERO, ZERO, ZERO)

    def scaled(self, factor: Fraction) -> Moments:
        """Return the moments of the same shape with `factor` times the density."""
        size = abs(factor)
        return Moments(
            self.origin,
            factor * self.zeroth,
            _vector(factor * k for k in self.first),
            _six(factor * k for k in self.second),
            size * self.zeroth_bound,
            _vector(size * k for k in self.first_bound),
            _six(size * k for k in self.second_bound),
        )

    def weighed(self, mass: Fraction) -> Moments:
        """Return the moments of the same shape with a total that is known exactly.

        What was uncertain in the computed total, at most ρ = B_v / (v − B_v) of it, goes over to the others.
        """
        slack = self.zeroth_bound / (self.zeroth - self.zeroth_bound)
        exact = self.scaled(mass / self.zeroth)

        def wider(bounds: Iterable[Fraction], values: Iterable[Fraction]) -> Iterator[Fraction]:
            return ((1 + slack) * b + slack * abs(k) for b, k in zip(bounds, values, strict=True))

        return replace(
            exact,
            zeroth_bound=ZERO,
            first_bound=_vector(wider(exact.first_bound, exact.first)),
            second_bound=_six(wider(exact.second_bound, exact.second)),
        )

    def in_unit(self, metres: Fraction) -> Moments:
        """Return the same moments with lengths in metres, for coordinates in a unit of `metres`; `zeroth` stays.

        The zeroth moment's own unit is the caller's: it is a volume, an area, a length or a mass.
        """
        return Moments(
            _vector(metres * k for k in self.origin),
            self.zeroth,
            _vector(metres * k for k in self.first),
            _six(metres**2 * k for k in self.second),
            self.zeroth_bound,
            _vector(metres * k for k in self.first_bound),
            _six(metres**2 * k for k in self.second_bound),
        )

    def about(self, point: Sequence[Fraction]) -> Moments:
        """Return the moments about another point (Steiner's theorem, exactly).

        With d = origin − point: ∫x → ∫x + d V and ∫x xᵀ → ∫x xᵀ + d ∫xᵀ + ∫x dᵀ + d dᵀ V.
        """
        d = [o - p for o, p in zip(self.origin, point, strict=True)]
        f, fb = self.first, self.first_bound
        v, vb = self.zeroth, self.zeroth_bound
        return Moments(
            _vector(point),
            v,
            _vector(f[i] + d[i] * v for i in range(3)),
            _six(self.second[k] + d[i] * f[j] + d[j] * f[i] + d[i] * d[j] * v for k, (i, j) in enumerate(PAIRS)),
            vb,
            _vector(fb[i] + abs(d[i]) * vb for i in range(3)),
            _six(
                self.second_bound[k] + abs(d[i]) * fb[j] + abs(d[j]) * fb[i] + abs(d[i] * d[j]) * vb
                for k, (i, j) in enumerate(PAIRS)
            ),
        )

    def __add__(self, other: Moments) -> Moments:
        """Return the moments of both bodies together, about the first one's origin."""
        moved = other.about(self.origin)
        return Moments(
            self.origin,
            self.zeroth + moved.zeroth,
            _vector(a + b for a, b in zip(self.first, moved.first, strict=True)),
            _six(a + b for a, b in zip(self.second, moved.second, strict=True)),
            self.zeroth_bound + moved.zeroth_bound,
            _vector(a + b for a, b in zip(self.first_bound, moved.first_bound, strict=True)),
            _six(a + b for a, b in zip(self.second_bound, moved.second_bound, strict=True)),
        )

    @property
    def centroid(self) -> Vector:
        """The centre of volume or mass, in file axes."""
        return _vector(o + f / self.zeroth for o, f in zip(self.origin, self.first, strict=True))

    @property
    def centroid_bound(self) -> Fraction:
        """A bound on the centroid's distance from the true one (Euclidean).

        |f̂/v̂ − f/v| ≤ (B_f + |f̂/v̂| B_v) / (|v̂| − B_v) for each axis.
        """
        least = abs(self.zeroth) - self.zeroth_bound
        if least <= 0:
            raise ZeroDivisionError
        bounds = [
            (b + abs(f / self.zeroth) * self.zeroth_bound) / least
            for f, b in zip(self.first, self.first_bound, strict=True)
        ]
        return root_above(sum((b * b for b in bounds), ZERO))

    def central(self) -> Moments:
        """Return the moments about the centroid, with bounds that hold for the *true* centroid.

        The central moments are s − f fᵀ/v. With c = f̂/v̂ and ε the bound on c, f fᵀ/v moves by at most
        |c| B_f + B_f |c|ᵀ + |c||c|ᵀ B_v + ε εᵀ |v| (expand about c; the last term is of second order).
        """
        v, vb = self.zeroth, self.zeroth_bound
        least = abs(v) - vb
        if least <= 0:
            raise ZeroDivisionError
        c = [f / v for f in self.first]
        fb = self.first_bound
        eps = [(b + abs(k) * vb) / least for k, b in zip(c, fb, strict=True)]
        return Moments(
            self.centroid,
            v,
            (ZERO, ZERO, ZERO),
            _six(self.second[k] - self.first[i] * c[j] for k, (i, j) in enumerate(PAIRS)),
            vb,
            (ZERO, ZERO, ZERO),
            _six(
                self.second_bound[k]
                + abs(c[i]) * fb[j]
                + abs(c[j]) * fb[i]
                + abs(c[i] * c[j]) * vb
                + eps[i] * eps[j] * (abs(v) + vb)
                for k, (i, j) in enumerate(PAIRS)
            ),
        )


def total(bodies: Iterable[Moments]) -> Moments:
    """Add up the moments of several bodies, about the origin of the first; at least one is needed."""
    first, *others = bodies
    for other in others:
        first = first + other
    return first


def inertia_tensor(second: Six) -> list[list[Fraction]]:
    """Return the 3×3 inertia tensor of second moments: I = tr(S) δ − S, with Ixx formed as Syy + Szz."""
    xx, yy, zz, yz, zx, xy = second
    return [[yy + zz, -xy, -zx], [-xy, zz + xx, -yz], [-zx, -yz, xx + yy]]


def inertia_bounds(bound: Six) -> list[list[Fraction]]:
    """Return bounds on the elements of the tensor's error, from the bounds on the second moments."""
    return [[_rounded_up(abs(k)) for k in row] for row in inertia_tensor(bound)]


def inertia_bound(bound: Six) -> Fraction:
    """Return a bound on the Frobenius norm of the tensor's error, from the bounds on the second moments."""
    return root_above(sum((k * k for row in inertia_bounds(bound) for k in row), ZERO))


def root_above(square: Fraction) -> Fraction:
    """Return a rational at least as large as √square, above it by at most a part in 2⁶⁰."""
    if square <= 0:
        return ZERO
    n, d = square.numerator, square.denominator
    shift = max(0, 64 - (n.bit_length() - d.bit_length()) // 2)
    scaled = (n << (2 * shift)) // d + 1
    return Fraction(isqrt(scaled) + 1, 1 << shift)


def _rounded_up(bound: Fraction) -> Fraction:
    """Return a short rational at least as large, by at most a part in 2⁶³: long ones make all that follows slow."""
    if bound <= 0:
        return ZERO
    unit = Fraction(2) ** (bound.numerator.bit_length() - bound.denominator.bit_length() - 64)
    return ceil(bound / unit) * unit


@dataclass(frozen=True)
class Roundings:
    """How many errors of `unit`, relative to the magnitudes that enter, a term of the sums passes through.

    `normal`: in d; `corner`: in s; `bracket`: in the brackets; `blocks`: where the rows of the blocks are added. To
    these come one for the product of d with s or a bracket, and those of the additions within a block.
    """

    unit: Fraction
    normal: int
    corner: int
    bracket: int
    blocks: int

    def across(self, count: int) -> int:
        """Return the most additions that the term of one of `count` triangles passes through."""
        within = min(DEPTH, -(-count // LANES)) + LANES.bit_length() - 1
        return within + min(self.blocks, (-(-count // BLOCK)).bit_length() + 1)


FLOAT64 = Roundings(Fraction(1, 2**53), normal=8, corner=3, bracket=10, blocks=5)
"""The roundings of `inertia.mass.sums`.

Eight in d (two edges and a product: 3, the difference: 1, the corner: 1, its product: 1, two additions: 2), three in
s (a corner, two additions), ten in a bracket (three for each s, their product, three additions), four additions across
blocks and one for the final sum.
"""


def moments_of(sums: Sums, *, surface: bool = False, watched: Float | None = None) -> Moments:
    """Turn the sums over triangles into moments with bounds, in the file's unit.

    For a solid, V = Σd/6, ∫x = Σd s/24, ∫x xᵀ = Σd(…)/120 (twice that on the diagonal); for a shell, with |n| for d,
    A = Σ|n|/2, ∫x = Σ|n|s/6, ∫x xᵀ = Σ|n|(…)/24. The bounds are the a-priori ones of `assembled`, or those of
    `inertia.mass.running` where they are smaller.

    Parameters
    ----------
    watched : (10,) bounds of `inertia.mass.running` for the same triangles, where they are at hand
    """
    values = tuple(map(Fraction, sums.sums[:10].tolist()))
    return assembled(values, sums, FLOAT64, surface=surface, watched=watched)


def assembled(
    value: Sequence[Fraction],
    sums: Sums,
    roundings: Roundings,
    *,
    surface: bool = False,
    watched: Float | None = None,
) -> Moments:
    """Turn ten sums in the frame of `sums` into moments; the magnitudes in their bounds are those of `sums`.

    A product of k numbers and sums each known to a relative error of u is off by at most γₖ = k u/(1 − k u) of its
    magnitude (Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., lemma 3.1). So a term d B, with a
    bracket B (or an s), is off by at most

        γ p |B|  (roundings in d)  +  γ |d| M  (those in B, M: with the magnitudes of all that enters)
        +  γ |d B|  (those of the product and of the additions),

    each with the γ of its own count. With X, Y the largest distances from the origin along two axes, P = Σp, D = Σ|d|:

    - |B| ≤ 6 X² on the diagonal and M ≤ 4 B, since B = ½ (s² + a² + b² + c²) and M ≤ 2 (a² + b² + c²);
    - E = Σ |d| B ≤ Σ d B + 6 X² (D − Σ d), the last factor being twice the sum of the |d| with d < 0;
    - off the diagonal (where brackets are taken twice) Σ |d B| ≤ 2 √(E_xx E_yy) and Σ |d| M ≤ 8 √(E_xx E_yy), by
      Cauchy's inequality;
    - Σ |d s| ≤ √(2 D E), Σ |d| M ≤ √(6 D E) in the first moments.

    What underflow can add, at most 100 smallest normal numbers a triangle (in a shell 2⁻⁵⁰⁰, as a square root is
    taken of the squares of n) times the four lengths that may multiply them, is added.
    """
    shrink = Fraction(2) ** -sums.exponent
    origin = _vector(Fraction(float(k)) for k in sums.origin)
    farthest = np.maximum(np.abs(sums.high - sums.origin), np.abs(sums.low - sums.origin))
    reach = (np.ldexp(farthest, sums.exponent) * _INFLATED).tolist()
    tiny = sums.count * (2.0**-500 if surface else 100 * 2.0**-1022) * max(1.0, *reach) ** 4
    bounds = _bounds(value, sums, roundings, reach)
    if watched is not None:
        bounds = [min(pair) for pair in zip(bounds, watched.tolist(), strict=True)]  # of a NaN, the first
    zeroth, *others = (Fraction((k + tiny) * _INFLATED) for k in bounds)
    unit = shrink ** (2 if surface else 3)
    zeroth_factor = unit / (2 if surface else 6)
    first_factor = unit * shrink / (6 if surface else 24)
    second_factor = unit * shrink**2 / (24 if surface else 120)
    twice = 2 * second_factor
    return Moments(
        origin,
        zeroth_factor * value[0],
        _vector(first_factor * k for k in value[1:4]),
        _six((*(twice * k for k in value[4:7]), *(second_factor * k for k in value[7:10]))),
        zeroth_factor * zeroth,
        _vector(first_factor * k for k in others[:3]),
        _six(second_factor * k for k in others[3:]),
    )


_INFLATED = 1.0 + 1e-9
"""More than the arithmetic of the bounds, the products of two γ and the roundings of P and D can take from them."""


def _bounds(value: Sequence[Fraction], sums: Sums, roundings: Roundings, reach: list[float]) -> list[float]:
    """Return a-priori bounds on the errors of Σd, Σd s and Σd(…), twice that on the diagonal."""
    unit = float(roundings.unit) * _INFLATED
    additions = roundings.across(sums.count) * unit
    across = additions + unit  # and the product before them
    normal, corner, bracket = (k * unit for k in (roundings.normal, roundings.corner, roundings.bracket))
    magnitude, total = float(sums.sums[10]) * _INFLATED, float(sums.sums[12]) * _INFLATED
    slack = 1e-12 * (magnitude + total)  # far more than the errors of the sums that take part here
    negative = max(total - float(value[0]) + slack, 0.0)
    weighted = [
        min(6 * x * x * total, max(float(value[4 + i]), 0.0) + 6 * x * x * negative) for i, x in enumerate(reach)
    ]
    first = [
        3 * x * normal * magnitude
        + corner * min(3 * x * total, sqrt(6 * total) * sqrt(e))
        + across * min(3 * x * total, sqrt(2 * total) * sqrt(e))
        for x, e in zip(reach, weighted, strict=True)
    ]
    second = [
        12 * x * x * normal * magnitude + 2 * (bracket * min(6 * x * x * total, 4 * e) + across * e)
        for x, e in zip(reach, weighted, strict=True)
    ]
    for i, j in PAIRS[3:]:
        largest, both = 12 * reach[i] * reach[j], sqrt(weighted[i]) * sqrt(weighted[j])
        second.append(
            largest * normal * magnitude
            + bracket * min(largest * total, 8 * both)
            + across * min(largest * total, 2 * both)
        )
    return [normal * magnitude + additions * total, *first, *second]


def _vector(values: Iterable[Fraction]) -> Vector:
    x, y, z = values
    return x, y, z


def _six(values: Iterable[Fraction]) -> Six:
    xx, yy, zz, yz, zx, xy = values
    return xx, yy, zz, yz, zx, xy


def simplex_moments(corners: Float, measures: Iterable[Fraction | float], relative: Fraction = ZERO) -> Moments:
    """Return the moments of points, segments or triangles of uniform density.

    For a k-dimensional simplex of measure m with corners v: ∫x = m/(k + 1) Σv and
    ∫x xᵀ = m/((k + 1)(k + 2)) (s sᵀ + Σ v vᵀ), s = Σv. Summed in rational arithmetic: exact for the measures given.

    Parameters
    ----------
    corners : (n, k + 1, 3), in any unit
    measures : (n,) mass, length or area of each
    relative : how far each measure may be from the true one, as a part of it; it goes into the bounds
    """
    corner_count = corners.shape[1]
    zeroth, first, second = ZERO, [ZERO] * 3, [ZERO] * 6
    zeroth_size, first_size, second_size = ZERO, [ZERO] * 3, [ZERO] * 6
    for simplex, measure in zip(corners.tolist(), measures, strict=True):
        m = Fraction(measure)
        points = [[Fraction(x) for x in point] for point in simplex]
        s = [sum(column, ZERO) for column in zip(*points, strict=True)]
        zeroth += m
        zeroth_size += abs(m)
        for i in range(3):
            term = m * s[i] / corner_count
            first[i] += term
            first_size[i] += abs(term)
        for k, (i, j) in enumerate(PAIRS):
            squares = s[i] * s[j] + sum((p[i] * p[j] for p in points), ZERO)
            term = m * squares / (corner_count * (corner_count + 1))
            second[k] += term
            second_size[k] += abs(term)
    return Moments(
        (ZERO, ZERO, ZERO),
        zeroth,
        _vector(first),
        _six(second),
        relative * zeroth_size,
        _vector(relative * k for k in first_size),
        _six(relative * k for k in second_size),
    )
