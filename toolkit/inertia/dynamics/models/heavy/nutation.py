"""Nutation of a heavy symmetric top: the constants of its closed form, worked out in decimal arithmetic.

With u the cosine of the tilt, a = p_ψ/I1, b = p_φ/I1, α = 2E′/I1 and β = 2 mgh/I1 ≥ 0,

    u̇² = (1 − u²)(α − βu) − (b − a u)² = (u − u₁)(u₂ − u)(X − βu),    u = u₁ + (u₂ − u₁) sn² w,   w = w₀ + Ω t,

with 4Ω² = X − βu₁ and the complementary parameter (X − βu₂)/4Ω². X = βu₃ stays finite where the weight vanishes. The
Cayley–Klein parameters cos ½θ exp ½i(φ + ψ) and sin ½θ exp ½i(φ − ψ) need one integral of the third kind each.

A dozen scalars decide everything, and near the vertical all of them are small differences. They come from the start
taken as exact, with as many digits as the context of the caller has, and are handed on as float64, those that
multiply a time in double-double.

Source: textbook § 13.23; F. Klein, A. Sommerfeld, *The Theory of the Top* II, ch. IV and VI; DLMF 19.7.8 for the
parameters that make the integrals of the third kind carry a passage through the vertical.
"""

from __future__ import annotations

import math
from decimal import Decimal, getcontext

from inertia.dynamics.special.decimal_elliptic import PI, complete, first_kind, pair
from inertia.dynamics.special.double_double import Pair
from inertia.records import dataclass

ZERO, ONE = Decimal(0), Decimal(1)


@dataclass(frozen=True)
class Parameter:
    """One Cayley–Klein parameter as a function of time and of w, with P = cn² + p sn².

    It is (A cn dn + i S sn)/√P where it `alternates`, which carries the axis through the vertical without a jump, and
    A √P else; times exp i(`rate` t + C), with C = coefficient × ∫ cn²/P dw for p ≥ 1 and coefficient × ∫ sn²/P dw for
    p < 1, whichever stays small. Where it does not alternate, S is A d(phase)/dw at w = 0.

    Attributes
    ----------
    amplitude, swing : A and S
    rate : rad/s
    advance : what C gains while w grows by 2K
    """

    alternates: bool
    amplitude: float
    swing: float
    p: float
    rate: Pair
    coefficient: float
    advance: Pair


@dataclass(frozen=True)
class Nutation:
    """The constants of the closed form, for the top turned so that mgh ≥ 0.

    Attributes
    ----------
    hanging : the weight is on the other side of the fixed point, and the top has been turned
    still : the symmetry axis keeps its direction: vertical, or at rest where there is no weight
    noise : relative rounding of what it was worked out from
    rises, falls : 1 + u and 1 − u, at u₁ and at u₂
    speeds : of the axis at u₁ and at u₂, √(α − βu), rad/s; zero at u₂ for a cusp
    reverses : φ̇ changes sign between u₁ and u₂
    rate : Ω, rad/s; mc : complementary parameter; quarter : K; start : w₀, −K … K
    cycles : Ω/2K, the frequency of nutation in s⁻¹; zero on the separatrix
    upper, lower : the parameters with cos ½θ and with sin ½θ
    gain : what φ gains in a period, rad; a passage through the vertical itself counts as no turn
    """

    hanging: bool
    still: bool
    noise: float
    rises: tuple[float, float]
    falls: tuple[float, float]
    speeds: tuple[float, float]
    reverses: bool
    rate: float
    mc: float
    quarter: float
    start: float
    cycles: Pair
    upper: Parameter
    lower: Parameter
    gain: float


@dataclass(frozen=True)
class Start:
    """What a motion starts from: `spin` a, `plus` b + a, `minus` b − a, β, and `own` ω₃, all in rad/s;
    `rise` 1 + u, `fall` 1 − u, `speed2` the axis' speed squared, and whether u grows."""

    spin: Decimal
    plus: Decimal
    minus: Decimal
    beta: Decimal
    own: Decimal
    rise: Decimal
    fall: Decimal
    speed2: Decimal
    upward: bool
    hanging: bool
    noise: float


