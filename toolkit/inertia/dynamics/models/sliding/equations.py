"""The equations of a ball-shaped body that slides on a plane with friction, its centre of mass anywhere in the ball.

The plane is z = 0 of its own axes, k its normal; b leads from the centre of mass to the centre of the ball, and so the
point of contact is at a = b − R k from the centre of mass whatever the attitude, and its velocity is u = v + ω × a.

    m v̇ = F + m g,    I ω̇ = I ω × ω + a × F,    F = N (k − μ u/√(u² + u₀²)),    u · k = 0.

The friction is Coulomb's, made smooth below the slip speed u₀: with u ≫ u₀ it is μ N, with u ≪ u₀ viscous, −(μ/u₀) N u,
the law that analyses of the tippe top take. Coulomb's own law jumps at u = 0, where the contact would stick and slip in
turn, which no error estimate survives. The normal force follows from u · k = 0:

    N [1/m + (b × k) · I⁻¹ (a × (k − μ u/√…))] = −g·k − (b × k) · I⁻¹ (I ω × ω) − k · (ω × (ω × b)).

Moffatt & Shimomura, Nature 416 (2002) 385; Bou-Rabee, Marsden & Romero, SIAM J. Appl. Dyn. Syst. 3 (2004) 352;
Rauch-Wojciechowski, Sköldstam & Glad, Regul. Chaotic Dyn. 10 (2005) 333.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import ClassVar

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.rotation import Figures, RotationProblem, power_of_two
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError
from inertia.native import Kernel
from inertia.records import dataclass

_KERNEL = Kernel("inertia.dynamics.integrators.sliding_kernel", "slide", "ppipidddipddpp")


@dataclass(frozen=True, eq=False)
class SlidingBall(RotationProblem):
    """A ball that slides: where it starts, in the axes of the plane, and what holds it there.

    Beside (q, ω) it carries the velocity and the place of the centre of mass along the plane, (2,) m/s and (2,) m, and
    the heat that friction has made, J. `arm`, along the principal axes, is b.

    Attributes
    ----------
    radius : m, of the ball; friction : μ; slip_speed : u₀ in m/s
    gravity : (3,) m/s², towards the plane
    velocity : (2,) m/s, of the centre of mass along the plane at the start
    """

    caution: ClassVar[float] = 1.5
    longest_step_follows: ClassVar[bool] = True

    radius: float = 1.0
    friction: float = 0.0
    slip_speed: float = 1.0
    gravity: Float = (0.0, 0.0, -9.80665)  # type: ignore[assignment]
    velocity: Float = (0.0, 0.0)  # type: ignore[assignment]

    @property
    def carried(self) -> Float:
        """Velocity, place and heat at the start; the point of contact is then at the origin."""
        up = quaternion.to_body(self.attitude, [0.0, 0.0, 1.0])
        away = quaternion.to_space(self.attitude, self.arm - self.radius * up)
        return np.array([*self.velocity, -away[0], -away[1], 0.0])

    @cached_property
    def rate(self) -> float:
        """The unit of 1/time in 1/s: √(ω² + g/R) at the start."""
        square = float(self.angular_velocity @ self.angular_velocity) - float(self.gravity[2]) / self.radius
        return power_of_two(math.sqrt(square))

    @property
    def longest_step(self) -> float:
        """1/`rate` in s: what grows from below a tolerance grows at its own rate only where steps follow it."""
        return 1.0 / self.rate

    @cached_property
    def stable_step(self) -> float:
        """5/λ in s, λ being the rate at which friction takes slip away where it is viscous: DOP853 is stable to 6/λ."""
        reach = self.radius + float(np.linalg.norm(self.arm))
        mobility = 1.0 / self.mass + reach**2 / float(self.moments.min())
        decay = self.friction * -float(self.gravity[2]) * self.mass / self.slip_speed * mobility
        return 5.0 / decay if decay else np.inf

    @cached_property
    def unit(self) -> Float:
        """The units (12,) of the state: 1, the rate, R times the rate, R, and m R² times the square of the rate."""
        pace = self.radius * self.rate
        return np.array([1.0] * 4 + [self.rate] * 3 + [pace] * 2 + [self.radius] * 2 + [self.mass * pace**2])

    @cached_property
    def dop853(self) -> tuple[Kernel, Figures]:
        """The kernel, and the figures in units of the mass, R and 1/`rate`."""
        pace = self.radius * self.rate
        arm, gravity = self.arm / self.radius, np.asarray(self.gravity) / (pace * self.rate)
        figures = np.array([*arm, *gravity, self.friction, self.slip_speed / pace])
        return _KERNEL, (self.moments / (self.mass * self.radius**2), figures, 0)

    def terms(self, start: float) -> Terms | None:
        """Return None: friction is no polynomial."""
        return None

    def invariants(self, attitude: Float, angular_velocity: Float) -> dict[str, Float]:
        """Return nothing: friction and the plane keep neither energy nor L."""
        return {}

    def rhs(self, time: float, state: Float) -> Float:
        """Return the rate (12,) of the state, as `integrators.sliding_kernel` does in other units."""
        x, y, z, w, p, q, r, v, o, _, _, _ = state.tolist()
        i, j, k = self._moments
        b1, b2, b3 = self._arm
        scale = 2.0 / (x * x + y * y + z * z + w * w)
        # The plane's axes in the body: two along it, and its normal.
        e1, e2, e3 = 1.0 - scale * (y * y + z * z), scale * (x * y - z * w), scale * (x * z + y * w)
        f1, f2, f3 = scale * (x * y + z * w), 1.0 - scale * (x * x + z * z), scale * (y * z - x * w)
        n1, n2, n3 = scale * (x * z - y * w), scale * (y * z + x * w), 1.0 - scale * (x * x + y * y)
        a1, a2, a3 = b1 - self.radius * n1, b2 - self.radius * n2, b3 - self.radius * n3
        c1, c2, c3 = q * a3 - r * a2, r * a1 - p * a3, p * a2 - q * a1
        s, t = v + c1 * e1 + c2 * e2 + c3 * e3, o + c1 * f1 + c2 * f2 + c3 * f3
        square = s * s + t * t
        drag = self.friction / math.sqrt(square + self.slip_speed**2)
        # (b × k)/I, and what turns the body without a force
        h1, h2, h3 = (b2 * n3 - b3 * n2) / i, (b3 * n1 - b1 * n3) / j, (b1 * n2 - b2 * n1) / k
        g1, g2, g3 = (j - k) * q * r, (k - i) * r * p, (i - j) * p * q
        inward = (p * n1 + q * n2 + r * n3) * (p * b1 + q * b2 + r * b3)
        inward -= (p * p + q * q + r * r) * (b1 * n1 + b2 * n2 + b3 * n3)
        pull = -self._gravity[2] - (h1 * g1 + h2 * g2 + h3 * g3) - inward
        if pull < 0:  # the plane would have to hold the ball down: it then does so without friction
            drag = 0.0
        d1, d2, d3 = n1 - drag * (s * e1 + t * f1), n2 - drag * (s * e2 + t * f2), n3 - drag * (s * e3 + t * f3)
        m1, m2, m3 = a2 * d3 - a3 * d2, a3 * d1 - a1 * d3, a1 * d2 - a2 * d1
        share = 1.0 / self.mass + h1 * m1 + h2 * m2 + h3 * m3
        if share <= 0:
            raise GeometryError(
                f"the friction, {self.friction:g}, jams the ball: no normal force keeps it on the plane "
                f"(Painlevé's paradox) about t = {time:.6g} s; take less friction"
            )
        force = pull / share
        return np.array(
            [
                0.5 * (w * p + y * r - z * q),
                0.5 * (w * q + z * p - x * r),
                0.5 * (w * r + x * q - y * p),
                -0.5 * (x * p + y * q + z * r),
                (g1 + force * m1) / i,
                (g2 + force * m2) / j,
                (g3 + force * m3) / k,
                self._gravity[0] - force * drag * s / self.mass,
                self._gravity[1] - force * drag * t / self.mass,
                v,
                o,
                force * drag * square,
            ]
        )

    @cached_property
    def _moments(self) -> list[float]:
        return list(map(float, self.moments))

    @cached_property
    def _arm(self) -> list[float]:
        return list(map(float, self.arm))

    @cached_property
    def _gravity(self) -> list[float]:
        return list(map(float, self.gravity))

    def up(self, attitude: Float) -> Float:
        """Return k (n, 3), along the principal axes."""
        return quaternion.to_body(attitude, np.array([0.0, 0.0, 1.0]))

    def contact(self, attitude: Float) -> Float:
        """Return a (n, 3) m, from the centre of mass to the point of contact, in the plane's axes."""
        return quaternion.to_space(attitude, self.arm - self.radius * self.up(attitude))

    def velocities(self, attitude: Float, spin: Float, along: Float) -> tuple[Float, Float]:
        """Return the velocities (n, 3) m/s of the centre of mass, and of the body at the point of contact."""
        turning = np.cross(quaternion.to_space(attitude, spin), self.contact(attitude))
        center = np.column_stack([along, -turning[:, 2]])
        return center, center + turning

    def force(self, attitude: Float, spin: Float, slip: Float) -> Float:
        """Return the force of the plane (n, 3) N, from the velocity of the contact (n, 3)."""
        up, arm, moments = self.up(attitude), self.arm, self.moments
        lever = np.cross(arm, up) / moments
        euler = np.cross(moments * spin, spin)
        inward = np.cross(spin, np.cross(spin, arm))
        pull = -self.gravity[2] - (lever * euler).sum(axis=1) - (up * inward).sum(axis=1)
        drag = np.where(pull < 0, 0.0, self.friction / np.hypot(np.linalg.norm(slip, axis=1), self.slip_speed))
        direction = np.array([0.0, 0.0, 1.0]) - drag[:, None] * slip
        turned = np.cross(arm - self.radius * up, quaternion.to_body(attitude, direction))
        pressed = pull / (1.0 / self.mass + (lever * turned).sum(axis=1))
        return np.asarray(pressed[:, None] * direction)

    def jellett(self, attitude: Float, spin: Float) -> Float:
        """Return −L·a (n,) kg m³/s, which a body of revolution about b keeps whatever the force is at the contact.

        J. H. Jellett, *A Treatise on the Theory of Friction* (1872), ch. VIII: dL/dt = a × F has no part along a, and
        da/dt = ω × b has none along L.
        """
        return np.asarray(-(self.moments * spin * (self.arm - self.radius * self.up(attitude))).sum(axis=1))
