"""`MassProperties`: mass, centre of mass and inertia tensor of a body, with bounds, and the algebra on them.

Signs and frames are those of `inertia.mass.tensor`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import field, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.errors import UNIT, GeometryError, UsageError, require_kind
from inertia.estimate import is_number
from inertia.mass import principal as principals
from inertia.mass.density import number_of, positive
from inertia.mass.eigen import Spectrum
from inertia.mass.moments import ZERO, Moments, Six, dyadic, nearby, norm_above, norm_above_of
from inertia.mass.tensor import array_of, exact_point, faults, rotation_of
from inertia.mesh.tree import ONE
from inertia.records import dataclass

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CERTAIN = 1e-9
"""Relative bound of the volume and of each principal moment that an answer has where the mesh can give it."""

_ROUNDOFF = Fraction(1, 2**53)
_NORMAL = 2.0**-1022  # below it rounding is not relative, but of up to half the spacing of the numbers there
_SPACING = Fraction(1, 2**1074)
_ONE, _TWO = Fraction(1), Fraction(2)
_ROUNDED_UP = 1.0 + 1e-12  # more than float64 takes from a norm of nine elements
_WIDEN = 1 + Fraction(1, 2**59)  # more than a root is rounded up by


@dataclass(frozen=True)
class ErrorBound:
    """Bounds on the arithmetic error, and the method that ran.

    `volume`, `mass` and `inertia` (Frobenius norm) are relative; `center_of_mass` is a distance in metres. They
    compare with the exact answer *for the coordinates as stored*: what tessellation or storage lost before is not
    in them.
    """

    method: str
    volume: float
    mass: float
    center_of_mass: float
    inertia: float


_GIVEN = ErrorBound("given", 0.0, 0.0, 0.0, 0.0)


class Summed(Protocol):
    """A solid whose sums are at hand, and from which the bounds follow in rational arithmetic."""

    def properties(self) -> MassProperties:
        """Return the mass properties, with their bounds."""


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass properties of a body, in SI units and part axes.

    Attributes
    ----------
    mass : kg
    volume : m³; 0 for wires and points
    center_of_mass : (3,) m
    inertia : (3, 3) kg m² about the centre of mass; off-diagonal elements are negative products of inertia. Mirrored
        elements that rounding set apart, as in float32, are taken as their mean, and `error.inertia` covers that
    error : `ErrorBound`

    Raises `UsageError` where an argument is no number or of another shape, `GeometryError` where no body of positive
    mass can have these properties.

    >>> ball = MassProperties(2.0, 1.0, [0, 0, 0], 0.8 * np.eye(3))
    >>> (ball + ball).about([0, 0, 1]).tolist()
    [[5.6, 0.0, 0.0], [0.0, 5.6, 0.0], [0.0, 0.0, 1.6]]
    """

    mass: float
    volume: float
    center_of_mass: Float
    inertia: Float
    error: ErrorBound = field(default_factory=lambda: _GIVEN)
    _exact: Moments | None = field(default_factory=lambda: None, init=False, repr=False)  # before rounding, if at hand

    def __post_init__(self) -> None:
        object.__setattr__(self, "center_of_mass", array_of(self.center_of_mass, (3,), "center_of_mass"))
        object.__setattr__(self, "inertia", array_of(self.inertia, (3, 3), "inertia"))
        object.__setattr__(self, "mass", number_of(self.mass, "mass", "kg"))
        object.__setattr__(self, "volume", number_of(self.volume, "volume", "m³"))
        require_kind(self.error, ErrorBound, "error", "inertia.ErrorBound(...)")
        if not 0 < self.mass < np.inf:
            raise GeometryError(f"the mass is {self.mass:.6g} kg: it must be positive and finite")
        if not 0 <= self.volume < np.inf:
            raise GeometryError(f"the volume is {self.volume:.6g} m³: it must be finite and not negative")
        if broken := faults(self.inertia, max(principals.CLASS_TOLERANCE, 4 * self.error.inertia)):
            raise GeometryError(f"the inertia tensor is not physical: {broken[0]}", code="unphysical")
        if not np.array_equal(self.inertia, self.inertia.T):
            self._symmetrise()
        self.center_of_mass.setflags(write=False)
        self.inertia.setflags(write=False)

    def _symmetrise(self) -> None:
        """Let mirrored elements be their mean: no farther from the true tensor, but with a bound of no less than that.

        A bound below the distance to the nearest symmetric tensor cannot hold for the elements as they were given.
        """
        mean = self.inertia / 2 + self.inertia.T / 2
        largest = np.abs(mean).max()
        given, size = (float(np.linalg.norm(each / largest)) for each in (self.inertia, mean))
        moved = float(np.linalg.norm((self.inertia - mean) / largest)) * _ROUNDED_UP
        error = replace(self.error, inertia=max(self.error.inertia * given, moved) / size)
        object.__setattr__(self, "inertia", mean)
        object.__setattr__(self, "error", error)

    @classmethod
    def from_moments(cls, moments: Moments, volume: Fraction, volume_bound: Fraction, method: str) -> MassProperties:
        """Round exact moments of mass (kg, m) to float64, once each.

        Raises `GeometryError` where the mass or the volume is not larger than its bound (a volume may be exactly
        zero), or a result leaves float64.
        """
        _require_mass(moments)
        if volume <= volume_bound and (volume or volume_bound):
            raise GeometryError(
                f"the volume, {_show(volume)} m³, is not above its error bound of {_show(volume_bound)} m³: nothing "
                "is left of the solid"
            )
        try:
            size = float(volume)
        except OverflowError:
            raise GeometryError(*TOO_LARGE) from None
        if volume and not size:
            raise GeometryError(*TOO_SMALL)
        return cls._rounded(moments, size, _relative(volume_bound, [volume], [size]), None, method)

    @classmethod
    def of_small(cls, mass: float, volume: float, center: Float, inertia: Float, solid: Summed) -> MassProperties:
        """Return what `solid` has, of which these are known already; its bounds are formed where they are read."""
        properties = object.__new__(cls)
        center.setflags(write=False)
        inertia.setflags(write=False)
        properties.__dict__.update(mass=mass, volume=volume, center_of_mass=center, inertia=inertia, _solid=solid)
        return properties

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Form the bounds, and what was exact before it was rounded, where either is read for the first time."""
            solid = self.__dict__.get("_solid")
            if name not in ("error", "_exact") or solid is None:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            whole = solid.properties()
            self.__dict__.update(error=whole.error, _exact=whole._exact)
            return self.__dict__[name]

    @classmethod
    def _rounded(
        cls, moments: Moments, volume: float, volume_error: float, mass_error: float | None, method: str
    ) -> MassProperties:
        """Round exact moments of mass; the volume's error, and the mass' if it is at hand, are those stated."""
        central = moments.central()
        exact = [k for row in central.tensor for k in row]
        try:
            mass = float(moments.zeroth)
            center, d = central.numbers["origin"]
            com = [k / d for k in center]
            tensor = [float(k) for k in exact]
        except OverflowError:
            raise GeometryError(*TOO_LARGE) from None
        if mass == 0 or (any(exact) and not any(tensor)):
            raise GeometryError(*TOO_SMALL)
        error = ErrorBound(
            method,
            volume_error,
            _relative(moments.zeroth_bound, [moments.zeroth], [mass]) if mass_error is None else mass_error,
            _sum_above((moments.centroid_bound, 0), (_size(com), 53), (_TWO, 1074)),
            _relative(central.error_norms[1], exact, tensor),
        )
        properties = cls(mass, volume, np.array(com), np.array(tensor).reshape(3, 3), error)
        object.__setattr__(properties, "_exact", moments.shortened())
        return properties

    def center_of_mass_pair(self) -> tuple[Float, float]:
        """Return the centre of mass as an unevaluated sum of two float64, (2, 3) m, and the bound on its error, m.

        The first row is `center_of_mass`, the second what rounding took from it: far from the origin a float64 holds
        the distance, and few digits of where in the part the centre lies. A centre that was given has no second part.

        >>> ball = MassProperties(1.0, 1.0, [0, 0, 0], np.eye(3))
        >>> pair, bound = (ball.expressed_in(np.eye(3), [-1e6, 0, 0]) + ball).center_of_mass_pair()
        >>> pair[:, 0].tolist(), bound
        ([500000.0, 0.0], 0.0)
        """
        if self._exact is None:
            return np.array([self.center_of_mass, np.zeros(3)]), self.error.center_of_mass
        exact = self._exact.centroid
        low = [float(k - Fraction(h)) for k, h in zip(exact, self.center_of_mass.tolist(), strict=True)]
        lost = norm_above(
            k - Fraction(h) - Fraction(x) for k, h, x in zip(exact, self.center_of_mass.tolist(), low, strict=True)
        )
        return np.array([self.center_of_mass, low]), _above(self._exact.centroid_bound + lost)

    @cached_property
    def principal(self) -> principals.Principal:
        """Principal moments, axes, their bounds, degenerate subspaces and class, at the default tolerance."""
        return principals.principal_of(self._spectrum)

    def principal_within(self, tolerance: float) -> principals.Principal:
        """Return `principal` with another relative tolerance for equal moments.

        Bodies that were integrated are diagonalised as they were before the tensor's elements were rounded. The
        tensor is diagonalised once, however many tolerances are asked about.
        """
        if tolerance == principals.CLASS_TOLERANCE:
            return self.principal
        return principals.principal_of(self._spectrum, tolerance)

    @cached_property
    def _spectrum(self) -> Spectrum:
        if self._exact is None:
            return principals.spectrum_of_tensor(self.inertia, Fraction(self.error.inertia) * _norm(self.inertia))
        return principals.spectrum_of_moments(self._exact.central())

    @property
    def loses_smallest_moment(self) -> bool:
        """Whether the smallest principal moment, or another, is uncertain by more than a part in 10⁹.

        The sums of a body are off in proportion to its largest moment, and, where it lies askew or far from where it
        is thick, to its slenderness too: the smallest moment of a needle drowns in that though the coordinates carry
        it. Turning the mesh into the principal frame in float64 does not bring it back, as a turned coordinate is off
        by 1e-16 of the length: for a needle of aspect 1e9 a ten-millionth of its width. Sums with more digits do.
        """
        return not self.moments_within(CERTAIN)

    def moments_within(self, relative: float) -> bool:
        """Whether each principal moment is certain to this part of itself."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = (self.inertia / (float(np.abs(self.inertia).max()) or 1.0)).tolist()
        # No moment is off by more than the tensor, and the smallest of those that are positive is at least
        # det I / (½ tr I)²: that is most often enough, and costs no decomposition. Sums in float64 may be worth so
        # little that moments are negative, two of them with a positive determinant.
        determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
        definite = xx > 0 and xx * yy > xy * xy  # with a positive determinant
        if definite and self.error.inertia * (xx + yy + zz) ** 3 < relative * (determinant - 1e-14):
            return True
        return bool((self.principal.moment_bounds <= relative * self.principal.moments).all())

    @property
    def principal_moments(self) -> Float:
        """Principal moments (3,) kg m², ascending."""
        return self.principal.moments

    @property
    def principal_axes(self) -> Float:
        """Principal axes (3, 3), columns of a right-handed rotation, in part axes."""
        return self.principal.axes

    @property
    def radii_of_gyration(self) -> Float:
        """Return √(I/M) for each principal moment, (3,) m."""
        return principals.radii_of_gyration(self.principal.moments, self.mass)

    @property
    def equivalent_ellipsoid(self) -> Float:
        """Semi-axes (3,) m, along the principal axes, of the uniform solid ellipsoid of the same mass and moments.

        a² = 5 ∫x² dm / M for each axis (textbook exercise 8); the first is the longest, and zero is flat.
        """
        semi_axes: Float = np.sqrt(5.0 * self.principal.second_moments / self.mass)
        return semi_axes

    def plot(self, ax: Axes | None = None) -> Figure:
        """Draw the `equivalent_ellipsoid` in its place, with its axes, z upright, and return the figure.

        Raises `UsageError` where matplotlib is not installed.
        """
        from inertia.plotting import draw_ellipsoid, figure_of

        return figure_of(
            lambda axes: draw_ellipsoid(axes, self.center_of_mass, self.equivalent_ellipsoid, self.principal.axes),
            ax,
            "ellipsoid of the same mass and moments",
        )

    def _repr_html_(self) -> str:
        """Return a small table and a sketch of the equivalent ellipsoid, as a notebook shows them."""
        from inertia.notebook import ellipsoid_svg, html_of

        return html_of(self.rows(), ellipsoid_svg(self.equivalent_ellipsoid, self.principal.axes))

    def rows(self) -> list[tuple[str, str]]:
        """Return what a notebook shows, as labels and texts."""
        error = self.error
        center = (k if abs(k) > error.center_of_mass else 0.0 for k in self.center_of_mass.tolist())
        return [
            ("Mass", f"{self.mass:.10g} kg"),
            ("Volume", f"{self.volume:.10g} m³"),
            ("Centre of mass", f"{', '.join(f'{k:.10g}' for k in center)} m"),
            ("Moments", f"{', '.join(f'{k:.10g}' for k in self.principal.moments)} kg m² ({self.principal.kind})"),
            ("Bound", f"mass {error.mass:.2g}, tensor {error.inertia:.2g} (relative), centre of mass "
                      f"{error.center_of_mass:.2g} m; {error.method}"),
        ]  # fmt: skip

    def moments_about(self, point: ArrayLike | Sequence[Fraction] | None = None) -> Moments:
        """Return mass, first and second moments about `point` (3,) m, or the centre of mass: exact, with bounds."""
        return self._moments.central() if point is None else self._moments.about(exact_point(point, "point"))

    @property
    def bounds(self) -> tuple[float, float, float]:
        """How far mass (kg), centre of mass (m) and the tensor about it (kg m², Frobenius norm) may be off, rounded."""
        here = self.moments_about()
        known = float(here.zeroth_bound), float(here.centroid_bound), float(here.error_norms[1])
        sizes = self.mass, float(_norm(self.center_of_mass)), float(_norm(self.inertia))
        mass, center, inertia = (bound + float(_ROUNDOFF) * size for bound, size in zip(known, sizes, strict=True))
        return mass, center, inertia

    def about(self, point: ArrayLike | Sequence[Fraction]) -> Float:
        """Return the tensor (3, 3) kg m² about `point` (3,) m, in part axes (Steiner's theorem)."""
        return self.about_with_bound(point)[0]

    def about_with_bound(self, point: ArrayLike | Sequence[Fraction]) -> tuple[Float, float]:
        """Return the tensor (3, 3) kg m² about `point` (3,) m, and the relative bound on its error (Frobenius norm).

        A coordinate may be a `Fraction`: it counts as it is. What is not known of the centre of mass is in the bound.

        >>> import inertia
        >>> ball = MassProperties(2.0, 1.0, [0, 0, 0], 0.8 * np.eye(3), inertia.ErrorBound("measured", 0, 0, 0.001, 0))
        >>> tensor, bound = ball.about_with_bound([0, 0, 1])
        >>> tensor.diagonal().tolist(), round(bound, 5)
        ([2.8, 2.8, 0.8], 0.00149)
        """
        to = exact_point(point, "point")
        there = self._moments.about(to)
        exact = [k for row in there.tensor for k in row]
        try:
            tensor = [float(k) for k in exact]
        except OverflowError:
            raise UsageError(
                f"the tensor about {[float(k) for k in to]} is above 1.8e308: name a nearer point"
            ) from None
        return np.array(tensor).reshape(3, 3), _relative(there.error_norms[1], exact, tensor)

    def expressed_in(self, rotation: ArrayLike, origin: ArrayLike = (0.0, 0.0, 0.0)) -> MassProperties:
        """Return the same body in another frame.

        Parameters
        ----------
        rotation : (3, 3), its columns are the new axes in the old ones; the bounds hold for it as it is given, and for
            the rotation nearest to it
        origin : (3,) m, the new frame's origin in the old one
        """
        axes = [[Fraction(k) for k in row] for row in rotation_of(rotation).tolist()]
        _require_mass(self._moments)
        moments = self._moments.turned(axes, exact_point(origin, "origin"))
        return self._rounded(moments, self.volume, self.error.volume, self.error.mass, self.error.method)

    def with_mass(self, mass: float) -> MassProperties:
        """Return the same shape with another total mass, kg: the tensor in proportion.

        The mass is exact as given; what was uncertain in the old one goes over to the tensor, which is its multiple.
        """
        mass = positive(mass, "mass", "kg")
        _require_mass(self._moments)
        moments = self._moments.weighed(Fraction(mass))
        try:
            return self._rounded(moments, self.volume, self.error.volume, 0.0, self.error.method)
        except GeometryError as error:
            if error.words in (TOO_LARGE, TOO_SMALL):
                raise UsageError(
                    f"with a mass of {mass:g} kg the tensor leaves float64: name a mass nearer to {self.mass:g} kg"
                ) from None
            raise

    def __add__(self, other: object) -> MassProperties:
        """Assemble two bodies given in the same frame."""
        return self._combined(other, 1)

    def __radd__(self, other: object) -> MassProperties:
        """Return the body itself added to 0, no body, so that `sum` assembles a list of them."""
        return self if is_number(other) and other == 0 else self._combined(other, 1)

    def __sub__(self, other: object) -> MassProperties:
        """Cut a body out of another one that contains it, given in the same frame."""
        return self._combined(other, -1)

    def _combined(self, other: object, sign: int) -> MassProperties:
        if not isinstance(other, MassProperties):
            raise UsageError(f"mass properties combine with mass properties, not with {type(other).__name__}")
        volume = Fraction(self.volume) + sign * Fraction(other.volume)
        bound = sum((Fraction(k.volume) * Fraction(k.error.volume) for k in (self, other)), ZERO)
        methods = dict.fromkeys((self.error.method, other.error.method))
        a, b = self._moments, other._moments
        if sign < 0 and a.zeroth - b.zeroth <= a.zeroth_bound + b.zeroth_bound:
            raise GeometryError(
                f"nothing is left of {_show(a.zeroth)} kg where {_show(b.zeroth)} kg are cut out: subtract a body from "
                "one that contains it"
            )
        # About the origin of either, the bound of the other would be that of a lever, however light the first.
        share = b.zeroth / (a.zeroth + b.zeroth)
        middle = [x + share * (y - x) for x, y in zip(a.centroid, b.centroid, strict=True)]
        moments = a.about([nearby(k) for k in middle]) + b.scaled(Fraction(sign))
        return MassProperties.from_moments(moments, volume, bound, " + ".join(methods))

    @cached_property
    def _moments(self) -> Moments:
        """The moments of mass, with the bounds; about the centre of mass where it was given."""
        if self._exact is not None:
            return self._exact
        tensor = [[Fraction(k) for k in row] for row in self.inertia.tolist()]
        half = sum((tensor[i][i] for i in range(3)), ZERO) / 2
        mass, x, y, z = (Fraction(k) for k in (self.mass, *self.center_of_mass.tolist()))
        # |δS_ii| = |½ δtr − δI_ii| ≤ (½√3 + 1)|δI|, and off the diagonal |δS_ij| = |δI_ij|.
        size = Fraction(self.error.inertia) * _norm(self.inertia)
        mass_bound, off = mass * Fraction(self.error.mass), Fraction(self.error.center_of_mass)
        # Seen from the centre of mass given, the true one may be `off` away: by Steiner's theorem.
        shift = (mass + mass_bound) * off
        norms = shift, size + 3 * shift * off / 2
        second: Six = (
            *(half - tensor[i][i] for i in range(3)), -tensor[1][2], -tensor[2][0], -tensor[0][1]
        )  # type: ignore[assignment]  # fmt: skip
        return Moments(
            (x, y, z),
            mass,
            (ZERO, ZERO, ZERO),
            second,
            mass_bound,
            (shift, shift, shift),
            (*(2 * size + shift * off,) * 3, *(size + shift * off,) * 3),
            norms,
        )


