"""Lagrangian and Hamiltonian quantities of a rotating body in Euler angles (textbook § 13.12, 13.15–16, 13.18–19).

Angles, rates and momenta are arrays (…, 3) in the order φ, θ, ψ; their conventions are those of
`inertia.dynamics.kinematics.euler_angles`. Moments are principal, so that body axes are principal axes; of a rotor one
may be 0, except in `hamiltonian`, which divides by them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.arguments import moments_of, vectors
from inertia.dynamics.kinematics import euler_angles
from inertia.dynamics.kinematics.euler_angles import Convention, Frame, dot, raise_if_singular, rate_axes
from inertia.errors import UsageError
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class KineticEnergy:
    """Kinetic energy (…) in J: of translation with a point of the body, of rotation about it, and the cross term."""

    translation: Float
    cross: Float
    rotation: Float

    @property
    def total(self) -> Float:
        """The sum of the three."""
        return self.translation + self.cross + self.rotation


def kinetic_energy(
    inertia: ArrayLike, mass: float, lever: ArrayLike, velocity: ArrayLike, angular_velocity: ArrayLike
) -> KineticEnergy:
    """Return T = ½ M V² + M V·(ω × R) + ½ ω·J ω about any point O of the body (textbook eq. 13.58).

    The cross term vanishes where O is the centre of mass, or at rest.

    Parameters
    ----------
    inertia : (…, 3, 3) kg m² about O
    mass : kg
    lever : (…, 3) m, R, from O to the centre of mass
    velocity : (…, 3) m/s, of O
    angular_velocity : (…, 3) rad/s

    All are resolved along the same axes, of the body or of space.

    >>> rod_about_its_end = np.diag([0.0, 4.0, 4.0])     # 3 kg, 2 m
    >>> kinetic_energy(rod_about_its_end, 3.0, [1, 0, 0], [0, -1, 0], [0, 0, 1]).total.item()
    0.5
    """
    tensor = np.asarray(inertia, dtype=np.float64)
    if tensor.shape[-2:] != (3, 3):
        raise UsageError(f"inertia has shape {tensor.shape}: it must be (…, 3, 3)")
    v, omega = vectors(velocity, "velocity"), vectors(angular_velocity, "angular_velocity")
    return KineticEnergy(
        translation=0.5 * mass * dot(v, v),
        cross=mass * dot(v, np.cross(omega, vectors(lever, "lever"))),
        rotation=0.5 * np.einsum("...i,...ij,...j->...", omega, tensor, omega),
    )


def rotational_energy(
    moments: ArrayLike, angles: ArrayLike, rates: ArrayLike, convention: Convention = "z-x-z"
) -> Float:
    """Return T = ½ Σ I ω² (…) in J from Euler rates (textbook § 13.15).

    For z-x-z: 2T = I1 (φ̇ sinθ sinψ + θ̇ cosψ)² + I2 (φ̇ sinθ cosψ − θ̇ sinψ)² + I3 (φ̇ cosθ + ψ̇)².

    >>> rotational_energy([1, 1, 2], [0, np.pi / 2, 0], [1, 0, 3]).item()
    9.5
    """
    omega = euler_angles.angular_velocity(angles, rates, convention)
    return 0.5 * dot(moments_of(moments, rotor=True) * omega, omega)


def squared_speed(angles: ArrayLike, rates: ArrayLike, convention: Convention = "z-x-z") -> Float:
    """Return ω² = φ̇² + θ̇² + ψ̇² + 2 c φ̇ ψ̇ (…), c the cosine between the axes of φ and ψ (textbook § 13.16).

    c is cosθ for z-x-z and z-y-z, sinθ for x-y-z. Evaluated as the sum of squares along body axes, which cannot cancel.

    >>> squared_speed([0, np.pi / 3, 0], [1, 0, 1]).round(12).item()
    3.0
    """
    omega = euler_angles.angular_velocity(angles, rates, convention)
    return dot(omega, omega)


def momenta(
    angles: ArrayLike, angular_momentum: ArrayLike, convention: Convention = "z-x-z", frame: Frame = "body"
) -> Float:
    """Return the canonical momenta (p_φ, p_θ, p_ψ) (…, 3) from L (…, 3) kg m²/s along body or space axes.

    p = ∂T/∂(rate) is the component of L along the axis that the rate turns about: for z-x-z p_φ = L_z,
    p_θ along the line of nodes, p_ψ = L_3. Defined at the singular attitudes too, where p_φ = ±p_ψ.

    >>> momenta([0, np.pi / 2, 0], [1, 2, 3]).round(12).tolist()
    [2.0, 1.0, 3.0]
    """
    return dot(rate_axes(angles, convention, frame), vectors(angular_momentum, "angular_momentum")[..., None, :])


def momenta_of_rates(
    moments: ArrayLike, angles: ArrayLike, rates: ArrayLike, convention: Convention = "z-x-z"
) -> Float:
    """Return the canonical momenta (…, 3) from Euler rates (…, 3).

    For I1 = I2 and z-x-z: p_φ = (I1 sin²θ + I3 cos²θ) φ̇ + I3 ψ̇ cosθ, p_θ = I1 θ̇, p_ψ = I3 (φ̇ cosθ + ψ̇)
    (textbook § 13.20).
    """
    omega = euler_angles.angular_velocity(angles, rates, convention)
    return momenta(angles, moments_of(moments, rotor=True) * omega, convention)


def angular_momentum(
    angles: ArrayLike, momenta: ArrayLike, convention: Convention = "z-x-z", frame: Frame = "body"
) -> Float:
    """Return L (…, 3) along body or space axes from canonical momenta (…, 3).

    At a singular attitude the momenta do not determine L: `GeometryError`.

    >>> angular_momentum([0, np.pi / 2, 0], [2, 1, 3]).round(12).tolist()
    [1.0, 2.0, 3.0]
    """
    raise_if_singular(angles, convention, "the canonical momenta do not determine L there")
    outer, node, inner = np.moveaxis(rate_axes(angles, convention, frame), -2, 0)
    p = vectors(momenta, "momenta")[..., None]
    normal = np.cross(node, inner)
    plane = p[..., 0, :] * normal + p[..., 2, :] * np.cross(outer, node)
    momentum: Float = plane / dot(outer, normal)[..., None] + p[..., 1, :] * node
    return momentum


def squared_angular_momentum(angles: ArrayLike, momenta: ArrayLike, convention: Convention = "z-x-z") -> Float:
    """Return L² (…): for z-x-z p_θ² + p_ψ² + (p_φ − p_ψ cosθ)²/sin²θ (textbook § 13.16, 13.20)."""
    momentum = angular_momentum(angles, momenta, convention)
    return dot(momentum, momentum)


def lagrangian(
    moments: ArrayLike,
    angles: ArrayLike,
    rates: ArrayLike,
    potential: ArrayLike = 0.0,
    convention: Convention = "z-x-z",
) -> Float:
    """Return T − V (…) in J, V being the potential energy (…) at those angles."""
    return rotational_energy(moments, angles, rates, convention) - np.asarray(potential, dtype=np.float64)


def hamiltonian(
    moments: ArrayLike,
    angles: ArrayLike,
    momenta: ArrayLike,
    potential: ArrayLike = 0.0,
    convention: Convention = "z-x-z",
) -> Float:
    """Return H = ½ Σ L²/I + V (…) in J as a function of Euler angles and canonical momenta.

    For I1 = I2 and z-x-z: p_θ²/2I1 + (p_φ − p_ψ cosθ)²/(2 I1 sin²θ) + p_ψ²/2I3 + V (textbook § 13.23).
    `GeometryError` at the singular attitudes, as in `angular_momentum`.

    >>> hamiltonian([1, 1, 2], [0, np.pi / 2, 0], [2, 1, 4]).round(12).item()
    6.5
    """
    momentum = angular_momentum(angles, momenta, convention)
    return 0.5 * dot(momentum / moments_of(moments), momentum) + np.asarray(potential, dtype=np.float64)
