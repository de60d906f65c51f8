"""The angle of a body on a fixed axle: I θ̈ = N − c θ̇ − k (θ − θᵣ) + A cos θ + B sin θ, from θ = 0 on.

What is linear, and the pendulum (N = c = k = 0), have closed forms; the rest is stepped by Taylor series.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.computing_time import Watch
from inertia.errors import GeometryError

_EPS = 2.0**-52
_ORDER = 24
_LEVELS = (1.0, 0.7)  # of the step, in runs that are compared
_STEP = 1e-19  # that the last terms of the series may amount to
_SMALL = 0.3  # below which a difference is summed as a series
_NUDGES = 2.0**-26, 2.0**-35, 2.0**-44  # relative, that a figure is changed by to see what that does to the angle
_NEAR = 1e-3  # rad, within which what it does is in proportion to it
_LOST = 1e-2  # rad, from which on it is not, and nothing is known


@dataclass(frozen=True)
class Axle:
    """What decides the angle, SI units: inertia, spin, torque, damping, stiffness, rest, and gravity's A and B."""

    inertia: float
    spin: float
    torque: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    cosine: float = 0.0
    sine: float = 0.0

    @property
    def pull(self) -> float:
        """The largest torque of the weight, N m."""
        return math.hypot(self.cosine, self.sine)

    def acceleration(self, angle: Float, rate: Float) -> Float:
        """Return θ̈ (n,) rad/s²."""
        pull = self.cosine * np.cos(angle) + self.sine * np.sin(angle)
        spring = self.stiffness * (angle - self.rest)
        return np.asarray((self.torque - self.damping * rate - spring + pull) / self.inertia)


def solve_angle(axle: Axle, time: Float, known: Axle) -> tuple[Float, Float, float, str]:
    """Return θ (n,) rad and θ̇ (n,) rad/s at the instants (n,) s, how far θ may be off, and the method.

    Parameters
    ----------
    axle : what decides the angle
    time : (n,) s, ascending from 0
    known : how far each of these figures may be off
    """
    solve, method = _method(axle)
    angle, rate, off = solve(axle, time)
    # What the figures themselves are off by grows as neighbouring motions part, exponentially near the upper rest.
    for each in fields(Axle):
        value, doubt = getattr(axle, each.name), getattr(known, each.name)
        if not doubt:
            continue
        size = max(abs(value), axle.pull if each.name in ("cosine", "sine") else 0.0, _NUDGES[0])

        def moved(nudge: float, name: str = each.name, value: float = value, size: float = size) -> Float:
            return solve(replace(axle, **{name: value + nudge * size}), time)[0]

        off += doubt / size * _slope(moved, angle)
    off = off if off < _LOST else math.pi
    return angle, rate, off, method


def _slope(moved: Callable[[float], Float], angle: Float) -> float:
    """Return how much the angle (n,) moves for a nudge: the largest of three, for far neighbours part no more."""
    slopes = []
    for nudge in _NUDGES:
        apart = float(np.abs(moved(nudge) - angle).max())
        slopes.append(apart / nudge)
        if apart < _NEAR:
            break
    return max(slopes)


def _method(axle: Axle) -> tuple[Callable[[Axle, Float], tuple[Float, Float, float]], str]:
    heavy = axle.cosine or axle.sine
    if not heavy:
        return linear, "closed form: exponentials" if axle.damping or axle.stiffness else "closed form"
    if not (axle.torque or axle.damping or axle.stiffness):
        return _pendulum, "closed form: Jacobi elliptic functions"
    return _stepped, f"Taylor series of order {_ORDER}"


def linear(axle: Axle, time: Float) -> tuple[Float, Float, float]:
    """Return angle, rate and how far the angle may be off, of a free or driven axle with damping or a spring.

    With x = c t/I and no spring, θ = ω₀ t φ₁(x) + (N/I) t² φ₂(x), φ₁ = (1 − e⁻ˣ)/x and φ₂ = (e⁻ˣ − 1 + x)/x².
    """
    drive = (axle.torque + axle.stiffness * axle.rest) / axle.inertia
    half, square = 0.5 * axle.damping / axle.inertia, axle.stiffness / axle.inertia
    if not square:
        x = 2.0 * half * time
        begun, driven = axle.spin * time * _phi(1, x), drive * time**2 * _phi(2, x)
        rate = axle.spin * np.exp(-x) + drive * time * _phi(1, x)
        size = float(np.abs(begun).max() + np.abs(driven).max())
        return begun + driven, rate, (16.0 if half else 8.0) * _EPS * size
    middle = drive / square
    away = half * half - square
    fast = math.sqrt(abs(away))
    if away > 0:  # both exponents, of which the slow one must not cancel
        slow = square / (half + fast)
        decay = np.exp(-slow * time)
        cosine, sine = decay * 0.5 * (1.0 + np.exp(-2.0 * fast * time)), decay * time * _phi(1, 2.0 * fast * time)
    else:
        decay = np.exp(-half * time)
        cosine, sine = decay * np.cos(fast * time), decay * time * np.sinc(fast * time / math.pi)
    angle = middle - middle * cosine + (axle.spin - half * middle) * sine
    rate = axle.spin * cosine + (square * middle - half * axle.spin) * sine
    size = abs(middle) + abs(axle.spin) * float(np.abs(sine).max())
    return angle, rate, 8.0 * _EPS * size * (1.0 + (fast + half) * float(time[-1]))


