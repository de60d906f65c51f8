"""Balancing from amplitudes without phase: the three-run and the four-run method in one plane.

Of one plane and one sensor, the run with a trial weight w shows R = a |u + w|, with u the unbalance and a the machine's
sensitivity, neither of which is known. The squares of the runs are linear in (a²|u|², a² u, a²); with the first run
without weight, two runs more leave two places for u, a fourth tells which. Squares exaggerate what is uncertain, so
the amplitudes themselves are fitted afterwards, by Gauss and Newton.

The drawing of it has circles of radius R about the weights (Wowk, V. (1995), Machinery Vibration: Balancing,
McGraw-Hill, chapter 4).
"""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex
from inertia.errors import GeometryError, UsageError
from inertia.records import dataclass

_PARALLEL = 1e-9  # sine of the angle between two weights; weights no farther apart, of the largest, are one
_SAME = 1e-3  # of an unbalance: places no farther apart are one
_ALIKE = 9  # decimals of a misfit: what is beyond them is rounding
_STEPS = 50
_SETTLED = 1e-12
_STIFF = 1e6


@dataclass(frozen=True)
class AmplitudeFit:
    """An unbalance that explains the amplitudes.

    Attributes
    ----------
    unbalance : the heavy spot, in the unit of the weights
    sensitivity : amplitude per unit of unbalance
    misfit : root mean square of what it leaves of the amplitudes, over the largest of them
    """

    unbalance: complex
    sensitivity: float
    misfit: float


def amplitude_balance(amplitudes: ArrayLike, weights: ArrayLike) -> tuple[AmplitudeFit, ...]:
    """Return the unbalances that explain amplitudes measured with weights, the best first, of as good ones the smaller.

    Three runs leave two, as a rule; so do more whose weights all lie on one line. Where a second place fits as well as
    the first, another run tells: one weight in the direction of the first is enough.

    Parameters
    ----------
    amplitudes : (r,) in any unit of vibration
    weights : (r,) complex, what was mounted in each run; zero in one of them

    Raises `UsageError` where there are fewer than three runs or none without weight, `GeometryError` where no unbalance
    explains the amplitudes.

    >>> best = amplitude_balance([3.0, 4.0, 5.0, 5.0], [0, 1, 4j, -4j])[0]
    >>> round(best.unbalance.real, 9) + 0.0, round(best.unbalance.imag, 9) + 0.0, round(best.sensitivity, 9)
    (3.0, 0.0, 1.0)
    """
    sizes = np.abs(complex_of(amplitudes, "amplitudes"))
    mounted = complex_of(weights, "weights")
    if sizes.ndim != 1 or sizes.shape != mounted.shape:
        raise UsageError(f"amplitudes have shape {sizes.shape} and weights {mounted.shape}: give one of each a run")
    bare = np.flatnonzero(mounted == 0)
    apart = np.abs(mounted[:, None] - mounted) > _PARALLEL * np.abs(mounted).max(initial=0.0)
    places = sum(bool(row[:k].all()) for k, row in enumerate(apart))
    if not len(bare) or places < 3:
        zero = "one of them zero" if len(bare) else "none of them zero"
        raise UsageError(
            f"{places} different weights are given, {zero}: without phase it takes a run without weight and two or "
            "more with one, at different places"
        )
    largest = float(sizes.max())
    if not largest:
        raise GeometryError("all amplitudes are zero: there is nothing to be balanced, or the sensor is off")
    # In units of the largest amplitude and weight: the steps of the fit would be cut short by the size of others.
    unit = float(np.abs(mounted).max())
    sizes, mounted = sizes / largest, mounted / unit
    starts = [
        start
        for pair in combinations(np.flatnonzero(mounted != 0).tolist(), 2)
        for start in _of_three(float(sizes[bare].mean()), sizes[list(pair)], mounted[list(pair)])
    ]
    fits = sorted(
        (_fitted(sizes, mounted, start) for start in starts),
        key=lambda fit: (round(fit.misfit, _ALIKE), abs(fit.unbalance)),
    )
    fits = [AmplitudeFit(fit.unbalance * unit, fit.sensitivity * largest / unit, fit.misfit) for fit in fits]
    unlike: list[AmplitudeFit] = []
    for fit in fits:
        if all(abs(fit.unbalance - one.unbalance) > _SAME * abs(one.unbalance) for one in unlike):
            unlike.append(fit)
    if not unlike:
        raise GeometryError(
            "no unbalance explains the amplitudes: the weights did not change them, or they were not all measured at "
            "one speed; repeat with larger weights"
        )
    return tuple(unlike)


