"""`Unbalance`: the static and couple unbalance of a rigid rotor, and what any set of planes sees of it.

Frames and signs, once and for all: z′ runs along the shaft from bearing A to bearing B. 0° is the zero mark (x′).
Angles go from +x′ to +y′: counter-clockwise seen from the B end looking toward A. A vector across the shaft is the
complex number u = x + i y. With the tensor in shaft axes, whose elements off the diagonal are negative products,

    U = ∫ (x + i y) dm = m (x_G + i y_G),          kg m
    D = ∫ (x + i y)(z − z_G) dm = −(I_xz + i I_yz),  kg m², about the plane of the centre of mass.

An angle is that of the *heavy* spot. Everything is SI; g·mm and degrees belong in text and files.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.balancing import bounds
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.bounds import Source, Uncertainty
from inertia.errors import UsageError
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.records import dataclass

Kind = Literal["balanced", "static", "couple", "quasi-static", "dynamic"]
Complex = NDArray[np.complex128]

_COINCIDENT = 1e-9  # of their distance from the centre of mass


@dataclass(frozen=True)
class PointMass:
    """A mass (kg; negative where it is taken away) at z (m), at a radius (m) and an angle (rad) from the zero mark."""

    mass: float
    radius: float
    angle: float
    z: float

    @property
    def unbalance(self) -> complex:
        """The mass times its vector from the shaft, kg m."""
        return cmath.rect(self.mass * self.radius, self.angle)


@dataclass(frozen=True)
class Unbalance:
    """The unbalance of a rigid rotor.

    Attributes
    ----------
    mass : kg
    z : m, the place along the shaft of the centre of mass
    static : U, kg m
    couple : D, kg m², about the plane z
    uncertainties : what U and D are uncertain by, one entry a source; for the couple about the plane z as it stands

    >>> rotor = Unbalance(mass=10.0, z=0.1, static=2e-3, couple=0.0)
    >>> a, b = rotor.in_planes(0.0, 0.4)
    >>> round(a.real, 12), round(b.real, 12)
    (0.0015, 0.0005)
    >>> rotor.kind
    'static'
    """

    mass: float
    z: float
    static: complex
    couple: complex
    uncertainties: tuple[Uncertainty, ...] = ()

    @classmethod
    def of(
        cls,
        properties: MassProperties,
        shaft: Shaft,
        *,
        tessellation: ErrorBound | None = None,
        chord: float | None = None,
        radial_uncertainty: float = 0.0,
    ) -> Unbalance:
        """Return the unbalance of a body on a shaft, with the bounds that the body and the axis carry.

        Parameters
        ----------
        properties : in part axes
        shaft : in part axes
        tessellation : what triangles may have changed of the properties (`inertia.mass.tessellation`)
        chord : m, the chord tolerance behind it
        radial_uncertainty : m, how far each bearing centre may be from where it is given
        """
        body = shaft.resolve(properties)
        x, y, z = body.center_of_mass.tolist()
        sources = [bounds.arithmetic(body)]
        if tessellation is not None:
            sources.append(bounds.from_errors("tessellation", body, tessellation, chord))
        if radial_uncertainty:
            sources.append(bounds.axis(body, shaft.span, radial_uncertainty))
        return cls(
            mass=body.mass,
            z=z + shaft.z_a,
            static=body.mass * complex(x, y),
            couple=-complex(body.inertia[0, 2], body.inertia[1, 2]),
            uncertainties=tuple(sources),
        )

    @property
    def eccentricity(self) -> float:
        """Specific unbalance e = |U|/m, m."""
        return abs(self.static) / self.mass

    @property
    def static_bound(self) -> float:
        """How far `static` may be from the true one, kg m."""
        return math.fsum(self.bounds_of(1.0, 0.0).values())

    @property
    def couple_bound(self) -> float:
        """How far `couple` may be from the true one about the same plane, kg m²."""
        return math.fsum(self.bounds_of(0.0, 1.0).values())

    @property
    def kind(self) -> Kind:
        """The class of the unbalance, where what is within the bounds counts as zero.

        Static: no couple about the centre of mass. Couple: no static unbalance. Quasi-static: Im(D Ū) = 0, one vector
        at the plane z + Re(D/U) does it all. Dynamic: none of these (ISO 21940-2).
        """
        u, d = abs(self.static), abs(self.couple)
        du, dd = self.static_bound, self.couple_bound
        if u <= du:
            return "balanced" if d <= dd else "couple"
        if d <= dd:
            return "static"
        crossed = abs((self.couple * self.static.conjugate()).imag)
        rounding = 4.0 * np.finfo(float).eps * u * d
        return "quasi-static" if crossed <= u * dd + d * du + du * dd + rounding else "dynamic"

    def couple_about(self, z: float) -> complex:
        """Return the couple about the plane z (m): D + U (z_G − z), kg m²."""
        return self.couple + self.static * (self.z - z)

    def in_planes(self, z_a: float, z_b: float) -> tuple[complex, complex]:
        """Return the vectors (kg m) in two planes (m) that are together the same unbalance.

        U_B = [U (z_G − z_A) + D]/(z_B − z_A), U_A = U − U_B.

        Raises `UsageError` where the planes coincide.
        """
        a, b = self.in_many_planes([z_a, z_b]).tolist()
        return a, b

    def in_many_planes(self, zs: Sequence[float]) -> Complex:
        """Return the vectors (n,) kg m in two planes or more that are together the same unbalance, of least Σ|Uₖ|²."""
        p, q = plane_weights(self.z, zs)
        vectors: Complex = p * self.static + q * self.couple
        return vectors

    def bounds_in_planes(self, zs: Sequence[float]) -> tuple[dict[Source, float], ...]:
        """Return, for each of the planes, how far its vector may be off, kg m, by source."""
        weights = zip(*(k.tolist() for k in plane_weights(self.z, zs)), strict=True)
        return tuple(self.bounds_of(p, q) for p, q in weights)

    def bounds_of(self, p: float, q: float) -> dict[Source, float]:
        """Return how far p U + q D may be off, kg m, by source; p is a number, q in 1/m."""
        totals: dict[Source, float] = {}
        for uncertainty in self.uncertainties:
            totals[uncertainty.source] = totals.get(uncertainty.source, 0.0) + uncertainty.bound(p, q)
        return totals

    def with_uncertainties(self, *more: Uncertainty) -> Unbalance:
        """Return the same unbalance with further sources; their couples are about the plane z."""
        return replace(self, uncertainties=(*self.uncertainties, *more))

    def with_masses(self, masses: Sequence[PointMass]) -> Unbalance:
        """Return the unbalance with point masses added, or taken away where negative.

        The centre of mass moves, and the couple is about its new plane. The uncertainties stay those of the rotor.

        Raises `UsageError` where no mass is left.
        """
        mass = math.fsum([self.mass, *(k.mass for k in masses)])
        if mass <= 0:
            raise UsageError(f"the masses taken away leave {mass:.3g} kg of {self.mass:.6g} kg: take away less")
        shift = math.fsum(k.mass * (k.z - self.z) for k in masses) / mass
        moved = self.with_vectors([(k.z, k.unbalance) for k in masses])
        return Unbalance(
            mass,
            self.z + shift,
            moved.static,
            moved.couple - moved.static * shift,
            tuple(k.about(shift) for k in self.uncertainties),
        )

    def with_vectors(self, vectors: Sequence[tuple[float, complex]]) -> Unbalance:
        """Return the unbalance with (z m, vector kg m) added, whose own mass does not count."""
        return replace(
            self,
            static=self.static + sum(u for _, u in vectors),
            couple=self.couple + sum(u * (z - self.z) for z, u in vectors),
        )

    def rotated(self, angle: float) -> Unbalance:
        """Return the unbalance of the rotor turned by an angle (rad) about the shaft against its zero mark."""
        turn = cmath.rect(1.0, angle)
        return replace(
            self,
            static=turn * self.static,
            couple=turn * self.couple,
            uncertainties=tuple(k.turned(turn) for k in self.uncertainties),
        )


def plane_weights(z: float, zs: ArrayLike) -> tuple[Float, Float]:
    """Return p (n,) and q (n,) 1/m so that the vectors p U + q D in the planes `zs` (n,) m make up the unbalance.

    Of all that do, the one of least Σ|Uₖ|². With ζ = zs − z, its mean ζ̄ and s = Σ(ζ − ζ̄)²:
    q = (ζ − ζ̄)/s, p = 1/n − ζ̄ q.

    Parameters
    ----------
    z : m, the plane that D is about
    zs : m, two planes or more; `UsageError` where all coincide
    """
    planes = np.asarray(zs, dtype=np.float64)
    if planes.ndim != 1 or planes.size < 2:
        raise UsageError(f"{planes.size} plane is given: a couple takes two planes or more")
    if not np.isfinite(planes).all():
        raise UsageError(f"the planes lie at z = {planes.tolist()} m: give finite places")
    local = planes - z
    mean = float(local.mean())
    apart = local - mean
    if np.ptp(planes) <= _COINCIDENT * max(float(np.abs(planes).max()), abs(z)):
        raise UsageError(f"the planes coincide at z = {planes[0]:.6g} m: a couple takes planes that lie apart")
    q = apart / float(apart @ apart)
    return 1.0 / planes.size - mean * q, q
