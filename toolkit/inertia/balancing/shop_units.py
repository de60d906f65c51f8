"""Units of the shop, and an unbalance in them: g·mm and degrees, where everything else here is SI and complex."""

from __future__ import annotations

import cmath
import math

GRAM_MILLIMETRE = 1e-6
"""kg m in a g·mm."""

GRAM_SQUARE_MILLIMETRE = 1e-9
"""kg m² in a g·mm²."""

INCH = 25.4e-3
"""m in an inch."""

OUNCE_INCH = 28.349523125e-3 * INCH
"""kg m in an oz·in: 720.0779 g·mm."""

POUND = 0.45359237
"""kg in a pound."""


def in_gmm(unbalance: complex) -> float:
    """Return the magnitude of an unbalance (kg m) in g·mm.

    >>> round(in_gmm(3e-3 + 4e-3j), 9)
    5000.0
    """
    return abs(unbalance) / GRAM_MILLIMETRE


def in_degrees(unbalance: complex) -> float:
    """Return the angle of an unbalance in degrees, from 0 up to but not including 360; 0 for no unbalance.

    >>> in_degrees(-1j)
    270.0
    """
    angle = math.degrees(cmath.phase(unbalance)) if unbalance else 0.0
    turned = angle % 360.0
    return turned if turned < 360.0 else 0.0


def angular_speed(rpm: float) -> float:
    """Return rad/s of r/min.

    >>> round(angular_speed(3000.0), 6)
    314.159265
    """
    return rpm * math.pi / 30.0
