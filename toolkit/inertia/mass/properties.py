"""`MassProperties`: mass, centre of mass and inertia tensor of a body, with bounds, and the algebra on them.

Signs and frames are those of `inertia.mass.tensor`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.errors import UNIT, GeometryError, UsageError
from inertia.mass import principal as principals
from inertia.mass.eigen import Spectrum
from inertia.mass.moments import ZERO, Moments, Six, inertia_bound, inertia_tensor
from inertia.mass.tensor import array_of, faults, rotation_of

_ROUNDOFF = Fraction(1, 2**53)
_SLENDER, _CERTAIN = 1e-3, 1e-9
_SPACING = Fraction(1, 2**1074)  # of the numbers below the normal range, where rounding is not relative


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


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass properties of a body, in SI units and part axes.

    Attributes
    ----------
    mass : kg
    volume : m³; 0 for wires and points
    center_of_mass : (3,) m
    inertia : (3, 3) kg m² about the centre of mass; off-diagonal elements are negative products of inertia
    error : `ErrorBound`

    Raises `GeometryError` where no body of positive mass can have these properties.

    >>> ball = MassProperties(2.0, 1.0, [0, 0, 0], 0.8 * np.eye(3))
    >>> (ball + ball).about([0, 0, 1]).tolist()
    [[5.6, 0.0, 0.0], [0.0, 5.6, 0.0], [0.0, 0.0, 1.6]]
    """

    mass: float
    volume: float
    center_of_mass: Float
    inertia: Float
    error: ErrorBound = ErrorBound("given", 0.0, 0.0, 0.0, 0.0)
    _central: Moments | None = field(default=None, init=False, repr=False)  # before rounding, where at hand

    def __post_init__(self) -> None:
        object.__setattr__(self, "center_of_mass", array_of(self.center_of_mass, (3,), "center_of_mass"))
        object.__setattr__(self, "inertia", array_of(self.inertia, (3, 3), "inertia"))
        if not 0 < self.mass < np.inf:
            raise GeometryError(f"the mass is {self.mass:.6g} kg: it must be positive and finite")
        if not 0 <= self.volume < np.inf:
            raise GeometryError(f"the volume is {self.volume:.6g} m3: it must be finite and not negative")
        if broken := faults(self.inertia, max(principals.CLASS_TOLERANCE, 4 * self.error.inertia)):
            raise GeometryError(f"the inertia tensor is not physical: {broken[0]}")
        self.center_of_mass.setflags(write=False)
        self.inertia.setflags(write=False)

    @classmethod
    def from_moments(cls, moments: Moments, volume: Fraction, volume_bound: Fraction, method: str) -> MassProperties:
        """Round exact moments of mass (kg, m) to float64, once each.

        Raises `GeometryError` where the mass or the volume is not larger than its bound (a volume may be exactly
        zero), or a result leaves float64.
        """
        if moments.zeroth <= moments.zeroth_bound:
            raise GeometryError(
                f"the mass, {_show(moments.zeroth)} kg, is not above its error bound of "
                f"{_show(moments.zeroth_bound)} kg: the solid has no volume that these coordinates can tell from zero"
            )
        if volume <= volume_bound and (volume or volume_bound):
            raise GeometryError(
                f"the volume, {_show(volume)} m3, is not above its error bound of {_show(volume_bound)} m3: nothing "
                "is left of the solid"
            )
        central = moments.central()
        try:
            mass, size = float(moments.zeroth), float(volume)
            com = np.array([float(k) for k in central.origin])
            tensor = np.array([[float(k) for k in row] for row in inertia_tensor(central.second)])
        except OverflowError:
            raise GeometryError(
                "the result is above 1.8e308 and leaves float64: give the coordinates in a smaller unit with ",
                UNIT,
            ) from None
        norm, bound = _norm(tensor), inertia_bound(central.second_bound)
        if mass == 0 or (any(central.second) and not tensor.any()):
            raise GeometryError(
                "the result is below 5e-324 and leaves float64: give the coordinates in a larger unit with ",
                UNIT,
            )
        error = ErrorBound(
            method,
            _relative(volume_bound, volume),
            _relative(moments.zeroth_bound, moments.zeroth),
            float(moments.centroid_bound + _norm(com) * _ROUNDOFF + 2 * _SPACING),
            _relative(bound + _SPACING, norm),
        )
        properties = cls(mass, size, com, tensor, error)
        object.__setattr__(properties, "_central", central)
        return properties

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
        if self._central is None:
            return principals.spectrum_of_tensor(self.inertia, Fraction(self.error.inertia) * _norm(self.inertia))
        return principals.spectrum_of_moments(self._central.second, self._central.second_bound)

    @property
    def loses_smallest_moment(self) -> bool:
        """Whether the body is slender, and its smallest principal moment uncertain by more than a part in 10⁹.

        The sums of a body are off in proportion to its largest moment, and, where it lies askew, to its slenderness
        too: the smallest moment of a needle drowns in that though the coordinates carry it. Turning the mesh into the
        principal frame in float64 does not bring it back, as a turned coordinate is off by 1e-16 of the length: for a
        needle of aspect 1e9 a ten-millionth of its width. Sums with more digits do.
        """
        size = float(np.abs(self.inertia).max()) or 1.0
        least, _, largest = np.linalg.eigvalsh(self.inertia / size).tolist()
        if least > _SLENDER * largest:
            return False
        return bool(self.principal.moment_bounds[0] > _CERTAIN * self.principal.moments[0])

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

    def about(self, point: ArrayLike) -> Float:
        """Return the tensor (3, 3) kg m² about `point` (3,) m, in part axes (Steiner's theorem)."""
        to = [Fraction(k) for k in array_of(point, (3,), "point").tolist()]
        try:
            return np.array([[float(k) for k in row] for row in inertia_tensor(self._moments.about(to).second)])
        except OverflowError:
            raise UsageError(
                f"the tensor about {[float(k) for k in to]} is above 1.8e308: name a nearer point"
            ) from None

    def expressed_in(self, rotation: ArrayLike, origin: ArrayLike = (0.0, 0.0, 0.0)) -> MassProperties:
        """Return the same body in another frame.

        Parameters
        ----------
        rotation : (3, 3), its columns are the new axes in the old ones; the bounds take it as it is given
        origin : (3,) m, the new frame's origin in the old one
        """
        axes = rotation_of(rotation)
        tensor = axes.T @ self.inertia @ axes
        offset = self.center_of_mass - array_of(origin, (3,), "origin")
        com = axes.T @ offset
        error = ErrorBound(
            self.error.method,
            self.error.volume,
            self.error.mass,
            self.error.center_of_mass + float(8 * _ROUNDOFF * _norm(offset)),
            self.error.inertia + float(16 * _ROUNDOFF),
        )
        return MassProperties(self.mass, self.volume, com, 0.5 * (tensor + tensor.T), error)

    def with_mass(self, mass: float) -> MassProperties:
        """Return the same shape with another total mass, kg: the tensor in proportion.

        The mass is exact as given; what was uncertain in the old one goes over to the tensor, which is its multiple.
        """
        if not 0 < mass < np.inf:
            raise UsageError(f"mass is {mass!r} kg: it must be positive and finite")
        least = max(1 - self.error.mass, float(_ROUNDOFF))
        error = replace(
            self.error,
            mass=0.0,
            inertia=(self.error.inertia + self.error.mass) / least + float(4 * _ROUNDOFF),
        )
        return MassProperties(mass, self.volume, self.center_of_mass, self.inertia * (mass / self.mass), error)

    def __add__(self, other: object) -> MassProperties:
        """Assemble two bodies given in the same frame."""
        return self._combined(other, 1)

    def __sub__(self, other: object) -> MassProperties:
        """Cut a body out of another one that contains it, given in the same frame."""
        return self._combined(other, -1)

    def _combined(self, other: object, sign: int) -> MassProperties:
        if not isinstance(other, MassProperties):
            raise UsageError(f"mass properties combine with mass properties, not with {type(other).__name__}")
        volume = Fraction(self.volume) + sign * Fraction(other.volume)
        bound = sum((Fraction(k.volume) * Fraction(k.error.volume) for k in (self, other)), ZERO)
        methods = dict.fromkeys((self.error.method, other.error.method))
        moments = self._moments + other._moments.scaled(Fraction(sign))
        return MassProperties.from_moments(moments, volume, bound, " + ".join(methods))

    @cached_property
    def _moments(self) -> Moments:
        """The moments of mass about the centre of mass, with the bounds."""
        if self._central is not None:
            return self._central
        tensor = [[Fraction(k) for k in row] for row in self.inertia.tolist()]
        half = sum((tensor[i][i] for i in range(3)), ZERO) / 2
        mass, x, y, z = (Fraction(k) for k in (self.mass, *self.center_of_mass.tolist()))
        # |δS_ii| = |½ δtr − δI_ii| ≤ (½√3 + 1)|δI|, and off the diagonal |δS_ij| = |δI_ij|.
        size = Fraction(self.error.inertia) * _norm(self.inertia)
        mass_bound, off = mass * Fraction(self.error.mass), Fraction(self.error.center_of_mass)
        # Seen from the centre of mass given, the true one may be `off` away: by Steiner's theorem.
        shift = (mass + mass_bound) * off
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
        )


def _norm(array: Float) -> Fraction:
    """Return the Frobenius norm, also of numbers whose squares leave float64."""
    largest = float(np.abs(array).max())
    return Fraction(largest) * Fraction(float(np.linalg.norm(array / largest))) if largest else ZERO


def _relative(bound: Fraction, value: Fraction) -> float:
    """Return a bound relative to the value, with what rounding the value to float64 adds; 0 of nothing."""
    return float((bound + _SPACING) / abs(value) + _ROUNDOFF) if value else 0.0


def _show(value: Fraction) -> str:
    try:
        return f"{float(value):.3g}"
    except OverflowError:
        return "inf"
