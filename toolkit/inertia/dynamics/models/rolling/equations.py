"""The equations of a body of revolution that rolls without slipping on its circular rim (textbook § 13.24).

Lengths are in units of the rim's radius R, masses in units of the body's; what is left of the body are three numbers
and g/R. Vectors are resolved along the axes of the nodes: 1 along the horizontal k × n, 3 along the symmetry axis n,
2 = 3 × 1, where k is up, k = e₂ sinθ + e₃ cosθ. They turn at (ω₁, ω₂, Ω₃) with Ω₃ = ω₂ cotθ, the body at
(ω₁, ω₂, ω₃) = (θ̇, φ̇ sinθ, ψ̇ + φ̇ cosθ) (eqs 13.191–192). The lowest point of the rim is at ρ = h e₃ − e₂ from the
centre of mass, h = offset/R, so that v = −ω × ρ (eq. 13.197 has h = 0).

The functions here are arithmetic alone: they take floats or arrays, with s = sinθ and c = cosθ.
"""

from __future__ import annotations

from functools import cached_property
from typing import TypeVar

import numpy as np

from inertia.arrays import Float
from inertia.errors import GeometryError
from inertia.mass.tensor import VALIDITY_TOLERANCE
from inertia.records import dataclass

Number = TypeVar("Number", float, Float)
"""A float or an array."""


@dataclass(frozen=True)
class RollingBody:
    """A body of revolution and the rim that it rolls on, under gravity.

    Attributes
    ----------
    mass : kg
    transverse, axial : kg m², moments about the centre of mass: I₁ = I₂, and I₃ about the symmetry axis
    radius : m, of the rim, which is the only part of the body that touches the plane
    offset : m, from the centre of mass along axis 3 to the plane of the rim; 0 for a thin disc
    gravity : m/s², downwards

    Raises `GeometryError` where a value is not physical.

    >>> RollingBody(mass=1.0, transverse=0.25, axial=0.5, radius=1.0).coupling
    (2.0, 0.0, 0.6666666666666666)
    """

    mass: float
    transverse: float
    axial: float
    radius: float
    offset: float = 0.0
    gravity: float = 9.80665

    def __post_init__(self) -> None:
        for name in ("mass", "transverse", "axial", "radius", "gravity"):
            value = getattr(self, name)
            if not 0 < value < np.inf:
                raise GeometryError(f"the {name} of the rolling body is {value:.6g}: it must be positive and finite")
        if not np.isfinite(self.offset):
            raise GeometryError(f"the offset of the rolling body is {self.offset:.6g}: it must be finite")
        if self.axial > 2 * self.transverse * (1 + VALIDITY_TOLERANCE):
            raise GeometryError(
                f"the axial moment {self.axial:.6g} kg m² of the rolling body is more than twice the transverse one, "
                f"{self.transverse:.6g} kg m²: no body has such moments"
            )

    @cached_property
    def reduced(self) -> tuple[float, float, float, float]:
        """The four numbers that the equations need: I₁/(M R²), I₃/(M R²), offset/R, and g/R in 1/s²."""
        unit = self.mass * self.radius**2
        return self.transverse / unit, self.axial / unit, self.offset / self.radius, self.gravity / self.radius

    @cached_property
    def coupling(self) -> tuple[float, float, float]:
        """α, β, γ of the linear equations dω₂/dθ + ω₂ cotθ = α ω₃ + β ω₂ and dω₃/dθ = γ ω₂ − β ω₃.

        They are the second and third moment equations about the contact, divided by θ̇ (eq. 13.198 for h = 0).
        """
        a, c, h, _ = self.reduced
        determinant = a * (c + 1) + c * h * h
        return c * (c + 1) / determinant, c * h / determinant, a / determinant


def angular_acceleration(
    body: RollingBody, s: Number, c: Number, w1: Number, w2: Number, w3: Number
) -> tuple[Number, Number, Number]:
    """Return (ω̇₁, ω̇₂, ω̇₃) in rad/s²: the moments about the contact, which the reaction does not enter.

    With h = 0: (I₁ + MR²) ω̇₁ + (I₃ + MR²) ω₂ω₃ − I₁ Ω₃ω₂ = −MgR cosθ, I₁ ω̇₂ + I₁ Ω₃ω₁ − I₃ ω₁ω₃ = 0 and
    (I₃ + MR²) ω̇₃ − MR² ω₁ω₂ = 0 (eq. 13.198).
    """
    transverse, axial, h, g = body.reduced
    alpha, beta, gamma = body.coupling
    turn = w2 * c / s
    moment = w2 * (transverse * turn - axial * w3) - (w2 - h * turn) * (h * w2 + w3) - g * (c + h * s)
    return (
        moment / (transverse + 1 + h * h),
        w1 * (alpha * w3 + beta * w2 - turn),
        w1 * (gamma * w2 - beta * w3),
    )


def reaction(
    body: RollingBody, s: Number, c: Number, w1: Number, w2: Number, w3: Number
) -> tuple[Number, Number, Number]:
    """Return the force of the plane on the rim in N: along e₁, along the horizontal k × e₁, and upwards.

    F = M (dv/dt + g k), with dv/dt = ∂v/∂t + (ω₁, ω₂, Ω₃) × v and v = (−h ω₂ − ω₃, h ω₁, ω₁) (eqs 13.193–194).
    """
    _, _, h, g = body.reduced
    d1, d2, d3 = angular_acceleration(body, s, c, w1, w2, w3)
    turn, pace = w2 * c / s, h * w2 + w3
    first = w1 * (w2 - h * turn) - h * d2 - d3
    second = h * d1 - turn * pace - w1 * w1 + g * s
    third = d1 + h * w1 * w1 + w2 * pace + g * c
    unit = body.mass * body.radius
    return unit * first, unit * (second * c - third * s), unit * (second * s + third * c)


def energy(body: RollingBody, s: Number, c: Number, w1: Number, w2: Number, w3: Number) -> Number:
    """Return the energy in J: ½ M v² + ½ I₁ (ω₁² + ω₂²) + ½ I₃ ω₃² + M g z, with z = R sinθ − offset cosθ."""
    transverse, axial, h, g = body.reduced
    kinetic = (1 + h * h + transverse) * w1 * w1 + (h * w2 + w3) ** 2 + transverse * w2 * w2 + axial * w3 * w3
    return body.mass * body.radius**2 * (0.5 * kinetic + g * (s - h * c))