@dataclass(frozen=True)
class _Pace:
    """Ω, 4Ω², mc and K."""

    rate: Decimal
    size: Decimal
    mc: Decimal
    quarter: Decimal

    def integral(self, p: Decimal, cosine: int, sine: int) -> Decimal:
        """Return 2 ∫₀ᴷ (cosine cn² + sine sn²)/(cn² + p sn²) dw; zero on the separatrix, which has no second period."""
        return 2 * complete(self.mc.sqrt(), p, Decimal(cosine), Decimal(sine)) if self.mc else ZERO


def roots(spin: Decimal, b: Decimal, alpha: Decimal, beta: Decimal) -> tuple[Decimal, Decimal, Decimal]:
    """Return u₁ ≤ u₂ and X; where u₁ and u₂ are not real, their real part twice.

    y = βu gives the cubic the leading coefficient 1; Newton's method comes down on its largest root from above without
    ever crossing it. The other two are the roots of the quotient, divided from its constant term up.
    """
    square, linear, constant = alpha + spin * spin, (2 * spin * b - beta) * beta, (alpha - b * b) * beta * beta
    top = square + 2 * beta
    while True:
        value = ((top - square) * top + linear) * top + constant
        slope = (3 * top - 2 * square) * top + linear
        lower = top - value / slope if value > 0 < slope else top
        if not lower < top:
            break
        top = lower
    product = (b * b - alpha) / top
    total = (2 * spin * b - beta - beta * product) / top
    apart = max(total * total - 4 * product, ZERO).sqrt()
    return (total - apart) / 2, (total + apart) / 2, top


