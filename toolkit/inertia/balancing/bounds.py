"""Error bounds of an unbalance, source by source, in a form from which the bound in any plane follows.

A source moves the static unbalance U and the couple D about a fixed plane together: (δU, δD) = Σ ζₖ (gₖ, hₖ) with
complex |ζₖ| ≤ 1. What a correction or tolerance plane sees is p U + q D with real p and q, so it is off by at most
Σ |p gₖ + q hₖ|: nothing is lost by bounding U and D apart.

The same ζₖ move the mass m of the rotor and its first moment S along the shaft, which limits may follow (U_per = e m):
(δm, δS) = Σ Re ζₖ (mₖ, sₖ). Of a body whose density is uncertain, unbalance and limit grow together.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.balancing.axis.shaft import Shaft
from inertia.errors import UsageError
from inertia.mass.integrand import principal_elements
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.records import dataclass

Complex = NDArray[np.complex128]
Source = Literal["arithmetic", "tessellation", "axis", "density", "measurement", "input"]

COVERAGE = 2.0
"""The factor k of the expanded uncertainty U = k u (GUM 6.2.1) that counts as a bound."""

_NO_MODE = 1e-7  # of the largest: the root of what rounding leaves of a covariance
_NOTHING = 1e-9  # of a change and of that of its limit
_PER_SPAN = 1e-4  # of the bearings' distance: about what limits are per kg, so that no mode outweighs the others
_NO_MASS = (0.0, 0.0)
_ROUNDOFF = 2.0**-53


@dataclass(frozen=True)
class Uncertainty:
    """One source of uncertainty of an unbalance.

    Attributes
    ----------
    source : its name
    modes : pairs (g, h): how far it can move the static unbalance, kg m, and the couple, kg m², each mode by itself; of
        the source "input", and where they scatter, what one standard deviation of each of several independent normal
        numbers does
    cause : the size of the input that the modes are in proportion to: m of chord or radius, or a relative density;
        None where no input makes it smaller
    bodies : of a rotor with several, those that it is of: for a density one for each mode; of the source "input" the
        input's name, or that of each mode
    masses : pairs (m, s): what each mode does to the mass, kg, and to its first moment along the shaft about the plane
        of the couple, kg m; empty where it does nothing to them
    scatters : whether a measurement's modes are standard deviations, not limits
    """

    source: Source
    modes: tuple[tuple[complex, complex], ...]
    cause: float | None = None
    bodies: tuple[str, ...] = ()
    masses: tuple[tuple[float, float], ...] = ()
    scatters: bool = False

    def bound(self, p: float, q: float, share: complex = 0.0, rates: tuple[float, float] = (0.0, 0.0)) -> float:
        """Return how far p U + q D − share · limit may be off, kg m; of an input, two standard deviations.

        Where modes scatter, it is twice the standard deviation in the direction in which that is largest.

        Parameters
        ----------
        p, q : a number, and 1/m
        share : of the limit, as a vector, that p U + q D is
        rates : what the limit changes by with the mass, m, and with its first moment, a number
        """
        if self.scatters:
            return COVERAGE * float(worst_direction(np.array([p * g + q * h for g, h in self.modes], np.complex128)))
        masses = self.masses or ((0.0, 0.0),) * len(self.modes)
        each = (
            _apart(p * g + q * h, share * (rates[0] * m + rates[1] * s))
            for (g, h), (m, s) in zip(self.modes, masses, strict=True)
        )
        if self.source == "input":
            return COVERAGE * math.sqrt(math.fsum(k**2 for k in each))
        return math.fsum(each)

    def about(self, shift: float) -> Uncertainty:
        """Return the same source for the couple about a plane that lies `shift` metres further along the shaft."""
        return replace(
            self,
            modes=tuple((g, h - g * shift) for g, h in self.modes),
            masses=tuple((m, s - m * shift) for m, s in self.masses),
        )

    @property
    def of_mass_alone(self) -> Uncertainty:
        """The same source where the unbalance is known without it, as one that a machine showed."""
        return replace(self, modes=((0j, 0j),) * len(self.modes))

    def turned(self, factor: complex) -> Uncertainty:
        """Return the same source with the rotor turned by the angle of `factor`, which has unit length."""
        return replace(self, modes=tuple((factor * g, factor * h) for g, h in self.modes))


def from_errors(source: Source, body: MassProperties, error: ErrorBound, cause: float | None = None) -> Uncertainty:
    """Return what relative bounds on the mass properties leave uncertain of the unbalance.

    |δU| ≤ m (δ_G + ε_m e (1 + …)) and, about the plane of the centre of mass found, |δD| ≤ ε_I |I| + |U| δ_G; with
    δ_G the bound on the centre of mass and e its distance from the shaft.

    Parameters
    ----------
    source : its name
    body : in shaft axes, origin on the shaft
    error : of arithmetic, or of tessellation
    cause : see `Uncertainty`
    """
    heaviest = body.mass * (1.0 + error.mass)
    eccentricity = math.hypot(*body.center_of_mass[:2])
    off = error.center_of_mass
    static = heaviest * off + body.mass * error.mass * eccentricity
    couple = error.inertia * _norm(body) + heaviest * (eccentricity + off) * off
    modes = ((static, 0.0), (0.0, couple), (0.0, 0.0), (0.0, 0.0))
    return Uncertainty(
        source, modes, cause, masses=(_NO_MASS, _NO_MASS, (body.mass * error.mass, 0.0), (0.0, heaviest * off))
    )


def arithmetic(body: MassProperties) -> Uncertainty:
    """Return what the sums over the mesh, and turning their results into shaft axes, may have lost.

    The axes themselves are rounded to 8 units in the last place: that much of a tilt is added.
    """
    summed = from_errors("arithmetic", body, body.error)
    tilt = 8.0 * _ROUNDOFF
    rounded = (tilt * body.mass * math.hypot(*body.center_of_mass), 0.0), (0.0, tilt * _norm(body))
    return Uncertainty("arithmetic", (*summed.modes, *rounded), masses=(*summed.masses, _NO_MASS, _NO_MASS))


def axis(body: MassProperties, span: float, radius: float) -> Uncertainty:
    """Return what an axis leaves uncertain whose bearing centres are known to within a radius.

    With bearing A off by a and B by b the axis is off by d = a (1 − t) + b t at the centre of mass, t = (z_G − z_A)/L,
    and tilted by s = (b − a)/L: δU = −m d, δD = −s (I_t − I_p), to first order in both. On top of that may come |s|
    times half the difference of the two transverse moments, and times m e² of a body whose centre of mass lies off the
    axis by e, as the tilt shifts it along the shaft.

    Parameters
    ----------
    body : in shaft axes, origin at bearing A
    span : L, m
    radius : m, at each bearing
    """
    if not 0 <= radius < math.inf:
        raise UsageError(f"the radial uncertainty of the axis is {radius!r} m: it must be finite and not negative")
    t = float(body.center_of_mass[2]) / span
    i = body.inertia
    stiff = 0.5 * float(i[0, 0] + i[1, 1]) - float(i[2, 2])
    uneven = math.hypot(0.5 * float(i[0, 0] - i[1, 1]), float(i[0, 1]))
    uneven += body.mass * (float(body.center_of_mass[0]) ** 2 + float(body.center_of_mass[1]) ** 2)
    mass, tilt = body.mass * radius, radius / span
    return Uncertainty(
        "axis",
        ((-mass * (1.0 - t), tilt * stiff), (-mass * t, -tilt * stiff), (0.0, 2.0 * tilt * uneven)),
        radius,
    )


def density(
    bodies: Iterable[tuple[complex, complex]], relative: float, masses: Iterable[tuple[float, float]] = ()
) -> Uncertainty:
    """Return what densities leave uncertain that are each known to a relative figure, apart from each other.

    Parameters
    ----------
    bodies : (static kg m, couple kg m² about the common plane) of each body
    relative : of each density
    masses : (mass kg, its first moment kg m about the common plane) of each body, where limits may follow them
    """
    if not 0 <= relative < 1:
        raise UsageError(f"the relative uncertainty of the density is {relative!r}: it must be at least 0 and below 1")
    return Uncertainty(
        "density",
        tuple((relative * u, relative * d) for u, d in bodies),
        relative,
        masses=tuple((relative * m, relative * s) for m, s in masses),
    )


def propagated(name: str, covariance: Float, properties: MassProperties, shaft: Shaft, z: float) -> Uncertainty:
    """Return what an uncertain input of a body leaves uncertain of the unbalance: law of propagation, GUM 5.2.2.

    δU = δm u + m δu with u = x + i y, and δD = −(δI_xz + i δI_yz) + δU (z_G − z) + m u δz_G about the plane z; and
    δS = δm (z_G − z) + m δz_G.

    Parameters
    ----------
    name : what the input is called
    covariance : (11, 11), as of `inertia.mass.uncertainty`, that the input contributes
    properties : of the body, in part axes
    shaft : in part axes
    z : m, the plane that the couple is about
    """
    x, y, height = shaft.to_shaft(properties.center_of_mass).tolist()
    place = np.array([[x], [y]])
    moved = np.zeros((3, 11))  # the centre of mass, in shaft axes
    moved[:, 2:5] = properties.mass * shaft.axes.T
    static = place * np.eye(11)[1] + moved[:2]
    couple = static * (height - z) + place * moved[2]
    couple[:, 5:] -= principal_elements(shaft.axes)[[4, 3]]  # xz and yz
    weight = np.eye(11)[1]
    along = [shaft.span * weight, weight * (height - z) + moved[2]]
    rows = np.concatenate([static, couple / shaft.span, _PER_SPAN * np.array(along)])
    values, vectors = np.linalg.eigh(rows @ covariance @ rows.T)
    modes = (np.sqrt(np.maximum(values, 0.0)) * vectors).T
    modes = modes[np.abs(modes).max(axis=1) > _NO_MODE * np.abs(modes).max()]
    return Uncertainty(
        "input",
        tuple((complex(a, b), shaft.span * complex(c, d)) for a, b, c, d in modes[:, :4].tolist()),
        bodies=(name,),
        masses=tuple((m / (_PER_SPAN * shaft.span), s / _PER_SPAN) for m, s in modes[:, 4:].tolist()),
    )


def measured(moves: Complex, zs: ArrayLike, z: float) -> Uncertainty:
    """Return what readings leave uncertain of an unbalance, from what each input does to all planes at once.

    Parameters
    ----------
    moves : (m, n) kg m, what one standard deviation of each of m independent inputs does to the vectors of n planes
    zs : (n,) m, the planes
    z : m, the plane that the couple is about
    """
    arms = np.asarray(zs, dtype=np.float64) - z
    reach = float(np.abs(arms).max(initial=0.0)) or 1.0
    static, couple = moves.sum(axis=1), moves @ (arms / reach)
    sides = np.stack([static.real, static.imag, couple.real, couple.imag], axis=1)
    # Four inputs do what all of them do: those along the principal axes of their covariance.
    _, sizes, ways = np.linalg.svd(sides, full_matrices=False)
    modes = (sizes[:, None] * ways)[sizes > _NO_MODE * sizes.max(initial=0.0)]
    return Uncertainty(
        "measurement", tuple((complex(a, b), reach * complex(c, d)) for a, b, c, d in modes.tolist()), scatters=True
    )


def worst_direction(moves: Complex) -> Float:
    """Return the standard uncertainty of complex numbers by moves (m, ...), where its direction is the largest."""
    spread: Float = np.sqrt(0.5 * ((np.abs(moves) ** 2).sum(axis=0) + np.abs((moves**2).sum(axis=0))))
    return spread


def _apart(vector: complex, follows: complex) -> float:
    """Return how far a change of the vector is from that of its limit; 0 for what rounding leaves of equal ones."""
    apart = abs(vector - follows)
    return apart if apart > _NOTHING * (abs(vector) + abs(follows)) else 0.0


def _norm(body: MassProperties) -> float:
    return math.sqrt(math.fsum(float(k) ** 2 for k in body.inertia.flat))
