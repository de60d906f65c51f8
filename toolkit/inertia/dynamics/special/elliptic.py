"""Elliptic functions and integrals from the complementary parameter mc = 1 − m, which is what a separatrix makes small.

Nothing here forms 1 − mc: parameters given as m have lost their digits before any formula sees them. All functions
broadcast. `complete` alone works in double-double, for the periods that long times are reduced by.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from inertia.dynamics.special import extended
from inertia.dynamics.special.extended import Pair
from inertia.mesh.part import Float


def sncndn(u: ArrayLike, mc: ArrayLike) -> tuple[Float, Float, Float]:
    """Return the Jacobi functions sn, cn, dn of u at the complementary parameter 0 ≤ mc ≤ 1.

    Arithmetic–geometric means down to a circular function, then Landen's transformation back, in the form that adds
    positive terms only (R. Bulirsch, *Numerical calculation of elliptic integrals and elliptic functions*, Numer.
    Math. 7 (1965) 78). At mc = 0, the separatrix, tanh u, sech u, sech u.

    >>> [float(f) for f in sncndn(0.5, 1.0)]  # sin, cos, 1
    [0.479425538604203, 0.8775825618903728, 1.0]
    """
    u, mc = np.asarray(u, dtype=np.float64), np.asarray(mc, dtype=np.float64)
    open_ended = mc == 0
    ladder = _means(np.where(open_ended, 1.0, mc))
    mean = 0.5 * (ladder[-1][0] + ladder[-1][1])
    sine, cosine = np.sin(mean * u), np.cos(mean * u)
    small = np.abs(sine) < 1e-150  # u itself: the cotangent of less would leave float64
    a = cosine / np.where(small, 1.0, sine)
    c = mean * a
    dn = np.ones_like(c)
    for arithmetic, geometric in reversed(ladder):
        a = c * a
        c = dn * c
        dn = (geometric + a) / (arithmetic + a)
        a = c / arithmetic
    sn = np.copysign(1.0 / np.hypot(c, 1.0), sine)
    cn = c * sn
    sn, cn, dn = np.where(small, u, sn), np.where(small, 1.0, cn), np.where(small, 1.0, dn)
    if np.any(open_ended):
        sech = 1.0 / np.cosh(np.clip(u, -710.0, 710.0))
        sn, cn, dn = (np.where(open_ended, s, f) for s, f in ((np.tanh(u), sn), (sech, cn), (sech, dn)))
    return sn, cn, dn


def _means(mc: Float) -> list[tuple[Float, Float]]:
    """Return the arithmetic and geometric means of 1 and √mc, down to where their own mean is their limit."""
    a, g = np.ones_like(mc), np.sqrt(mc)
    ladder = [(a, g)]
    while np.any(a - g > 1e-8 * a):
        a, g = 0.5 * (a + g), np.sqrt(a * g)
        ladder.append((a, g))
    return ladder


def quarter_period(mc: ArrayLike) -> Float:
    """Return K; infinite at mc = 0."""
    from scipy.special import ellipkm1

    return np.asarray(ellipkm1(mc))


def first_kind(sn: ArrayLike, cn: ArrayLike, mc: ArrayLike) -> Float:
    """Return the argument u, −K … K, whose sn and cn ≥ 0 are given: s R_F(c², c² + mc s², 1) (Carlson 1995, 4.5)."""
    from scipy.special import elliprf

    s, c, mc = (np.asarray(x, dtype=np.float64) for x in (sn, cn, mc))
    return np.asarray(s * elliprf(c * c, c * c + mc * s * s, 1.0))


def third_kind(sn: Float, cn: Float, dn: Float, mc: Float, n: Float) -> Float:
    """Return J = ∫₀ᵘ cn² / (1 + n sn²) du for −K ≤ u ≤ K and 0 ≤ n, from the Jacobi functions of u.

    J = arctan(w s c/d) / w + mc/(3 (1 + n)) s³ R_J(c², d², 1, c² + mc s²/(1 + n)), w² = n (m + n)/(1 + n): the
    symmetric integral R_F − (1 + n)/3 R_J(…, 1 + n s²), its parameter changed (DLMF 19.21.12) so that the terms add.
    The integrand vanishes with cn on the unstable axis: J stays finite as mc → 0, where the arctangent is all of it.
    """
    from scipy.special import elliprj

    cn = np.maximum(cn, 0.0)  # u may be beyond ±K by a rounding
    c2, d2 = cn * cn, dn * dn
    w = np.sqrt(n * (1.0 - mc / (1.0 + n)))  # (m + n)/(1 + n) is no difference of near numbers unless n and m vanish
    x = sn * cn / np.where(dn == 0, 1.0, dn)
    circular = np.where(w > 0, np.arctan(w * x) / np.where(w > 0, w, 1.0), x)
    share = mc / (1.0 + n)
    none = share == 0
    c2, d2 = np.where(none, 1.0, c2), np.where(none, 1.0, d2)
    rest = elliprj(c2, d2, 1.0, c2 + share * (sn * sn))
    return np.asarray(circular + share / 3.0 * sn**3 * rest)


def complete(kc: Pair, n: Pair) -> tuple[Pair, Pair]:
    """Return K and J(K), in double-double, for kc = √mc > 0 and n ≥ 0.

    π/2 over the arithmetic–geometric mean, and Bulirsch's cel(kc, 1 + n, 1, 0), all of positive terms, on the same
    ladder (*Numerical calculation of elliptic integrals and elliptic functions III*, Numer. Math. 13 (1969) 305).
    """
    ea = extended
    mean, other = ea.of(0.0 * kc[0] + 1.0), kc
    product = kc
    p = ea.square_root(ea.add(mean, n))
    a, b = mean, ea.ZERO
    doubled = 0.5
    while True:
        quotient = ea.divide(product, p)
        a, b = ea.add(a, ea.divide(b, p)), _twice(ea.add(b, ea.multiply(a, quotient)))
        p = ea.add(p, quotient)
        close = np.all(abs(mean[0] - other[0]) <= 1e-16 * mean[0])
        mean, other = ea.add(mean, other), _twice(ea.square_root(product))
        doubled *= 2.0
        if close:
            break
        product = ea.multiply(mean, other)
    half_turn = ea.times(ea.PI, doubled)
    sums = ea.divide(ea.add(b, ea.multiply(a, mean)), ea.multiply(mean, ea.add(mean, p)))
    return ea.divide(half_turn, mean), ea.multiply(ea.times(ea.PI, 0.5), sums)


def _twice(x: Pair) -> Pair:
    return 2.0 * x[0], 2.0 * x[1]
