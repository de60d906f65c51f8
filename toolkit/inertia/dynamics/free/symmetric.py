"""Free rotation that needs sines only: steady rotation, and the symmetric top with its two uniform turns."""

from __future__ import annotations

import numpy as np

from inertia.dynamics import quaternion
from inertia.dynamics.special import extended
from inertia.dynamics.special.extended import Number, Pair
from inertia.mesh.part import Float

_FOUR_PI = (4.0 * extended.PI[0], 4.0 * extended.PI[1])


def steady(angular_velocity: Float, time: Float) -> tuple[Float, Float]:
    """Return attitude (N, n, 4) and ω (N, n, 3) of bodies that keep their angular_velocity (N, 3), at time (N, n).

    R(t) = exp(ω t): a principal axis, a spherical top (textbook § 13.18), or rest.
    """
    attitude = _turn(angular_velocity, _length([extended.of(w[:, None]) for w in angular_velocity.T]), time)
    return attitude, np.broadcast_to(angular_velocity[:, None], (*time.shape, 3))


def symmetric(moments: Float, angular_velocity: Float, time: Float) -> tuple[Float, Float]:
    """Return attitude (N, n, 4) and ω (N, n, 3) of bodies with two equal moments (N, 3), at time (N, n).

    R(t) = exp(L t / I) exp(e β t), β = (1 − I_s/I) ω_s: about L, fixed in space, at |L|/I, and about the symmetry axis
    e at β, seen from which the rest of ω turns backwards (textbook § 13.20, Ω = −β). I_s may be zero, a rod, whose
    spin about itself is then kept.
    """
    axis, lead, back = _rates(moments, angular_velocity)
    own = _turn(axis, back, time)
    attitude = quaternion.multiply(_turn(moments * angular_velocity, lead, time), own)
    about = axis * angular_velocity
    omega = quaternion.to_body(own, (angular_velocity - about)[:, None]) + about[:, None]
    return attitude, omega


def period(moments: Float, angular_velocity: Float) -> Float:
    """Return 2π/|β| (N,), after which ω recurs in a body with two equal moments; infinite where it is kept."""
    _, _, (back, _) = _rates(moments, angular_velocity)
    still = back[:, 0] == 0
    return np.where(still, np.inf, 2.0 * np.pi / np.where(still, 1.0, np.abs(back[:, 0])))


def _rates(moments: Float, angular_velocity: Float) -> tuple[Float, Pair, Pair]:
    """Return the symmetry axis (N, 3), |L|/I and β (N, 1)."""
    x, y, z = moments.T
    which = np.argmax([y == z, z == x, x == y], axis=0)
    rows = np.arange(len(moments))
    along, across = moments[rows, which][:, None], moments[rows, which - 1][:, None]
    spin = angular_velocity[rows, which][:, None]
    components = zip(moments.T[..., None], angular_velocity.T[..., None], strict=True)
    momentum = [extended.two_product(i, w) for i, w in components]
    lead = extended.divide(_length(momentum), (across, 0.0))
    back = extended.divide(extended.times(extended.two_sum(across, -along), spin), (across, 0.0))
    return np.eye(3)[which], lead, back


def _turn(axis: Float, rate: Pair, time: Float) -> Float:
    """Return the turn (N, n, 4) about axis (N, 3), of any length, at rate (N, 1) rad/s, reduced to 4π."""
    _, phase = extended.reduce(extended.times(rate, time), _FOUR_PI)
    half = 0.5 * phase[0]
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    unit = axis / np.where(length > 0, length, 1.0)
    return np.concatenate([np.sin(half)[..., None] * unit[:, None], np.cos(half)[..., None]], axis=-1)


def _length(vector: list[Pair]) -> Pair:
    x, y, z = (extended.multiply(component, component) for component in vector)
    square = extended.add(extended.add(x, y), z)
    zero: Number = square[0] == 0
    root = extended.square_root(extended.select(zero, (1.0, 0.0), square))
    return extended.select(zero, extended.ZERO, root)
