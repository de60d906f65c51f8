"""Elliptic integrals of a few scalars in decimal arithmetic, to the digits of the context that the caller sets.

All arguments are such that only positive terms are added, so that a small complementary parameter or characteristic
costs no digits.
"""

from __future__ import annotations

from decimal import Decimal

PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211707")
"""To 99 digits; results that hold π are good to 40, more than anything asks."""

_ENOUGH = Decimal("1e-40")


def complete(kc: Decimal, p: Decimal, cosine: Decimal, sine: Decimal) -> Decimal:
    """Return ∫₀ᴷ (cosine cn² + sine sn²)/(cn² + p sn²) dw for kc = √mc > 0, p > 0 and coefficients ≥ 0.

    Bulirsch's cel (*Numerical calculation of elliptic integrals and elliptic functions III*, Numer. Math. 13 (1969)
    305): arithmetic–geometric means that converge quadratically. K itself is complete(kc, 1, 1, 1).

    >>> print(round(complete(Decimal(1), Decimal(4), Decimal(1), Decimal(1)) * 4 / PI, 12))  # ∫ dw/(1 + 3 sin² w) = π/4
    1.000000000000
    """
    product, mean, other = kc, Decimal(1), kc
    p = p.sqrt()
    a, b = cosine, sine / p
    while True:
        quotient = product / p
        a, b, p, previous = a + b / p, 2 * (b + a * quotient), p + quotient, mean
        mean += other
        if abs(previous - other) <= _ENOUGH * previous:
            return PI / 2 * (b + a * mean) / (mean * (mean + p))
        other = 2 * product.sqrt()
        product = other * mean


def first_kind(sine: Decimal, cosine_squared: Decimal, mc: Decimal) -> Decimal:
    """Return w, −K … K, with sn w = `sine` and cn² w = `cosine_squared`: s R_F(c², c² + mc s², 1).

    Carlson's duplication, with the series of its last step (Numer. Algor. 10 (1995) 13, eq. 2.1–2.13).

    >>> print(round(6 * first_kind(Decimal("0.5"), Decimal("0.75"), Decimal(1)) / PI, 12))  # arcsin ½ = π/6
    1.000000000000
    """
    x, y, z = cosine_squared, cosine_squared + mc * sine * sine, Decimal(1)
    while True:
        mean = (x + y + z) / 3
        dx, dy = 1 - x / mean, 1 - y / mean
        dz = -dx - dy
        if max(abs(dx), abs(dy), abs(dz)) < Decimal("1e-6"):
            e2, e3 = dx * dy - dz * dz, dx * dy * dz
            series = 1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44 - 5 * e2**3 / 208 + 3 * e3 * e3 / 104
            return sine * (series + e2 * e2 * e3 / 16) / mean.sqrt()
        roots = x.sqrt(), y.sqrt(), z.sqrt()
        shift = roots[0] * roots[1] + roots[1] * roots[2] + roots[2] * roots[0]
        x, y, z = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4


def pair(value: Decimal) -> tuple[float, float]:
    """Return the double-double nearest to a decimal number."""
    high = float(value)
    return high, float(value - Decimal(high))