def _phi(order: int, x: Float) -> Float:
    """Return (1 − e⁻ˣ)/x, or (e⁻ˣ − 1 + x)/x², of x ≥ 0, to the last digits also where x is small."""
    small = x < _SMALL
    divisor = np.where(small, 1.0, x)
    if order == 1:
        return np.where(
            small,
            sum((-np.where(small, x, 0.0)) ** k / math.factorial(k + 1) for k in range(18)),
            -np.expm1(-x) / divisor,
        )
    series = sum((-np.where(small, x, 0.0)) ** k / math.factorial(k + 2) for k in range(18))
    return np.where(small, series, (np.expm1(-x) + x) / divisor**2)


def _pendulum(axle: Axle, time: Float) -> tuple[Float, Float, float]:
    """Solve I θ̈ = −M sin(θ − θ₀) as a top that has no momentum along its axis or the vertical."""
    from inertia.dynamics.kinematics import quaternion
    from inertia.dynamics.models.heavy.top import solve_heavy_top

    size, lowest = axle.pull, math.atan2(axle.cosine, -axle.sine)
    start = quaternion.from_rotation_vector([math.pi - lowest, 0.0, 0.0])
    motion = solve_heavy_top((axle.inertia, axle.inertia), size, start, [axle.spin, 0.0, 0.0], time)
    turned = quaternion.multiply(motion.attitude, quaternion.conjugate(start))
    angle = np.unwrap(2.0 * np.arctan2(turned[:, 0], turned[:, 3]))
    return angle, motion.angular_velocity[:, 0], motion.reached + 4.0 * _EPS


def _stepped(axle: Axle, time: Float) -> tuple[Float, Float, float]:
    """Step by Taylor series, twice, with steps of another length; the estimate is twice how far they are apart.

    What every step is rounded by comes on top, as far as neighbouring motions part.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        (angle, rate), (other, _) = (_series(axle, time, level) for level in _LEVELS)
    off = 2.0 * float(np.abs(angle - other).max())
    return angle, rate, off + 4.0 * _EPS * _slope(lambda noise: _series(axle, time, _LEVELS[0], noise)[0], angle)


def _series(axle: Axle, time: Float, level: float, noise: float = 0.0) -> tuple[Float, Float]:
    """Return θ and θ̇ at the instants, from steps as long as the last terms of the series allow.

    Every step may be off by `noise`, relative.
    """
    angle, rate = np.empty_like(time), np.empty_like(time)
    at, state = 0.0, (0.0, axle.spin)
    first, watch = 0, Watch()
    while first < len(time):
        watch.require(at / float(time[-1]))
        terms = _terms(axle, *state)
        if not np.isfinite(terms).all():
            raise GeometryError(f"the angle leaves float64 after {at:.2g} s: check the units of the scene")
        last = max(abs(terms[-1]) ** (1.0 / _ORDER), abs(terms[-2]) ** (1.0 / (_ORDER - 1)), 1e-300)
        step = level * _STEP ** (1.0 / _ORDER) * max(1.0, abs(state[0])) ** (1.0 / _ORDER) / last
        stop = int(np.searchsorted(time, at + step, side="right"))
        here = time[first:stop] - at
        slopes = terms[1:] * np.arange(1, len(terms))
        angle[first:stop], rate[first:stop] = np.polyval(terms[::-1], here), np.polyval(slopes[::-1], here)
        ends = float(np.polyval(terms[::-1], step)), float(np.polyval(slopes[::-1], step))
        state = ends[0] + noise * abs(ends[0]), ends[1] + noise * abs(ends[1])
        at, first = at + step, stop
    return angle, rate


def _terms(axle: Axle, angle: float, rate: float) -> Float:
    """Return the coefficients of θ in powers of the time; those of its sine and cosine follow from each other."""
    theta, sine, cosine = np.zeros((3, _ORDER + 1))
    theta[:2], sine[0], cosine[0] = (angle, rate), math.sin(angle), math.cos(angle)
    constant = axle.torque + axle.stiffness * axle.rest
    for n in range(_ORDER - 1):
        slopes = theta[1 : n + 1] * np.arange(1, n + 1)
        if n:
            sine[n], cosine[n] = slopes @ cosine[n - 1 :: -1][:n] / n, -(slopes @ sine[n - 1 :: -1][:n]) / n
        pull = axle.cosine * cosine[n] + axle.sine * sine[n] + (constant if n == 0 else 0.0)
        loss = axle.damping * (n + 1) * theta[n + 1] + axle.stiffness * theta[n]
        theta[n + 2] = (pull - loss) / (axle.inertia * (n + 1) * (n + 2))
    return theta
