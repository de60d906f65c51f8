"""Loads on a body that turns about its reference point: the torque, the potential energy and what is kept.

Every load gives its torque along the principal axes of the body about the reference point, at attitudes (…, 4) and
angular velocities (…, 3).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import array_of

Frame = Literal["body", "space"]
TorqueFunction = Callable[[float, Float, Float], Float]


class Load(ABC):
    """A torque law."""

    conservative: bool = False
    """Whether the torque follows from `potential`, so that the energy is kept."""

    @property
    def breaks(self) -> Float:
        """Instants (k,) in s at which the torque has a kink or a jump."""
        return np.empty(0)

    @abstractmethod
    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return the torque (…, 3) in N m along the principal axes."""

    def potential(self, attitude: Float, moments: Float) -> Float:
        """Return the potential energy (…) in J; zero for a load that has none."""
        return np.zeros(np.shape(attitude)[:-1])

    def directions(self) -> Float:
        """Return directions (k, 3) in space whose span holds the torque at all times: L is kept across that span."""
        return np.eye(3)

    def terms(self, moments: Float, start: float) -> Terms | None:
        """Return the torque from `start` to the next break as `Terms`; None for a torque that is not of that form."""
        return None


@dataclass(frozen=True, eq=False)
class Gravity(Load):
    """Weight on a body held at a fixed point: N = c × m Rᵀg, V = −m g·(R c); keeps the energy and L·g.

    Attributes
    ----------
    mass : kg; offset : (3,) m, body axes, from the fixed point to the centre of mass
    acceleration : (3,) m/s², in space

    >>> top = Gravity(2.0, [0, 0, 0.1], [0, 0, -10])
    >>> tilted = quaternion.from_rotation_vector([np.pi / 2, 0, 0])
    >>> top.torque(0.0, tilted, np.zeros(3), np.ones(3)).round(12).tolist()
    [2.0, 0.0, 0.0]
    """

    mass: float
    offset: Float
    acceleration: Float
    conservative = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", array_of(self.offset, (3,), "offset"))
        object.__setattr__(self, "acceleration", array_of(self.acceleration, (3,), "acceleration"))
        if not 0 < self.mass < np.inf:
            raise GeometryError(f"mass is {self.mass:.6g} kg: gravity needs a body whose mass is positive and finite")

    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return c × m Rᵀg."""
        return np.cross(self.offset, self.mass * quaternion.to_body(attitude, self.acceleration))

    def potential(self, attitude: Float, moments: Float) -> Float:
        """Return −m g·(R c), zero with the centre of mass level with the fixed point."""
        return -self.mass * np.asarray(quaternion.to_space(attitude, self.offset) @ self.acceleration)

    def directions(self) -> Float:
        """Return two directions across g."""
        return across(self.acceleration)

    def terms(self, moments: Float, start: float) -> Terms:
        """Return A = m [c]×, v = g."""
        x, y, z = self.mass * self.offset
        return Terms.of_vector(self.acceleration, matrix=np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]))


@dataclass(frozen=True, eq=False)
class Torque(Load):
    """A constant torque (3,) in N m, along body axes or along space axes; in space it keeps L − N t."""

    value: Float
    frame: Frame = "body"

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", array_of(self.value, (3,), "torque"))
        check_frame(self.frame)

    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return N, or RᵀN."""
        if self.frame == "space":
            return quaternion.to_body(attitude, self.value)
        return np.broadcast_to(self.value, np.shape(angular_velocity))

    def directions(self) -> Float:
        """Return N where it stands in space."""
        return self.value[None] if self.frame == "space" else np.eye(3)

    def terms(self, moments: Float, start: float) -> Terms:
        """Return the torque itself, or A = 1, v = N."""
        return Terms.of_vector(self.value, matrix=np.eye(3)) if self.frame == "space" else Terms(self.value)


