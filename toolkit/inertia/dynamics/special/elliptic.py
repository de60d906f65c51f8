"""Elliptic functions and integrals from the complementary parameter mc = 1 − m, which is what a separatrix makes small.

Nothing here forms 1 − mc: parameters given as m have lost their digits before any formula sees them. All functions
broadcast arrays, and take floats alone to floats. `complete` alone works in double-double, for the periods that long
times are reduced by.
"""

from __future__ import annotations

from typing import TypeVar

from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.special import double_double as ea
from inertia.dynamics.special.double_double import Pair
from inertia.dynamics.special.elementary import Number, anywhere, arctan, cos, exp, number, sin, sqrt, tanh, where

Value = TypeVar("Value", float, Float)

_FARTHEST = 700.0
"""Where sech u is as near to zero as it gets: beyond, cn/dn would be lost, which is 1."""


def sncndn(u: Number, mc: Number) -> tuple[Number, Number, Number]:
    """Return the Jacobi functions sn, cn, dn of u at the complementary parameter 0 ≤ mc ≤ 1.

    Arithmetic–geometric means down to a circular function, then Landen's transformation back, in the form that adds
    positive terms only (R. Bulirsch, *Numerical calculation of elliptic integrals and elliptic functions*, Numer.
    Math. 7 (1965) 78). At mc = 0, the separatrix, tanh u, sech u, sech u.

    >>> [float(f) for f in sncndn(0.5, 1.0)]  # sin, cos, 1
    [0.479425538604203, 0.8775825618903728, 1.0]
    """
    u, mc = number(u), number(mc)
    open_ended = mc == 0
    ladder = _means(where(open_ended, 1.0, mc))
    mean = 0.5 * (ladder[-1][0] + ladder[-1][1])
    phase = mean * u
    sine = sin(phase)
    small = abs(sine) < 1e-150  # u itself: the cotangent of less would leave float64
    a = cos(phase) / where(small, 1.0, sine)
    c = mean * a
    dn = 1.0
    for arithmetic, geometric in reversed(ladder):
        a = c * a
        c = dn * c
        dn = (geometric + a) / (arithmetic + a)
        a = c / arithmetic
    sn = where(sine < 0, -1.0, 1.0) / sqrt(c * c + 1.0)
    cn = c * sn
    sn, cn, dn = where(small, u, sn), where(small, 1.0, cn), where(small, 1.0, dn)
    if anywhere(open_ended):
        decay = exp(-where(abs(u) < _FARTHEST, abs(u), _FARTHEST))
        sech = 2.0 * decay / (1.0 + decay * decay)
        sn, cn, dn = where(open_ended, tanh(u), sn), where(open_ended, sech, cn), where(open_ended, sech, dn)
    return sn, cn, dn


def _means(mc: Number) -> list[tuple[Number, Number]]:
    """Return the arithmetic and geometric means of 1 and √mc, down to where their own mean is their limit."""
    a, g = 1.0, sqrt(mc)
    ladder = [(a, g)]
    while anywhere(a - g > 1e-8 * a):
        a, g = 0.5 * (a + g), sqrt(a * g)
        ladder.append((a, g))
    return ladder


def first_kind(sn: ArrayLike, cn: ArrayLike, mc: ArrayLike) -> Number:
    """Return the argument u, −K … K, whose sn and cn ≥ 0 are given: s R_F(c², c² + mc s², 1) (Carlson 1995, 4.5)."""
    from scipy.special import elliprf

    s, c, mc = number(sn), number(cn), number(mc)
    return number(s * elliprf(c * c, c * c + mc * s * s, 1.0))


def third_kind(sn: Value, cn: Value, dn: Value, mc: Number, n: Number) -> Value:
    """Return J = ∫₀ᵘ cn² / (1 + n sn²) du for −K ≤ u ≤ K and 0 ≤ n, from the Jacobi functions of u.

    J = arctan(w s c/d) / w + mc/(3 (1 + n)) s³ R_J(c², d², 1, c² + mc s²/(1 + n)), w² = n (m + n)/(1 + n): the
    symmetric integral R_F − (1 + n)/3 R_J(…, 1 + n s²), its parameter changed (DLMF 19.21.12) so that the terms add.
    The integrand vanishes with cn on the unstable axis: J stays finite as mc → 0, where the arctangent is all of it.
    """
    from scipy.special import elliprj

    cn = where(cn > 0, cn, 0.0)  # u may be beyond ±K by a rounding
    s2, c2, d2 = sn * sn, cn * cn, dn * dn
    share = mc / (1.0 + n)
    w = sqrt(n * (1.0 - share))  # (m + n)/(1 + n) is no difference of near numbers unless n and m vanish
    x = sn * cn / where(dn == 0, 1.0, dn)
    circular = where(w > 0, arctan(w * x) / where(w > 0, w, 1.0), x)
    none = share == 0
    c2, d2 = where(none, 1.0, c2), where(none, 1.0, d2)
    rest = elliprj(c2, d2, 1.0, c2 + share * s2)
    integral: Value = number(circular + share / 3.0 * (sn * s2) * rest)
    return integral


def complete(kc: Pair, n: Pair) -> tuple[Pair, Pair]:
    """Return K and J(K), in double-double, for kc = √mc > 0 and n ≥ 0.

    π/2 over the arithmetic–geometric mean, and Bulirsch's cel(kc, 1 + n, 1, 0), all of positive terms, on the same
    ladder (*Numerical calculation of elliptic integrals and elliptic functions III*, Numer. Math. 13 (1969) 305). Once
    the means differ by a part of 1e-16, one step more is to put half their sum for both, to the square of that.
    """
    mean, other, product = (1.0, 0.0), kc, kc
    p = ea.square_root(ea.add(mean, n))
    a, b = mean, ea.ZERO
    doubled = 0.5
    while True:
        quotient = ea.divide(product, p)
        a, b = ea.add(a, ea.divide(b, p)), _times(2.0, ea.add(b, ea.multiply(a, quotient)))
        p = ea.add(p, quotient)
        apart = anywhere(abs(mean[0] - other[0]) > 1e-8 * mean[0])
        mean, other = ea.add(mean, other), _times(2.0, ea.square_root(product))
        doubled *= 2.0
        if not apart:
            break
        product = ea.multiply(mean, other)
    mean = _times(0.5, ea.add(mean, other))
    sums = ea.divide(ea.add(b, ea.multiply(a, mean)), ea.multiply(mean, ea.add(mean, p)))
    return ea.divide(_times(doubled, ea.PI), mean), _times(0.5, ea.multiply(ea.PI, sums))


def _times(power_of_two: float, x: Pair) -> Pair:
    return power_of_two * x[0], power_of_two * x[1]
