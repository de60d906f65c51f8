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

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.special import elliptic
from inertia.dynamics.special.double_double import (
    PI,
    Pair,
    add,
    divide,
    minus,
    modulo,
    multiply,
    reduce,
    several,
    square_root,
    times,
)
from inertia.dynamics.special.elementary import Number, columns, cos, packed, select, sin, sqrt, where
from inertia.records import dataclass

_ENDLESS = 1e200
"""Half a period of u on the separatrix: no time is that long."""

_EPSILON = 2.0**-52
_FOUR_PI = (4.0 * PI[0], 4.0 * PI[1])


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """The constants of N motions, as (N, 1) arrays, or as floats where N = 1.

    Attributes
    ----------
    axes, signs : the body axis, and the direction along it, of each axis of the frame: (i, j, k) where `about_k`,
        else (k, −j, i)
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
    closeness : d over the sum of the two terms it is the difference of, times how close moments are to each other
        where those have more digits than a float64
    """

    axes: tuple[Number, Number, Number]
    signs: tuple[Number, Number, Number]
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


def closed_form(moments: Float, angular_velocity: Float, rest: tuple[Float, Float] | None = None) -> ClosedForm:
    """Return the constants of N motions about three different moments (N, 3), from angular_velocity (N, 3).

    Both are of the order of 1; two components of ω at least are not zero, and those are not tiny
    (`inertia.dynamics.models.free.initial_conditions` sees to it). `rest` is what float64 leaves out of both, (N, 3).
    """
    low, middle, high = _ascending(moments, angular_velocity, rest)
    momentum = [multiply(moment, w) for moment, w, _ in (low, middle, high)]
    tl, tj, th = (multiply(m, each[1]) for m, each in zip(momentum, (low, middle, high), strict=True))
    (b, (y, _), j), negative = middle, minus(low[0])
    lower, upper, ca = add(b, negative), add(high[0], minus(b)), add(high[0], negative)
    one, other = multiply(th, upper), multiply(tl, lower)
    d = add(one, minus(other))
    p, q = add(multiply(tl, ca), multiply(tj, upper)), add(multiply(tj, lower), multiply(th, ca))
    high_kept = d[0] >= 0
    a, c = select(high_kept, low[0], high[0]), select(high_kept, high[0], low[0])
    (x, i), (z, k) = (
        (where(high_kept, s[1][0], t[1][0]), where(high_kept, s[2], t[2])) for s, t in ((low, high), (high, low))
    )
    ba, cb = select(high_kept, lower, upper), select(high_kept, upper, lower)
    p, q = select(high_kept, p, q), select(high_kept, q, p)
    d = select(high_kept, d, minus(d))
    g = square_root(_sum(*(multiply(m, m) for m in momentum)))
    sign_i, sign_k = where(x < 0, -1.0, 1.0), where(z < 0, -1.0, 1.0)
    sign_j = where((j - i) % 3 == 1, sign_i * sign_k, -sign_i * sign_k)

    cb_q, ab = multiply(cb, q), multiply(a, b)
    rate = square_root(divide(cb_q, multiply(ab, c)))
    mc = divide(multiply(ca, d), cb_q)
    ap, cq = multiply(p, a), multiply(q, c)
    about_k = ap[0] >= cq[0]
    n = divide(select(about_k, multiply(ba, c), ap), select(about_k, multiply(cb, a), cq))
    precession = divide(select(about_k, g, _sum(tl, tj, th)), select(about_k, b, g))
    share = divide(select(about_k, multiply(g, ba), minus(p)), multiply(rate, select(about_k, ab, multiply(g, c))))
    endless = mc[0] == 0
    quarter, third = elliptic.complete(square_root(select(endless, (1.0, 0.0), mc)), n)
    half_period = select(endless, (_ENDLESS, 0.0), times(quarter, 2.0))

    root_p = sqrt(p[0])
    wobbles = root_p > 0
    divisor = where(wobbles, root_p, 1.0)
    sn, cn = sign_j * y * sqrt(b[0] * cb[0]) / divisor, where(wobbles, abs(x) * sqrt(a[0] * ca[0]) / divisor, 1.0)
    dn = sqrt(cn * cn + mc[0] * sn * sn)
    start = elliptic.first_kind(sn, cn, mc[0]), sn, cn, dn, elliptic.third_kind(sn, cn, dn, mc[0], n[0])
    ca_g = sqrt(ca[0]) * g[0]
    # Moments of one float64 each have an exact difference, those of two lose what is alike in them.
    alike = 1.0 if rest is None else 1.0 + b[0] / lower[0] + high[0][0] / upper[0]
    return ClosedForm(
        axes=select(about_k, (i, j, k), (k, j, i)),
        signs=select(about_k, (sign_i, sign_j, sign_k), (sign_k, -sign_j, sign_i)),
        about_k=about_k,
        reach=(sqrt(ap[0]) / ca_g, root_p * sqrt(b[0] / cb[0]) / g[0], sqrt(cq[0]) / ca_g),
        spin=(g[0] / where(about_k, a[0], c[0]), g[0] / b[0], g[0] / where(about_k, c[0], a[0])),
        rate=select(high_kept, rate, minus(rate)),
        half_period=half_period,
        start=start,
        mc=mc[0],
        n=n[0],
        precession=precession,
        turn=multiply(times(share, 2.0), third),
        share=share[0],
        closeness=d[0] / (one[0] + other[0]) / alike,
    )