@dataclass(frozen=True, eq=False)
class CallableTorque(Load):
    """A torque N(t, attitude, ω) by any function, in N m along body axes or along space axes; keeps nothing known.

    `function` takes the time in s, one attitude (4,) of the principal axes and ω (3,) along them, and returns (3,).
    """

    function: TorqueFunction
    frame: Frame = "body"

    def __post_init__(self) -> None:
        check_frame(self.frame)

    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return what the function gives; raise `UsageError` where that is not three finite numbers."""
        value = np.asarray(self.function(time, attitude, angular_velocity), dtype=np.float64)
        if value.shape != (3,) or not np.isfinite(value).all():
            raise UsageError(f"the torque function returned {value} at t = {time:.6g} s: return three finite numbers")
        return quaternion.to_body(attitude, value) if self.frame == "space" else value


@dataclass(frozen=True, eq=False)
class Damping(Load):
    """Linear damping by the surroundings: N = −d ω, with d ≥ 0 in N m s, one number or one for each axis (3,)."""

    coefficient: Float | float

    def __post_init__(self) -> None:
        value = np.asarray(self.coefficient, dtype=np.float64)
        if value.shape not in ((), (3,)) or not (np.isfinite(value).all() and (value >= 0).all()):
            raise UsageError(f"damping is {self.coefficient}: give one number ≥ 0 in N m s, or three")
        object.__setattr__(self, "coefficient", np.broadcast_to(value, 3))

    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return −d ω."""
        return -np.asarray(self.coefficient) * angular_velocity

    def terms(self, moments: Float, start: float) -> Terms:
        """Return d."""
        return Terms(damping=np.asarray(self.coefficient))


@dataclass(frozen=True, eq=False)
class GravityGradient(Load):
    """The pull of a distant primary on the two ends of a body, with the reference point at the centre of mass.

        N = 3 (μ/r³) r̂ × I r̂,    V = (3/2)(μ/r³) r̂·I r̂;

    keeps the energy and L·r̂. Hughes, *Spacecraft Attitude Dynamics* (1986), § 8.1: first order in size over distance.

    Attributes
    ----------
    mu : m³/s², gravitational parameter of the primary
    position : (3,) m, in space, from the body to the primary
    """

    mu: float
    position: Float
    conservative = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", array_of(self.position, (3,), "position"))
        if not 0 < self.mu < np.inf:
            raise UsageError(f"mu is {self.mu:.6g} m³/s²: give a positive finite number")
        if not self.position.any():
            raise GeometryError("position is zero: the primary cannot be inside the body")

    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return 3 (μ/r³) r̂ × I r̂."""
        toward = quaternion.to_body(attitude, self._unit)
        return self._strength * np.cross(toward, moments * toward)

    def potential(self, attitude: Float, moments: Float) -> Float:
        """Return (3/2)(μ/r³) r̂·I r̂."""
        toward = quaternion.to_body(attitude, self._unit)
        return 0.5 * self._strength * np.asarray((moments * toward * toward).sum(axis=-1))

    def directions(self) -> Float:
        """Return two directions across r."""
        return across(self.position)

    def terms(self, moments: Float, start: float) -> Terms:
        """Return b = 3 (μ/r³) I, v = r̂."""
        return Terms.of_vector(self._unit, square=self._strength * moments)

    @property
    def _unit(self) -> Float:
        return self.position / np.linalg.norm(self.position)

    @property
    def _strength(self) -> float:
        return float(3.0 * self.mu / np.linalg.norm(self.position) ** 3)


@dataclass(frozen=True, eq=False)
class Dissipation(Load):
    """Energy lost inside the body: L is kept in space, the energy falls, and the spin ends on the largest moment.

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

    rate: float

    def __post_init__(self) -> None:
        if not 0 <= self.rate < np.inf:
            raise UsageError(f"the dissipation rate is {self.rate:.6g}: give a finite number ≥ 0 in kg m² s")

    def torque(self, time: float, attitude: Float, angular_velocity: Float, moments: Float) -> Float:
        """Return zero: nothing acts from outside."""
        return np.zeros(np.shape(angular_velocity))

    def directions(self) -> Float:
        """Return none."""
        return np.empty((0, 3))

    def terms(self, moments: Float, start: float) -> Terms:
        """Return κ."""
        return Terms(dissipation=self.rate)


def across(vector: Float) -> Float:
    """Return two unit vectors (2, 3) across `vector`; none where it is zero."""
    if not np.any(vector):
        return np.empty((0, 3))
    rows: Float = np.linalg.svd(vector[None])[2][1:]
    return rows


def check_frame(frame: str) -> None:
    """Raise `UsageError` for a frame that is neither body nor space."""
    if frame not in ("body", "space"):
        raise UsageError(f"frame is {frame!r}: a torque is given in the body or space frame")
