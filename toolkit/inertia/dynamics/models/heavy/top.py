"""The heavy symmetric top about a fixed point: its quantities, and its motion in closed form (textbook § 13.23).

Space z is up and gravity points along −z; the symmetry axis is body axis 3, and the centre of mass lies on it at the
signed distance h from the fixed point, so that the potential energy is mgh cosθ. Moments are those about the fixed
point. Angles are z-x-z: φ about the vertical, θ the tilt of axis 3, ψ about axis 3.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import to_angles
from inertia.dynamics.models.heavy.initial_conditions import EPSILON, Real, of_integrals, of_state
from inertia.dynamics.models.heavy.motion import against_vertical, follow, integrals, turning_times
from inertia.dynamics.models.heavy.nutation import Nutation
from inertia.dynamics.motion import Event, Motion
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import array_of
from inertia.records import dataclass

Kind = Literal["sleeping", "steady precession", "pendulum", "cusp", "loops", "no reversal"]

State = tuple[tuple[Real, Real], Real, tuple[Real, ...], tuple[Real, ...]]
"""Moments (I1, I3), mgh, attitude (4,) and ω (3,)."""

MOST_EVENTS = 1000
"""How many turning points `solve_heavy_top` lists as events."""

CUSP = 1e-9
"""Speed of the axis at its upper turning point, relative to the lower one, below which it is a cusp."""

_MOST = 700.0  # exp of more is no float64

_ROUNDINGS = 16.0
"""Roundings of the start that nutation, momenta or the speed at a cusp are told from nothing by."""


@dataclass(frozen=True)
class HeavyTop:
    """A heavy symmetric top and the three integrals of its motion.

    Attributes
    ----------
    I1, I3 : moments about the fixed point, kg m²: I1 = I2 transverse, I3 about the symmetry axis; 0 of a spherical
        pendulum, which turns about that as it starts, as a top does whose I3 is as small as one likes
    mgh : mass × gravity × height of the centre of mass over the fixed point along axis 3, N m; negative where it hangs
    p_phi : I1 φ̇ sin²θ + p_ψ cosθ, the vertical angular momentum, kg m²/s
    p_psi : I3 (φ̇ cosθ + ψ̇), the angular momentum along axis 3, kg m²/s
    energy : ½ I1 (θ̇² + φ̇² sin²θ) + p_ψ²/(2 I3) + mgh cosθ, J
    start : moments, mgh, attitude (4,) and ω (3,) that all of these follow from, which then decide what they round off

    Raises `GeometryError` where the moments are no body's or the energy is below the least possible.

    >>> top = HeavyTop.of_state((1.0, 0.5), 2.0, [0.3, 0, 0, 0.9], [0, 0, 8.0])  # let go at rest but for its spin
    >>> top.kind, [round(angle, 6) for angle in top.turning_angles]
    ('cusp', [0.643501, 0.85216])
    """

    I1: float
    I3: float
    mgh: float
    p_phi: float
    p_psi: float
    energy: float
    start: State | None = None

    def __post_init__(self) -> None:
        values = array_of([self.I1, self.I3, self.mgh, self.p_phi, self.p_psi, self.energy], (6,), "heavy top")
        if not values[0] > 0 or not 0 <= values[1] <= 2.0 * values[0] * (1 + 1e-9):
            raise GeometryError(
                f"the moments I1 = I2 = {self.I1:.6g} and I3 = {self.I3:.6g} kg m² are no body's: "
                "I1 must be positive, and I3 not negative and at most 2 I1"
            )
        if not self.I3 and self.p_psi:
            raise GeometryError(f"p_psi = {self.p_psi:.6g} kg m²/s takes a moment I3, which is 0: give one of them")
        _ = self.nutation  # raises

    @classmethod
    def of_state(
        cls,
        moments: tuple[float, float],
        mgh: float,
        attitude: ArrayLike,
        angular_velocity: ArrayLike,
        exact: State | None = None,
    ) -> HeavyTop:
        """Take the integrals from moments (I1, I3), an attitude (4,) xyzw and ω (3,) rad/s along the body axes.

        `exact` are these four before they were rounded to float64, as rationals.
        """
        i1, i3 = array_of(moments, (2,), "moments").tolist()
        q, omega = array_of(attitude, (4,), "attitude"), array_of(angular_velocity, (3,), "angular_velocity")
        if not q.any():
            raise UsageError("the attitude is zero: give a quaternion (x, y, z, w)")
        (energy,), (p_phi,), (p_psi,) = integrals((i1, i3), mgh, quaternion.normalise(q)[None], omega[None])
        start = exact or ((i1, i3), float(mgh), tuple(q.tolist()), tuple(omega.tolist()))
        return cls(i1, i3, float(mgh), float(p_phi), float(p_psi), float(energy), start)

    @cached_property
    def nutation(self) -> Nutation:
        """The constants of the closed form."""
        if self.start is None:
            return of_integrals((self.I1, self.I3), self.mgh, self.p_phi, self.p_psi, self.energy)
        return of_state(*self.start)

    @property
    def effective_energy(self) -> float:
        """E′ = E − p_ψ²/(2 I3) = ½ I1 θ̇² + V(θ), J."""
        return self.energy - (self.p_psi**2 / (2.0 * self.I3) if self.I3 else 0.0)

    def effective_potential(self, theta: ArrayLike) -> Float:
        """Return V(θ) = (p_φ − p_ψ cosθ)²/(2 I1 sin²θ) + mgh cosθ in J; infinite where the vertical is out of reach."""
        half = 0.5 * np.asarray(theta, dtype=np.float64)
        s, c = np.sin(half), np.cos(half)
        # p_φ − p_ψ cosθ over sinθ, from the pole that is nearer
        far, near, pole = np.where(s < c, s, c), np.where(s < c, c, s), np.where(s < c, 1.0, -1.0)
        apart = self.p_phi - pole * self.p_psi
        apart = np.where(np.abs(apart) <= 4.0 * EPSILON * abs(self.p_psi), 0.0, apart)
        with np.errstate(divide="ignore", invalid="ignore"):
            rest = np.where(apart == 0, 0.0, apart / (2.0 * far * near))
        flow = rest + pole * self.p_psi * far / near
        return np.asarray(flow**2 / (2.0 * self.I1) + self.mgh * (c - s) * (c + s))

    @property
    def turning_angles(self) -> tuple[float, float]:
        """θ₁ ≤ θ₂ in rad, between which the axis nods; equal for a steady precession and a sleeping top."""
        n = self.nutation
        halves = zip(n.rises, n.falls, strict=True) if n.hanging else zip(n.falls, n.rises, strict=True)
        first, second = sorted(2.0 * math.atan2(math.sqrt(s2), math.sqrt(c2)) for s2, c2 in halves)
        return first, second

    @property
    def kind(self) -> Kind:
        """The kind of nutation, named within the rounding of what the top was made from.

        "sleeping" where the axis stays vertical, up or down; "steady precession" where θ stays; "pendulum" where both
        momenta vanish; else by φ̇: it stops at the upper turning point in a "cusp", changes sign in "loops", or there
        is "no reversal".
        """
        n, (first, second) = self.nutation, self.turning_angles
        pace = n.speeds[0] + (abs(self.p_psi) * (1.0 / self.I1 + 1.0 / self.I3) if self.I3 else 0.0)
        noise = _ROUNDINGS * n.noise
        slack = 0.0 if n.still else noise * (1.0 + pace / n.rate)
        if second <= slack or math.pi - first <= slack:
            return "sleeping"
        if second - first <= slack:
            return "steady precession"
        if max(abs(self.p_phi), abs(self.p_psi)) <= noise * self.I1 * n.speeds[0]:
            return "pendulum"
        if n.mc and n.speeds[1] <= max(noise * pace, CUSP * n.speeds[0]):
            return "cusp"  # on the separatrix the axis comes to rest too, but at the vertical
        return "loops" if n.reverses else "no reversal"

    @property
    def nutation_period(self) -> float:
        """Time in s from one least tilt to the next; that of small nutations where there are none.

        Infinite where the axis takes for ever to reach the vertical, or falls from it if disturbed.
        """
        return 1.0 / self.nutation.cycles[0] if self.nutation.cycles[0] else math.inf

    @property
    def precession_rate(self) -> float:
        """Mean φ̇ over a period of nutation, rad/s; not a number where the axis is vertical or on its way there."""
        return float(self.nutation.gain * self.nutation.cycles[0])

    def steady_precession(self, tilt: float) -> tuple[float, float]:
        """Return the slow and the fast φ̇ in rad/s at which the top precesses steadily at `tilt` with its p_ψ.

        The roots of I1 cosθ φ̇² − p_ψ φ̇ + mgh = 0, with p_φ − p_ψ cosθ = I1 φ̇ sin²θ (textbook § 13.23); the fast one is
        infinite at the horizontal.

        Raises `GeometryError` where |p_ψ| is below `least_p_psi`.

        >>> HeavyTop(1.0, 0.5, 2.0, 0.0, 3.0, 9.0).steady_precession(math.pi / 3)
        (0.76393202250021, 5.23606797749979)
        """
        level = self.I1 * math.cos(tilt) if abs(math.cos(tilt)) > EPSILON else 0.0
        weight = 4.0 * self.mgh * level
        square = self.p_psi**2 - weight
        if square < -8.0 * EPSILON * abs(weight) or not (square or weight or self.p_psi):
            raise GeometryError(
                f"p_psi = {self.p_psi:.6g} kg m²/s is too small for a steady precession at a tilt of {tilt:.6g} rad: "
                f"it must {f'be at least {self.least_p_psi(tilt):.6g}' if weight else 'not vanish'} in size"
            )
        double = self.p_psi + math.copysign(math.sqrt(max(square, 0.0)), self.p_psi)
        return 2.0 * self.mgh / double, double / (2.0 * level) if level else math.copysign(math.inf, double)

    def least_p_psi(self, tilt: float) -> float:
        """Return the least |p_ψ| in kg m²/s with which a steady precession at `tilt` exists: √(4 mgh I1 cosθ), or 0."""
        return 2.0 * math.sqrt(max(self.mgh * self.I1 * math.cos(tilt), 0.0))

    @property
    def sleeps_stably(self) -> bool:
        """Whether the upright axis is stable at this p_ψ: p_ψ² ≥ 4 mgh I1, that is |p_ψ| ≥ `least_p_psi` (0)."""
        return self.p_psi**2 >= 4.0 * self.mgh * self.I1

    @property
    def growth_rate(self) -> float:
        """Rate in s⁻¹ at which a small tilt from upright grows: √(4 mgh I1 − p_ψ²)/(2 I1), or 0."""
        return math.sqrt(max(4.0 * self.mgh * self.I1 - self.p_psi**2, 0.0)) / (2.0 * self.I1)


def solve_heavy_top(
    moments: tuple[float, float],
    mgh: float,
    attitude: ArrayLike,
    angular_velocity: ArrayLike,
    time: ArrayLike,
    exact: State | None = None,
) -> Motion:
    """Return the motion of a heavy symmetric top about a fixed point, in closed form, at any instants.

    Input is taken as the exact numbers that it is in float64; the error of the attitude is a few roundings, however
    long the time and however close the top to the vertical, to a separatrix or to a steady precession.

    Parameters
    ----------
    moments : (I1, I3) kg m², about the fixed point
    mgh : N m, negative where the centre of mass is at the −3 side of the fixed point
    attitude : (4,) at t = 0, body to space, z up
    angular_velocity : (3,) rad/s at t = 0, along the body axes
    time : (n,) s, in any order and of either sign
    exact : moments, mgh, attitude and ω before they were rounded to float64, as rationals

    Returns
    -------
    A `Motion` with the invariants "energy" (J), "p_phi" and "p_psi" (kg m²/s); the quantities "theta", "phi", "psi"
    (n,) and "turning theta" (2,) in rad, "effective potential energy" (n,) in J, "nutation period" in s and "precession
    rate" in rad/s; and the events "turning point", the first `MOST_EVENTS` of them.

    Raises `GeometryError` where the moments are no body's, `UsageError` for an argument that cannot be used.

    >>> motion = solve_heavy_top((1.0, 0.5), 2.0, [0.3, 0, 0, 0.9], [0, 0, 8.0], [0.0, 1e6])
    >>> motion.reached < 1e-14, motion.events[0].what
    (True, 'theta is least, 0.643501 rad')
    """
    top = HeavyTop.of_state(moments, mgh, attitude, angular_velocity, exact)
    n, t = top.nutation, array_of(time, (np.size(time),), "time")
    attitudes, omega = follow(n, top.p_psi / top.I1, attitude, angular_velocity, t)
    energy, p_phi, p_psi = integrals(moments, mgh, attitudes, omega)
    height, level, across = against_vertical(attitudes, omega)
    flow = np.where(level > 0, across / np.where(level > 0, level, 1.0), 0.0)  # φ̇ sinθ
    phi, theta, psi = to_angles(attitudes).T
    span = float(np.max(np.abs(t), initial=0.0))
    momentum = float(np.max(np.linalg.norm(omega * (top.I1, top.I1, top.I3), axis=-1), initial=0.0))
    momentum += math.sqrt(top.I1 * abs(mgh))  # a top that is at rest keeps none
    return Motion(
        attitude=attitudes,
        angular_velocity=omega,
        method=_method(n),
        reached=_rounding(n, span) + _left_out(top, span),
        invariants={"energy": energy, "p_phi": p_phi, "p_psi": p_psi},
        scales={"energy": float(np.max(energy - mgh * height, initial=0.0)) + abs(mgh)}
        | dict.fromkeys(("p_phi", "p_psi"), momentum),
        quantities={
            "theta": theta,
            "phi": phi,
            "psi": psi,
            "turning theta": np.array(top.turning_angles),
            "effective potential energy": 0.5 * top.I1 * flow * flow + mgh * height,
            "nutation period": np.array(top.nutation_period),
            "precession rate": np.array(top.precession_rate),
        },
        events=_turning_points(top, t),
        warnings=_warnings(top),
    )


def _method(n: Nutation) -> str:
    if n.still:
        return "closed form: steady rotation about an axis at rest"
    return "closed form: Jacobi elliptic functions" if n.mc else "closed form: hyperbolic functions, on the separatrix"


def _rounding(n: Nutation, span: float) -> float:
    """Return an estimate in rad of the largest error up to t = ± span: roundings of w and of phases that grow with it,
    and of the double-doubles that multiply a time."""
    farthest = min(n.quarter, abs(n.start) + n.rate * span)
    secular = (abs(n.upper.rate[0]) + abs(n.lower.rate[0]) + n.rate) * span
    return float(EPSILON * (32.0 + 2.0 * farthest + EPSILON * secular))


def _left_out(top: HeavyTop, span: float) -> float:
    """Return what becomes of a tilt that is so small that the axis was taken as at rest upright, at most π."""
    rate = math.sqrt(max(4.0 * abs(top.mgh) * top.I1 - top.p_psi**2, 0.0)) / (2.0 * top.I1)
    if top.start is None or not top.nutation.still or not rate:
        return 0.0
    _, mgh, (x, y, z, w), (o1, o2, _) = top.start
    level, upright = math.hypot(x, y), math.hypot(z, w)
    off, other = (level, upright) if mgh > 0 else (upright, level)
    if off > other:  # it hangs
        return 0.0
    disturbed = 2.0 * off / other + math.hypot(o1, o2) / rate
    return min(disturbed * math.exp(min(rate * span, _MOST)), math.pi)


def _turning_points(top: HeavyTop, time: Float) -> tuple[Event, ...]:
    if not time.size or top.kind in ("sleeping", "steady precession"):
        return ()
    times, upper = turning_times(top.nutation, float(time.min()), float(time.max()), MOST_EVENTS)
    least = upper.astype(bool) != top.nutation.hanging
    what = [
        f"theta is {name}, {angle:.6g} rad"
        for name, angle in zip(("least", "greatest"), top.turning_angles, strict=True)
    ]
    return tuple(
        Event("turning point", float(t), what[0] if up else what[1]) for t, up in zip(times, least, strict=True)
    )


def _warnings(top: HeavyTop) -> tuple[str, ...]:
    n = top.nutation
    if not n.still or n.rate or not top.growth_rate:
        return ()
    return (
        f"the upright axis is unstable, p_psi = {top.p_psi:.6g} kg m²/s being less than {top.least_p_psi(0.0):.6g} in "
        f"size: a disturbance grows by a factor e in {1.0 / top.growth_rate:.3g} s",
    )
