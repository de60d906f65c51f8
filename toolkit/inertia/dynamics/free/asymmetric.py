"""The free asymmetric top in closed form: attitude and angular velocity at any time, at a cost that no time changes.

With the axes named i, j, k so that j is the intermediate one and k the one whose momentum M_k keeps its sign, and
moments a, b, c about them, G = |L| and T the kinetic energy,

    M = (A cn u, B sn u, C dn u),  u = u₀ ± λ t,  λ² = |c−b| q / (a b c),  mc = |c−a| d / (|c−b| q),
    p = |2Tc − G²| = a ω_i² |c−a| + b ω_j² |c−b|,  q = |G² − 2Ta| = b ω_j² |b−a| + c ω_k² |c−a|,
    d = |G² − 2Tb| = c ω_k² |c−b| − a ω_i² |b−a|,  A² = a p/|c−a|,  B² = b p/|c−b|,  C² = c q/|c−a|;

d alone is a difference, and is formed in double-double. The attitude turns about L, fixed in space, by the third
angle φ of the body axis k or i: of whichever stays farther from L, so that |L⊥|² ≥ G²/2 and nothing is singular. With
J = ∫ cn²/(1 + n sn²) du,

    axis k (A ≥ C):  φ = G t/b + G |b−a|/(a b λ) ΔJ,  n = c |b−a|/(a |c−b|) ≤ 1;
    axis i (A < C):  φ = (2T/G) t − p/(c G λ) ΔJ,     n = A²/C² < 1.

J is finite on the separatrix, where both rates are that of the steady rotation. λ t and φ are reduced to one period in
double-double, periods included, so that time adds no error.

Source: R. van Zon and J. Schofield, *Numerical implementation of the exact dynamics of free rigid bodies*, J. Comput.
Phys. 225 (2007) 145, for the functions; E. Celledoni, F. Fassò, N. Säfström, A. Zanna, *The exact computation of the
free rigid body motion and its use in splitting methods*, SIAM J. Sci. Comput. 30 (2008) 2084, for the choice of axis;
the third angle follows from φ' = G (2T − ω·M of the axis)/|L⊥|².
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inertia.dynamics import quaternion
from inertia.dynamics.special import elliptic
from inertia.dynamics.special.extended import (
    PI,
    Number,
    Pair,
    add,
    divide,
    minus,
    multiply,
    reduce,
    select,
    square_root,
    times,
    two_product,
    two_sum,
)
from inertia.mesh.part import Float

_ENDLESS = 1e200
"""Half a period of u on the separatrix: no time is that long."""

_EPSILON = 2.0**-52
_FOUR_PI = (4.0 * PI[0], 4.0 * PI[1])
_QUARTER_COSINES = np.array([1.0, 0.0, -1.0, 0.0])


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """The constants of N motions, as (N, 1) arrays, or as floats where N = 1.

    Attributes
    ----------
    axes, signs : (N, 1, 3) the body axis, and the direction along it, of each axis of the frame: (i, j, k) where
        `about_k`, else (k, −j, i)
    about_k : whether the third angle is that of axis k
    reach : A, B, C over G
    spin : G over the moment about each axis of the frame
    rate : ±λ
    half_period : 2 K(mc), of u
    start : u₀, its sn, cn, dn and its J
    mc, n : of the elliptic functions and of J
    precession : dφ/dt, without J
    turn : what 2 K adds to φ by way of J
    share : the factor of J in φ
    closeness : d over the sum of the two terms it is the difference of
    """

    axes: NDArray[np.intp]
    signs: Float
    about_k: Number
    reach: tuple[Number, Number, Number]
    spin: tuple[Number, Number, Number]
    rate: Pair
    half_period: Pair
    start: tuple[Number, Number, Number, Number, Number]
    mc: Number
    n: Number
    precession: Pair
    turn: Pair
    share: Number
    closeness: Number


def closed_form(moments: Float, angular_velocity: Float) -> ClosedForm:
    """Return the constants of N motions about three different moments (N, 3), from angular_velocity (N, 3).

    Both are of the order of 1; two components of ω at least are not zero, and those are not tiny
    (`inertia.dynamics.free.starts` sees to it).
    """
    ijk, signs, sense = _axes(moments, angular_velocity)
    a, b, c = about = _columns(np.take_along_axis(moments, ijk, -1))
    x, y, _ = w = _columns(signs * np.take_along_axis(angular_velocity, ijk, -1))
    ba, cb, ca = (_difference(s, t, sense) for s, t in ((b, a), (c, b), (c, a)))
    momentum = [two_product(s, t) for s, t in zip(about, w, strict=True)]
    ti, tj, tk = (times(s, t) for s, t in zip(momentum, w, strict=True))
    g = square_root(_sum(*(multiply(s, s) for s in momentum)))
    p = add(multiply(ti, ca), multiply(tj, cb))
    q = add(multiply(tj, ba), multiply(tk, ca))
    one, other = multiply(tk, cb), multiply(ti, ba)
    d = add(one, minus(other))

    cb_q, ab = multiply(cb, q), two_product(a, b)
    rate = square_root(divide(cb_q, times(ab, c)))
    mc = divide(multiply(ca, d), cb_q)
    ap, cq = times(p, a), times(q, c)
    about_k = ap[0] >= cq[0]
    n = divide(select(about_k, times(ba, c), ap), select(about_k, times(cb, a), cq))
    precession = divide(select(about_k, g, _sum(ti, tj, tk)), select(about_k, (b, 0.0 * b), g))
    share = divide(select(about_k, multiply(g, ba), minus(p)), multiply(rate, select(about_k, ab, times(g, c))))
    endless = mc[0] == 0
    quarter, third = elliptic.complete(square_root(select(endless, (1.0, 0.0), mc)), n)
    half_period = select(endless, (_ENDLESS, 0.0), times(quarter, 2.0))

    root_p = np.sqrt(p[0])
    wobbles = root_p > 0
    divisor = np.where(wobbles, root_p, 1.0)
    sn, cn = y * np.sqrt(b * cb[0]) / divisor, np.where(wobbles, x * np.sqrt(a * ca[0]) / divisor, 1.0)
    dn = np.sqrt(cn * cn + mc[0] * sn * sn)
    start = elliptic.first_kind(sn, cn, mc[0]), sn, cn, dn, elliptic.third_kind(sn, cn, dn, mc[0], n[0])
    ca_g = np.sqrt(ca[0]) * g[0]
    ends_on_k = np.reshape(about_k, (-1, 1))
    return ClosedForm(
        axes=np.where(ends_on_k, ijk, ijk[:, ::-1])[:, None],
        signs=np.where(ends_on_k, signs, signs[:, ::-1] * (1.0, -1.0, 1.0))[:, None],
        about_k=about_k,
        reach=(np.sqrt(ap[0]) / ca_g, root_p * np.sqrt(b / cb[0]) / g[0], np.sqrt(cq[0]) / ca_g),
        spin=(g[0] / np.where(about_k, a, c), g[0] / b, g[0] / np.where(about_k, c, a)),
        rate=times(rate, sense),
        half_period=half_period,
        start=start,
        mc=mc[0],
        n=n[0],
        precession=precession,
        turn=multiply(times(share, 2.0), third),
        share=share[0],
        closeness=d[0] / (one[0] + other[0]),
    )


def evaluate(motion: ClosedForm, time: Float) -> tuple[Float, Float]:
    """Return attitude (N, n, 4), the identity at time 0, and ω (N, n, 3), at time (N, n) or (1, n)."""
    u0, *at_start, j0 = motion.start
    count, u = reduce(add(times(motion.rate, time), (u0, 0.0)), motion.half_period)
    sn, cn, dn = elliptic.sncndn(u[0] + u[1], motion.mc)
    _, phase = reduce(add(times(motion.precession, time), times(motion.turn, count)), _FOUR_PI)
    half = 0.5 * (phase[0] + motion.share * (elliptic.third_kind(sn, cn, dn, motion.mc, motion.n) - j0))
    sign = 1.0 - 2.0 * (count % 2)  # of sn and cn, half a period on: about k, half a turn of the frame
    x, y, z = _momentum(motion, (sn, cn, dn), np.where(motion.about_k, 1.0, sign))
    quarters = np.where(motion.about_k, count % 4, 0.0).astype(np.intp)
    attitude = quaternion.multiply(
        quaternion.conjugate(_towards(*_momentum(motion, at_start, 1.0))),
        _towards(x, y, z, (np.cos(half), np.sin(half)), (_QUARTER_COSINES[quarters], _QUARTER_COSINES[quarters - 1])),
    )
    sign = np.where(motion.about_k, sign, 1.0)
    omega = np.stack([f * w for f, w in zip((sign * x, sign * y, z), motion.spin, strict=True)], -1)
    back = np.argsort(motion.axes, axis=-1)
    attitude[..., :3] = np.take_along_axis(motion.signs * attitude[..., :3], back, -1)
    return attitude, np.take_along_axis(motion.signs * omega, back, -1)


def period(moments: Float, angular_velocity: Float) -> Float:
    """Return 4 K/λ (N,), after which ω recurs; infinite on the separatrix."""
    motion = closed_form(moments, angular_velocity)
    half = motion.half_period[0]
    cycle = np.where(motion.mc == 0, np.inf, 2.0 * half / np.abs(motion.rate[0]))
    return np.broadcast_to(cycle.reshape(-1), len(moments))


def rounding(motion: ClosedForm, time: Float) -> Float:
    """Return an estimate (N, n) in rad of the error of `evaluate` beyond that of a steady rotation.

    The roundings of u₀ and u, which reach K near the separatrix, and what double-double loses of d, once a half period.
    """
    u = np.abs(motion.rate[0] * time)
    flips = u / motion.half_period[0]
    closeness = np.where(motion.closeness > 0, motion.closeness, 1.0)
    error: Float = _EPSILON * (4.0 + np.minimum(u, motion.half_period[0]) + _EPSILON * flips / closeness)
    return error


def _axes(moments: Float, angular_velocity: Float) -> tuple[NDArray[np.intp], Float, Number]:
    """Return the axes i, j, k (N, 3), the directions (N, 3) along which ω_i, ω_k ≥ 0, and the sign of c − a."""
    order = np.argsort(moments, axis=-1)
    a, b, c = _columns(np.take_along_axis(moments, order, -1))
    x, _, z = _columns(np.take_along_axis(angular_velocity, order, -1))
    one = multiply(times(two_product(c, z), z), _difference(c, b, 1.0))
    other = multiply(times(two_product(a, x), x), _difference(b, a, 1.0))
    largest_kept = np.reshape(add(one, minus(other))[0] >= 0, (-1, 1))
    ijk = np.where(largest_kept, order, order[:, ::-1])
    signs = np.where(np.take_along_axis(angular_velocity, ijk, -1) < 0, -1.0, 1.0)
    right_handed = (ijk[:, 1] - ijk[:, 0]) % 3 == 1
    signs[:, 1] = np.where(right_handed, 1.0, -1.0) * signs[:, 0] * signs[:, 2]
    return ijk, signs, *_columns(np.where(largest_kept, 1.0, -1.0))


def _momentum(motion: ClosedForm, functions: Sequence[Number], sign: Number) -> tuple[Float, Float, Float]:
    """Return M / G along the axes of the frame, from sn, cn, dn."""
    sn, cn, dn = functions
    a, b, c = (f * g for f, g in zip(motion.reach, (cn, sn, dn), strict=True))
    return np.where(motion.about_k, a, c), np.where(motion.about_k, b, -sign * b), np.where(motion.about_k, c, sign * a)


def _towards(
    x: Float, y: Float, z: Float, half: tuple[Number, Number] = (1.0, 0.0), turn: tuple[Number, Number] = (1.0, 0.0)
) -> Float:
    """Return the attitude (…, 4) that takes the direction (x ≥ 0, y, z), turned about z, to the space axis 3.

    The direction is brought into the plane 1, 3 about axis 3 and to axis 3 about axis 2; `half` and `turn` are the
    cosine and sine of half the turn φ about the space axis 3 that follows, and of half the turn that precedes.
    """
    cosine = np.sqrt(0.5 * (1.0 + z))
    across = np.hypot(x, y)
    sine = 0.5 * across / cosine
    real = np.sqrt(0.5 * (1.0 + x / across))
    imaginary = 0.5 * (y / across) / real
    p, q = turn[0] * real - turn[1] * imaginary, turn[0] * imaginary + turn[1] * real
    c, s = half
    parts = sine * (s * p + c * q), sine * (s * q - c * p), cosine * (s * p - c * q), cosine * (c * p + s * q)
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _difference(x: Number, y: Number, sense: Number) -> Pair:
    high, low = two_sum(x, -y)
    return sense * high, sense * low


def _sum(x: Pair, y: Pair, z: Pair) -> Pair:
    return add(add(x, y), z)


def _columns(rows: Float) -> tuple[Number, ...]:
    """Return the columns of (N, k) rows as (N, 1) arrays, or as floats where N = 1: arithmetic on those is faster."""
    return tuple(rows[0].tolist()) if len(rows) == 1 else tuple(rows.T[..., None])
