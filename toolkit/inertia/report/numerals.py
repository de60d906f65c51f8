"""Numbers as the balancing report prints them."""

from __future__ import annotations

import cmath
import math

from inertia.balancing.shop_units import GRAM_MILLIMETRE, OUNCE_INCH, in_degrees

_OUNCE_INCH_GMM = OUNCE_INCH / GRAM_MILLIMETRE
_INCH_MM = 25.4


def significant(value: float, digits: int = 4, decimals: int = 3) -> str:
    """Return a value with so many significant digits, but no more decimals than given; never in powers of ten.

    >>> significant(28647.89), significant(0.65432), significant(0.0), significant(0.0001)
    ('28648', '0.654', '0', '<0.001')
    """
    size = abs(value)
    if size == 0:
        return "0"
    if size < 0.5 * 10.0**-decimals:
        return f"<{10.0**-decimals:.{decimals}f}"
    places = digits - 1 - math.floor(math.log10(size))
    return f"{value:.{min(max(places, 0), decimals)}f}"


def fixed(value: float, decimals: int) -> str:
    """Return a value with so many decimals, and no minus sign before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def plain(value: float, decimals: int) -> str:
    """Return a value with so many decimals at most, and none that are zero.

    >>> plain(280.0, 3), plain(150.60714, 3), plain(-0.0, 1)
    ('280', '150.607', '0')
    """
    text = fixed(value, decimals)
    return text.rstrip("0").rstrip(".") if "." in text else text


def degrees(vector: complex) -> str:
    """Return the angle of a vector, to 0.1°.

    >>> degrees(-1j), degrees(1 - 1e-9j)
    ('270.0°', '0.0°')
    """
    return f"{round(in_degrees(vector), 1) % 360.0:.1f}°"


def ounce_inches(gmm: float) -> str:
    """Return an unbalance in g·mm as oz·in.

    >>> ounce_inches(720.0778862)
    '1.000'
    """
    return significant(abs(gmm) / _OUNCE_INCH_GMM, 4, 5)


def ounce_square_inches(gmm2: float) -> str:
    """Return a couple in g·mm² as oz·in²."""
    return significant(abs(gmm2) / (_OUNCE_INCH_GMM * _INCH_MM), 4, 4)


def rectangular(magnitude: float, angle: float) -> complex:
    """Return the vector of a magnitude at an angle in degrees."""
    return cmath.rect(magnitude, math.radians(angle))
