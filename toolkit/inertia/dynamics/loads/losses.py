"""Losses of energy: linear damping by the surroundings, and dissipation inside the body."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np

from inertia.arrays import Float
from inertia.documents import number
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.loads.load import Load, TurningBody
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Damping(Load):
    """Linear damping by the surroundings: N = −`coefficient` ω, in N m s."""

    kind = "damping"
    noun = "damping"

    coefficient: Annotated[float, number("N m s", negative=False)]

    @property
    def idle(self) -> bool:
        """Whether the coefficient is zero."""
        return self.coefficient == 0

    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return −d ω."""
        return -self.coefficient * np.asarray(angular_velocity)

    def terms(self, body: TurningBody, start: float) -> Terms:
        """Return d about each axis."""
        return Terms(damping=np.broadcast_to(np.float64(self.coefficient), 3))

    def described(self, listed: Callable[[Float | float], str]) -> str:
        """Return the coefficient."""
        return f"damping {listed(self.coefficient)} N m s"


@dataclass(frozen=True, eq=False)
class Dissipation(Load):
    """Energy lost inside a free body: L is kept in space, the energy falls, and the spin ends on the largest moment.

    A ball of moment J in the body turns at σ against it in a fluid that holds it back with the torque −c σ. With
    L = I Ω + J σ, I being the tensor of both, and a fluid stiff enough that J Ω̇ = −c σ, the axes turn at
    Ω = I⁻¹(L − J σ) = ω + κ I⁻² (I ω × ω), with I ω = L and κ = J²/c, so that

        L̇ = L × Ω,    d(½ ω·I ω)/dt = −κ |I⁻¹(I ω × ω)|² ≤ 0,

    zero for spin about a principal axis only. It is a double bracket, L̇ = L × ω + L × K (L × ω), K = κ I⁻²: Bloch,
    Krishnaprasad, Marsden & Ratiu, Commun. Math. Phys. 175 (1996) 1, § 5. The stated angular velocity is ω, so that
    I ω is the whole angular momentum; the axes turn faster by the small second term.

    Attributes
    ----------
    rate : κ in kg m² s, ≥ 0; the loss is κ |ω̇|² in W
    """

    kind = "dissipation"
    noun = "energy lost inside the body"
    free_bodies_only = True

    rate: Annotated[float, number("kg m² s", negative=False)]

    @property
    def idle(self) -> bool:
        """Whether the rate is zero."""
        return self.rate == 0

    @property
    def dissipation(self) -> float:
        """κ in kg m² s."""
        return self.rate

    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return zero: nothing acts from outside."""
        return np.zeros(np.shape(angular_velocity))

    def directions(self) -> Float:
        """Return none."""
        return np.empty((0, 3))

    def terms(self, body: TurningBody, start: float) -> Terms:
        """Return κ."""
        return Terms(dissipation=self.rate)

    def described(self, listed: Callable[[Float | float], str]) -> str:
        """Return the rate."""
        return f"dissipation inside the body, {listed(self.rate)} kg m² s"
