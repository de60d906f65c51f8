"""The Appell–Korteweg constants of a rolling body: what its two linear equations keep besides the energy.

ω₂ and ω₃ depend on time through θ alone (`RollingBody.coupling`), so that w = ω₃(θ) obeys

    w″ + cotθ w′ + (β cotθ − β² − αγ) w = 0,   ω₂ = (w′ + β w)/γ,

and ω₃ = c₁ P(θ) + c₂ Q(θ) with constant c₁ and c₂. P is the solution that is 1 at θ = 0 and Q the one that is 1 at
θ = π; each has a logarithm at the other end. For offset = 0 they are Legendre functions of degree ν,
P_ν(cosθ) and P_ν(−cosθ) with ν (ν + 1) = −αγ, conical where ν = −½ + iτ (Appell and Korteweg, both in Rend. Circ.
Mat. Palermo 14 (1900)). For any offset they are power series in θ and in π − θ, which converge up to the other end;
each is used over its half.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.models.rolling.equations import RollingBody
from inertia.records import dataclass

_TERMS = 64
"""The series converge like (θ/π)ⁿ, and θ goes to π/2."""

_PI_REST = 1.2246467991473532e-16
"""What float64 leaves out of π: next to θ = π it would show in the logarithm."""


def appell_korteweg(body: RollingBody, theta: Float, w2: Float, w3: Float) -> tuple[Float, Float]:
    """Return c₁ and c₂ in rad/s, (n,) each, of states with angular velocities w2, w3 (n,) along the nodes' axes 2, 3.

    With w = ω₃, w′ = γ ω₂ − β ω₃ and the Wronskian P Q′ − P′ Q = K/sinθ: c₁ = (w Q′ − w′ Q) sinθ/K and
    c₂ = (w′ P − w P′) sinθ/K.
    """
    _, beta, gamma = body.coupling
    p, p_slope, q, q_slope, wronskian = _solutions(body, theta)
    slope, s = gamma * w2 - beta * w3, np.sin(theta)
    return (w3 * q_slope - slope * q) * s / wronskian, (slope * p - w3 * p_slope) * s / wronskian


def _solutions(body: RollingBody, theta: Float) -> tuple[Float, Float, Float, Float, float]:
    """Return P, P′, Q, Q′ (n,) at `theta` and K."""
    alpha, beta, gamma = body.coupling
    near, far = (_Ends.of(b, beta * beta + alpha * gamma) for b in (beta, -beta))
    quarter = np.array([np.pi / 2])
    (p,), (dp,) = near.regular(quarter)
    (q,), (dq,) = far.regular(quarter)
    upper = theta > np.pi / 2
    below, above = np.where(upper, np.pi / 2, theta), np.where(upper, np.pi - theta + _PI_REST, np.pi / 2)
    # The slopes of `far` are in π − θ, which runs the other way.
    own, own_slope = near.regular(below), far.regular(above)
    of_p = far.continued(above, p, -dp)
    of_q = near.continued(below, q, -dq)
    return (
        np.where(upper, of_p[0], own[0]),
        np.where(upper, -of_p[1], own[1]),
        np.where(upper, own_slope[0], of_q[0]),
        np.where(upper, -own_slope[1], of_q[1]),
        float(-p * dq - dp * q),
    )


@dataclass(frozen=True, eq=False)
class _Ends:
    """Both solutions about one end: Σ aₙ θⁿ, and its product with lnθ plus Σ bₙ θⁿ (Frobenius)."""

    plain: Float
    logarithmic: Float

    @classmethod
    def of(cls, beta: float, mu: float) -> _Ends:
        """Solve θ w″ + (θ cotθ) w′ + (β θ cotθ − μ θ) w = 0 power by power."""
        cot = _theta_cot()
        a, b = np.zeros(_TERMS), np.zeros(_TERMS)
        a[0] = 1.0
        powers = np.arange(_TERMS)
        for n in range(1, _TERMS):
            back, tail = cot[1 : n + 1][::-1], cot[:n][::-1]
            before = slice(0, n)
            for w in (a, b):
                driven = back @ (powers[before] * w[before]) + beta * (tail @ w[before])
                w[n] = (mu * w[n - 2] if n > 1 else 0.0) - driven
            a[n] /= n * n
            b[n] = (b[n] - 2 * n * a[n] - back @ a[before]) / (n * n)
        return cls(a, b)

    def regular(self, theta: Float) -> tuple[Float, Float]:
        """Return the solution that is 1 at this end and its slope."""
        return _value(theta, self.plain), _slope(theta, self.plain)

    def continued(self, theta: Float, value: float, slope: float) -> tuple[Float, Float]:
        """Return the solution that has `value` and `slope` at π/2, and its slope."""
        quarter = np.array([np.pi / 2])
        (r,), (dr,) = self.regular(quarter)
        (l,), (dl,) = self._singular(quarter)
        wronskian = r * dl - dr * l
        x, y = (value * dl - slope * l) / wronskian, (slope * r - value * dr) / wronskian
        plain, singular = self.regular(theta), self._singular(theta)
        return x * plain[0] + y * singular[0], x * plain[1] + y * singular[1]

    def _singular(self, theta: Float) -> tuple[Float, Float]:
        value, slope = self.regular(theta)
        log = np.log(theta)
        rest, rest_slope = _value(theta, self.logarithmic), _slope(theta, self.logarithmic)
        return value * log + rest, slope * log + value / theta + rest_slope


def _value(theta: Float, series: Float) -> Float:
    return np.asarray(np.polynomial.polynomial.polyval(theta, series), dtype=np.float64)


def _slope(theta: Float, series: Float) -> Float:
    return _value(theta, series[1:] * np.arange(1, len(series)))


def _theta_cot() -> Float:
    """Return the coefficients of θ cotθ: from θ cosθ = (θ cotθ) sinθ, power by power."""
    sine, cosine = np.zeros(_TERMS + 1), np.zeros(_TERMS)  # of sinθ/θ and cosθ
    term = 1.0
    for n in range(0, _TERMS, 2):
        cosine[n], sine[n] = term, term / (n + 1)
        term /= -(n + 1) * (n + 2)
    cot = np.zeros(_TERMS)
    for n in range(0, _TERMS, 2):
        cot[n] = cosine[n] - sine[1 : n + 1][::-1] @ cot[:n]
    return cot
