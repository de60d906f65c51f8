"""The heavy symmetric top in closed form: attitude and angular velocity at any instants, and what they keep."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.heavy.nutation import Nutation, Parameter
from inertia.dynamics.special import double_double
from inertia.dynamics.special.double_double import Pair
from inertia.dynamics.special.elliptic import sncndn, third_kind

Complex = NDArray[np.complex128]

_TURN: Pair = 2.0 * double_double.PI[0], 2.0 * double_double.PI[1]
_HALF_TURN = (1.0, 0.0, 0.0, 0.0)  # about axis 1: what brings a weight below the fixed point above it
_TURNED = (1.0, -1.0, -1.0)
_FAR = 300.0
"""Argument at which the separatrix has come to the vertical as near as the square of cn is a float64."""


def follow(
    nutation: Nutation, spin: float, attitude: ArrayLike, angular_velocity: ArrayLike, time: Float
) -> tuple[Float, Float]:
    """Return attitudes (n, 4) and ω (n, 3) at the instants (n,), from those at t = 0; `spin` is p_ψ/I1.

    The attitude is (Re β, Im β, Im α, Re α) with α = cos ½θ exp ½i(φ + ψ) and β = sin ½θ exp ½i(φ − ψ), and
    ω₁ + iω₂ = 2 (ᾱ β̇ − β α̇*), in which what is common to the rates of both phases drops out.
    """
    q, omega = quaternion.normalise(attitude), np.array(angular_velocity, dtype=np.float64)
    if nutation.hanging:
        q, omega, spin = quaternion.multiply(q, _HALF_TURN), omega * _TURNED, -spin
    first = complex(q[3], q[2]), complex(q[0], q[1])
    across = complex(omega[0], omega[1])
    rate = nutation.rate or 1.0
    slopes = (
        0.5 * (1j * spin * first[0] - first[1] * across.conjugate()) / rate,
        0.5 * (across * first[0] - 1j * spin * first[1]) / rate,
    )
    count, w = _argument(nutation, time)
    values, derivatives = [], []
    for parameter, value, slope in zip((nutation.upper, nutation.lower), first, slopes, strict=True):
        (at_start,), (rising,) = _shape(parameter, np.array([nutation.start]), nutation.mc)
        constant = value * at_start.conjugate() + slope * rising.conjugate()  # either of the two may vanish
        constant /= abs(constant) or 1.0
        phase = _phase(double_double.times(parameter.rate, time))
        phase = phase + _phase(double_double.several(parameter.advance, count))
        turn = constant * np.exp(1j * phase)
        if parameter.alternates:
            turn = turn * (1.0 - 2.0 * double_double.modulo(count, 2.0))
        shape, derivative = _shape(parameter, w, nutation.mc)
        values.append(turn * shape)
        derivatives.append(turn * derivative)
    (alpha, beta), (alpha_w, beta_w) = values, derivatives
    attitudes = quaternion.normalise(np.stack([beta.real, beta.imag, alpha.imag, alpha.real], axis=-1))
    across_now = 2.0 * nutation.rate * (alpha.conj() * beta_w - beta * alpha_w.conj())
    turned = np.stack([across_now.real, across_now.imag, np.full(len(w), omega[2])], axis=-1)
    if nutation.hanging:
        return -quaternion.multiply(attitudes, _HALF_TURN), turned * _TURNED
    return attitudes, turned


def turning_times(nutation: Nutation, first: float, last: float, most: int) -> tuple[Float, Float]:
    """Return the instants from `first` to `last` at which θ turns, `most` at most, and 1 for those at u₂, else 0."""
    if not nutation.cycles[0]:  # the separatrix turns once, at w = 0
        offset = nutation.start / nutation.rate
        number = np.zeros(1 if first <= -offset <= last else 0)
        return number - offset, number
    step, offset = 0.5 / nutation.cycles[0], nutation.start / nutation.quarter  # s, and how many, −1 … 1
    start = np.ceil(first / step + offset)
    number = start + np.arange(min(np.floor(last / step + offset) - start + 1.0, most))
    return (number - offset) * step, np.mod(number, 2.0)


def integrals(moments: tuple[float, float], mgh: float, attitude: Float, omega: Float) -> tuple[Float, Float, Float]:
    """Return energy, p_φ and p_ψ, (n,) each, of attitudes (n, 4) and ω (n, 3); moments are (I1, I3)."""
    i1, i3 = moments
    o1, o2, o3 = omega.T
    height, _, across = against_vertical(attitude, omega)
    energy = 0.5 * (i1 * (o1 * o1 + o2 * o2) + i3 * o3 * o3) + mgh * height
    return energy, i1 * across + i3 * o3 * height, i3 * o3


def against_vertical(attitude: Float, omega: Float) -> tuple[Float, Float, Float]:
    """Return cosθ, sinθ and φ̇ sin²θ = ω₁γ₁ + ω₂γ₂, (n,) each, γ being the vertical in body components."""
    x, y, z, w = attitude.T
    g1, g2 = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x)
    return (z * z + w * w) - (x * x + y * y), np.hypot(g1, g2), omega[:, 0] * g1 + omega[:, 1] * g2


def _argument(nutation: Nutation, time: Float) -> tuple[Pair, Float]:
    """Return the whole periods 2K in w, and the rest, −K … K."""
    if not nutation.cycles[0]:
        return double_double.of(np.zeros_like(time)), np.clip(nutation.start + nutation.rate * time, -_FAR, _FAR)
    start = double_double.of(nutation.start / (2.0 * nutation.quarter))
    cycles = double_double.add(double_double.times(nutation.cycles, time), start)
    count, rest = double_double.reduce(cycles, (1.0, 0.0))
    return count, (rest[0] + rest[1]) * (2.0 * nutation.quarter)


def _phase(angle: Pair) -> Float:
    """Return an angle in rad, reduced to one turn in double-double."""
    _, rest = double_double.reduce(angle, _TURN)
    return np.asarray(rest[0] + rest[1])


def _shape(parameter: Parameter, w: Float, mc: float) -> tuple[Complex, Complex]:
    """Return a Cayley–Klein parameter less its constant and secular phases, and its derivative in w."""
    s, c, d = sncndn(w, mc)
    p, a, b = parameter.p, parameter.amplitude, parameter.swing
    root = np.sqrt(c * c + p * (s * s))
    turn: Any = np.exp(1j * parameter.coefficient * _integral(s, c, d, mc, p)) if parameter.coefficient else 1.0
    if parameter.alternates:
        turn = turn / root
        return turn * (a * c * d + 1j * b * s), turn * (1j * b * c * d - a * s * (p + (1.0 - mc) * (c * c)))
    return turn * (a * root), turn / root * (1j * b - a * (1.0 - p) * s * c * d)


def _integral(s: Float, c: Float, d: Float, mc: float, p: float) -> Float:
    """Return ∫₀ʷ cn²/P dw for p ≥ 1, else ∫₀ʷ sn²/P dw = ⅓ s³ R_J(c², d², 1, P), with P = cn² + p sn²; |w| ≤ K."""
    from scipy.special import elliprj

    if p >= 1.0:
        return third_kind(s, c, d, np.asarray(mc), np.asarray(p - 1.0))
    return np.asarray(s**3 / 3.0 * elliprj(c * c, d * d, 1.0, c * c + p * (s * s)))