def _of_three(bare: float, sizes: Float, weights: Complex) -> list[complex]:
    """Return the unbalances that a run without weight and two with weights leave, exactly or as near as can be.

    With β = 1/a² the squares say 2 Re(u w̄ₖ) = β (Rₖ² − R₀²) − |wₖ|²: u = β g + h, and |u|² = β R₀².
    """
    (x1, y1), (x2, y2) = ((w.real, w.imag) for w in weights.tolist())
    gains, lengths = sizes**2 - bare**2, np.abs(weights)
    across = x1 * y2 - x2 * y1
    if abs(across) > _PARALLEL * lengths.prod():
        matrix = np.linalg.inv(2.0 * np.array([[x1, y1], [x2, y2]]))
        g, h = (complex(*(matrix @ side)) for side in (gains, -(lengths**2)))
        betas = _roots(abs(g) ** 2, 2.0 * (g * h.conjugate()).real - bare**2, abs(h) ** 2)
        return [beta * g + h for beta in betas if beta > 0]
    along = weights[0] / lengths[0]
    first, second = (weights / along).real.tolist()
    if abs(first - second) <= _PARALLEL * max(abs(first), abs(second)):
        return []
    # Both on one line, at places p: (Rₖ² − R₀²)/pₖ = a² (2 x + pₖ), and the unbalance lies on either side of the line.
    over = gains / [first, second]
    square = float(over[1] - over[0]) / (second - first)
    if square <= 0:
        return []
    x = 0.5 * (float(over[0]) / square - first)
    y = math.sqrt(max(0.0, bare**2 / square - x**2))
    return [complex(along) * complex(x, y), complex(along) * complex(x, -y)]


def _roots(a: float, b: float, c: float) -> tuple[float, ...]:
    """Return the real roots of a x² + b x + c, or where they are complex their real part."""
    if a == 0:
        return (-c / b,) if b else ()
    inner = b**2 - 4.0 * a * c
    if inner <= 0:
        return (-b / (2.0 * a),)
    total = -0.5 * (b + math.copysign(math.sqrt(inner), b))
    return (total / a, c / total) if total else (0.0,)


def _fitted(sizes: Float, weights: Complex, start: complex) -> AmplitudeFit:
    """Fit a |u + w| to the amplitudes of all runs, from a start, by damped Gauss-Newton steps."""
    u, damping = start, 1e-6

    def best(place: complex) -> tuple[float, Float]:
        reach = np.abs(place + weights)
        slope = float(reach @ sizes / (reach @ reach)) if reach.any() else 0.0
        return slope, slope * reach - sizes

    a, left = best(u)
    for _ in range(_STEPS):
        reach = np.abs(u + weights)
        toward = np.divide(u + weights, reach, out=np.ones_like(weights), where=reach > 0)
        jacobian = np.column_stack([a * toward.real, a * toward.imag, reach])
        normal = jacobian.T @ jacobian
        step = np.linalg.lstsq(normal + damping * np.diag(np.diag(normal)), -jacobian.T @ left, rcond=None)[0]
        moved = u + complex(step[0], step[1])
        forward, after = best(moved)
        if after @ after < left @ left:
            settled = abs(moved - u) <= _SETTLED * abs(u)
            u, a, left, damping = moved, forward, after, damping / 10.0
            if settled:
                break
        else:
            damping *= 10.0
            if damping > _STIFF:
                break
    return AmplitudeFit(u, a, float(np.sqrt(np.mean(left**2)) / sizes.max()))
