"""Geometry of free rotation: cones of the symmetric top, and the constructions of Poinsot and Binet (§ 13.20–21).

Angular velocities and moments are resolved along principal axes. The curves on the surfaces are in
`inertia.dynamics.kinematics.polhode`.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.dynamics.arguments import moments_of, scaled, vectors
from inertia.dynamics.kinematics.euler_angles import dot
from inertia.errors import GeometryError
from inertia.mass.principal import CLASS_TOLERANCE
from inertia.mass.tensor import array_of
from inertia.records import dataclass

Rolling = Literal["outside", "inside", "none"]

_Scaled = tuple[Float, NDArray[np.intc]]


@dataclass(frozen=True, eq=False)
class Cones:
    """What ω sweeps out in a free symmetric top, symmetry axis 3 (textbook § 13.20).

    The body cone, about axis 3, rolls without slipping on the space cone, about L; they touch along ω.

    Attributes
    ----------
    alpha : (…) rad, between ω and axis 3
    theta : (…) rad, between L and axis 3; tanθ = (I1/I3) tanα
    body_half_angle, space_half_angle : (…) rad, 0 … π/2: of the cones about ±axis 3 and L
    rolling : the body cone rolls on the outside of the space cone (prolate, I3 < I1), or with its inside around the
        space cone (oblate, I3 > I1); none where ω stays along L (spherical)
    precession : (…) rad/s, φ̇ = L/I1, at which axis 3 and ω go round L in space
    body_precession : (…) rad/s, Ω = (I3 − I1) ω3/I1, at which ω goes round axis 3 in the body
    """

    alpha: Float
    theta: Float
    body_half_angle: Float
    space_half_angle: Float
    rolling: Rolling
    precession: Float
    body_precession: Float


def cones(moments: ArrayLike, angular_velocity: ArrayLike) -> Cones:
    """Return the cones and precessions of a free symmetric top.

    φ̇ = L/I1 = ω √(1 + ((I3/I1)² − 1) cos²α), Ω = (I3 − I1) ω3/I1, tanθ = (I1/I3) tanα (textbook § 13.20).

    Parameters
    ----------
    moments : (3,) kg m², symmetry axis last; of a rotor that one is 0, and θ is 0 where it spins about its axis alone
    angular_velocity : (…, 3) rad/s

    Raises `GeometryError` where I1 and I2 differ by more than `inertia.mass.principal.CLASS_TOLERANCE` of the largest
    moment; their mean is I1.

    >>> plate = cones([1, 1, 2], [0.01, 0, 1])                     # Feynman's plate: it wobbles twice in a turn
    >>> plate.rolling, plate.precession.round(3).item(), plate.body_precession.item()
    ('inside', 2.0, 1.0)
    """
    i1, i2, i3 = moments_of(array_of(moments, (3,), "moments"), rotor=True).tolist()
    if abs(i1 - i2) > CLASS_TOLERANCE * max(i1, i2, i3):
        raise GeometryError(
            f"moments are {[i1, i2, i3]} kg m²: cones belong to a symmetric top with its symmetry axis last, I1 and I2 "
            f"may differ by {CLASS_TOLERANCE:g} of the largest moment"
        )
    i1, i2, i3 = scaled(np.array([i1, i2, i3]))[0].tolist()
    i1 = 0.5 * (i1 + i2)
    omega, exponent = scaled(vectors(angular_velocity, "angular_velocity"))
    across, along, exponent = np.hypot(omega[..., 0], omega[..., 1]), omega[..., 2], exponent[..., 0]
    alpha = np.arctan2(across, along)
    theta = np.arctan2(i1 * across, i3 * along)
    return Cones(
        alpha=alpha,
        theta=theta,
        body_half_angle=np.arctan2(across, np.abs(along)),
        space_half_angle=np.arctan2(abs(i3 - i1) * across * np.abs(along), i1 * across**2 + i3 * along**2),
        rolling="outside" if i3 < i1 else "inside" if i3 > i1 else "none",
        precession=np.ldexp(np.hypot(i1 * across, i3 * along) / i1, exponent),
        body_precession=np.ldexp((i3 - i1) * along / i1, exponent),
    )


def momentum_angle(moments: ArrayLike, angular_velocity: ArrayLike) -> Float:
    """Return the angle (…) in rad between L and ω, 0 … π/2: that of |L × ω| and L·ω = 2T.

    The components of L × ω are (I2 − I3) ω2 ω3, cyclic: small angles are as well known as large ones.

    Parameters
    ----------
    moments : (…, 3) kg m²; of a rotor one is 0, and the angle is 0 where there is no L
    angular_velocity : (…, 3) rad/s

    >>> momentum_angle([1, 1, 1], [3, -4, 12]).item()
    0.0
    """
    i, _ = scaled(moments_of(moments, rotor=True))
    w, _ = scaled(vectors(angular_velocity, "angular_velocity"))
    x, y, z = ((i[..., j] - i[..., k]) * w[..., j] * w[..., k] for j, k in ((1, 2), (2, 0), (0, 1)))
    angle: Float = np.arctan2(np.hypot(np.hypot(x, y), z), dot(i * w, w))
    return angle


@dataclass(frozen=True, eq=False)
class Poinsot:
    """The ellipsoid Σ I ω² = 2T of angular velocities, which rolls without slipping on the invariable plane.

    Attributes
    ----------
    semi_axes : (…, 3) rad/s, √(2T/I)
    normal : (…, 3) the plane's unit normal L/L along the principal axes
    distance : (…) rad/s, 2T/L, of the plane from the centre, which stays at rest
    contact : (…, 3) rad/s, ω: where they touch
    """

    semi_axes: Float
    normal: Float
    distance: Float
    contact: Float


@dataclass(frozen=True, eq=False)
class Binet:
    """The ellipsoid Σ L²/I = 2T of angular momenta and the sphere of radius |L|; L moves along their intersection.

    Attributes
    ----------
    semi_axes : (…, 3) kg m²/s, √(2T I)
    radius : (…) kg m²/s, |L|
    momentum : (…, 3) kg m²/s, L along the principal axes
    """

    semi_axes: Float
    radius: Float
    momentum: Float


def poinsot(moments: ArrayLike, angular_velocity: ArrayLike) -> Poinsot:
    """Return Poinsot's construction of a free body from moments (…, 3) kg m² and ω (…, 3) rad/s.

    Raises `GeometryError` where a body does not rotate.

    >>> poinsot([1, 2, 2], [0, 3, 0]).distance.item()
    3.0
    """
    (i, _), (w, exponent) = _rotating(moments_of(moments), angular_velocity)
    momentum, twice_energy = i * w, dot(i * w, w)[..., None]
    size = np.linalg.norm(momentum, axis=-1, keepdims=True)
    return Poinsot(
        np.ldexp(np.sqrt(twice_energy / i), exponent),
        momentum / size,
        np.ldexp(twice_energy / size, exponent)[..., 0],
        np.ldexp(w, exponent),
    )


def binet(moments: ArrayLike, angular_velocity: ArrayLike) -> Binet:
    """Return Binet's construction of a free body from moments (…, 3) kg m² and ω (…, 3) rad/s.

    Of a rotor one moment is 0, and its ellipsoid a flat disc. Raises `GeometryError` where a body does not rotate.

    >>> binet([1, 2, 2], [0, 3, 0]).semi_axes[1:].tolist()
    [6.0, 6.0]
    """
    (i, size), (w, pace) = _rotating(moments_of(moments, rotor=True), angular_velocity)
    momentum, exponent = i * w, size + pace
    return Binet(
        np.ldexp(np.sqrt(dot(momentum, w)[..., None] * i), exponent),
        np.ldexp(np.linalg.norm(momentum, axis=-1), exponent[..., 0]),
        np.ldexp(momentum, exponent),
    )


def _rotating(moments: Float, angular_velocity: ArrayLike) -> tuple[_Scaled, _Scaled]:
    """Return moments and ω as `scaled` does; refuse a body that has no angular momentum."""
    omega = vectors(angular_velocity, "angular_velocity")
    if not ((moments > 0) & (omega != 0)).any(axis=-1).all():
        raise GeometryError("the body has no angular momentum: at rest it has neither ellipsoid nor plane")
    return scaled(moments), scaled(omega)
