"""The textbook's quadratures for a top let go at a tilt, with nothing but its spin, by mpmath at 60 digits.

θ by sn, φ and φ + ψ by Legendre's integrals of the third kind: another route than the package's, and one whose cost
does not grow with the time. Nothing here is shared with the package.
"""

from collections.abc import Sequence

import mpmath
import numpy as np


def let_go(
    moments: tuple[float, float], mgh: float, half_angle: tuple[float, float], spin: float, times: Sequence[float]
) -> np.ndarray:
    """Return attitudes (n, 4) in mpf from (s, 0, 0, c)/|…| with (s, c) = `half_angle` and ω = (0, 0, spin); mgh > 0.

    With u₀ = cosθ₀ the upper turning point, u̇² = (u₀ − u) [β (1 − u²) − a² (u₀ − u)].
    """
    with mpmath.workdps(60):
        i1, i3, weight, own = map(mpmath.mpf, (*moments, mgh, spin))
        s, c = map(mpmath.mpf, half_angle)
        fall, rise = 2 * s**2 / (s**2 + c**2), 2 * c**2 / (s**2 + c**2)
        a, beta = i3 * own / i1, 2 * weight / i1
        root = mpmath.sqrt(a**4 + 4 * beta**2 - 4 * a**2 * beta * (1 - fall))
        far, low = (a**2 + root) / (2 * beta), (a**2 - root) / (2 * beta)
        high = 1 - fall
        m, pace = (high - low) / (far - low), mpmath.sqrt(beta * (far - low)) / 2
        quarter = mpmath.ellipk(m)
        answer = []
        for t in map(mpmath.mpf, times):
            count = mpmath.nint((quarter + pace * t) / (2 * quarter))
            w = quarter + pace * t - 2 * quarter * count
            sn = mpmath.ellipfun("sn", w, m=m)
            amplitude = mpmath.asin(sn)
            below = -a * fall * third((high - low) / (1 - low), m, amplitude, count) / pace / (1 - low)
            above = a * rise * third((low - high) / (1 + low), m, amplitude, count) / pace / (1 + low)
            phi, both = (below + above) / 2, (own - a) * t + above
            u = low + (high - low) * sn**2
            c_half, s_half = mpmath.sqrt((1 + u) / 2), mpmath.sqrt((1 - u) / 2)
            difference = phi - both / 2
            answer.append(
                [
                    s_half * mpmath.cos(difference),
                    s_half * mpmath.sin(difference),
                    c_half * mpmath.sin(both / 2),
                    c_half * mpmath.cos(both / 2),
                ]
            )
        return np.array(answer, dtype=object)


def third(n: mpmath.mpf, m: mpmath.mpf, amplitude: mpmath.mpf, count: mpmath.mpf) -> mpmath.mpf:
    """Return ∫ dw/(1 − n sn² w) from the quarter period K to 2K × count + am⁻¹(amplitude)."""
    return (2 * count - 1) * mpmath.ellippi(n, m) + mpmath.ellippi(n, amplitude, m)


def attitude_error(attitude: np.ndarray, true: np.ndarray) -> float:
    """Return the largest angle in rad between float64 attitudes (n, 4) and mpf ones."""
    with mpmath.workdps(60):
        worst = mpmath.mpf(0)
        for p, q in zip(attitude, true, strict=True):
            p = [mpmath.mpf(float(x)) for x in p]
            size = mpmath.norm(p)
            chord = min(mpmath.norm([x / size - sign * y for x, y in zip(p, q, strict=True)]) for sign in (1, -1))
            worst = max(worst, 4 * mpmath.asin(chord / 2))
        return float(worst)
