"""Free rotation that needs sines only: steady rotation, and the symmetric top with its two uniform turns."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.special import double_double
from inertia.dynamics.special.double_double import Pair
from inertia.dynamics.special.elementary import Number, columns, cos, packed, select, sin, where

_FOUR_PI = (4.0 * double_double.PI[0], 4.0 * double_double.PI[1])


def steady(angular_velocity: Float, rest: Float | None, time: Float) -> tuple[Float, Float]:
    """Return attitude (N, n, 4) and ω (N, n, 3) of bodies that keep their angular_velocity (N, 3), at time (N, n).

    R(t) = exp(ω t): a principal axis, a spherical top (textbook § 13.18), or rest. `rest` is what float64 leaves out
    of ω, (N, 3).
    """
    omega = columns(angular_velocity[:, None])
    speed = _length(_pairs(angular_velocity, rest))
    half = _half_turn(speed, time)
    sine = sin(half) / where(speed[0] > 0, speed[0], 1.0)
    return packed((*(sine * w for w in omega), cos(half)), time.shape), packed(omega, time.shape)


def symmetric(
    moments: Float, angular_velocity: Float, rest: tuple[Float, Float] | None, time: Float
) -> tuple[Float, Float]:
    """Return attitude (N, n, 4) and ω (N, n, 3) of bodies with two equal moments (N, 3), at time (N, n).

    R(t) = exp(L t / I) exp(e β t), β = (1 − I_s/I) ω_s: about L, fixed in space, at |L|/I, and about the symmetry axis
    e at β, seen from which the rest of ω turns backwards (textbook § 13.20, Ω = −β). I_s may be zero, a rod, whose
    spin about itself is then kept. With e as axis 3 of a frame in the body, both are products of complex numbers: the
    attitude is w + iz and x + iy. `rest` is what float64 leaves out of moments and ω, (N, 3).
    """
    axis, inertia, spin = _frame(moments, angular_velocity, rest)
    momentum, lead, back = _rates(inertia, spin)
    (across, _), _, (along, _) = inertia
    (x, _), (y, _), (z, _) = spin
    about_l, own = _half_turn(lead, time), _half_turn(back, time)
    turn = cos(own) + 1j * sin(own)
    sine = sin(about_l) / momentum
    one = (cos(about_l) + 1j * (sine * (along * z))) * turn
    other = (sine * (across * x) + 1j * (sine * (across * y))) * turn.conjugate()
    across_spin = (x + 1j * y) * (turn * turn).conjugate()
    vector = _rolled((other.real, other.imag, one.imag), 2 - axis)
    return packed((*vector, one.real), time.shape), packed(
        _rolled((across_spin.real, across_spin.imag, z), 2 - axis), time.shape
    )


def period(moments: Float, angular_velocity: Float) -> Float:
    """Return 2π/|β| (N,), after which ω recurs in a body with two equal moments; infinite where it is kept."""
    _, inertia, spin = _frame(moments, angular_velocity, None)
    _, _, (back, _) = _rates(inertia, spin)
    cycle = where(back == 0, np.inf, 2.0 * np.pi / where(back == 0, 1.0, abs(back)))
    return np.reshape(cycle, -1)


def _frame(
    moments: Float, angular_velocity: Float, rest: tuple[Float, Float] | None
) -> tuple[Number, list[Pair], list[Pair]]:
    """Return the number of the symmetry axis, and moments and ω of bodies (N, 3) in the order that puts it third."""
    inertia_rest, spin_rest = rest or (None, None)
    inertia, spin = _pairs(moments, inertia_rest), _pairs(angular_velocity, spin_rest)
    (x, x_low), (y, y_low), (z, z_low) = inertia
    axis = where((y == z) & (y_low == z_low), 0, where((z == x) & (z_low == x_low), 1, 2))
    shift = (axis + 1) % 3
    return axis, _rolled_pairs(inertia, shift), _rolled_pairs(spin, shift)


def _pairs(vectors: Float, rest: Float | None) -> list[Pair]:
    """Return the columns of vectors (N, 3), with what float64 leaves out of them."""
    low = (0.0, 0.0, 0.0) if rest is None else columns(rest[:, None])
    return list(zip(columns(vectors[:, None]), low, strict=True))


def _rates(inertia: list[Pair], spin: list[Pair]) -> tuple[Number, Pair, Pair]:
    """Return |L|, |L|/I and β, from the moments and from ω with the symmetry axis third."""
    across, _, along = inertia
    momentum = _length([double_double.multiply(i, w) for i, w in zip((across, across, along), spin, strict=True)])
    lead = double_double.divide(momentum, across)
    apart = double_double.add(across, double_double.minus(along))
    return momentum[0], lead, double_double.divide(double_double.multiply(apart, spin[2]), across)


def _half_turn(rate: Pair, time: Float) -> Number:
    """Return half the angle turned at rate rad/s until time (N, n), within ±π."""
    (t,) = columns(time[..., None])
    _, phase = double_double.reduce(double_double.times(rate, t), _FOUR_PI)
    return 0.5 * phase[0]


def _length(vector: list[Pair]) -> Pair:
    x, y, z = (double_double.multiply(component, component) for component in vector)
    square = double_double.add(double_double.add(x, y), z)
    zero = square[0] == 0
    root = double_double.square_root(select(zero, (1.0, 0.0), square))
    return select(zero, double_double.ZERO, root)


def _rolled_pairs(pairs: list[Pair], shift: Number) -> list[Pair]:
    high, low = (_rolled(tuple(each), shift) for each in zip(*pairs, strict=True))
    return list(zip(high, low, strict=True))


def _rolled(vector: tuple[Number, ...], shift: Number) -> tuple[Number, ...]:
    """Return x, y, z (shift 0), y, z, x (1) or z, x, y (2)."""
    x, y, z = vector
    return select(shift == 0, (x, y, z), select(shift == 1, (y, z, x), (z, x, y)))
