"""Free rotation that needs sines only: steady rotation, and the symmetric top with its two uniform turns."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.special import double_double
from inertia.dynamics.special.double_double import Pair
from inertia.dynamics.special.elementary import Number, columns, cos, packed, select, sin, where

_FOUR_PI = (4.0 * double_double.PI[0], 4.0 * double_double.PI[1])


def steady(angular_velocity: Float, time: Float) -> tuple[Float, Float]:
    """Return attitude (N, n, 4) and ω (N, n, 3) of bodies that keep their angular_velocity (N, 3), at time (N, n).

    R(t) = exp(ω t): a principal axis, a spherical top (textbook § 13.18), or rest.
    """
    omega = columns(angular_velocity[:, None])
    speed = _length([double_double.of(w) for w in omega])
    half = _half_turn(speed, time)
    sine = sin(half) / where(speed[0] > 0, speed[0], 1.0)
    return packed((*(sine * w for w in omega), cos(half)), time.shape), packed(omega, time.shape)


def symmetric(moments: Float, angular_velocity: Float, time: Float) -> tuple[Float, Float]:
    """Return attitude (N, n, 4) and ω (N, n, 3) of bodies with two equal moments (N, 3), at time (N, n).

    R(t) = exp(L t / I) exp(e β t), β = (1 − I_s/I) ω_s: about L, fixed in space, at |L|/I, and about the symmetry axis
    e at β, seen from which the rest of ω turns backwards (textbook § 13.20, Ω = −β). I_s may be zero, a rod, whose
    spin about itself is then kept. With e as axis 3 of a frame in the body, both are products of complex numbers: the
    attitude is w + iz and x + iy.
    """
    axis, (across, _, along), (x, y, z) = _frame(moments, angular_velocity)
    momentum, lead, back = _rates(across, along, (x, y, z))
    about_l, own = _half_turn(lead, time), _half_turn(back, time)
    turn = cos(own) + 1j * sin(own)
    sine = sin(about_l) / momentum
    one = (cos(about_l) + 1j * (sine * (along * z))) * turn
    other = (sine * (across * x) + 1j * (sine * (across * y))) * turn.conjugate()
    rest = (x + 1j * y) * (turn * turn).conjugate()
    vector = _rolled((other.real, other.imag, one.imag), 2 - axis)
    return packed((*vector, one.real), time.shape), packed(_rolled((rest.real, rest.imag, z), 2 - axis), time.shape)


def period(moments: Float, angular_velocity: Float) -> Float:
    """Return 2π/|β| (N,), after which ω recurs in a body with two equal moments; infinite where it is kept."""
    _, (across, _, along), spin = _frame(moments, angular_velocity)
    _, _, (back, _) = _rates(across, along, spin)
    cycle = where(back == 0, np.inf, 2.0 * np.pi / where(back == 0, 1.0, abs(back)))
    return np.reshape(cycle, -1)


def _frame(moments: Float, angular_velocity: Float) -> tuple[Number, tuple[Number, ...], tuple[Number, ...]]:
    """Return the number of the symmetry axis, and moments and ω of bodies (N, 3) in the order that puts it third."""
    x, y, z = columns(moments[:, None])
    axis = where(y == z, 0, where(z == x, 1, 2))
    shift = (axis + 1) % 3
    return axis, _rolled((x, y, z), shift), _rolled(columns(angular_velocity[:, None]), shift)


def _rates(across: Number, along: Number, spin: tuple[Number, ...]) -> tuple[Number, Pair, Pair]:
    """Return |L|, |L|/I and β, from the moments I and I_s and from ω with the symmetry axis third."""
    x, y, z = spin
    momentum = _length([double_double.two_product(i, w) for i, w in ((across, x), (across, y), (along, z))])
    lead = double_double.divide(momentum, (across, 0.0))
    back = double_double.divide(double_double.times(double_double.two_sum(across, -along), z), (across, 0.0))
    return momentum[0], lead, back


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


def _rolled(vector: tuple[Number, ...], shift: Number) -> tuple[Number, ...]:
    """Return x, y, z (shift 0), y, z, x (1) or z, x, y (2)."""
    x, y, z = vector
    return select(shift == 0, (x, y, z), select(shift == 1, (y, z, x), (z, x, y)))