def evaluate(motion: ClosedForm, time: Float) -> tuple[Float, Float]:
    """Return attitude (N, n, 4), the identity at time 0, and ω (N, n, 3), at time (N, n)."""
    (t,) = columns(time[..., None])
    u0, *at_start, j0 = motion.start
    count, u = reduce(add(times(motion.rate, t), (u0, 0.0)), motion.half_period)
    sn, cn, dn = elliptic.sncndn(u[0] + u[1], motion.mc)
    _, phase = reduce(add(times(motion.precession, t), several(motion.turn, count)), _FOUR_PI)
    half = 0.5 * (phase[0] + motion.share * (elliptic.third_kind(sn, cn, dn, motion.mc, motion.n) - j0))
    turn = cos(half) + 1j * sin(half)
    halves = modulo(count, 4.0)  # half periods, each of which turns sn and cn over: about k, half a turn of the frame
    odd = halves % 2
    sign = 1.0 - 2.0 * odd
    quarter = where(motion.about_k, (1.0 - odd) * (1.0 - halves) + 1j * (odd * (2.0 - halves)), 1.0)
    x, y, z = _momentum(motion, (sn, cn, dn), where(motion.about_k, 1.0, sign))
    a, b = _towards(x, y, z)
    a, b = turn * quarter.conjugate() * a, turn * quarter * b
    a0, b0 = _towards(*_momentum(motion, at_start, 1.0))
    along, across = a0.conjugate() * a + b0 * b.conjugate(), a0.conjugate() * b - b0 * a.conjugate()
    sign = where(motion.about_k, sign, 1.0)
    omega = [f * w for f, w in zip((sign * x, sign * y, z), motion.spin, strict=True)]
    attitude = *_along_body_axes(motion, across.real, across.imag, along.imag), along.real
    return packed(attitude, time.shape), packed(_along_body_axes(motion, *omega), time.shape)


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
    error: Float = _EPSILON * (4.0 + 2.0 * np.minimum(u, motion.half_period[0]) + _EPSILON * flips / closeness)
    return error


def _ascending(moments: Float, spin: Float, rest: tuple[Float, Float] | None) -> list[tuple[Pair, Pair, Number]]:
    """Return moment, ω and number of each axis, by ascending moment."""
    parts = [columns(each[:, None]) for each in (moments, spin)]
    parts += [(0.0, 0.0, 0.0)] * 2 if rest is None else [columns(each[:, None]) for each in rest]
    axes = [(*part, axis) for axis, part in enumerate(zip(*parts, strict=True))]
    for k, n in ((0, 1), (1, 2), (0, 1)):
        swap = (axes[k][0] > axes[n][0]) | (axes[k][0] == axes[n][0]) & (axes[k][2] > axes[n][2])
        axes[k], axes[n] = select(swap, axes[n], axes[k]), select(swap, axes[k], axes[n])
    return [((moment, low), (w, slow), axis) for moment, w, low, slow, axis in axes]


def _along_body_axes(motion: ClosedForm, x: Number, y: Number, z: Number) -> tuple[Number, ...]:
    """Return the components along the body axes of a vector along the axes of the frame."""
    (i, j, _), (u, v, w) = motion.axes, motion.signs
    x, y, z = u * x, v * y, w * z
    return tuple([where(i == axis, x, where(j == axis, y, z)) for axis in range(3)])


def _momentum(motion: ClosedForm, functions: Sequence[Number], sign: Number) -> tuple[Number, Number, Number]:
    """Return M / G along the axes of the frame, from sn, cn, dn."""
    sn, cn, dn = functions
    a, b, c = motion.reach
    a, b, c = a * cn, b * sn, c * dn
    return select(motion.about_k, (a, b, c), (c, -sign * b, sign * a))


def _towards(x: Number, y: Number, z: Number) -> tuple[Number, Number]:
    """Return the attitude that takes the direction (x ≥ 0, y, z) to the space axis 3, as w + iz and x + iy.

    The direction is brought into the plane 1, 3 about axis 3 and to axis 3 about axis 2. In these two numbers, the
    Cayley–Klein parameters (A, B), an attitude that follows a turn e^(iφ/2) about axis 3 is (A e^(iφ/2), B e^(−iφ/2)),
    and one that such a turn follows (A e^(iφ/2), B e^(iφ/2)).
    """
    cosine = sqrt(0.5 * (1.0 + z))
    across = sqrt(x * x + y * y)
    sine = 0.5 * across / cosine
    real = sqrt(0.5 * (1.0 + x / across))
    imaginary = 0.5 * (y / across) / real
    return cosine * real - 1j * (cosine * imaginary), sine * imaginary - 1j * (sine * real)


def _sum(x: Pair, y: Pair, z: Pair) -> Pair:
    return add(add(x, y), z)
