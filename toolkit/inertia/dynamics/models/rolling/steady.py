"""Steady motions of a rolling body: circles, straight rolling, spinning on the edge, and which of them last."""

from __future__ import annotations

import math

from inertia.dynamics.models.rolling.equations import RollingBody, angular_acceleration, reaction
from inertia.errors import GeometryError, UsageError
from inertia.records import dataclass


@dataclass(frozen=True)
class SteadyRolling:
    """A motion with constant tilt and rates.

    Attributes
    ----------
    body : what rolls
    theta : rad, from the vertical up to axis 3
    precession, spin : rad/s, φ̇ and ψ̇
    """

    body: RollingBody
    theta: float
    precession: float
    spin: float

    @property
    def angular_velocity(self) -> tuple[float, float, float]:
        """(ω₁, ω₂, ω₃) in rad/s along the axes of the nodes; ω₁ = θ̇ = 0."""
        s, c = math.sin(self.theta), math.cos(self.theta)
        return 0.0, self.precession * s, self.spin + self.precession * c

    @property
    def contact_radius(self) -> float:
        """Radius in m, −R ψ̇/φ̇, of the circle that the contact describes; infinite without precession.

        Positive where the centre of the circle lies along k × e₁ of the contact, the side that axis 3 leans away from.
        """
        return -self.body.radius * self.spin / self.precession if self.precession else math.inf

    @property
    def center_radius(self) -> float:
        """Radius in m of the circle that the centre of mass describes, signed likewise."""
        s, c = math.sin(self.theta), math.cos(self.theta)
        return self.contact_radius - (self.body.offset * s + self.body.radius * c) if self.precession else math.inf

    @property
    def friction(self) -> float:
        """The least coefficient of friction that the motion needs: |horizontal force| over normal force."""
        along, across, up = reaction(self.body, math.sin(self.theta), math.cos(self.theta), *self.angular_velocity)
        return math.hypot(along, across) / up

    @property
    def nutation_squared(self) -> float:
        """Ω² in (rad/s)²: a small change of θ oscillates at Ω, and grows like exp(√(−Ω²) t) where Ω² < 0."""
        return nutation_squared(self.body, self.theta, *self.angular_velocity[1:])


def steady_rolling(body: RollingBody, theta: float, precession: float) -> SteadyRolling:
    """Return the steady motion at tilt `theta` rad that precesses at φ̇ = `precession` rad/s.

    With ω₂ = φ̇ sinθ and θ̈ = 0, eq. 13.199 (here for any offset; h = offset/R, per M R²) gives

        ω₃ = [I₁ φ̇² sinθ cosθ − h φ̇² sinθ (sinθ − h cosθ) − (g/R)(cosθ + h sinθ)] / (φ̇ [I₃ sinθ + sinθ − h cosθ]).

    Raises `UsageError` for a precession of 0: rolling straight on needs the centre of mass above the contact and then
    takes any spin (`straight_rolling`).

    >>> disc = RollingBody(mass=1.0, transverse=0.25, axial=0.5, radius=1.0, gravity=9.81)
    >>> circle = steady_rolling(disc, 1.2, 2.0)
    >>> round(circle.contact_radius, 6), circle.nutation_squared > 0
    (0.937619, True)
    """
    s, c = _tilt(theta)
    if not (precession and math.isfinite(precession)):
        raise UsageError(f"the precession is {precession} rad/s: a circle needs one that is finite and not zero")
    transverse, axial, h, g = body.reduced
    height = s - h * c
    push = precession**2 * s * (transverse * c - h * height) - g * (c + h * s)
    w3 = push / (precession * (axial * s + height))
    return SteadyRolling(body, theta, precession, w3 - precession * c)


