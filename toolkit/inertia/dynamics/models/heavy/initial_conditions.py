"""Constants of the motion of a heavy symmetric top from its initial conditions: attitude and ω, or three integrals.

The input is taken as exact and turned into decimal numbers. A weight on the other side of the fixed point is
the same top with axes 2 and 3 turned half about axis 1: mgh and p_ψ change sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal, localcontext
from fractions import Fraction

from inertia.dynamics.models.heavy.nutation import ONE, ZERO, Nutation, Start, moving, roots, still
from inertia.errors import GeometryError

EPSILON = 2.0**-52

_DIGITS = 120
_VERTICAL = Decimal("1e-150")
"""Squared tilt, and squared turn per spin, below which an axis is vertical: float64 still holds their squares."""
_SLACK = Decimal("1e-13")
"""Share of the energy by which integrals rounded to float64 may fall short of the least effective potential."""


Real = float | Fraction


def of_state(
    moments: Sequence[Real], mgh: Real, attitude: Sequence[Real], angular_velocity: Sequence[Real]
) -> Nutation:
    """Return the constants of the motion from an attitude (4,), scalar last, and ω (3,); moments are (I1, I3)."""
    with localcontext() as context:
        context.prec = _DIGITS
        i1, i3, weight = _decimal(moments[0]), _decimal(moments[1]), _decimal(mgh)
        x, y, z, w = map(_decimal, attitude)
        o1, o2, o3 = map(_decimal, angular_velocity)
        if weight < 0:
            x, y, z, w, o2, o3 = w, z, -y, -x, -o2, -o3
        spin, beta, speed2 = i3 * o3 / i1, 2 * abs(weight) / i1, o1 * o1 + o2 * o2
        scale = speed2 + spin * spin + beta
        level, upright = x * x + y * y, z * z + w * w
        smallest = min(n for n in (ONE, level, upright, speed2 / (scale or 1)) if n)
        context.prec -= 2 * smallest.adjusted()
        size = level + upright
        rise, fall = 2 * upright / size, 2 * level / size
        g1, g2 = 2 * (x * z - w * y) / size, 2 * (y * z + w * x) / size
        across = o1 * g1 + o2 * g2
        start = Start(
            spin=spin,
            plus=across + spin * rise,
            minus=across - spin * fall,
            beta=beta,
            own=o3,
            rise=rise,
            fall=fall,
            speed2=speed2,
            upward=g1 * o2 > g2 * o1,
            hanging=weight < 0,
            noise=EPSILON,
        )
        at_rest = speed2 <= _VERTICAL * scale and (min(rise, fall) < _VERTICAL or not beta)
        return still(start) if at_rest else moving(start)


def _decimal(x: Real) -> Decimal:
    return Decimal(x.numerator) / x.denominator if isinstance(x, Fraction) else Decimal(x)


def of_integrals(moments: Sequence[float], mgh: float, p_phi: float, p_psi: float, energy: float) -> Nutation:
    """Return the constants of the motion with these integrals, from its lower turning point.

    Raises `GeometryError` where the energy is below the least effective potential.
    """
    with localcontext() as context:
        context.prec = _DIGITS
        i1, i3, weight = Decimal(moments[0]), Decimal(moments[1]), Decimal(mgh)
        p_own = Decimal(p_psi) * (-1 if weight < 0 else 1)
        spin, b, beta, own = p_own / i1, Decimal(p_phi) / i1, 2 * abs(weight) / i1, p_own / i3 if i3 else ZERO
        alpha = 2 * Decimal(energy) / i1 - spin * own
        scale = abs(alpha) + spin * own + beta
        if not scale:
            raise GeometryError("the top has neither weight nor energy: it rests at any tilt, so give its attitude")
        low, high, _ = roots(spin, b, alpha, beta)
        middle = max(min((low + high) / 2, ONE), -ONE)
        if (1 - middle * middle) * (alpha - beta * middle) - (b - spin * middle) ** 2 < -_SLACK * scale:
            raise GeometryError(
                f"the energy of {energy:.6g} J is below the least that p_phi = {p_phi:.6g} and p_psi = {p_psi:.6g} "
                "kg m²/s allow: check the three of them"
            )
        low = max(min(low, ONE), -ONE)
        start = Start(
            spin=spin,
            plus=b + spin,
            minus=b - spin,
            beta=beta,
            own=own,
            rise=1 + low,
            fall=1 - low,
            speed2=max(alpha - beta * low, ZERO),
            upward=True,
            hanging=weight < 0,
            noise=EPSILON**0.5,
        )
        at_rest = low == 1 or high <= -1 or not (beta or start.speed2)
        return still(start) if at_rest else moving(start)