def stretched(
    properties: MassProperties, rows: Sequence[Sequence[Fraction]], density: Fraction = _ONE
) -> MassProperties:
    """Return what a solid has whose points x are moved to A x, at `density` times its own, with its bounds.

    Its coordinates are not multiplied, which would round them: see `inertia.mass.moments.Moments.stretched`.

    Parameters
    ----------
    rows : of A (3, 3), not singular
    """
    own = properties.moments_about(properties.center_of_mass.tolist())
    moments = own if rows == ONE else own.stretched(rows)
    volume = Fraction(properties.volume) * moments.zeroth / own.zeroth
    bound = volume * Fraction(properties.error.volume)
    return MassProperties.from_moments(moments.scaled(density), volume, bound, properties.error.method)


TOO_LARGE = "the result is above 1.8e308 and leaves float64: give the coordinates in a smaller unit with ", UNIT
TOO_SMALL = "the result is below 5e-324 and leaves float64: give the coordinates in a larger unit with ", UNIT


def _require_mass(moments: Moments) -> None:
    if moments.zeroth <= moments.zeroth_bound:
        raise GeometryError(
            f"the mass, {_show(moments.zeroth)} kg, is not above its error bound of "
            f"{_show(moments.zeroth_bound)} kg: the solid has no volume that these coordinates can tell from zero"
        )


