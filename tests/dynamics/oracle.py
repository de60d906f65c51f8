"""An independent answer to every rigid-body scene: Taylor series in fixed-point integers, to 30 digits and more.

The right-hand side is polynomial once each vector that is fixed in space is carried along by its body components v,

    I ω̇ = (I ω) × ω + N + Σ (A v + v × B v) − d ω,   v̇ = v × ω,   q̇ = ½ q (ω, 0),

so that the Taylor coefficients follow from Cauchy products (Moore 1966; Jorba & Zou, Experim. Math. 14 (2005) 99).
Numbers are Python integers over 2**BITS; the step in time follows from the decay of the last coefficients. Every
answer is computed twice, by two orders that take different steps, and their difference is the error that is stated.

Nothing here is shared with the package under test. Attitudes are scalar-last quaternions, body to space.

>>> answer = rotate((1.0, 2.0, 3.0), (1.0, 0.5, 2.0), [0.0, 10.0])
>>> answer.error < 1e-28
True
>>> float(answer.attitude[1] @ answer.attitude[1])
1.0
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import mul

import mpmath
import numpy as np

BITS = 256
ONE = 1 << BITS
ORDERS = 44, 36

Vector = Sequence[float]
Series = list[list[int]]


@dataclass(frozen=True)
class Answer:
    """What happened at n times: arrays of mpf (n, 4) and (n, 3); `error` bounds every component of both."""

    attitude: np.ndarray
    angular_velocity: np.ndarray
    error: float

    def attitude_error(self, attitude: np.ndarray) -> np.ndarray:
        """Return the angle in rad, (n,), between float64 attitudes (n, 4) and the true ones."""
        with mpmath.workdps(60):
            return np.array([_angle(p, q) for p, q in zip(np.asarray(attitude), self.attitude, strict=True)])

    def angular_velocity_error(self, angular_velocity: np.ndarray) -> np.ndarray:
        """Return |Δω| in rad/s, (n,)."""
        with mpmath.workdps(60):
            apart = np.asarray(angular_velocity) - self.angular_velocity
            return np.array([float(mpmath.norm(list(row))) for row in apart])


@dataclass(frozen=True)
class Equations:
    """Coefficients of the polynomial right-hand side as exact rationals; `fixed` are (components, A, B) of vectors
    fixed in space with the torques A v and v × B v that they make."""

    moments: list[Fraction]
    torque: list[Fraction]
    damping: list[Fraction]
    fixed: list[tuple[list[Fraction], list[list[Fraction]], list[Fraction]]]


def rotate(
    moments: Vector,
    angular_velocity: Vector,
    times: Sequence[float],
    *,
    attitude: Vector = (0.0, 0.0, 0.0, 1.0),
    mass: float = 0.0,
    offset: Vector = (0.0, 0.0, 0.0),
    gravity: Vector = (0.0, 0.0, 0.0),
    body_torque: Vector = (0.0, 0.0, 0.0),
    space_torque: Vector = (0.0, 0.0, 0.0),
    damping: float | Vector = 0.0,
    gravity_gradient: tuple[float, Vector] | None = None,
    digits: int = 30,
) -> Answer:
    """Follow a body about its reference point from t = 0; `times` ascend from 0 on, or descend.

    Parameters
    ----------
    moments : principal moments about the reference point, kg m²; angular_velocity : along the principal axes, rad/s
    mass, offset, gravity : weight: kg; m in body axes, from the fixed point to the centre of mass; m/s² in space
    body_torque, space_torque : N m, constant in the body or in space; damping : N m s, torque −d ω
    gravity_gradient : μ in m³/s² and the position of the primary in space, m: torque 3 μ/r³ r̂ × I r̂
    digits : of the local error, absolute, with attitude in rad and time in units of the fastest turn
    """
    exact = [Fraction(x) for x in moments]
    fixed = []
    if mass and any(offset) and any(gravity):
        c = [Fraction(mass) * Fraction(x) for x in offset]
        cross = [[Fraction(0), -c[2], c[1]], [c[2], Fraction(0), -c[0]], [-c[1], c[0], Fraction(0)]]
        fixed.append((_to_body(attitude, gravity), cross, [Fraction(0)] * 3))
    if any(space_torque):
        unit = [[Fraction(i == j) for j in range(3)] for i in range(3)]
        fixed.append((_to_body(attitude, space_torque), unit, [Fraction(0)] * 3))
    if gravity_gradient is not None:
        mu, place = gravity_gradient
        with mpmath.workdps(60):
            strength = 3 * mpmath.mpf(mu) / mpmath.norm([mpmath.mpf(x) for x in place]) ** 5
            rational = Fraction(*strength.as_integer_ratio())
        zero = [[Fraction(0)] * 3 for _ in range(3)]
        fixed.append((_to_body(attitude, place), zero, [rational * x for x in exact]))
    rates = [damping] * 3 if np.ndim(damping) == 0 else damping
    equations = Equations(exact, [Fraction(x) for x in body_torque], [Fraction(x) for x in rates], fixed)
    start = [Fraction(x) for x in (*angular_velocity, *attitude)] + [x for v, _, _ in fixed for x in v]
    with mpmath.workdps(60):
        first, second = (_integrate(equations, start, times, order, digits) for order in ORDERS)
        error = float(max(abs(first - second).max(), mpmath.mpf(10) ** (-2 * digits)))
    return Answer(first[:, 3:7], first[:, :3], error)


def _integrate(
    equations: Equations, start: list[Fraction], times: Sequence[float], order: int, digits: int
) -> np.ndarray:
    state, now = [_fixed(x) for x in start], Fraction(0)
    targets = [Fraction(float(t)) for t in times]
    sign = -1 if targets and targets[-1] < 0 else 1
    spin = max(map(abs, start[:3])) + max((max(map(abs, v)) for v in _rates(equations)), default=Fraction(0))
    step = Fraction(float(sign / spin)) if spin else Fraction(float(targets[-1]) or 1.0)
    out, done = [], 0
    while done < len(targets):
        if now == targets[done]:
            reach = Fraction(0)
            series = [[x] for x in state]
        else:
            series = _series(equations, state, step, order)
            reach = _reach(series, order, digits)
        while done < len(targets) and abs(targets[done] - now) <= abs(reach * step):
            out.append([_value(row, _fixed((targets[done] - now) / step)) for row in series[:7]])
            done += 1
        if reach:
            tau = _fixed(reach)
            state = [_value(row, tau) for row in series]
            now += reach * step
            step *= reach
    return np.array([[mpmath.mpf(x) / ONE for x in row] for row in out], dtype=object).reshape(-1, 7)


def _rates(equations: Equations) -> list[list[Fraction]]:
    """Sizes of the angular accelerations over a unit of time: only a first guess of the step follows from them."""
    torque = [equations.torque]
    for v, a, _ in equations.fixed:
        torque.append([sum((abs(p * q) for p, q in zip(row, v, strict=True)), Fraction(0)) for row in a])
    answer = [
        [Fraction(float(abs(n / i)) ** 0.5) for n, i in zip(row, equations.moments, strict=True)] for row in torque
    ]
    return [*answer, [abs(d / i) for d, i in zip(equations.damping, equations.moments, strict=True)]]


def _series(equations: Equations, state: list[int], step: Fraction, order: int) -> Series:
    """Return the Taylor coefficients of every component in time over `step`."""
    i = equations.moments
    spin = [_fixed(step * (i[(k + 1) % 3] - i[(k + 2) % 3]) / i[k]) for k in range(3)]
    torque = [_fixed(step * n / j) for n, j in zip(equations.torque, i, strict=True)]
    drag = [_fixed(step * d / j) for d, j in zip(equations.damping, i, strict=True)]
    linear = [[[_fixed(step * x / i[k]) for x in a[k]] for k in range(3)] for _, a, _ in equations.fixed]
    square = [
        [_fixed(step * (b[(k + 2) % 3] - b[(k + 1) % 3]) / i[k]) for k in range(3)] for _, _, b in equations.fixed
    ]
    pace = _fixed(step)
    rows: Series = [[x] for x in state]
    w, q = rows[:3], rows[3:7]
    vectors = [rows[m : m + 3] for m in range(7, len(rows), 3)]
    for n in range(order):
        back = [row[::-1] for row in w]
        rate = []
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            total = spin[k] * (_dot(w[a], back[b])) - drag[k] * w[k][n]
            for v, lin, quad in zip(vectors, linear, square, strict=True):
                total += sum(map(mul, lin[k], (v[0][n], v[1][n], v[2][n])))
                if quad[k]:
                    total += quad[k] * _dot(v[a], v[b][::-1])
            rate.append((total >> BITS) + (torque[k] if n == 0 else 0))
        x, y, z, s = q
        p, r, t = back
        half = pace >> 1
        turn = [
            half * (_dot(s, p) + _dot(y, t) - _dot(z, r)),
            half * (_dot(s, r) + _dot(z, p) - _dot(x, t)),
            half * (_dot(s, t) + _dot(x, r) - _dot(y, p)),
            -half * (_dot(x, p) + _dot(y, r) + _dot(z, t)),
        ]
        carried = [
            pace * (_dot(v[(k + 1) % 3], back[(k + 2) % 3]) - _dot(v[(k + 2) % 3], back[(k + 1) % 3]))
            for v in vectors
            for k in range(3)
        ]
        for row, value in zip(rows, [*rate, *(x >> BITS for x in (*turn, *carried))], strict=True):
            row.append(value // (n + 1))
    return rows


def _dot(a: list[int], b: list[int]) -> int:
    return sum(map(mul, a, b)) >> BITS


def _reach(series: Series, order: int, digits: int) -> Fraction:
    """Return the part of the step over which the last two coefficients stay below 10**-digits of the largest rate."""
    share = 4.0
    for n in (order - 1, order):
        largest = max(abs(row[n]) for row in series)
        if largest:
            size = math.log(largest) - BITS * math.log(2.0)
            share = min(share, math.exp(-(size + digits * math.log(10.0)) / n))
    return Fraction(share)


def _value(row: list[int], tau: int) -> int:
    total = 0
    for coefficient in reversed(row):
        total = (total * tau >> BITS) + coefficient
    return total


def _fixed(x: Fraction) -> int:
    return (x.numerator << BITS) // x.denominator


def _to_body(attitude: Vector, vector: Vector) -> list[Fraction]:
    """Return qᵀ v q exactly; the attitude is used as given, whatever its rounding."""
    x, y, z, w = (Fraction(a) for a in attitude)
    size = x * x + y * y + z * z + w * w
    v = [Fraction(a) for a in vector]
    rows = [
        [1 - 2 * (y * y + z * z) / size, 2 * (x * y + z * w) / size, 2 * (x * z - y * w) / size],
        [2 * (x * y - z * w) / size, 1 - 2 * (x * x + z * z) / size, 2 * (y * z + x * w) / size],
        [2 * (x * z + y * w) / size, 2 * (y * z - x * w) / size, 1 - 2 * (x * x + y * y) / size],
    ]
    return [sum(map(mul, row, v), Fraction(0)) for row in rows]


def _angle(p: np.ndarray, q: np.ndarray) -> float:
    """Return the angle between the directions of two quaternions, doubled; small ones from their difference."""
    p, q = [mpmath.mpf(float(x)) for x in p], list(q)
    p, q = ([x / mpmath.norm(r) for x in r] for r in (p, q))
    if sum(map(mul, p, q)) < 0:
        q = [-x for x in q]
    chord = mpmath.norm([a - b for a, b in zip(p, q, strict=True)])
    return float(4 * mpmath.asin(chord / 2))


def off_by(
    inertia: Callable[[mpmath.mpf], mpmath.mpf], pull: float, start: mpmath.mpf, end: float, time: float
) -> float:
    """Return how far an angle is off that is said to be reached at `time` by what falls from rest at `start`.

    ½ J(φ) φ̇² = pull (cos φ₀ − cos φ); with sin ½φ = sin ½φ₀ cosh u, the time is ∫ √(J/pull)/cos ½φ du.
    """
    with mpmath.workdps(30):
        small = mpmath.sin(start / 2)

        def slowness(u: mpmath.mpf) -> mpmath.mpf:
            angle = 2 * mpmath.asin(small * mpmath.cosh(u))
            return mpmath.sqrt(inertia(angle) / pull) / mpmath.cos(angle / 2)

        last = mpmath.acosh(mpmath.sin(mpmath.mpf(end) / 2) / small)
        spent = mpmath.quad(slowness, mpmath.linspace(0, last, 20))
        speed = mpmath.sqrt(2 * pull * (mpmath.cos(start) - mpmath.cos(end)) / inertia(mpmath.mpf(end)))
        return float(abs(spent - mpmath.mpf(time)) * speed)
