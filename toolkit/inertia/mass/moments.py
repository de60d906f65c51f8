"""Zeroth, first and second moments of a body, as exact rationals with bounds.

Everything after the sums over the mesh is done in rational arithmetic: shifting (Steiner), adding bodies, the unit,
the density. Each result is rounded to float64 once. So the only errors are those of the sums, and those have bounds.

`second` holds ∫ x xᵀ, the *positive* second moments; the sign of the tensor's products enters in `inertia_tensor`
only: I_xx = ∫(y² + z²), I_xy = −∫xy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field, replace
from fractions import Fraction
from functools import cached_property
from math import gcd, isqrt, lcm
from typing import TYPE_CHECKING, Any

from inertia.arrays import Float
from inertia.records import dataclass

Over = tuple[list[int], int]
"""Numerators, and the positive denominator that they have in common, which may share factors with all of them."""

Vector = tuple[Fraction, Fraction, Fraction]
Six = tuple[Fraction, Fraction, Fraction, Fraction, Fraction, Fraction]

PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
"""The axes of the six second moments: xx, yy, zz, yz, zx, xy."""

ZERO = Fraction(0)

_LONGEST, _CUT = 1024, 512
"""Bits of the numerators and denominators above which moments are cut, and bits of the largest that are left."""


@dataclass(frozen=True)
class Moments:
    """Moments about `origin`, and bounds on the error of each.

    `zeroth` is a volume, an area, a length or a mass; `first` is ∫x, `second` is ∫x xᵀ (xx, yy, zz, yz, zx, xy),
    with x measured from `origin`. The bounds are absolute. Lengths are in any one unit.

    `norms` are bounds on the Euclidean norm of the error of `first`, and on the Frobenius norm of that of the inertia
    tensor of `second`, where less is known of them than the bounds of the elements say: turning keeps the norms, and
    makes the elements' bounds up to three times as large.
    """

    origin: Vector
    zeroth: Fraction
    first: Vector
    second: Six
    zeroth_bound: Fraction = field(default_factory=lambda: ZERO)
    first_bound: Vector = field(default_factory=lambda: (ZERO, ZERO, ZERO))
    second_bound: Six = field(default_factory=lambda: (ZERO, ZERO, ZERO, ZERO, ZERO, ZERO))
    norms: tuple[Fraction, Fraction] | None = None

    @classmethod
    def over(cls, norms: tuple[Fraction, Fraction] | None = None, **numbers: Over) -> Moments:
        """Return moments whose numbers have common denominators; each is reduced where it is read for the first time.

        To reduce a number takes longer than to work out with integers what is read of it in the end.
        """
        moments = object.__new__(cls)
        moments.__dict__.update(norms=norms, numbers=numbers)
        return moments

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Reduce a number of `over` where it is read for the first time."""
            if name not in _FIELDS or "numbers" not in self.__dict__:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            numerators, d = self.numbers[name]
            values = tuple(Fraction(n, d) for n in numerators)
            self.__dict__[name] = value = values[0] if name.startswith("zeroth") else values
            return value

    @cached_property
    def numbers(self) -> dict[str, Over]:
        """Each field but `norms`, as integers over a common denominator."""
        values = self.__dict__
        return {name: over((values[name],) if name.startswith("zeroth") else values[name]) for name in _FIELDS}

    @cached_property
    def error_norms(self) -> tuple[Fraction, Fraction]:
        """Bounds on the norms of the errors of `first` and of the inertia tensor; see `norms`."""
        tensor = norm_above(k for row in self.tensor_bounds for k in row)
        return self.first_norm, tensor if self.norms is None else min(self.norms[1], tensor)

    @cached_property
    def first_norm(self) -> Fraction:
        """Bound on the norm of the error of `first`; see `norms`."""
        elements = norm_above_of(*self.numbers["first_bound"])
        return elements if self.norms is None else min(self.norms[0], elements)

    @cached_property
    def tensor(self) -> list[list[Fraction]]:
        """The inertia tensor of `second`."""
        (xx, yy, zz, yz, zx, xy), d = self.numbers["second"]
        a, b, c, e, f, g = (Fraction(k, d) for k in (yy + zz, zz + xx, xx + yy, -yz, -zx, -xy))
        return [[a, g, f], [g, b, e], [f, e, c]]

    @cached_property
    def tensor_bounds(self) -> list[list[Fraction]]:
        """Bounds on the elements of the error of the inertia tensor of `second`."""
        return _inertia_bounds_of(*self.numbers["second_bound"])

    def scaled(self, factor: Fraction) -> Moments:
        """Return the moments of the same shape with `factor` times the density."""
        size = abs(factor)
        return Moments.over(
            self.norms and (size * self.norms[0], size * self.norms[1]),
            origin=self.numbers["origin"],
            **{name: times(self.numbers[name], factor) for name in ("zeroth", "first", "second")},
            **{name: times(self.numbers[name], size) for name in ("zeroth_bound", "first_bound", "second_bound")},
        )

    def weighed(self, mass: Fraction) -> Moments:
        """Return the moments of the same shape with a total that is known exactly.

        What was uncertain in the computed total, at most ρ = B_v / (v − B_v) of it, goes over to the others.
        """
        slack = self.zeroth_bound / (self.zeroth - self.zeroth_bound)
        exact = self.scaled(mass / self.zeroth)

        def wider(bounds: Iterable[Fraction], values: Iterable[Fraction]) -> Iterator[Fraction]:
            return ((1 + slack) * b + slack * abs(k) for b, k in zip(bounds, values, strict=True))

        norms = None
        if exact.norms is not None:
            first, tensor = wider(exact.norms, (norm_above(exact.first), inertia_bound(exact.second)))
            norms = first, tensor
        return replace(
            exact,
            zeroth_bound=ZERO,
            first_bound=vector(wider(exact.first_bound, exact.first)),
            second_bound=six(wider(exact.second_bound, exact.second)),
            norms=norms,
        )

    def in_unit(self, metres: Fraction) -> Moments:
        """Return the same moments with lengths in metres, for coordinates in a unit of `metres`; `zeroth` stays.

        The zeroth moment's own unit is the caller's: it is a volume, an area, a length or a mass.
        """
        if metres == 1:
            return self
        square = metres**2
        powers = {"origin": metres, "first": metres, "second": square, "first_bound": metres, "second_bound": square}
        return Moments.over(
            self.norms and (metres * self.norms[0], square * self.norms[1]),
            zeroth=self.numbers["zeroth"],
            zeroth_bound=self.numbers["zeroth_bound"],
            **{name: times(self.numbers[name], power) for name, power in powers.items()},
        )

    def about(self, point: Sequence[Fraction]) -> Moments:
        """Return the moments about another point (Steiner's theorem, exactly).

        With d = origin − point: ∫x → ∫x + d V and ∫x xᵀ → ∫x xᵀ + d ∫xᵀ + ∫x dᵀ + d dᵀ V.
        """
        here, own = over(tuple(point)), self.numbers
        lever, d = _plus(own["origin"], ([-k for k in here[0]], here[1]))
        arm = [abs(k) for k in lever], d
        norms = None
        if self.norms is not None:
            far, (off, tensor), vb = norm_above_of(lever, d), self.error_norms, self.zeroth_bound
            norms = off + far * vb, tensor + 3 * far * off + Fraction(3, 2) * far**2 * vb
        first, second = _shifted((lever, d), own["zeroth"], own["first"], own["second"])
        first_bound, second_bound = _shifted(arm, own["zeroth_bound"], own["first_bound"], own["second_bound"])
        return Moments.over(
            norms,
            origin=here,
            zeroth=own["zeroth"],
            first=first,
            second=second,
            zeroth_bound=own["zeroth_bound"],
            first_bound=first_bound,
            second_bound=second_bound,
        )

    def stretched(self, rows: Sequence[Sequence[Fraction]]) -> Moments:
        """Return the moments of volume of a body whose points x are moved to A x.

        With |det A| = d they are d V, d A ∫x and d A ∫x xᵀ Aᵀ.

        Parameters
        ----------
        rows : of A (3, 3), not singular
        """
        (a, b, c), (d, e, f), (g, h, i) = rows
        size = abs(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g))
        largest = [[abs(k) for k in row] for row in rows]
        return Moments(
            vector(dot(row, self.origin) for row in rows),
            size * self.zeroth,
            vector(size * dot(row, self.first) for row in rows),
            six(size * k for k in _congruent(rows, self.second)),
            size * self.zeroth_bound,
            vector(size * dot(row, self.first_bound) for row in largest),
            six(size * k for k in _congruent(largest, self.second_bound)),
        )

    def turned(self, axes: Sequence[Sequence[Fraction]], origin: Sequence[Fraction]) -> Moments:
        """Return the moments in another frame: x′ = Rᵀ (x − o), the columns of R (3, 3) being the new axes.

        A rotation in float64 is off orthonormal by E = Rᵀ R − δ. So that it does not matter what is made of that, the
        bounds hold for R as it is given, for Rᵀ J R of the inertia tensor J, and for the rotation Q nearest to R, which
        is within ‖E‖ of it: with T the trace of ∫x xᵀ, the tensors of the three differ by less than 3 ‖E‖ T, and the
        elements of ∫x xᵀ by less than 5/2 ‖E‖ T.
        """
        columns = list(zip(*axes, strict=True))
        skew = norm_above(dot(a, b) - (i == j) for i, a in enumerate(columns) for j, b in enumerate(columns))
        away = [k - o for k, o in zip(self.origin, origin, strict=True)]
        largest = [[abs(k) for k in column] for column in columns]
        first, tensor = ((1 + 2 * skew) * k for k in self.error_norms)
        along = vector(min(dot(column, self.first_bound), first) for column in largest)
        across = _congruent(largest, self.second_bound)
        trace = sum(self.second[:3], ZERO) + sum(self.second_bound[:3], ZERO)
        shift, weight = skew * norm_above(away), abs(self.zeroth) + self.zeroth_bound
        lever = (1 + skew) * norm_above(self.first) + first
        off = skew * lever + weight * shift
        displaced = 2 * shift * lever + weight * shift**2
        return Moments(
            vector(dot(column, away) for column in columns),
            self.zeroth,
            vector(dot(column, self.first) for column in columns),
            _congruent(columns, self.second),
            self.zeroth_bound,
            vector(k + off for k in along),
            six(min(k, tensor) + Fraction(5, 2) * skew * trace + displaced for k in across),
            (first + off, tensor + 3 * skew * trace + 2 * displaced),
        )

    def shortened(self) -> Moments:
        """Return the same moments in rationals of a thousand bits; what longer ones lose goes over to the bounds.

        Every verb makes the rationals longer, and long ones make all that follows slow.
        """
        exact = [self.numbers[name] for name in ("origin", "zeroth", "first", "second")]
        if all(k.bit_length() <= _LONGEST for numerators, d in exact for k in (*numerators, d)):
            return self  # without being reduced
        numbers = (*self.origin, self.zeroth, *self.first, *self.second)
        if all(max(k.numerator.bit_length(), k.denominator.bit_length()) <= _LONGEST for k in numbers):
            return self
        here = self.about([nearby(k) for k in self.origin])
        zeroth, first, second = (_cut(values) for values in ([here.zeroth], here.first, here.second))
        bounds = [
            [_short(bound + abs(a - b)) for bound, a, b in zip(*each, strict=True)]
            for each in (
                ([here.zeroth_bound], zeroth, [here.zeroth]),
                (here.first_bound, first, here.first),
                (here.second_bound, second, here.second),
            )
        ]
        norms = None
        if here.norms is not None:
            lost = [
                [a - b for a, b in zip(*each, strict=True)] for each in ((first, here.first), (second, here.second))
            ]
            norms = (
                _short(here.norms[0] + norm_above(lost[0])),
                _short(here.norms[1] + inertia_bound(six(lost[1]))),
            )
        return Moments(
            here.origin, zeroth[0], vector(first), six(second), bounds[0][0], vector(bounds[1]), six(bounds[2]), norms
        )

    def __add__(self, other: Moments) -> Moments:
        """Return the moments of both bodies together, about the first one's origin."""
        moved = other.about(self.origin)
        norms = None
        if self.norms is not None or moved.norms is not None:
            (a, b), (c, d) = self.error_norms, moved.error_norms
            norms = a + c, b + d
        sums = {name: _plus(self.numbers[name], moved.numbers[name]) for name in _FIELDS if name != "origin"}
        return Moments.over(norms, origin=self.numbers["origin"], **sums)

    @property
    def centroid(self) -> Vector:
        """The centre of volume or mass, in file axes."""
        numerators, d = self._centroid
        return vector(Fraction(n, d) for n in numerators)

    @cached_property
    def _centroid(self) -> Over:
        (origin, d), ((v,), e), (first, f) = (self.numbers[name] for name in ("origin", "zeroth", "first"))
        sign = (v > 0) - (v < 0)
        if not sign:
            raise ZeroDivisionError
        own, others = f * abs(v), sign * d * e
        return [o * own + k * others for o, k in zip(origin, first, strict=True)], d * own

    @cached_property
    def centroid_bound(self) -> Fraction:
        """A bound on the centroid's distance from the true one (Euclidean).

        |f̂/v̂ − f/v| ≤ (B_f + |f̂/v̂| B_v) / (|v̂| − B_v) for each axis, and for the norms.
        """
        (size, bound, least, d), (first, _, e) = self._weight, self._lever
        far = norm_above_of([k * d for k in first], e * size)
        return min(norm_above_of(self._off, e * size), self.first_norm + far * Fraction(bound, d)) * Fraction(d, least)

    @cached_property
    def _weight(self) -> tuple[int, int, int, int]:
        """Size and bound of `zeroth` and the first less the second, which must be positive, and their denominator."""
        ((v,), (vb,)), d = _together(self.numbers["zeroth"], self.numbers["zeroth_bound"])
        if abs(v) <= vb:
            raise ZeroDivisionError
        return abs(v), vb, abs(v) - vb, d

    @cached_property
    def _lever(self) -> tuple[list[int], list[int], int]:
        """The elements of `first`, their bounds, and the denominator of all."""
        (first, bound), d = _together(self.numbers["first"], self.numbers["first_bound"])
        return first, bound, d

    @cached_property
    def _off(self) -> list[int]:
        """B_f + |f̂/v̂| B_v of each axis, times the size of v̂, over the denominator of `_lever`."""
        (size, vb, _, _), (first, bounds, _) = self._weight, self._lever
        return [b * size + abs(k) * vb for k, b in zip(first, bounds, strict=True)]

    def central(self) -> Moments:
        """Return the moments about the centroid, with bounds on ∫x xᵀ that hold for the *true* centroid.

        About that one ∫x is zero, and has no error. How far it may be from the centroid here is lost: what goes on to
        be added or shifted is the moments themselves.

        The central moments are s − f fᵀ/v. With c = f̂/v̂ and ε the bound on c, f fᵀ/v moves by at most
        |c| B_f + B_f |c|ᵀ + |c||c|ᵀ B_v + ε εᵀ |v| (expand about c; the last term is of second order).
        """
        return self._central

    @cached_property
    def _central(self) -> Moments:
        (size, vb, least, d), (f, fb, e) = self._weight, self._lever
        (s, g), (sb, h) = self.numbers["second"], self.numbers["second_bound"]
        norms = None
        if self.norms is not None:
            far, (first, tensor) = norm_above_of([k * d for k in f], e * size), self.error_norms
            bound = Fraction(vb, d)
            away = (first + far * bound) * Fraction(d, least)
            both = far**2 * bound + away**2 * Fraction(size + vb, d)
            norms = ZERO, tensor + 3 * far * first + Fraction(3, 2) * both
        # |c| is |f| d/(e size) and ε is off d/(e size least).
        off, square, sign = self._off, least * least, 1 if self.numbers["zeroth"][0][0] > 0 else -1
        shift = [
            (abs(f[i]) * fb[j] * size + abs(f[j]) * off[i]) * square + off[i] * off[j] * (size + vb) for i, j in PAIRS
        ]
        own, wide = e * e * size, e * e * size * size * square
        nothing = [0, 0, 0], 1
        return Moments.over(
            norms,
            origin=self._centroid,
            zeroth=self.numbers["zeroth"],
            first=nothing,
            second=([own * k - sign * d * g * f[i] * f[j] for k, (i, j) in zip(s, PAIRS, strict=True)], own * g),
            zeroth_bound=self.numbers["zeroth_bound"],
            first_bound=nothing,
            second_bound=([wide * k + d * h * moved for k, moved in zip(sb, shift, strict=True)], wide * h),
        )


