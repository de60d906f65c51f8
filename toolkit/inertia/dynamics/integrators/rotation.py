"""A rigid body that turns about its reference point under loads: Euler's equations and the attitude."""

from __future__ import annotations

import math
from functools import cached_property
from typing import ClassVar

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.load import Load
from inertia.dynamics.observer import Observer
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import array_of
from inertia.native import Kernel
from inertia.records import dataclass

_SLOWEST = 1e-9
"""Of the rate that the loads have elsewhere: a unit of time that is slower would leave float64."""

Figures = tuple[Float, Float, int]
"""What a kernel knows a problem by: principal moments (3,), all else in one array, and how many vectors are in it."""

_QUARTER_TURNS = np.sqrt(0.5) * (np.eye(4)[:3] + np.eye(4)[3])


@dataclass(frozen=True, eq=False)
class RotationProblem:
    """Where a body starts and what acts on it.

        I ω̇ = I ω × Ω + N(t, q, ω),    q̇ = ½ q (Ω, 0),    Ω = ω but for internal dissipation (`Dissipation`).

    Attributes
    ----------
    moments : (3,) kg m², principal, about the reference point (centre of mass or fixed point), in any order
    angular_velocity : (3,) rad/s, along the principal axes
    attitude : (4,) scalar-last, principal axes to space
    loads : what acts; along part axes is along the principal axes
    start : s, the instant at which the body is so
    mass : kg; arm : (3,) m, along the principal axes, from the reference point to the centre of mass: for gravity
    observer : what is handed samples, along the principal axes, while they are stepped
    numbers : what the axes are called in the names of what is kept
    """

    caution: ClassVar[float] = 1.0
    """What estimates of the error from two runs are multiplied by, for equations that change much within a step."""

    longest_step_follows: ClassVar[bool] = False
    """Whether no step up to `longest_step` is long against what the equations do."""

    moments: Float
    angular_velocity: Float
    attitude: Float = quaternion.IDENTITY  # type: ignore[assignment]
    loads: tuple[Load, ...] = ()
    start: float = 0.0
    mass: float = 0.0
    arm: Float = (0.0, 0.0, 0.0)  # type: ignore[assignment]
    observer: Observer | None = None
    numbers: tuple[int, ...] = (1, 2, 3)

    def __post_init__(self) -> None:
        object.__setattr__(self, "moments", array_of(self.moments, (3,), "moments"))
        object.__setattr__(self, "angular_velocity", array_of(self.angular_velocity, (3,), "angular_velocity"))
        attitude = array_of(self.attitude, (4,), "attitude")
        if (self.moments <= 0).any():
            raise GeometryError(
                f"moments are {self.moments.tolist()} kg m²: a body that is stepped needs all three > 0"
            )
        if not attitude.any():
            raise UsageError("attitude is the zero quaternion: give one of unit length")
        object.__setattr__(self, "attitude", quaternion.normalise(attitude))
        object.__setattr__(self, "loads", tuple(self.loads))
        object.__setattr__(self, "arm", array_of(self.arm, (3,), "arm"))
        if any(load.acts_on_mass for load in self.loads) and not 0 < self.mass < np.inf:
            raise GeometryError(f"mass is {self.mass:.6g} kg: gravity needs a body whose mass is positive and finite")

    def torque(self, time: float, attitude: Float, angular_velocity: Float) -> Float:
        """Return the torque (3,) of all loads along the principal axes, N m."""
        total = np.zeros(3)
        for load in self.loads:
            total = total + load.torque_at(time, attitude, angular_velocity, self)
        return total

    def rhs(self, time: float, state: Float) -> Float:
        """Return the rate (7,) of the state (q, ω), (7,), for solvers that know nothing of rotations."""
        x, y, z, w, p, q, r = state.tolist()
        a, b, c = self.moments.tolist()
        u, v, s = (b - c) * q * r / a, (c - a) * r * p / b, (a - b) * p * q / c
        if self._dissipation:
            d, e, f = self._dissipation * u / a, self._dissipation * v / b, self._dissipation * s / c
            u, v, s = u + (b * q * f - c * r * e) / a, v + (c * r * d - a * p * f) / b, s + (a * p * e - b * q * d) / c
            p, q, r = p + d, q + e, r + f
        rate = np.array(
            [
                0.5 * (w * p + y * r - z * q),
                0.5 * (w * q + z * p - x * r),
                0.5 * (w * r + x * q - y * p),
                -0.5 * (x * p + y * q + z * r),
                u,
                v,
                s,
            ]
        )
        if self.loads:
            rate[4:] += self.torque(time, quaternion.normalise(state[:4]), state[4:]) / self.moments
        return rate

    @cached_property
    def _dissipation(self) -> float:
        return sum(load.dissipation for load in self.loads)

    def terms(self, start: float) -> Terms | None:
        """Return all loads from the instant `start` to the next break as one; None where one has no such form."""
        total = Terms()
        for load in self.loads:
            terms = load.terms(self, start)
            if terms is None:
                return None
            total = total + terms
        return total

    @cached_property
    def breaks(self) -> Float:
        """Instants (k,) s at which a load has a kink or a jump, ascending."""
        return np.unique(np.concatenate([np.empty(0), *(load.breaks for load in self.loads)]))

    @cached_property
    def longest_step(self) -> float:
        """The longest step in s that steps over no pulse, as far as the loads say; infinite where they say nothing."""
        return min((load.longest_step or np.inf for load in self.loads), default=np.inf)

    @property
    def probed(self) -> bool:
        """Whether a load may have pulses, and does not say how short they are."""
        return any(load.probed for load in self.loads)

    @cached_property
    def rate(self) -> float:
        """The unit of 1/time in 1/s: |ω|, or √(|N|/I) where the loads are faster, at the start.

        It is the next power of two, so that the change of units rounds nothing.
        """
        spin = float(np.linalg.norm(self.angular_velocity))
        pull = self.torque(self.start, self.attitude, self.angular_velocity) / self.moments
        swing = float(np.sqrt(np.abs(pull).max()))
        return power_of_two(max(spin, swing, _SLOWEST * self._later) or 1.0)

    @cached_property
    def fastest(self) -> float:
        """The largest rate in 1/s of the motion, as far as the start and steady torques tell; it may grow."""
        return max(self.rate, self._later)

    @cached_property
    def _later(self) -> float:
        """The rate in 1/s of what polynomial loads do at another attitude than the first, and of damping."""
        terms = self.terms(self.start)
        if terms is None:
            return 0.0
        damped = float((terms.damping / self.moments).max())
        if not len(terms.vectors):
            return damped
        turned = [quaternion.multiply(self.attitude, turn) for turn in _QUARTER_TURNS]
        pulls = [self.torque(self.start, there, np.zeros(3)) / self.moments for there in turned]
        return max(damped, float(np.sqrt(np.abs(pulls).max())))

    @property
    def stable_step(self) -> float:
        """The longest step in s over which an explicit method does not let errors grow that the equations damp."""
        return np.inf

    @property
    def carried(self) -> Float:
        """What is integrated beside (q, ω), (k,), at the start: nothing, but for problems with a `rhs` of their own."""
        return np.empty(0)

    @property
    def dop853(self) -> tuple[Kernel, Figures] | None:
        """The kernel of DOP853 for a `rhs` of its own, and the figures that it takes; None where there is none."""
        return None

    @property
    def unit(self) -> Float:
        """The units (7 + k,) of the state: 1, and `rate` of ω."""
        return np.array([1.0] * 4 + [self.rate] * 3)

    def energy(self, attitude: Float, angular_velocity: Float) -> Float:
        """Return kinetic plus potential energy (…) in J."""
        total = 0.5 * np.asarray((self.moments * angular_velocity**2).sum(axis=-1))
        for load in self.loads:
            total = total + load.potential(attitude, self)
        return total

    def angular_momentum(self, attitude: Float, angular_velocity: Float) -> Float:
        """Return L (…, 3) in space, kg m²/s."""
        return quaternion.to_space(attitude, self.moments * angular_velocity)

    def invariants(self, attitude: Float, angular_velocity: Float) -> dict[str, Float]:
        """Return what the loads keep, over the samples: the energy, L or its components, one along a body axis."""
        invariants: dict[str, Float] = {}
        if all(load.conservative for load in self.loads):
            invariants["energy"] = self.energy(attitude, angular_velocity)
        momentum = self.angular_momentum(attitude, angular_velocity)
        directions = self._kept_directions
        if len(directions) == 3:
            invariants["angular momentum"] = momentum
        else:
            for row in directions:
                name = ", ".join(f"{x:.4g}" for x in row)
                invariants[f"angular momentum along ({name}) in space"] = momentum @ row
        for k in self._symmetry_axes:
            name = f"angular momentum about body axis {self.numbers[k]}"
            invariants[name] = self.moments[k] * angular_velocity[..., k]
        return invariants

    def drift(self, attitude: Float, angular_velocity: Float) -> float:
        """Return by how much of itself what the loads keep drifts from the start over the states (n, 4) and (n, 3)."""
        q, w = np.vstack([self.attitude, attitude]), np.vstack([self.angular_velocity, angular_velocity])
        momentum = float(np.linalg.norm(self.moments * w, axis=1).max())
        strayed = 0.0
        for name, values in self.invariants(q, w).items():
            rows = values.reshape(len(q), -1)
            if name == "energy":
                potential = sum(float(np.abs(load.potential(q, self)).max()) for load in self.loads)
                scale = 0.5 * float((self.moments * w**2).sum(axis=1).max()) + potential
            else:
                scale = momentum
            strayed = max(strayed, float(np.linalg.norm(rows - rows[0], axis=1).max()) / (scale or 1.0))
        return strayed

    @cached_property
    def _kept_directions(self) -> Float:
        """Directions (k, 3) in space across all torques."""
        spanned = np.concatenate([np.empty((0, 3)), *(load.directions() for load in self.loads)])
        sizes = np.linalg.norm(spanned, axis=1)
        spanned = spanned[sizes > 0] / sizes[sizes > 0, None]
        if not len(spanned):
            return np.eye(3)
        _, values, rows = np.linalg.svd(spanned)
        basis: Float = rows[int((values > 1e-9).sum()) :]
        largest = np.take_along_axis(basis, np.abs(basis).argmax(axis=1)[:, None], axis=1)
        return basis * np.sign(largest) + 0.0

    @cached_property
    def _symmetry_axes(self) -> list[int]:
        """Axes of revolution about which no load has a torque."""
        parts = [None if load.breaks.size else load.terms(self, self.start) for load in self.loads]
        symmetric = [k for k in range(3) if self.moments[(k + 1) % 3] == self.moments[(k + 2) % 3]]
        return [k for k in symmetric if all(terms and self._turns_freely(k, terms) for terms in parts)]

    def _turns_freely(self, axis: int, terms: Terms) -> bool:
        b, c = (axis + 1) % 3, (axis + 2) % 3
        return not (
            terms.torque[axis]
            or terms.damping[axis]
            or terms.dissipation
            or terms.matrices[:, axis].any()
            or (terms.squares[:, b] != terms.squares[:, c]).any()
        )


def power_of_two(value: float) -> float:
    """Return the least power of two above a positive value."""
    return math.ldexp(1.0, math.frexp(value)[1])
