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

_MOST = 6  # decimals: a nanometre, a millionth of a degree, a microgram
_ROUNDING = 1e-12  # of a figure in its unit: what conversions leave of it


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


def decimals_needed(value: float, within: float = math.inf) -> int:
    """Return with how many decimals a figure is printed, six at most.

    Parameters
    ----------
    value : the figure
    within : where it has no end, by how much it may be off as printed, in its unit

    >>> decimals_needed(12.775), decimals_needed(0.018 * 25.4), decimals_needed(90.0)
    (3, 4, 0)
    >>> decimals_needed(360 / 7), decimals_needed(360 / 7, within=0.01), decimals_needed(40.03605502)
    (0, 2, 0)
    """
    for decimals in range(_MOST + 1):
        if abs(round(value, decimals) - value) <= _ROUNDING * max(1.0, abs(value)):
            return decimals
    if within == math.inf:
        return 0
    return min(_MOST, max(0, math.ceil(-math.log10(2.0 * within)))) if within > 0 else _MOST