_FIELDS = ("origin", "zeroth", "first", "second", "zeroth_bound", "first_bound", "second_bound")


def over(values: Sequence[Fraction]) -> Over:
    """Return rationals over their common denominator."""
    d = lcm(*(k.denominator for k in values))
    return [k.numerator * (d // k.denominator) for k in values], d


def _together(a: Over, b: Over) -> tuple[tuple[list[int], list[int]], int]:
    """Return the numerators of both over one denominator."""
    d = lcm(a[1], b[1])
    p, q = d // a[1], d // b[1]
    return ([p * k for k in a[0]], [q * k for k in b[0]]), d


def _plus(*terms: Over) -> Over:
    """Add rows of numbers, in lowest terms together."""
    d = lcm(*(own for _, own in terms))
    rows = [[d // own * k for k in numbers] for numbers, own in terms]
    sums = [sum(column) for column in zip(*rows, strict=True)]
    common = gcd(d, *sums)
    return [k // common for k in sums], d // common


def _shifted(lever: Over, zeroth: Over, first: Over, second: Over) -> tuple[Over, Over]:
    """Return first and second moments about a point from which a lever leads to where they were about."""
    (d, own), (f, g), ((v,), e) = lever, first, zeroth
    crossed = [d[i] * f[j] + d[j] * f[i] for i, j in PAIRS], own * g
    return (
        _plus(first, ([k * v for k in d], own * e)),
        _plus(second, crossed, ([d[i] * d[j] * v for i, j in PAIRS], own * own * e)),
    )


def dyadic(values: Sequence[float]) -> Over:
    """Return floats over their common denominator."""
    ratios = [k.as_integer_ratio() for k in values]
    d = max(d for _, d in ratios)  # of powers of two
    return [n * (d // own) for n, own in ratios], d


def times(numbers: Over, factor: Fraction) -> Over:
    """Return the numbers multiplied by a rational."""
    n = factor.numerator
    return [n * k for k in numbers[0]], numbers[1] * factor.denominator


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
    return _inertia_bounds_of(*over(bound))


def _inertia_bounds_of(bound: Sequence[int], d: int) -> list[list[Fraction]]:
    xx, yy, zz, yz, zx, xy = bound
    a, b, c, e, f, g = (_rounded_up(abs(k), d) for k in (yy + zz, zz + xx, xx + yy, yz, zx, xy))
    return [[a, g, f], [g, b, e], [f, e, c]]


def inertia_bound(bound: Six) -> Fraction:
    """Return a bound on the Frobenius norm of the tensor's error, from the bounds on the second moments."""
    return norm_above(k for row in inertia_bounds(bound) for k in row)


def norm_above(values: Iterable[Fraction]) -> Fraction:
    """Return a rational at least as large as the root of the sum of the squares, by at most a part in 2⁶⁰."""
    return norm_above_of(*over(tuple(values)))


def norm_above_of(numerators: Iterable[int], d: int) -> Fraction:
    """Return what `norm_above` does, of values over a common denominator."""
    return root_above(Fraction(sum(n * n for n in numerators), d * d))


def root_above(square: Fraction) -> Fraction:
    """Return a rational at least as large as √square, above it by at most a part in 2⁶⁰."""
    if square <= 0:
        return ZERO
    n, d = square.numerator, square.denominator
    shift = max(0, 64 - (n.bit_length() - d.bit_length()) // 2)
    scaled = (n << (2 * shift)) // d + 1
    return Fraction(isqrt(scaled) + 1, 1 << shift)


def _rounded_up(n: int, d: int) -> Fraction:
    """Return a short rational at least as large as n/d, by at most a part in 2⁶³: long ones make what follows slow."""
    last = n.bit_length() - d.bit_length() - 64
    if last >= 0:
        return Fraction(-(-n // (d << last)) << last)
    return Fraction(-((-n << -last) // d), 1 << -last)


def _short(bound: Fraction) -> Fraction:
    return _rounded_up(bound.numerator, bound.denominator)


def nearby(value: Fraction) -> Fraction:
    """Return a short rational near a value, off by at most a part in 2⁶³."""
    unit = _last_bit(value)
    return round(value / unit) * unit


def _cut(values: Sequence[Fraction]) -> list[Fraction]:
    """Return the values as multiples of the last bit that is left of the largest."""
    unit = _last_bit(max(map(abs, values)), _CUT)
    return [round(k / unit) * unit for k in values]


def _last_bit(value: Fraction, bits: int = 64) -> Fraction:
    return Fraction(2) ** (value.numerator.bit_length() - value.denominator.bit_length() - bits)


def dot(a: Iterable[Fraction], b: Iterable[Fraction]) -> Fraction:
    """Return the scalar product."""
    return sum((x * y for x, y in zip(a, b, strict=True)), ZERO)


def _congruent(columns: Sequence[Sequence[Fraction]], second: Six) -> Six:
    """Return the elements of Rᵀ S R from the columns of R and the elements of S."""
    xx, yy, zz, yz, zx, xy = second
    rows = (xx, xy, zx), (xy, yy, yz), (zx, yz, zz)
    return six(dot(columns[i], [dot(row, columns[j]) for row in rows]) for i, j in PAIRS)


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