def steady_circle(body: RollingBody, theta: float, contact_radius: float) -> SteadyRolling:
    """Return the steady motion at tilt `theta` rad whose contact describes a circle of `contact_radius` m (signed).

    The constraint ψ̇ = −φ̇ r/R leaves, with κ = cosθ − r/R,

        φ̇² [sinθ (I₁ cosθ − h (sinθ − h cosθ)) − κ (I₃ sinθ + sinθ − h cosθ)] = (g/R)(cosθ + h sinθ);

    φ̇ and −φ̇ describe the circle either way round, and the positive one is returned. Raises `GeometryError` where no
    speed holds the body up.

    >>> disc = RollingBody(mass=1.0, transverse=0.25, axial=0.5, radius=1.0, gravity=9.81)
    >>> round(steady_circle(disc, 1.2, 0.9376194).precession, 6)
    2.0
    """
    s, c = _tilt(theta)
    transverse, axial, h, g = body.reduced
    lean = c - contact_radius / body.radius
    height = s - h * c
    weight = g * (c + h * s)
    hold = s * (transverse * c - h * height) - lean * (axial * s + height)
    if not weight * hold > 0:
        raise GeometryError(
            f"no one speed keeps a body tilted by {theta:.6g} rad on a circle of radius {contact_radius:.6g} m: "
            "give the radius the other sign, or another size"
        )
    precession = math.sqrt(weight / hold)
    return SteadyRolling(body, theta, precession, -precession * contact_radius / body.radius)


def straight_rolling(body: RollingBody, spin: float) -> SteadyRolling:
    """Return rolling straight on at ψ̇ = `spin` rad/s: the centre of mass is above the contact, tanθ = −R/offset."""
    return SteadyRolling(body, math.atan2(body.radius, -body.offset), 0.0, spin)


def straight_rolling_threshold(body: RollingBody) -> float:
    """Return the spin in rad/s above which rolling straight on is stable.

    ω₃² = M g l / (α (I₃ + M l²)), with l² = R² + offset² and α as in `RollingBody.coupling`; for a thin disc or hoop
    I₁ M g R / (I₃ (I₃ + M R²)): v² = gR/3 and gR/4.

    >>> disc = RollingBody(mass=1.0, transverse=0.25, axial=0.5, radius=1.0, gravity=9.81)
    >>> round(straight_rolling_threshold(disc) ** 2 / 9.81, 12)
    0.333333333333
    """
    _, axial, h, g = body.reduced
    length = math.hypot(1.0, h)
    return math.sqrt(g * length / (body.coupling[0] * (axial + length**2)))


def edge_spin_threshold(body: RollingBody) -> float:
    """Return the rate in rad/s above which a thin disc (offset 0) spins stably about its vertical diameter.

    φ̇² = M g R / (I₁ + M R²): 4g/(5R) for a uniform disc. Raises `GeometryError` for another offset, where the vertical
    through the contact and the centre of mass is no principal axis.

    >>> disc = RollingBody(mass=1.0, transverse=0.25, axial=0.5, radius=1.0, gravity=10.0)
    >>> round(edge_spin_threshold(disc) ** 2, 12)
    8.0
    """
    transverse, _, h, g = body.reduced
    if h:
        raise GeometryError(
            f"the rim is {body.offset:.6g} m off the centre of mass: only a body with offset 0 spins on its edge"
        )
    return math.sqrt(g / (transverse + 1.0))


def nutation_squared(body: RollingBody, theta: float, w2: float, w3: float) -> float:
    """Return −dω̇₁/dθ in (rad/s)², with ω₂ and ω₃ following θ as the Appell–Korteweg constants make them.

    Where ω̇₁ = 0 this is the square of the frequency of small nutations about the steady motion.
    """
    s, c = math.sin(theta), math.cos(theta)
    transverse, axial, h, g = body.reduced
    cot = c / s
    _, d2, d3 = angular_acceleration(body, s, c, 1.0, w2, w3)
    pace, arm = h * w2 + w3, 1.0 - h * cot
    by_theta = g * (s - h * c) - w2 * (transverse * w2 + h * pace) / s**2
    by_w2 = 2 * transverse * w2 * cot - axial * w3 - arm * (pace + h * w2)
    by_w3 = -(axial + arm) * w2
    return -(by_theta + by_w2 * d2 + by_w3 * d3) / (transverse + 1 + h * h)


def _tilt(theta: float) -> tuple[float, float]:
    if not 0 < theta < math.pi:
        raise UsageError(f"the tilt is {theta} rad: a rolling body needs one between 0 and π")
    return math.sin(theta), math.cos(theta)
