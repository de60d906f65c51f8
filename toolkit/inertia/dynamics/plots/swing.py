"""A motion of one angle: its rate, the potential (or effective potential) it moves in, and curves of equal energy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import from_angles
from inertia.dynamics.models.heavy.top import HeavyTop
from inertia.dynamics.motion import Motion
from inertia.dynamics.plots.subject import Subject
from inertia.records import dataclass

_LEVELS, _ANGLES = 9, 201
_UPRIGHT = 1e-9  # sine of a tilt, below which it has no direction to change in
_TURNS = 40.0  # that a window shows at most, for curves of equal energy to be told apart
_BESIDE, _BEYOND = 0.15, 0.25  # of its range, that is shown on either side of the angle, and of the rate


@dataclass(frozen=True, eq=False)
class Swing:
    """A motion with the energy ½ J θ̇² + V(θ).

    Attributes
    ----------
    inertia : kg m², J
    potential : returns V (m,) in J at angles (m,) in rad
    rate_of : returns θ̇ (m,) of ω (m, 3) rad/s in space, at attitudes (m, 4) and angles (m,)
    barrier : J, greatest V of all angles, where a body that has more goes round; None where there is none
    """

    inertia: float
    potential: Callable[[Float], Float]
    rate_of: Callable[[Float, Float, Float], Float]
    barrier: float | None = None

    def energy(self, angle: Float, rate: Float) -> Float:
        """Return ½ J θ̇² + V(θ) (m,) J of angles (m,) rad and rates (m,) rad/s."""
        return np.asarray(0.5 * self.inertia * rate**2 + self.potential(angle))

    def rates(self, energy: float, angles: Float) -> Float:
        """Return θ̇ ≥ 0 (m,) that a body of this energy has at angles (m,), NaN beyond those where it turns.

        >>> swing = Swing(2.0, np.square, lambda omega, attitude, angle: angle)
        >>> swing.rates(4.0, np.array([-3.0, -2.0, 0.0, 2.0, 3.0])).tolist()
        [nan, 0.0, 2.0, 0.0, nan]
        """
        left = energy - np.asarray(self.potential(angles))
        reached, moving = left >= 0, left > 0
        rates = np.sqrt(np.where(reached, 2.0 * left / self.inertia, 0.0))
        reached[1:] |= moving[:-1]  # a step further, so that the two halves of a curve meet
        reached[:-1] |= moving[1:]
        return np.asarray(np.where(reached, rates, np.nan))

    def draws_levels(self, window: Window) -> bool:
        """Say whether curves of equal energy tell something: not where V is even, or goes up and down too often."""
        if self.barrier is not None and window.right - window.left > 2.0 * np.pi * _TURNS:
            return False
        return bool(np.ptp(self.potential(np.linspace(window.left, window.right, _ANGLES))))

    def levels(self, window: Window) -> Float:
        """Return energies (k,) J whose curves of (θ, θ̇) spread over a window."""
        angles = np.linspace(window.left, window.right, _ANGLES)
        most = 0.5 * self.inertia * max(window.low**2, window.high**2)
        values = np.asarray(self.potential(angles))
        low, high = float(values.min()), float(np.median(values)) + most
        return np.linspace(low, high, _LEVELS + 2)[1:-1]


@dataclass(frozen=True)
class Window:
    """What of the plane of θ (rad) and θ̇ (rad/s) is shown."""

    left: float
    right: float
    low: float
    high: float

    def shows(self, rates: Float) -> bool:
        """Say whether a curve of rates (m,), NaN where there is none, at angles within the window comes into it."""
        return bool(((rates >= self.low) & (rates <= self.high)).any())

    @classmethod
    def around(cls, angle: Float, rate: Float) -> Window:
        """Take the range of a motion (n,), and some room."""
        width = max(float(np.ptp(angle)), 0.2)
        height = max(float(np.ptp(rate)), 1e-3 * float(np.abs(rate).max()), 1e-9)
        return cls(
            float(angle.min()) - _BESIDE * width,
            float(angle.max()) + _BESIDE * width,
            float(rate.min()) - _BEYOND * height,
            float(rate.max()) + _BEYOND * height,
        )


def swing_of(run: Subject) -> Swing | None:
    """Return the angle of a body on an axle, or the tilt of a heavy symmetric top; None of other motions."""
    if "angle" in run.quantities:
        return _on_axle(run)
    if "effective potential energy" in run.quantities:
        return _of_top(run)
    return None


def heavy_top_of(run: Subject) -> HeavyTop:
    """Return the heavy symmetric top that a run starts as."""
    plan = run.plan
    start = from_angles([float(run.quantities[name][0]) for name in ("phi", "theta", "psi")])
    weight = plan.problem.weight * float(np.linalg.norm(plan.problem.arm))
    moments = float(plan.moments[0]), float(plan.moments[2])
    return HeavyTop.of_state(moments, weight, start, run.angular_velocity[0] @ plan.axes)


def _of_top(run: Subject) -> Swing:
    """θ̇ = −(ω × a)·u / sinθ, with the axis a and the vertical u."""
    top = heavy_top_of(run)
    gravity = run.plan.problem.scene.gravity
    down, along = gravity / np.linalg.norm(gravity), run.plan.axes[:, 2]

    def rate_of(omega: Float, attitude: Float, angle: Float) -> Float:
        falling = np.cross(omega, quaternion.to_space(attitude, np.broadcast_to(along, omega.shape))) @ down
        sine = np.sin(angle)
        return np.asarray(np.divide(falling, sine, out=np.zeros_like(sine), where=sine > _UPRIGHT))

    return Swing(top.I1, top.effective_potential, rate_of)


def _on_axle(run: Subject) -> Swing:
    candidate, held = run.plan.candidate, run.plan.problem.scene.constraint
    axis = candidate.axes.T @ run.plan.problem.axle
    start = candidate.attitude
    around = quaternion.to_space(start, axis)

    def potential(angles: Float) -> Float:
        attitude = quaternion.multiply(quaternion.from_rotation_vector(angles[:, None] * around), start)
        spring = {"energy of the spring": 0.5 * held.stiffness * (angles - held.rest_angle) ** 2}
        at_rest = Motion(attitude, np.zeros((len(angles), 3)), "", 0.0, quantities=spring)
        return candidate.model.energy(candidate, at_rest)

    hills = potential(np.linspace(-np.pi, np.pi, 1441))
    barrier = float(hills.max()) if not held.stiffness and np.ptp(hills) > 0 else None
    inertia = float(axis @ (candidate.moments * axis))
    return Swing(inertia, potential, lambda omega, *_: np.asarray(omega @ around), barrier)
