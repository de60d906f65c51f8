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
from math import ceil, isqrt

from inertia.arrays import Float

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
            vector(factor * k for k in self.first),
            six(factor * k for k in self.second),
            size * self.zeroth_bound,
            vector(size * k for k in self.first_bound),
            six(size * k for k in self.second_bound),
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
            first_bound=vector(wider(exact.first_bound, exact.first)),
            second_bound=six(wider(exact.second_bound, exact.second)),
        )

    def in_unit(self, metres: Fraction) -> Moments:
        """Return the same moments with lengths in metres, for coordinates in a unit of `metres`; `zeroth` stays.

        The zeroth moment's own unit is the caller's: it is a volume, an area, a length or a mass.
        """
        return Moments(
            vector(metres * k for k in self.origin),
            self.zeroth,
            vector(metres * k for k in self.first),
            six(metres**2 * k for k in self.second),
            self.zeroth_bound,
            vector(metres * k for k in self.first_bound),
            six(metres**2 * k for k in self.second_bound),
        )

    def about(self, point: Sequence[Fraction]) -> Moments:
        """Return the moments about another point (Steiner's theorem, exactly).

        With d = origin − point: ∫x → ∫x + d V and ∫x xᵀ → ∫x xᵀ + d ∫xᵀ + ∫x dᵀ + d dᵀ V.
        """
        d = [o - p for o, p in zip(self.origin, point, strict=True)]
        f, fb = self.first, self.first_bound
        v, vb = self.zeroth, self.zeroth_bound
        return Moments(
            vector(point),
            v,
            vector(f[i] + d[i] * v for i in range(3)),
            six(self.second[k] + d[i] * f[j] + d[j] * f[i] + d[i] * d[j] * v for k, (i, j) in enumerate(PAIRS)),
            vb,
            vector(fb[i] + abs(d[i]) * vb for i in range(3)),
            six(
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
            vector(a + b for a, b in zip(self.first, moved.first, strict=True)),
            six(a + b for a, b in zip(self.second, moved.second, strict=True)),
            self.zeroth_bound + moved.zeroth_bound,
            vector(a + b for a, b in zip(self.first_bound, moved.first_bound, strict=True)),
            six(a + b for a, b in zip(self.second_bound, moved.second_bound, strict=True)),
        )

    @property
    def centroid(self) -> Vector:
        """The centre of volume or mass, in file axes."""
        return vector(o + f / self.zeroth for o, f in zip(self.origin, self.first, strict=True))

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
            six(self.second[k] - self.first[i] * c[j] for k, (i, j) in enumerate(PAIRS)),
            vb,
            (ZERO, ZERO, ZERO),
            six(
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


def vector(values: Iterable[Fraction]) -> Vector:
    """Return three values as a tuple."""
    x, y, z = values
    return x, y, z


def six(values: Iterable[Fraction]) -> Six:
    """Return six values as a tuple."""
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
        vector(first),
        six(second),
        relative * zeroth_size,
        vector(relative * k for k in first_size),
        six(relative * k for k in second_size),
    )
