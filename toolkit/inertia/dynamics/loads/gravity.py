"""Gravity, uniform or that of a distant primary, which pulls more at the nearer end of a body."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np

from inertia.arrays import Float, cross
from inertia.documents import number, numbers
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.load import Load, TurningBody, across
from inertia.errors import FieldPath, GeometryError
from inertia.records import dataclass

STANDARD_GRAVITY = (0.0, 0.0, -9.80665)


@dataclass(frozen=True, eq=False)
class Gravity(Load):
    """Uniform gravity.

    About the reference point N = c × m Rᵀg, V = −m g·(R c); keeps the energy and L·g.

    Attributes
    ----------
    acceleration : (3,) m/s², in space

    >>> from inertia.dynamics.integrators.rotation import RotationProblem
    >>> top = RotationProblem([1, 1, 1], [0, 0, 0], loads=[Gravity([0, 0, -10])], mass=2.0, arm=[0, 0, 0.1])
    >>> tilted = quaternion.from_rotation_vector([np.pi / 2, 0, 0])
    >>> top.torque(0.0, tilted, np.zeros(3)).round(12).tolist()
    [2.0, 0.0, 0.0]
    """

    kind = "gravity"
    noun = "gravity"
    acts_on_mass = True
    conservative = True

    acceleration: Annotated[Float, numbers((3,), "m/s²")] = STANDARD_GRAVITY  # type: ignore[assignment]

    @property
    def idle(self) -> bool:
        """Whether the acceleration is zero."""
        return not np.any(self.acceleration)

    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return c × m Rᵀg."""
        return cross(body.arm, body.mass * quaternion.to_body(attitude, self.acceleration))

    def potential(self, attitude: Float, body: TurningBody) -> Float:
        """Return −m g·(R c), zero with the centre of mass level with the reference point."""
        return -body.mass * np.asarray(quaternion.to_space(attitude, body.arm) @ self.acceleration)

    def directions(self) -> Float:
        """Return two directions across g."""
        return across(self.acceleration)

    def terms(self, body: TurningBody, start: float) -> Terms:
        """Return A = m [c]×, v = g."""
        x, y, z = body.mass * body.arm
        return Terms.of_vector(self.acceleration, matrix=np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]))

    def described(self, listed: Callable[[Float | float], str]) -> str:
        """Return the acceleration."""
        return f"gravity {listed(self.acceleration)} m/s²"


@dataclass(frozen=True, eq=False)
class GravityGradient(Load):
    """The pull of a distant primary on the two ends of a free body, about its centre of mass.

        N = 3 (μ/r³) r̂ × I r̂,    V = (3/2)(μ/r³) r̂·I r̂;

    keeps the energy and L·r̂. Hughes, *Spacecraft Attitude Dynamics* (1986), § 8.1: first order in size over distance.

    Attributes
    ----------
    mu : m³/s², gravitational parameter of the primary
    position : (3,) m in space, from the body to the primary

    Raises `GeometryError` where the primary is inside the body.
    """

    kind = "gravity_gradient"
    noun = "the gravity gradient"
    starts_motion = True
    free_bodies_only = True
    conservative = True

    mu: Annotated[float, number("m³/s²", positive=True)]
    position: Annotated[Float, numbers((3,), "m")]

    def require_sense(self, path: str) -> None:
        """Raise `GeometryError` where the primary is inside the body."""
        if not self.position.any():
            raise GeometryError(FieldPath(f"{path}.position"), " is zero: the primary cannot be inside the body")

    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return 3 (μ/r³) r̂ × I r̂."""
        toward = quaternion.to_body(attitude, self._unit)
        return self._strength * across_gradient(toward, body.moments)

    def potential(self, attitude: Float, body: TurningBody) -> Float:
        """Return (3/2)(μ/r³) r̂·I r̂."""
        toward = quaternion.to_body(attitude, self._unit)
        return 0.5 * self._strength * np.asarray((body.moments * toward * toward).sum(axis=-1))

    def directions(self) -> Float:
        """Return two directions across r."""
        return across(self.position)

    def terms(self, body: TurningBody, start: float) -> Terms:
        """Return b = 3 (μ/r³) (I − I₂), v = r̂: what all moments have in common turns nothing, and would cost digits."""
        return Terms.of_vector(self._unit, square=self._strength * (body.moments - np.median(body.moments)))

    def described(self, listed: Callable[[Float | float], str]) -> str:
        """Return where the primary is, and how strong."""
        return f"gravity gradient of μ = {listed(self.mu)} m³/s² at {listed(self.position)} m"

    @property
    def _unit(self) -> Float:
        return self.position / np.linalg.norm(self.position)

    @property
    def _strength(self) -> float:
        return float(3.0 * self.mu / np.linalg.norm(self.position) ** 3)


def across_gradient(toward: Float, moments: Float) -> Float:
    """Return r̂ × I r̂ (…, 3) from differences of moments, so that near equal ones keep their digits."""
    following, after = [1, 2, 0], [2, 0, 1]
    return (moments[after] - moments[following]) * toward[..., following] * toward[..., after]