def _norm(array: Float) -> Fraction:
    """Return the Frobenius norm, rounded up."""
    return _size(array.ravel().tolist())


def _size(values: Sequence[float]) -> Fraction:
    """Return the root of the sum of the squares, rounded up."""
    return norm_above_of(*dyadic(values))


def _relative(bound: Fraction, exact: Sequence[Fraction], rounded: Sequence[float]) -> float:
    """Return a bound with what rounding adds to it, over the norm of the rounded values; 0 of nothing."""
    if below := sum(abs(k) < _NORMAL and bool(value) for value, k in zip(exact, rounded, strict=True)):
        bound += below * _SPACING
    if norm := _size(rounded):
        n, d = norm.numerator * bound.denominator * _WIDEN.denominator, norm.denominator * _WIDEN.numerator
        return _ratio_above((bound.numerator * d << 53) + n, n << 53)
    return math.inf if bound else 0.0


def _sum_above(*terms: tuple[Fraction, int]) -> float:
    """Return the sum of rationals, each divided by a power of two, rounded up."""
    d = math.prod(value.denominator for value, _ in terms)
    last = max(power for _, power in terms)
    n = sum(value.numerator * (d // value.denominator) << (last - power) for value, power in terms)
    return _ratio_above(n, d << last)


def _above(value: Fraction) -> float:
    """Return the value rounded up."""
    return _ratio_above(value.numerator, value.denominator)


def _ratio_above(n: int, d: int) -> float:
    """Return n/d rounded up."""
    try:
        rounded = n / d
    except OverflowError:
        return math.inf
    p, q = rounded.as_integer_ratio()
    return rounded if p * d >= n * q else math.nextafter(rounded, math.inf)


def _show(value: Fraction) -> str:
    try:
        return f"{float(value):.3g}"
    except OverflowError:
        return "inf"