def moving(start: Start) -> Nutation:
    """Return the constants where the axis moves."""
    beta = start.beta
    alpha = start.speed2 + beta * (start.rise - 1)
    low, high, top = roots(start.spin, (start.plus + start.minus) / 2, alpha, beta)
    low, high = max(min(low, start.rise - 1), -ONE), min(max(high, start.rise - 1), ONE)
    rise2, fall1, fall2, over = 1 + high, 1 - low, 1 - high, max(top - beta, ZERO)
    # small ones from (b + a)² = (1 + u₁)(1 + u₂)(X + β) and (b − a)² = (1 − u₁)(1 − u₂)(X − β)
    rise1 = start.plus**2 / (rise2 * (top + beta))
    near = fall2 * beta < over
    if near:
        fall2 = start.minus**2 / (fall1 * over)
    elif fall2:
        over = start.minus**2 / (fall1 * fall2)
    size = over + beta * fall1
    mc = (over + beta * fall2) / size
    if mc < Decimal(10) ** (15 - getcontext().prec // 2):  # all the digits that a double root has
        fall2 = over = mc = ZERO
        near = False
    whole = complete(mc.sqrt(), ONE, ONE, ONE) if mc else Decimal("Infinity")
    pace = _Pace(size.sqrt() / 2, size, mc, whole)

    apart = _difference(rise2, rise1, fall1, fall2)
    below = _difference(rise2, start.rise, start.fall, fall2)
    cosine2 = min(below / apart, ONE) if apart else ONE
    begin = first_kind((1 - cosine2).sqrt(), cosine2, mc)
    drift = (start.own - start.spin) / 2
    upper, gain = _upper(start, (rise1, rise2), drift, pace)
    lower, more = (_through if near else _away)(start, (fall1, fall2), over / size, -drift, pace)
    speed2 = start.speed2 + beta * (start.rise - rise1), start.speed2 - beta * (rise2 - start.rise)
    flow = start.minus + start.spin * fall1, start.minus + start.spin * fall2
    return Nutation(
        hanging=start.hanging,
        still=False,
        noise=start.noise,
        rises=(float(rise1), float(rise2)),
        falls=(float(fall1), float(fall2)),
        speeds=(math.sqrt(max(speed2[0], ZERO)), math.sqrt(max(speed2[1], ZERO))),
        reverses=flow[0] * flow[1] < 0,
        rate=float(pace.rate),
        mc=float(mc),
        quarter=float(whole),
        start=float(begin if start.upward else -begin),
        cycles=pair(pace.rate / (2 * whole)),
        upper=upper,
        lower=lower,
        gain=float(gain + more) if mc else math.nan,
    )


def still(start: Start) -> Nutation:
    """Return the constants where the axis keeps still; the rate is that of small nutations, zero if they grow."""
    size = start.spin**2 + (-2 if start.rise > start.fall else 2) * start.beta
    rate = max(size, ZERO).sqrt() / 2
    upper, lower = (
        Parameter(False, math.sqrt(distance / 2), 0.0, 1.0, pair(own / 2), 0.0, (0.0, 0.0))
        for distance, own in ((start.rise, start.own), (start.fall, -start.own))
    )
    return Nutation(
        hanging=start.hanging,
        still=True,
        noise=start.noise,
        rises=(float(start.rise),) * 2,
        falls=(float(start.fall),) * 2,
        speeds=(0.0, 0.0),
        reverses=False,
        rate=float(rate),
        mc=1.0,
        quarter=math.pi / 2,
        start=0.0,
        cycles=pair(rate / PI),
        upper=upper,
        lower=lower,
        gain=math.nan,
    )


def _difference(rise: Decimal, other_rise: Decimal, other_fall: Decimal, fall: Decimal) -> Decimal:
    """Return u − u′ ≥ 0 from whichever of 1 ± u is small."""
    return max(rise - other_rise if rise < 1 else other_fall - fall, ZERO)


def _upper(start: Start, rises: tuple[Decimal, Decimal], drift: Decimal, pace: _Pace) -> tuple[Parameter, Decimal]:
    """Return the parameter with cos ½θ, and what φ gains by it in a period apart from the drift."""
    p = 1 + start.beta * rises[0] / pace.size
    slope = start.beta * start.plus / (2 * pace.rate * pace.size * p)  # ∫ sn²/P = (w − ∫ cn²/P)/p, and w is linear in t
    advance = -slope * pace.integral(p, 1, 0)
    parameter = Parameter(
        alternates=True,
        amplitude=float((rises[0] / 2).sqrt()),
        swing=float((rises[1] * p / 2).sqrt().copy_sign(start.plus)),
        p=float(p),
        rate=pair(drift + slope * pace.rate),
        coefficient=float(-slope),
        advance=pair(advance),
    )
    return parameter, _half_turn(start.plus) + advance + slope * pace.integral(ONE, 1, 1)


def _through(
    start: Start, falls: tuple[Decimal, Decimal], p: Decimal, drift: Decimal, pace: _Pace
) -> tuple[Parameter, Decimal]:
    """Return the parameter with sin ½θ where it may vanish, and what φ gains by it in a period."""
    coefficient = -start.beta * start.minus / (2 * pace.rate * pace.size)
    advance = coefficient * pace.integral(p, 0, 1)
    parameter = Parameter(
        alternates=True,
        amplitude=float((falls[0] / 2).sqrt()),
        swing=float((falls[1] * p / 2).sqrt().copy_sign(start.minus)),
        p=float(p),
        rate=pair(drift),
        coefficient=float(coefficient),
        advance=pair(advance),
    )
    return parameter, _half_turn(start.minus) + advance


def _away(
    start: Start, falls: tuple[Decimal, Decimal], _: Decimal, drift: Decimal, pace: _Pace
) -> tuple[Parameter, Decimal]:
    """Return the parameter with sin ½θ where it stays away from zero, and what φ gains by it in a period."""
    p, slope = falls[1] / falls[0], start.minus / (2 * pace.rate * falls[0])
    coefficient = slope * (1 - p)
    advance = coefficient * pace.integral(p, 0, 1) if start.minus else ZERO
    amplitude = (falls[0] / 2).sqrt()
    parameter = Parameter(
        alternates=False,
        amplitude=float(amplitude),
        swing=float(amplitude * slope),
        p=float(p),
        rate=pair(drift + slope * pace.rate),
        coefficient=float(coefficient),
        advance=pair(advance),
    )
    return parameter, advance + slope * pace.integral(ONE, 1, 1)


def _half_turn(flow: Decimal) -> Decimal:
    return PI.copy_sign(flow) if flow else ZERO
